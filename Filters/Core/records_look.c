/* Labels of the cells that were taken down, and their facets that may cross or contradict a record. */
#include "clear.h"
#include "memory.h"
#include "records_parts.h"
#include "vector.h"

#include <math.h>

enum
{
  SIDES = 32, /* cells whose facets are looked at together */
  LOOKS = 64  /* that wait for memory together */
};

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
  const size_t last = mlim_records_begin_of(records, end);
  for (size_t k = mlim_records_begin_of(records, begin); k < last; k += LOOKS)
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
    for (int i = 0; i < MLIM_RECORD_FACETS; ++i)
    {
      mlim_prefetch(&records->facets[cells[k].facets[i]]);
      out[found].own = &cells[k];
      out[found].index = i;
      found += cells[k].beyond[i] != INT32_MAX;
    }
  }
  return found;
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
    kept +=
      (size_t)((is_open | (record != 0)) & !mlim_records_match(facet, own->label, beyond->label));
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
  side sides[MLIM_RECORD_FACETS * SIDES];
  mlim_old_cell twice[MLIM_RECORD_FACETS * SIDES];
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
    .all = records->duals + MLIM_RECORD_FACETS * mlim_records_begin_of(records, part) };
}

static void look_at_part(const looking* range, size_t part)
{
  mlim_records* records = range->records;
  looking l = *range;
  l.found.all = records->duals + MLIM_RECORD_FACETS * mlim_records_begin_of(records, part);
  look_at_sides(&l, mlim_records_begin_of(records, part), mlim_records_begin_of(records, part + 1));
  mlim_duals_cross(records->oracle, records->vertices, l.found.all, l.found.count);
  keep_found(&l.found);
  records->dual_counts[part] = (uint32_t)l.found.count;
}

void mlim_records_look(mlim_records* records, size_t begin, size_t end, size_t labelled)
{
  const looking range = { .records = records, .end = mlim_records_begin_of(records, labelled) };
  for (size_t part = begin; part < end; ++part)
  {
    look_at_part(&range, part);
  }
}
