#include "oracle.h"

#include "oracle_walk.h"
#include "vector.h"

#include <math.h>

/* Most segments are: rounding cannot put an end that is this far inside on the box's surface. */
static int is_well_inside(const mlim_walk* w)
{
  int is_inside = 1;
  for (int k = 0; k < 3; ++k)
  {
    const double top = w->field->grid.cells[k];
    const double margin = 1e-9 * top;
    const double end = w->start[k] + w->direction[k];
    is_inside &=
      (w->start[k] > margin) & (w->start[k] < top - margin) & (end > margin) & (end < top - margin);
  }
  return is_inside;
}

/* Clips to the box. Returns 0 when the segment misses it. faces: where it enters and leaves, -1 for
   an end inside. */
static int clip(const mlim_walk* w, double t[2], int32_t faces[2])
{
  t[0] = 0;
  t[1] = 1;
  faces[0] = faces[1] = -1;
  if (is_well_inside(w))
  {
    return 1;
  }
  for (int k = 0; k < 3; ++k)
  {
    const double top = w->field->grid.cells[k];
    if (w->direction[k] == 0)
    {
      if (w->start[k] < 0 || w->start[k] > top)
      {
        return 0;
      }
      continue;
    }
    const int is_back = w->direction[k] < 0;
    const double enter = ((is_back ? top : 0) - w->start[k]) * w->inverse[k];
    const double leave = ((is_back ? 0 : top) - w->start[k]) * w->inverse[k];
    if (enter > t[0])
    {
      t[0] = enter;
      faces[0] = 2 * k + is_back;
    }
    if (leave < t[1])
    {
      t[1] = leave;
      faces[1] = 2 * k + !is_back;
    }
  }
  return t[0] < t[1];
}

/* The cell just after t. The offset, 1e-9 of a cell, keeps a point on a face from falling back into
   the cell it comes from; a cell missed by it holds less than 1e-9 of the segment. */
static void cell_after(const mlim_walk* w, double t, int32_t cell[3])
{
  for (int k = 0; k < 3; ++k)
  {
    const double at = w->start[k] + (t + w->nudge) * w->direction[k];
    cell[k] = (int32_t)mlim_min(mlim_max(at, 0), w->field->grid.cells[k] - 1);
  }
}

/* Where the segment leaves the box of cells [cell - reach, cell + reach]; axis: through which side. Without
   branches, which would go either way: a direction that is 0 counts as up, and never comes to the side. */
static double exit_of(const mlim_walk* w, const int32_t cell[3], int reach, int* axis)
{
  double least = INFINITY;
  *axis = -1;
  for (int k = 0; k < 3; ++k)
  {
    const int is_back = w->direction[k] < 0;
    const int32_t side = cell[k] + (is_back ? -reach : 1 + reach);
    const double t = (side - w->start[k]) * w->inverse[k];
    *axis = t < least ? k : *axis;
    least = t < least ? t : least;
  }
  return least;
}

/* Asks for what tells whether its cell is mixed. */
static void ask_for_cell(const mlim_walk* w)
{
  const size_t brick = field_brick_of(w->field, w->cell);
  mlim_prefetch(&w->field->clearances[BRICK_CELLS * brick]);
  mlim_prefetch(&w->field->coarse[brick]);
}

typedef enum step
{
  AT_END,
  AT_MIXED, /* whose word is asked for */
  ON_WAY
} step;

static step next_step(mlim_walk* w)
{
  const mlim_field* field = w->field;
  if (w->steps == 0 || !(w->t < w->last))
  {
    return AT_END;
  }
  --w->steps;
  const size_t brick = field_brick_of(field, w->cell);
  const size_t slot = field_slot_of(w->cell);
  const int clearance = field->clearances[BRICK_CELLS * brick + slot];
  if (clearance == 0)
  {
    const uint32_t* words = field->layers[w->cell[2] >> 2].words;
    w->word = words + BRICK_CELLS * (size_t)(field->coarse[brick] & DETAIL) + slot;
    mlim_prefetch(w->word);
    return AT_MIXED;
  }
  int axis;
  const double next = exit_of(w, w->cell, clearance - 1, &axis);
  if (!w->is_uniform)
  {
    const int is_known = w->last_label >= 0 && next >= w->last;
    mlim_walk_emit(
      w, w->t, is_known ? w->last_label : (int32_t)field_cell_word(field, w->cell), -1);
  }
  w->is_uniform = 1; /* and what comes next has the same label, or is mixed */
  w->t = next > w->t ? next : w->t + w->nudge;
  cell_after(w, w->t, w->cell);
  ask_for_cell(w);
  return ON_WAY;
}

