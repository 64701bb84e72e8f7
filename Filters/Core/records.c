#include "records.h"

#include "clear.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <string.h>

enum
{
  FACETS = 4,   /* of a cell */
  SIDES = 32,   /* cells whose facets are looked at together */
  LOOKS = 64,   /* that wait for memory together */
  BATCH = 4096, /* cells taken down at a time when all are brought up to date, about 3 ms */
  FEW = 256,    /* cells that are not worth waking a thread for */
  PARTS = 12,   /* of what threads that are awake look at, */
  PART = 32,    /* and cells of such a part at least */
  AHEAD = 8,    /* things from the one at work to the one that is sent for */
  TAKEN = -2    /* label of the first cell that was taken down; those of others follow below */
};

void mlim_records_free(mlim_records* records)
{
  mlim_release(records->cells);
  mlim_release(records->old_cells);
  mlim_release(records->duals);
  *records = (mlim_records){ 0 };
}

/* ---- taking down ---- */

/* Room for all of `made` is there. A cell that was made since has MLIM_NO_LABEL once: what is dead, or there
   twice, is passed over. */
static void take_cells(
  mlim_records* records, mlim_complex* complex, const int32_t* made, size_t count)
{
  size_t taken = 0;
  for (size_t k = 0; k < count; ++k)
  {
    mlim_cell* cell = &complex->cells[made[k]];
    if (cell->vertices[0] >= 0 && cell->label == MLIM_NO_LABEL)
    {
      cell->label = TAKEN - (int32_t)taken;
      records->cells[taken++].id = made[k];
    }
  }
  records->cell_count = taken;
}

/* Its place among the old cells is that of the facet, so that many can be taken down beside each other. */
static int32_t take_beyond(
  mlim_records* records, const mlim_complex* complex, int32_t id, size_t k, int index)
{
  if (id == MLIM_NO_CELL)
  {
    return INT32_MAX;
  }
  const mlim_cell* cell = &complex->cells[id];
  if (cell->label <= TAKEN)
  {
    const int32_t place = TAKEN - cell->label;
    return place > (int32_t)k ? place : INT32_MAX;
  }
  const size_t at = FACETS * k + (size_t)index;
  mlim_old_cell* out = &records->old_cells[at];
  mlim_copy(mlim_complex_center(complex, id), out->center);
  out->id = id;
  out->label = cell->label;
  out->clearance = cell->clearance;
  return -1 - (int32_t)at;
}

static void take_around(mlim_records* records, const mlim_complex* complex, size_t k)
{
  mlim_new_cell* out = &records->cells[k];
  const mlim_cell* cell = &complex->cells[out->id];
  mlim_copy(mlim_complex_center(complex, out->id), out->center);
  memcpy(out->vertices, cell->vertices, sizeof out->vertices);
  memcpy(out->facets, cell->facets, sizeof out->facets);
  for (int i = 0; i < FACETS; ++i)
  {
    out->beyond[i] = take_beyond(records, complex, cell->neighbors[i], k, i);
  }
}

static int reserve(mlim_records* records, size_t count)
{
  return mlim_reserve(
           &records->duals, &records->dual_capacity, FACETS * count, sizeof *records->duals) ||
         mlim_reserve(
           &records->old_cells, &records->old_capacity, FACETS * count, sizeof *records->old_cells);
}

static size_t begin_of(const mlim_records* records, size_t part)
{
  return records->cell_count * part / records->part_count;
}

static void take_part(void* data, size_t part)
{
  mlim_records* records = (mlim_records*)data;
  for (size_t k = begin_of(records, part); k < begin_of(records, part + 1); ++k)
  {
    take_around(records, records->complex, k);
  }
}

static void take_body(void* data, size_t begin, size_t end)
{
  for (size_t part = begin; part < end; ++part)
  {
    take_part(data, part);
  }
}

