#include "records.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>

enum
{
  FACETS = 4,         /* of a cell */
  MAX_CROSSINGS = 16, /* on one dual; more of them change nothing: it is refined anyway */
  PIECE = 64,         /* cells that one thread takes at a time */
  PIECES = 128,       /* between two looks at the host, about 5 ms */
  FEW = 16            /* pieces that are not worth waking a thread for */
};

/* What is new about a facet: its record goes if there is one, and another comes if it crosses. */
typedef struct finding
{
  double crossing[3];
  mlim_sheet sheet;
  int32_t cell;
  unsigned char index;
  unsigned char crosses;
  unsigned char is_multiple;
} finding;

typedef struct update
{
  mlim_complex* complex;
  double done;
  finding* findings; /* room for all facets of a piece's cells, piece after piece */
  size_t counts[PIECES];
} update;

static finding* findings_of(const update* u, size_t piece)
{
  return u->findings + (size_t)FACETS * PIECE * (piece % PIECES);
}

static size_t least(size_t a, size_t b)
{
  return a < b ? a : b;
}

/* ---- labels ---- */

/* Rounded down: less is only looked at more closely. */
static uint16_t narrow(float clearance)
{
  const float parts = clearance * MLIM_CLEARANCE_PARTS;
  return (uint16_t)(parts < UINT16_MAX ? parts : UINT16_MAX);
}

static void label_piece(const update* u, size_t piece)
{
  mlim_complex* complex = u->complex;
  const size_t begin = piece * PIECE;
  const size_t end = least(begin + PIECE, u->complex->made_count);
  mlim_field_look looks[PIECE];
  for (size_t k = begin; k < end; ++k)
  {
    looks[k - begin].point = mlim_complex_center(complex, complex->made[k]);
  }
  mlim_field_look_at(complex->oracle.field, looks, end - begin);
  for (size_t k = begin; k < end; ++k)
  {
    mlim_cell* cell = &complex->cells[complex->made[k]];
    cell->label = looks[k - begin].label;
    cell->clearance = narrow(looks[k - begin].clearance);
  }
}

static void label_body(void* data, size_t begin, size_t end)
{
  for (size_t piece = begin; piece < end; ++piece)
  {
    label_piece((const update*)data, piece);
  }
}

static mlim_status look_at_host(void* data, size_t begin, size_t end, mlim_context* context)
{
  (void)begin;
  (void)end;
  return mlim_progress(context, MLIM_STAGE_SURFACE, ((const update*)data)->done);
}

/* ---- facets ---- */

/* The crossing farthest from the facet: Chew's rule. All its vertices are equally far in power. */
static size_t farthest(const mlim_crossing* crossing, size_t count, const double vertex[3])
{
  size_t best = 0;
  double most = -1;
  for (size_t c = 0; c < count; ++c)
  {
    const double d = mlim_distance_squared(crossing[c].point, vertex);
    if (d > most)
    {
      most = d;
      best = c;
    }
  }
  return best;
}

/* A dual that stays where the field is uniform, as most between cells of one label do: round each end
   lies a cube of its label, and the two cover it together. */
static int is_clear(const mlim_complex* complex, int32_t a, int32_t b)
{
  const double* inverse = mlim_field_grid_of(complex->oracle.field)->inverse_spacing;
  const double* start = mlim_complex_center(complex, a);
  const double* end = mlim_complex_center(complex, b);
  double longest = 0;
  for (int k = 0; k < 3; ++k)
  {
    longest = mlim_max(longest, fabs(start[k] - end[k]) * inverse[k]);
  }
  return longest * MLIM_CLEARANCE_PARTS <=
         complex->cells[a].clearance + complex->cells[b].clearance;
}

static mlim_sheet sheet_between(int32_t from, int32_t to, int32_t face)
{
  const int is_up = from < to;
  return (mlim_sheet){ .low = is_up ? from : to, .high = is_up ? to : from, .face = face };
}

static float widen(const mlim_cell* cell)
{
  return (float)cell->clearance / MLIM_CLEARANCE_PARTS;
}