static void ask_for_entry(mlim_walk* w)
{
  w->entry = w->field->layers[w->cell[2] >> 2].pool + (*w->word & DETAIL);
  mlim_prefetch(w->entry);
  mlim_prefetch(w->entry + PAIR_WORDS - 1);
}

static void cross_cell(mlim_walk* w)
{
  int axis;
  const int32_t here[3] = { w->cell[0], w->cell[1], w->cell[2] };
  const double begin = w->t;
  const double next = mlim_max(exit_of(w, here, 0, &axis), begin);
  w->t = next >= w->last ? w->last : next;
  if (next < w->last)
  {
    w->cell[axis] += w->direction[axis] > 0 ? 1 : -1;
    const int is_outside = w->cell[axis] < 0 || w->cell[axis] >= w->field->grid.cells[axis];
    w->steps = is_outside ? 0 : w->steps;
    if (!is_outside)
    {
      ask_for_cell(w);
    }
  }
  w->is_uniform = 0;
  mlim_walk_cross(w, here, begin, w->t);
}

/* Takes away what is clear at the ends inside the box. Returns 0 when nothing is left. */
static int cut(mlim_walk* w, const mlim_segment* segment, const int32_t faces[2], double longest)
{
  const double inverse = 1 / longest;
  if (faces[0] < 0 && segment->clearances[0] > 0)
  {
    w->t = segment->clearances[0] * inverse;
    w->label = segment->labels[0];
    w->is_uniform = 1;
  }
  if (faces[1] < 0 && segment->clearances[1] > 0)
  {
    w->last = 1 - segment->clearances[1] * inverse;
    w->last_label = segment->labels[1];
  }
  return w->t < w->last;
}

/* Returns 0 when there is nothing to walk along. */
static int set_out(const mlim_oracle* oracle, const mlim_segment* segment, mlim_walk* w)
{
  const double* start = segment->ends[0];
  const double* end = segment->ends[1];
  w->field = oracle->field;
  w->tolerance = oracle->tolerance;
  w->label = w->last_label = w->leaves = -1;
  w->is_uniform = 0;
  w->count = 0;
  const mlim_field_grid* grid = &w->field->grid;
  double longest = 0;
  for (int k = 0; k < 3; ++k)
  {
    w->begin[k] = start[k];
    w->extent[k] = end[k] - start[k];
    w->start[k] = start[k] * grid->inverse_spacing[k];
    w->direction[k] = end[k] * grid->inverse_spacing[k] - w->start[k];
    w->inverse[k] = w->direction[k] == 0 ? INFINITY : 1 / w->direction[k];
    longest = mlim_max(longest, fabs(w->direction[k]));
  }
  w->squared = mlim_dot(w->extent, w->extent);
  w->nudge = 1e-9 / longest;
  double t[2];
  int32_t faces[2];
  if (!(w->squared > 0) || !isfinite(w->squared) || !clip(w, t, faces))
  {
    return 0;
  }
  w->t = t[0];
  w->last = t[1];
  if (faces[0] >= 0)
  {
    /* The first cell's label is not known yet: walk first, then look at the way in. */
    double in[3];
    for (int k = 0; k < 3; ++k)
    {
      in[k] = w->begin[k] + t[0] * w->extent[k];
    }
    in[faces[0] >> 1] = faces[0] & 1 ? grid->size[faces[0] >> 1] : 0;
    w->label = w->field->outside_label;
    mlim_walk_emit(w, t[0], mlim_field_label(w->field, in), faces[0]);
  }
  if (!cut(w, segment, faces, longest))
  {
    return 0;
  }
  w->leaves = faces[1];
  w->leave = t[1];
  w->steps = 2 * (grid->cells[0] + grid->cells[1] + grid->cells[2]) + 64;
  cell_after(w, w->t, w->cell);
  ask_for_cell(w);
  return 1;
}