/* Room for what is round the cells. */
static mlim_status take(mlim_records* records, mlim_complex* complex, const int32_t* made,
  size_t count, mlim_context* context)
{
  int has_failed =
    mlim_reserve(&records->cells, &records->cell_capacity, count, sizeof *records->cells);
  if (!has_failed)
  {
    take_cells(records, complex, made, count);
    has_failed = reserve(records, records->cell_count);
  }
  records->is_pending = !has_failed && records->cell_count > 0;
  records->complex = complex;
  records->oracle = &complex->oracle;
  records->vertices = complex->vertices;
  records->facets = complex->facets;
  return has_failed ? mlim_fail_memory(context, "the restricted facets") : MLIM_OK;
}

mlim_status mlim_records_take(
  mlim_records* records, mlim_complex* complex, mlim_team* team, mlim_context* context)
{
  const mlim_status status = take(records, complex, complex->made, complex->made_count, context);
  const size_t most = mlim_team_is_alone(team) ? 1 : PARTS;
  const size_t parts = 1 + records->cell_count / PART;
  complex->made_count = 0;
  if (status == MLIM_OK)
  {
    records->part_count = parts < most ? parts : most;
    mlim_team_offer(team, &(mlim_team_work){ .body = take_part,
                            .job = records,
                            .count = records->part_count,
                            .second = records->part_count });
    mlim_team_finish(team);
  }
  return status;
}

/* ---- labels ---- */

/* Rounded down: less is only looked at more closely. */
static uint16_t narrow(float clearance)
{
  const float parts = clearance * MLIM_CLEARANCE_PARTS;
  return (uint16_t)(parts < UINT16_MAX ? parts : UINT16_MAX);
}

static void label_some(const mlim_records* records, mlim_new_cell* cells, size_t count)
{
  mlim_field_look looks[LOOKS];
  for (size_t k = 0; k < count; ++k)
  {
    looks[k].point = cells[k].center;
  }
  mlim_field_look_at(records->oracle->field, looks, count);
  for (size_t k = 0; k < count; ++k)
  {
    cells[k].label = looks[k].label;
    cells[k].clearance = narrow(looks[k].clearance);
  }
}

void mlim_records_label(mlim_records* records, size_t begin, size_t end)
{
  const size_t last = begin_of(records, end);
  for (size_t k = begin_of(records, begin); k < last; k += LOOKS)
  {
    label_some(records, &records->cells[k], last - k < LOOKS ? last - k : LOOKS);
  }
}

/* ---- facets ---- */

typedef struct looking
{
  mlim_records* records;
  size_t end; /* of the cells that have their labels */
  mlim_duals found;
} looking;

/* A facet, between a new cell and what is beyond it. */
typedef struct side
{
  const mlim_new_cell* own;
  const mlim_old_cell* beyond;
  int32_t index;
  int32_t is_open;
} side;

/* In place of waiting for those who label it, if they ever do. */
static const mlim_old_cell* look_twice(
  const looking* l, const mlim_old_cell* beyond, mlim_old_cell* out)
{
  mlim_field_look look = { .point = beyond->center };
  mlim_field_look_at(l->records->oracle->field, &look, 1);
  mlim_copy(beyond->center, out->center);
  out->id = beyond->id;
  out->label = look.label;
  out->clearance = narrow(look.clearance);
  return out;
}

/* Those facets of some new cells that are looked at from there, whose records are asked for. Here and below: without
   branches, which would go either way. */
static size_t list_sides(
  const mlim_records* records, const mlim_new_cell* cells, size_t count, side* out)
{
  size_t found = 0;
  for (size_t k = 0; k < count; ++k)
  {
    for (int i = 0; i < FACETS; ++i)
    {
      mlim_prefetch(&records->facets[cells[k].facets[i]]);
      out[found].own = &cells[k];
      out[found].index = i;
      found += cells[k].beyond[i] != INT32_MAX;
    }
  }
  return found;
}

/* A single crossing of the sheet between the two labels is on the dual as long as its ends have them. */
static int matches(const mlim_facet* facet, int32_t a, int32_t b)
{
  const int32_t low = a < b ? a : b;
  const int32_t high = a < b ? b : a;
  return (!facet->is_multiple) & (low != high) & (facet->sheet.low == low) &
         (facet->sheet.high == high);
}