/* Looks along the dual of a facet. */
static void cross_facet(const mlim_complex* complex, finding* out)
{
  const mlim_cell* cell = &complex->cells[out->cell];
  const int32_t n = cell->neighbors[out->index];
  const mlim_cell* other = &complex->cells[n];
  const int differs = cell->label != other->label;
  out->crosses = 0;
  if (!differs && is_clear(complex, out->cell, n))
  {
    return;
  }
  const mlim_segment dual = { .ends = { mlim_complex_center(complex, out->cell),
                                mlim_complex_center(complex, n) },
    .labels = { cell->label, other->label },
    .clearances = { widen(cell), widen(other) } };
  mlim_crossing crossing[MAX_CROSSINGS];
  const size_t count =
    mlim_oracle_crossings_between(&complex->oracle, &dual, MAX_CROSSINGS, crossing);
  if (count == 0)
  {
    return;
  }
  const double* near = complex->vertices[cell->vertices[(out->index + 1) & 3]].point;
  const mlim_crossing* far = &crossing[farthest(crossing, count, near)];
  mlim_copy(far->point, out->crossing);
  out->sheet = sheet_between(far->from, far->to, far->face);
  out->crosses = 1;
  out->is_multiple = count > 1 || !differs;
}

/* A single crossing of the sheet between the two labels is on the dual as long as its ends have them. */
static int matches(const mlim_facet* facet, int32_t a, int32_t b)
{
  return !facet->is_multiple && a != b && facet->sheet.low == (a < b ? a : b) &&
         facet->sheet.high == (a < b ? b : a);
}

/* Whether there is something new about a facet of a new cell. Its dual may be part of one that was looked
   at before: there was no crossing, or its record says which. */
static int look_at_facet(const mlim_complex* complex, int32_t id, int index, finding* out)
{
  const mlim_cell* cell = &complex->cells[id];
  const int32_t n = cell->neighbors[index];
  if (n == MLIM_NO_CELL)
  {
    return 0;
  }
  const mlim_cell* other = &complex->cells[n];
  const int is_new = other->mark == complex->stamp;
  if (is_new && n < id)
  {
    return 0;
  }
  *out = (finding){ .cell = id, .index = (unsigned char)index };
  const int32_t record = cell->facets[index];
  const int differs = cell->label != other->label;
  if (record == 0)
  {
    if (is_new || differs)
    {
      cross_facet(complex, out);
    }
    return out->crosses;
  }
  const mlim_facet* facet = &complex->facets[record];
  if (matches(facet, cell->label, other->label))
  {
    return 0;
  }
  if (facet->is_multiple || differs)
  {
    cross_facet(complex, out);
  }
  return 1;
}

static void look_at_piece(update* u, size_t piece)
{
  const mlim_complex* complex = u->complex;
  const size_t begin = piece * PIECE;
  const size_t end = least(begin + PIECE, u->complex->made_count);
  finding* out = findings_of(u, piece);
  for (size_t k = begin; k < end; ++k)
  {
    for (int i = 0; i < FACETS; ++i)
    {
      out += look_at_facet(complex, complex->made[k], i, out);
    }
  }
  u->counts[piece % PIECES] = (size_t)(out - findings_of(u, piece));
}

static void look_body(void* data, size_t begin, size_t end)
{
  for (size_t piece = begin; piece < end; ++piece)
  {
    look_at_piece((update*)data, piece);
  }
}

/* ---- records ---- */

static int32_t new_record(mlim_complex* complex)
{
  if (complex->free_count > 0)
  {
    return complex->free_facets[--complex->free_count];
  }
  if (complex->facet_count >= INT32_MAX - 1 ||
      mlim_reserve_apart(&complex->facets, &complex->facet_capacity, complex->facet_count + 1,
        sizeof *complex->facets) ||
      mlim_reserve_apart(&complex->free_facets, &complex->free_capacity, complex->facet_capacity,
        sizeof *complex->free_facets))
  {
    return 0;
  }
  complex->facets[complex->facet_count] = (mlim_facet){ 0 };
  return (int32_t)complex->facet_count++;
}