/* All by one mixed cell: step by step, so that what they need of the field is on its way from memory for all at
   the same time. Leaves those that have not ended. */
static size_t go_on(mlim_walk* walks, unsigned char* on_way, size_t count)
{
  unsigned char searching[MLIM_SEGMENTS];
  size_t found = 0;
  memcpy(searching, on_way, count);
  while (count > 0)
  {
    size_t left = 0;
    for (size_t k = 0; k < count; ++k)
    {
      const unsigned char id = searching[k];
      const step now = next_step(&walks[id]);
      on_way[found] = id;
      found += now == AT_MIXED;
      searching[left] = id;
      left += now == ON_WAY;
    }
    count = left;
  }
  for (size_t k = 0; k < found; ++k)
  {
    ask_for_entry(&walks[on_way[k]]);
  }
  for (size_t k = 0; k < found; ++k)
  {
    cross_cell(&walks[on_way[k]]);
  }
  return found;
}

static void walk_all(mlim_walk* walks, size_t count)
{
  unsigned char on_way[MLIM_SEGMENTS];
  for (size_t k = 0; k < count; ++k)
  {
    on_way[k] = (unsigned char)k;
  }
  while (count > 0)
  {
    count = go_on(walks, on_way, count);
  }
}

static void cross_exact(const mlim_oracle* oracle, const mlim_segment* segments, size_t count,
  size_t capacity, mlim_crossing* out, size_t* counts)
{
  mlim_walk walks[MLIM_SEGMENTS];
  unsigned char segment_of[MLIM_SEGMENTS];
  size_t on_way = 0;
  for (size_t s = 0; s < count; ++s)
  {
    mlim_walk* w = &walks[on_way];
    w->capacity = capacity;
    w->out = out + s * capacity;
    const int is_walked = set_out(oracle, &segments[s], w);
    counts[s] = w->count;
    segment_of[on_way] = (unsigned char)s;
    on_way += (size_t)is_walked;
  }
  walk_all(walks, on_way);
  for (size_t k = 0; k < on_way; ++k)
  {
    mlim_walk* w = &walks[k];
    if (w->leaves >= 0)
    {
      mlim_walk_emit(w, w->leave, w->field->outside_label, w->leaves);
    }
    counts[segment_of[k]] = w->count;
  }
}

/* ---- both ---- */

void mlim_oracle_cross_all(const mlim_oracle* oracle, const mlim_segment* segments, size_t count,
  size_t capacity, mlim_crossing* out, size_t* counts)
{
  const int is_exact = oracle->mode == MLIM_ORACLE_EXACT;
  if (is_exact)
  {
    cross_exact(oracle, segments, count, capacity, out, counts);
  }
  for (size_t s = 0; s < count; ++s)
  {
    /* With an end within rounding of the interface, on the side that the walk did not see, bisection
       finds what the walk did not. */
    const mlim_segment* segment = &segments[s];
    if (!is_exact || (counts[s] == 0 && segment->labels[0] != segment->labels[1]))
    {
      counts[s] = mlim_oracle_crossings_by_bisection(
        oracle, segment->ends[0], segment->ends[1], capacity, out + s * capacity);
    }
  }
}

size_t mlim_oracle_crossings_between(
  const mlim_oracle* oracle, const mlim_segment* segment, size_t capacity, mlim_crossing* out)
{
  size_t count;
  mlim_oracle_cross_all(oracle, segment, 1, capacity, out, &count);
  return count;
}

size_t mlim_oracle_crossings(const mlim_oracle* oracle, const double start[3], const double end[3],
  size_t capacity, mlim_crossing* out)
{
  const mlim_segment segment = { .ends = { start, end },
    .labels = { mlim_field_label(oracle->field, start), mlim_field_label(oracle->field, end) } };
  return mlim_oracle_crossings_between(oracle, &segment, capacity, out);
}