/* Whether the dual between two cells stays in two cubes of their label round its ends. */
static int is_near(
  const mlim_field_grid* grid, const mlim_new_cell* own, const mlim_old_cell* beyond)
{
  double longest = 0;
  for (int k = 0; k < 3; ++k)
  {
    longest =
      mlim_max(longest, fabs(own->center[k] - beyond->center[k]) * grid->inverse_spacing[k]);
  }
  return longest * MLIM_CLEARANCE_PARTS <= own->clearance + beyond->clearance;
}

/* Keeps those whose duals may cross, or contradict a record. A dual may be part of one that was looked at before:
   there was no crossing, or its record says which. */
static size_t keep_sides(const looking* l, side* sides, size_t count, mlim_old_cell* twice)
{
  const mlim_records* records = l->records;
  const mlim_field_grid* grid = mlim_field_grid_of(records->oracle->field);
  size_t kept = 0;
  for (size_t k = 0; k < count; ++k)
  {
    const mlim_new_cell* own = sides[k].own;
    const int index = sides[k].index;
    const int32_t place = own->beyond[index];
    int is_new = place >= 0;
    const mlim_old_cell* beyond =
      is_new ? &records->cells[place].seen : &records->old_cells[-1 - place];
    if (place >= (int32_t)l->end || beyond->label == MLIM_NO_LABEL)
    {
      beyond = look_twice(l, beyond, &twice[k]);
      is_new = 1;
    }
    const int32_t record = own->facets[index];
    const mlim_facet* facet = &records->facets[record]; /* record 0 is empty */
    const int differs = own->label != beyond->label;
    const int may_cross = facet->is_multiple | (is_new & (record == 0));
    const int is_open = differs | (may_cross & !is_near(grid, own, beyond));
    sides[kept] = (side){ .own = own, .beyond = beyond, .index = index, .is_open = is_open };
    kept += (size_t)((is_open | (record != 0)) & !matches(facet, own->label, beyond->label));
  }
  return kept;
}

static void copy_dual(const side* from, mlim_dual* out)
{
  const mlim_new_cell* own = from->own;
  const mlim_old_cell* beyond = from->beyond;
  const int index = from->index;
  const int32_t* v = own->vertices;
  const int is_odd = index & 1;
  *out = (mlim_dual){ .cells = { own->id, beyond->id },
    .labels = { own->label, beyond->label },
    .vertices = { v[(index + 1) & 3], v[(index + (is_odd ? 3 : 2)) & 3],
      v[(index + (is_odd ? 2 : 3)) & 3] },
    .clearances = { (float)own->clearance / MLIM_CLEARANCE_PARTS,
      (float)beyond->clearance / MLIM_CLEARANCE_PARTS },
    .stale = own->facets[index],
    .index = (unsigned char)index,
    .is_open = (unsigned char)from->is_open };
  mlim_copy(own->center, out->ends[0]);
  mlim_copy(beyond->center, out->ends[1]);
}

static void copy_sides(looking* l, side* sides, size_t count)
{
  const mlim_field* field = l->records->oracle->field;
  for (size_t k = 0; k < count; ++k)
  {
    side* s = &sides[k];
    if (s->own->label == s->beyond->label && s->is_open)
    {
      s->is_open =
        !mlim_clear_between(field, (const double* const[2]){ s->own->center, s->beyond->center },
          (const uint16_t[2]){ s->own->clearance, s->beyond->clearance });
    }
    copy_dual(s, &l->found.all[l->found.count]);
    l->found.count += s->is_open || s->own->facets[s->index] > 0;
  }
}

static void look_at_sides(looking* l, size_t begin, size_t end)
{
  side sides[FACETS * SIDES];
  mlim_old_cell twice[FACETS * SIDES];
  for (size_t k = begin; k < end; k += SIDES)
  {
    const size_t some = end - k < SIDES ? end - k : SIDES;
    const size_t count = list_sides(l->records, &l->records->cells[k], some, sides);
    copy_sides(l, sides, keep_sides(l, sides, count, twice));
  }
}