/* Returns 1 when out of memory. */
static int apply(mlim_complex* complex, const finding* found)
{
  mlim_cell* cell = &complex->cells[found->cell];
  mlim_cell* other = &complex->cells[cell->neighbors[found->index]];
  const int32_t old = cell->facets[found->index];
  int32_t record = 0;
  if (old != 0)
  {
    mlim_complex_kill_record(complex, old);
  }
  if (found->crosses)
  {
    record = new_record(complex);
    if (record == 0 || mlim_reserve_apart(&complex->fresh, &complex->fresh_capacity,
                         complex->fresh_count + 1, sizeof *complex->fresh))
    {
      return 1;
    }
    mlim_facet* facet = &complex->facets[record];
    const uint32_t generation = facet->generation;
    *facet = (mlim_facet){ .sheet = found->sheet,
      .cell = found->cell,
      .generation = generation,
      .index = found->index,
      .is_alive = 1,
      .is_multiple = found->is_multiple };
    mlim_copy(found->crossing, facet->crossing);
    complex->fresh[complex->fresh_count++] = record;
  }
  cell->facets[found->index] = record;
  other->facets[mlim_complex_index_apart(other, cell)] = record;
  mlim_complex_touch_facet(complex, found->cell, found->index);
  return 0;
}

static mlim_status apply_all(void* data, size_t begin, size_t end, mlim_context* context)
{
  const update* u = (const update*)data;
  for (size_t piece = begin; piece < end; ++piece)
  {
    const finding* findings = findings_of(u, piece);
    for (size_t k = 0; k < u->counts[piece % PIECES]; ++k)
    {
      if (apply(u->complex, &findings[k]))
      {
        return mlim_fail_memory(context, "the restricted facets");
      }
    }
  }
  return mlim_progress(context, MLIM_STAGE_SURFACE, u->done);
}

/* ---- the whole ---- */

/* Leaves the cells that are alive, each once, and marks them with the stamp. */
static void keep_living(mlim_complex* complex)
{
  const uint32_t stamp = ++complex->stamp;
  size_t kept = 0;
  for (size_t k = 0; k < complex->made_count; ++k)
  {
    const int32_t id = complex->made[k];
    mlim_cell* cell = &complex->cells[id];
    if (cell->vertices[0] >= 0 && cell->mark != stamp)
    {
      cell->mark = stamp;
      complex->made[kept++] = id;
    }
  }
  complex->made_count = kept;
}

static mlim_status run(update* u, mlim_body body,
  mlim_status (*finish)(void*, size_t, size_t, mlim_context*), mlim_context* context)
{
  return mlim_parallel_batches(
    context, &(mlim_batches){ .count = (u->complex->made_count + PIECE - 1) / PIECE,
               .size = PIECES,
               .few = FEW,
               .body = body,
               .finish = finish,
               .job = u });
}

mlim_status mlim_records_update(mlim_complex* complex, double done, mlim_context* context)
{
  complex->fresh_count = 0;
  keep_living(complex);
  const size_t room = least(PIECES * PIECE, complex->made_count + PIECE);
  update u = {
    .complex = complex, .done = done, .findings = mlim_allocate(FACETS * room, sizeof(finding))
  };
  mlim_status status = u.findings == NULL ? mlim_fail_memory(context, "the restricted facets")
                                          : run(&u, label_body, look_at_host, context);
  status = status == MLIM_OK ? run(&u, look_body, apply_all, context) : status;
  mlim_release(u.findings);
  complex->made_count = 0;
  return status;
}

int mlim_records_hold(const mlim_complex* complex, const mlim_facet* facet)
{
  const mlim_cell* cell = &complex->cells[facet->cell];
  const int32_t sides[2] = { facet->cell, cell->neighbors[facet->index] };
  int32_t labels[2];
  int is_new = 0;
  for (int k = 0; k < 2; ++k)
  {
    const int32_t known = complex->cells[sides[k]].label;
    is_new |= known == MLIM_NO_LABEL;
    labels[k] = known != MLIM_NO_LABEL
                  ? known
                  : mlim_field_label(complex->oracle.field, mlim_complex_center(complex, sides[k]));
  }
  return !is_new || matches(facet, labels[0], labels[1]);
}
