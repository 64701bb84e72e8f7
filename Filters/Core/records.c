#include "records.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

enum
{
  FACETS = 4, /* of a cell */
  PIECE = 64, /* cells that one thread takes at a time */
  PIECES = MLIM_RECORD_PIECES,
  FEW = 4 /* pieces that are not worth waking a thread for */
};

/* One call, from the labels of the new cells to the duals that are left to look along. */
typedef struct update
{
  mlim_records* records;
  mlim_complex* complex;
  double done;
} update;

static size_t least(size_t a, size_t b)
{
  return a < b ? a : b;
}

static mlim_dual* duals_of(const mlim_records* records, size_t piece)
{
  return records->duals + (size_t)FACETS * PIECE * (piece % PIECES);
}

static int32_t* stale_of(const mlim_records* records, size_t piece)
{
  return records->stale + (size_t)FACETS * PIECE * (piece % PIECES);
}

void mlim_records_free(mlim_records* records)
{
  mlim_release(records->duals);
  mlim_release(records->stale);
  *records = (mlim_records){ 0 };
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

/* A single crossing of the sheet between the two labels is on the dual as long as its ends have them. */
static int matches(const mlim_facet* facet, int32_t a, int32_t b)
{
  return !facet->is_multiple && a != b && facet->sheet.low == (a < b ? a : b) &&
         facet->sheet.high == (a < b ? b : a);
}

/* How many duals and records a piece's cells have given so far. */
typedef struct finds
{
  mlim_dual* duals;
  int32_t* stale;
  size_t dual_count, stale_count;
} finds;

/* A facet of a new cell. Its dual may be part of one that was looked at before: there was no crossing, or its
   record says which. */
static void look_at_facet(const mlim_complex* complex, int32_t id, int index, finds* out)
{
  const mlim_cell* cell = &complex->cells[id];
  const int32_t n = cell->neighbors[index];
  if (n == MLIM_NO_CELL)
  {
    return;
  }
  const mlim_cell* other = &complex->cells[n];
  const int is_new = other->mark == complex->stamp;
  if (is_new && n < id)
  {
    return;
  }
  const int32_t record = cell->facets[index];
  const int differs = cell->label != other->label;
  int is_open = differs || (is_new && !mlim_dual_is_clear(complex, id, n));
  if (record > 0)
  {
    const mlim_facet* facet = &complex->facets[record];
    if (matches(facet, cell->label, other->label))
    {
      return;
    }
    out->stale[out->stale_count++] = record;
    is_open = differs || (facet->is_multiple && !mlim_dual_is_clear(complex, id, n));
  }
  if (is_open)
  {
    mlim_dual_copy(complex, id, index, &out->duals[out->dual_count++]);
  }
}

static void look_at_piece(update* u, size_t piece)
{
  mlim_records* records = u->records;
  const size_t begin = piece * PIECE;
  const size_t end = least(begin + PIECE, u->complex->made_count);
  finds out = { .duals = duals_of(records, piece), .stale = stale_of(records, piece) };
  for (size_t k = begin; k < end; ++k)
  {
    for (int i = 0; i < FACETS; ++i)
    {
      look_at_facet(u->complex, u->complex->made[k], i, &out);
    }
  }
  records->dual_counts[piece % PIECES] = (uint16_t)out.dual_count;
  records->stale_counts[piece % PIECES] = (uint16_t)out.stale_count;
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

/* A record goes; what its facet has instead is not known yet. */
static void drop_record(mlim_complex* complex, int32_t record)
{
  const mlim_facet* facet = &complex->facets[record];
  mlim_cell* cell = &complex->cells[facet->cell];
  mlim_cell* other = &complex->cells[cell->neighbors[facet->index]];
  mlim_complex_touch_facet(complex, facet->cell, facet->index);
  cell->facets[facet->index] = 0;
  other->facets[mlim_complex_index_apart(other, cell)] = 0;
  mlim_complex_kill_record(complex, record);
}

/* The side of a dual whose cell is still the one that it was, -1: neither. What was made since has no label. */
static int living_side(const mlim_complex* complex, const mlim_dual* dual)
{
  for (int side = 0; side < 2; ++side)
  {
    const mlim_cell* cell = &complex->cells[dual->cells[side]];
    if (cell->vertices[0] >= 0 && cell->label != MLIM_NO_LABEL)
    {
      return side;
    }
  }
  return -1;
}

/* The dual may have become shorter at one end since it was copied: the record passes on. Returns 1 when out of
   memory. */
static int add_record(mlim_complex* complex, const mlim_dual* dual)
{
  const int side = living_side(complex, dual);
  if (side < 0)
  {
    return 0;
  }
  const int32_t record = new_record(complex);
  if (record == 0 || mlim_reserve_apart(&complex->fresh, &complex->fresh_capacity,
                       complex->fresh_count + 1, sizeof *complex->fresh))
  {
    return 1;
  }
  mlim_facet* facet = &complex->facets[record];
  const uint32_t generation = facet->generation;
  *facet = (mlim_facet){ .sheet = dual->sheet,
    .cell = dual->cells[side],
    .generation = generation,
    .index = dual->indices[side] & 3,
    .is_alive = 1,
    .is_multiple = dual->is_multiple & 1 };
  mlim_copy(dual->crossing, facet->crossing);
  complex->fresh[complex->fresh_count++] = record;
  mlim_cell* cell = &complex->cells[facet->cell];
  mlim_cell* other = &complex->cells[cell->neighbors[facet->index]];
  cell->facets[facet->index] = record;
  other->facets[mlim_complex_index_apart(other, cell)] = record;
  mlim_complex_touch_facet(complex, facet->cell, facet->index);
  return 0;
}

void mlim_records_cross(mlim_records* records, const mlim_oracle* oracle, size_t part, size_t parts)
{
  for (size_t piece = part; piece < records->piece_count; piece += parts)
  {
    mlim_duals_cross(oracle, duals_of(records, piece), records->dual_counts[piece]);
  }
}

mlim_status mlim_records_end(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context)
{
  int has_failed = 0;
  for (size_t piece = 0; piece < records->piece_count && !has_failed; ++piece)
  {
    const mlim_dual* duals = duals_of(records, piece);
    for (size_t k = 0; k < records->dual_counts[piece] && !has_failed; ++k)
    {
      has_failed = duals[k].crosses && add_record(complex, &duals[k]);
    }
  }
  records->piece_count = 0;
  return has_failed ? mlim_fail_memory(context, "the restricted facets")
                    : mlim_progress(context, MLIM_STAGE_SURFACE, done);
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

static int reserve(mlim_records* records, size_t cells)
{
  const size_t room = FACETS * PIECE * least(PIECES, (cells + PIECE - 1) / PIECE);
  return mlim_reserve(&records->duals, &records->dual_capacity, room, sizeof *records->duals) ||
         mlim_reserve(&records->stale, &records->stale_capacity, room, sizeof *records->stale);
}

typedef struct crossing_job
{
  mlim_records* records;
  const mlim_oracle* oracle;
} crossing_job;

static void cross_body(void* data, size_t begin, size_t end)
{
  const crossing_job* job = (const crossing_job*)data;
  for (size_t piece = begin; piece < end; ++piece)
  {
    mlim_records_cross(job->records, job->oracle, piece, PIECES);
  }
}

mlim_status mlim_records_finish(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context)
{
  if (records->piece_count == 0)
  {
    return MLIM_OK;
  }
  mlim_parallel_for(records->piece_count > FEW ? context : NULL, records->piece_count, cross_body,
    &(crossing_job){ .records = records, .oracle = &complex->oracle });
  return mlim_records_end(records, complex, done, context);
}

/* The pieces that were looked at last are left to be looked along; those before them are done. */
static mlim_status take_looks(void* data, size_t begin, size_t end, mlim_context* context)
{
  const update* u = (const update*)data;
  for (size_t piece = begin; piece < end; ++piece)
  {
    const int32_t* stale = stale_of(u->records, piece);
    for (size_t k = 0; k < u->records->stale_counts[piece % PIECES]; ++k)
    {
      drop_record(u->complex, stale[k]);
    }
  }
  u->records->piece_count = end - begin;
  const size_t all = (u->complex->made_count + PIECE - 1) / PIECE;
  return end == all ? MLIM_OK : mlim_records_finish(u->records, u->complex, u->done, context);
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

mlim_status mlim_records_begin(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context)
{
  keep_living(complex);
  update u = { .records = records, .complex = complex, .done = done };
  mlim_status status = reserve(records, complex->made_count)
                         ? mlim_fail_memory(context, "the restricted facets")
                         : run(&u, label_body, look_at_host, context);
  status = status == MLIM_OK ? run(&u, look_body, take_looks, context) : status;
  complex->made_count = 0;
  return status;
}

mlim_status mlim_records_update(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context)
{
  mlim_status status = mlim_records_finish(records, complex, done, context);
  status = status == MLIM_OK ? mlim_records_begin(records, complex, done, context) : status;
  return status == MLIM_OK ? mlim_records_finish(records, complex, done, context) : status;
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