/* Of the duals that were looked along those stay that cross, or contradict a record. */
static void keep_found(mlim_duals* found)
{
  size_t kept = 0;
  for (size_t k = 0; k < found->count; ++k)
  {
    if (found->all[k].crosses || found->all[k].stale > 0)
    {
      found->all[kept++] = found->all[k];
    }
  }
  found->count = kept;
}

mlim_duals mlim_records_duals(const mlim_records* records, size_t part)
{
  return (mlim_duals){ .count = records->dual_counts[part],
    .all = records->duals + FACETS * begin_of(records, part) };
}

static void look_at_part(const looking* range, size_t part)
{
  mlim_records* records = range->records;
  looking l = *range;
  l.found.all = records->duals + FACETS * begin_of(records, part);
  look_at_sides(&l, begin_of(records, part), begin_of(records, part + 1));
  mlim_duals_cross(records->oracle, records->vertices, l.found.all, l.found.count);
  keep_found(&l.found);
  records->dual_counts[part] = (uint32_t)l.found.count;
}

void mlim_records_look(mlim_records* records, size_t begin, size_t end, size_t labelled)
{
  const looking range = { .records = records, .end = begin_of(records, labelled) };
  for (size_t part = begin; part < end; ++part)
  {
    look_at_part(&range, part);
  }
}

/* ---- settling ---- */

/* Cells that died meanwhile have no use for a label. */
static void give_labels(const mlim_records* records, mlim_complex* complex)
{
  for (size_t k = 0; k < records->cell_count; ++k)
  {
    const mlim_new_cell* from = &records->cells[k];
    mlim_cell* cell = &complex->cells[from->id];
    if (k + AHEAD < records->cell_count)
    {
      mlim_prefetch(&complex->cells[from[AHEAD].id]);
    }
    if (cell->label == TAKEN - (int32_t)k)
    {
      cell->label = from->label;
      cell->clearance = from->clearance;
    }
  }
}

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

/* A facet as its side tells it that is there. */
typedef struct place
{
  mlim_cell *cell, *other;
  int32_t id;
  int index, index_beyond;
} place;

/* From a cell of a dual that is still the one that it was: what was made since has no label. Its other one may be
   gone, the dual shorter. 0: both are gone. */
static int find_place(const mlim_complex* complex, const mlim_dual* dual, place* out)
{
  for (int end = 0; end < 2; ++end)
  {
    const int32_t id = dual->cells[end];
    mlim_cell* cell = &complex->cells[id];
    if (cell->vertices[0] < 0 || cell->label < 0)
    {
      continue;
    }
    int index = dual->index;
    if (end == 1)
    {
      const int32_t* v = dual->vertices;
      for (index = 0; index < 3; ++index)
      {
        const int32_t at = cell->vertices[index];
        if (at != v[0] && at != v[1] && at != v[2])
        {
          break;
        }
      }
    }
    mlim_cell* other = &complex->cells[cell->neighbors[index]];
    *out = (place){ .cell = cell,
      .other = other,
      .id = id,
      .index = index,
      .index_beyond = mlim_complex_index_apart(other, cell) };
    return 1;
  }
  return 0;
}

static void set_record(const place* at, int32_t record)
{
  at->cell->facets[at->index] = record;
  at->other->facets[at->index_beyond] = record;
}

/* Returns 1 when out of memory. */
static int add_record(mlim_complex* complex, mlim_dual* dual, const place* at)
{
  const int32_t record = new_record(complex);
  if (record == 0)
  {
    return 1;
  }
  mlim_facet* facet = &complex->facets[record];
  const uint32_t generation = facet->generation;
  *facet = (mlim_facet){ .sheet = dual->sheet,
    .cell = at->id,
    .generation = generation,
    .index = (unsigned)at->index & 3,
    .is_alive = 1,
    .is_multiple = dual->is_multiple };
  mlim_copy(dual->crossing, facet->crossing);
  set_record(at, record);
  dual->record = record;
  return 0;
}

/* Returns 1 when out of memory. */
static int settle_dual(mlim_complex* complex, mlim_dual* dual)
{
  place at;
  if (!find_place(complex, dual, &at))
  {
    return 0;
  }
  mlim_complex_touch_facet(complex, at.id, at.index);
  if (dual->stale > 0)
  {
    set_record(&at, 0);
    mlim_complex_kill_record(complex, dual->stale);
  }
  return dual->crosses && add_record(complex, dual, &at);
}

mlim_status mlim_records_settle(mlim_records* records, mlim_complex* complex, mlim_context* context)
{
  int has_failed = 0;
  if (!records->is_pending)
  {
    return MLIM_OK;
  }
  give_labels(records, complex);
  for (size_t p = 0; p < records->part_count && !has_failed; ++p)
  {
    const mlim_duals duals = mlim_records_duals(records, p);
    for (size_t k = 0; k < duals.count && !has_failed; ++k)
    {
      if (k + AHEAD < duals.count)
      {
        mlim_prefetch(&complex->cells[duals.all[k + AHEAD].cells[0]]);
        mlim_prefetch(&complex->cells[duals.all[k + AHEAD].cells[1]]);
      }
      has_failed = settle_dual(complex, &duals.all[k]);
    }
  }
  records->is_pending = 0;
  return has_failed ? mlim_fail_memory(context, "the restricted facets") : MLIM_OK;
}

/* ---- the whole ---- */

static void look_body(void* data, size_t begin, size_t end)
{
  mlim_records* records = (mlim_records*)data;
  mlim_records_label(records, begin, end);
  mlim_records_look(records, begin, end, end);
}

/* Returns 1 when out of memory. */
static int list_fresh(const mlim_records* records, mlim_complex* complex)
{
  for (size_t p = 0; p < records->part_count; ++p)
  {
    const mlim_duals duals = mlim_records_duals(records, p);
    if (mlim_reserve_apart(&complex->fresh, &complex->fresh_capacity,
          complex->fresh_count + duals.count, sizeof *complex->fresh))
    {
      return 1;
    }
    for (size_t k = 0; k < duals.count; ++k)
    {
      complex->fresh[complex->fresh_count] = duals.all[k].record;
      complex->fresh_count += duals.all[k].record > 0;
    }
  }
  return 0;
}

static mlim_status update_some(mlim_records* records, mlim_complex* complex, const int32_t* made,
  size_t count, mlim_context* context)
{
  mlim_context* host = count > FEW ? context : NULL;
  mlim_status status = take(records, complex, made, count, context);
  if (status != MLIM_OK)
  {
    return status;
  }
  records->part_count = host != NULL ? MLIM_RECORD_PARTS : 1;
  mlim_parallel_for(host, records->part_count, take_body, records);
  mlim_parallel_for(host, records->part_count, look_body, records);
  status = mlim_records_settle(records, complex, context);
  return status == MLIM_OK && list_fresh(records, complex)
           ? mlim_fail_memory(context, "the restricted facets")
           : status;
}

mlim_status mlim_records_update(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context)
{
  mlim_status status = mlim_progress(context, MLIM_STAGE_SURFACE, done);
  for (size_t k = 0; k < complex->made_count && status == MLIM_OK; k += BATCH)
  {
    const size_t left = complex->made_count - k;
    status = update_some(records, complex, complex->made + k, left < BATCH ? left : BATCH, context);
    status = status == MLIM_OK ? mlim_progress(context, MLIM_STAGE_SURFACE, done) : status;
  }
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
    is_new |= known < 0;
    labels[k] = known >= 0
                  ? known
                  : mlim_field_label(complex->oracle.field, mlim_complex_center(complex, sides[k]));
  }
  return !is_new || matches(facet, labels[0], labels[1]);
}
