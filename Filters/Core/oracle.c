#include "oracle.h"

#include "cubic.h"
#include "field_index.h"
#include "vector.h"

#include <math.h>

enum
{
  MAX_RIVALS = 32, /* labels that may win on one segment in one cell before it is cut in two */
  MAX_DEPTH = 40   /* halvings of a segment in a cell: 2^-40 of a cell is below any tolerance */
};

/* A crossing is solved to this part of the tolerance: Newton's last step is nearly free, and the
   mesh's points then lie on the interface to rounding. */
static const double ROOT_PART = 1e-6;

/* One segment on its way through the grid, in units of cells. */
typedef struct walk
{
  const mlim_field* field;
  double start[3];     /* in cells */
  double direction[3]; /* from start to end, in cells */
  double inverse[3];   /* of the direction */
  double begin[3];     /* in lengths, for the result */
  double extent[3];
  double length; /* in lengths */
  double tolerance;
  int32_t label; /* where the walk is; -1 before the first cell */
  size_t count, capacity;
  mlim_crossing* out;
} walk;

static void emit(walk* w, double t, int32_t to, int32_t face)
{
  if (w->label != to && w->label >= 0 && w->count < w->capacity)
  {
    mlim_crossing* c = &w->out[w->count++];
    *c = (mlim_crossing){ .from = w->label, .to = to, .face = face };
    for (int k = 0; k < 3; ++k)
    {
      const double x = w->begin[k] + t * w->extent[k];
      c->point[k] = mlim_min(mlim_max(x, 0), w->field->grid.size[k]); /* in spite of rounding */
    }
    if (face >= 0)
    {
      c->point[face >> 1] = face & 1 ? w->field->grid.size[face >> 1] : 0;
    }
  }
  w->label = to;
}

/* ---- inside a mixed cell ---- */

/* The part [t, t + width] of the segment, in the cell's own coordinates. */
typedef struct span
{
  double at[3];
  double by[3];
  double t, width;
} span;

/* Corner values as coefficients of 1 x y z xy xz yz xyz. */
static void monomials(const uint32_t* words, double m[8])
{
  double v[8];
  for (int c = 0; c < 8; ++c)
  {
    v[c] = (double)field_float(words[c]);
  }
  m[0] = v[0];
  m[1] = v[1] - v[0];
  m[2] = v[2] - v[0];
  m[3] = v[4] - v[0];
  m[4] = v[3] - v[2] - m[1];
  m[5] = v[5] - v[4] - m[1];
  m[6] = v[6] - v[4] - m[2];
  m[7] = (v[7] - v[6]) - (v[5] - v[4]) - m[4];
}

static mlim_cubic along(const uint32_t* words, const span* s)
{
  double m[8];
  monomials(words, m);
  const double x = s->at[0];
  const double y = s->at[1];
  const double z = s->at[2];
  const double dx = s->by[0];
  const double dy = s->by[1];
  const double dz = s->by[2];
  const double xy = m[4] + m[7] * z;
  const double xz = m[5] + m[7] * y;
  const double yz = m[6] + m[7] * x;
  const double value = m[0] + x * (m[1] + y * xy + z * m[5]) + y * (m[2] + z * m[6]) + z * m[3];
  const double linear = dx * (m[1] + y * xy + z * m[5]) + dy * (m[2] + x * m[4] + z * yz) +
                        dz * (m[3] + x * m[5] + y * (m[6] + m[7] * x));
  const double square = dx * dy * xy + dx * dz * xz + dy * dz * yz;
  const double cube = m[7] * dx * dy * dz;
  return (mlim_cubic){ { value, value + linear / 3, value + (2 * linear + square) / 3,
    value + linear + square + cube } };
}

static double root_precision(const walk* w, double width)
{
  return ROOT_PART * w->tolerance / (w->length * width + 1e-300);
}

/* Sign changes of f_first - f_second, labels in `pair`. */
static void cross_pair(
  walk* w, const mlim_cubic* f, const int32_t pair[2], double t, double width, int depth)
{
  const int changes = mlim_cubic_sign_changes(f);
  if (changes == 0)
  {
    return;
  }
  if (changes == 1)
  {
    const double root = mlim_cubic_root(f, root_precision(w, width));
    emit(w, t + width * root, pair[f->c[3] < 0], -1);
    return;
  }
  if (depth >= MAX_DEPTH || width * w->length < w->tolerance)
  {
    if ((f->c[0] >= 0) != (f->c[3] >= 0))
    {
      emit(w, t + 0.5 * width, pair[f->c[3] < 0], -1);
    }
    return;
  }
  mlim_cubic first;
  mlim_cubic second;
  mlim_cubic_halve(f, &first, &second);
  cross_pair(w, &first, pair, t, 0.5 * width, depth + 1);
  cross_pair(w, &second, pair, t + 0.5 * width, 0.5 * width, depth + 1);
}

/* Several labels on one span: the upper envelope of their cubics. */
typedef struct envelope
{
  int32_t count;
  int32_t labels[MAX_RIVALS]; /* ascending, so that the first of equals is the lowest */
  mlim_cubic f[MAX_RIVALS];
} envelope;

static int32_t winner_at(const envelope* e, int end)
{
  int32_t best = 0;
  for (int32_t n = 1; n < e->count; ++n)
  {
    best = e->f[n].c[end] > e->f[best].c[end] ? n : best;
  }
  return best;
}

static int is_below(const mlim_cubic* f, const mlim_cubic* g)
{
  return f->c[0] <= g->c[0] && f->c[1] <= g->c[1] && f->c[2] <= g->c[2] && f->c[3] <= g->c[3];
}

static void cross_many(walk* w, const envelope* e, double t, double width, int depth)
{
  const int32_t first = winner_at(e, 0);
  const int32_t last = winner_at(e, 3);
  int32_t others = 0;
  for (int32_t n = 0; n < e->count; ++n)
  {
    others += n != first && n != last && !is_below(&e->f[n], &e->f[first]) &&
              !is_below(&e->f[n], &e->f[last]);
  }
  if (others == 0 && first == last)
  {
    return;
  }
  if (others == 0)
  {
    const int32_t low = first < last ? first : last;
    const int32_t high = first < last ? last : first;
    mlim_cubic difference;
    for (int k = 0; k < 4; ++k)
    {
      difference.c[k] = e->f[low].c[k] - e->f[high].c[k];
    }
    cross_pair(
      w, &difference, (const int32_t[2]){ e->labels[low], e->labels[high] }, t, width, depth);
    return;
  }
  if (depth >= MAX_DEPTH || width * w->length < w->tolerance)
  {
    if (first != last)
    {
      emit(w, t + 0.5 * width, e->labels[last], -1);
    }
    return;
  }
  envelope halves[2];
  halves[0].count = halves[1].count = e->count;
  for (int32_t n = 0; n < e->count; ++n)
  {
    halves[0].labels[n] = halves[1].labels[n] = e->labels[n];
    mlim_cubic_halve(&e->f[n], &halves[0].f[n], &halves[1].f[n]);
  }
  cross_many(w, &halves[0], t, 0.5 * width, depth + 1);
  cross_many(w, &halves[1], t + 0.5 * width, 0.5 * width, depth + 1);
}

/* Keeps the labels that the winners of the two ends do not bound from above. Returns 0 when there
   are more than an envelope holds. */
static int gather(const uint32_t* entry, const span* s, envelope* out)
{
  const uint32_t count = entry[0];
  const uint32_t* values = entry + 1 + count;
  uint32_t ends[2] = { 0, 0 };
  mlim_cubic top[2];
  top[0] = top[1] = along(values, s);
  for (uint32_t n = 1; n < count; ++n)
  {
    const mlim_cubic f = along(values + 8 * (size_t)n, s);
    if (f.c[0] > top[0].c[0])
    {
      top[0] = f;
      ends[0] = n;
    }
    if (f.c[3] > top[1].c[3])
    {
      top[1] = f;
      ends[1] = n;
    }
  }
  out->count = 0;
  for (uint32_t n = 0; n < count; ++n)
  {
    const mlim_cubic f = along(values + 8 * (size_t)n, s);
    if (n != ends[0] && n != ends[1] && (is_below(&f, &top[0]) || is_below(&f, &top[1])))
    {
      continue;
    }
    if (out->count == MAX_RIVALS)
    {
      return 0;
    }
    out->labels[out->count] = (int32_t)entry[1 + n];
    out->f[out->count++] = f;
  }
  return 1;
}

static void cross_entry(walk* w, const uint32_t* entry, const span* s, int depth)
{
  envelope e;
  if (gather(entry, s, &e))
  {
    emit(w, s->t, e.labels[winner_at(&e, 0)], -1);
    cross_many(w, &e, s->t, s->width, depth);
    w->label = e.labels[winner_at(&e, 3)];
    return;
  }
  if (depth >= MAX_DEPTH)
  {
    return;
  }
  span halves[2] = { *s, *s };
  halves[0].width = halves[1].width = 0.5 * s->width;
  halves[1].t += 0.5 * s->width;
  for (int k = 0; k < 3; ++k)
  {
    halves[0].by[k] = halves[1].by[k] = 0.5 * s->by[k];
    halves[1].at[k] += 0.5 * s->by[k];
  }
  cross_entry(w, entry, &halves[0], depth + 1);
  cross_entry(w, entry, &halves[1], depth + 1);
}

static void cross_mixed(walk* w, const int32_t cell[3], uint32_t word, double t, double exit)
{
  const uint32_t* entry = field_pool_entry(w->field, cell, word);
  span s = { .t = t, .width = exit - t };
  for (int k = 0; k < 3; ++k)
  {
    s.at[k] = w->start[k] + t * w->direction[k] - cell[k];
    s.by[k] = (exit - t) * w->direction[k];
  }
  if (word & (uint32_t)MANY)
  {
    cross_entry(w, entry, &s, 0);
    return;
  }
  const int32_t pair[2] = { (int32_t)(entry[0] & 0xffffu), (int32_t)(entry[0] >> 16) };
  const mlim_cubic f = along(entry + 1, &s);
  emit(w, t, pair[f.c[0] < 0], -1);
  cross_pair(w, &f, pair, t, s.width, 0);
  w->label = pair[f.c[3] < 0];
}

/* ---- from cell to cell ---- */

/* Most segments are: rounding cannot put an end that is this far inside on the box's surface. */
static int is_well_inside(const walk* w)
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
static int clip(const walk* w, double t[2], int32_t faces[2])
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
static void cell_after(const walk* w, double t, double nudge, int32_t cell[3])
{
  for (int k = 0; k < 3; ++k)
  {
    const double at = w->start[k] + (t + nudge) * w->direction[k];
    const int32_t last = w->field->grid.cells[k] - 1;
    cell[k] = at > 0 ? (at < (double)last ? (int32_t)at : last) : 0;
  }
}

/* Where the segment leaves the box of cells [cell - reach, cell + reach]; axis: through which side. */
static double exit_of(const walk* w, const int32_t cell[3], int reach, int* axis)
{
  double least = INFINITY;
  *axis = -1;
  for (int k = 0; k < 3; ++k)
  {
    if (w->direction[k] != 0)
    {
      const double side = w->direction[k] > 0 ? cell[k] + 1 + reach : cell[k] - reach;
      const double t = (side - w->start[k]) * w->inverse[k];
      if (t < least)
      {
        least = t;
        *axis = k;
      }
    }
  }
  return least;
}

static void walk_cells(walk* w, double t, double last)
{
  const int32_t* cells = w->field->grid.cells;
  const double longest =
    mlim_max(fabs(w->direction[0]), mlim_max(fabs(w->direction[1]), fabs(w->direction[2])));
  const double nudge = 1e-9 / longest;
  const int max_steps = 2 * (cells[0] + cells[1] + cells[2]) + 64;
  int is_uniform = 0;
  int32_t cell[3];
  cell_after(w, t, nudge, cell);
  for (int step = 0; step < max_steps && t < last; ++step)
  {
    int axis;
    const int clearance = field_clearance(w->field, cell);
    if (clearance > 0)
    {
      if (!is_uniform)
      {
        emit(w, t, (int32_t)field_cell_word(w->field, cell), -1);
      }
      is_uniform = 1; /* and what comes next has the same label, or is mixed */
      const double next = exit_of(w, cell, clearance - 1, &axis);
      t = next > t ? next : t + nudge;
      cell_after(w, t, nudge, cell);
      continue;
    }
    is_uniform = 0;
    const uint32_t word = field_cell_word(w->field, cell);
    double next = exit_of(w, cell, 0, &axis);
    next = next < t ? t : next;
    const int is_last = next >= last;
    next = is_last ? last : next;
    cross_mixed(w, cell, word, t, next);
    t = next;
    if (is_last)
    {
      return;
    }
    cell[axis] += w->direction[axis] > 0 ? 1 : -1;
    if (cell[axis] < 0 || cell[axis] >= cells[axis])
    {
      return;
    }
  }
}

/* Takes away what is clear at the ends inside the box. Returns 0 when nothing is left. */
static int cut(walk* w, const mlim_segment* segment, const int32_t faces[2], double t[2])
{
  const double inverse =
    1 / mlim_max(fabs(w->direction[0]), mlim_max(fabs(w->direction[1]), fabs(w->direction[2])));
  if (faces[0] < 0 && segment->clearances[0] > 0)
  {
    t[0] = segment->clearances[0] * inverse;
    w->label = segment->labels[0];
  }
  if (faces[1] < 0)
  {
    t[1] = 1 - segment->clearances[1] * inverse;
  }
  return t[0] < t[1];
}

static size_t cross_exact(
  const mlim_oracle* oracle, const mlim_segment* segment, size_t capacity, mlim_crossing* out)
{
  const double* start = segment->ends[0];
  const double* end = segment->ends[1];
  walk w = { .field = oracle->field,
    .tolerance = oracle->tolerance,
    .label = -1,
    .capacity = capacity,
    .out = out };
  for (int k = 0; k < 3; ++k)
  {
    w.begin[k] = start[k];
    w.extent[k] = end[k] - start[k];
    w.start[k] = start[k] * w.field->grid.inverse_spacing[k];
    w.direction[k] = end[k] * w.field->grid.inverse_spacing[k] - w.start[k];
    w.inverse[k] = 1 / w.direction[k];
  }
  w.length = sqrt(mlim_dot(w.extent, w.extent));
  double t[2];
  int32_t faces[2];
  if (!(w.length > 0) || !isfinite(w.length) || !clip(&w, t, faces))
  {
    return 0;
  }
  const int32_t outside = w.field->outside_label;
  if (faces[0] >= 0)
  {
    /* The first cell's label is not known yet: walk first, then look at the way in. */
    double in[3];
    for (int k = 0; k < 3; ++k)
    {
      in[k] = w.begin[k] + t[0] * w.extent[k];
    }
    in[faces[0] >> 1] = faces[0] & 1 ? w.field->grid.size[faces[0] >> 1] : 0;
    w.label = outside;
    emit(&w, t[0], mlim_field_label(w.field, in), faces[0]);
  }
  if (!cut(&w, segment, faces, t))
  {
    return w.count;
  }
  walk_cells(&w, t[0], t[1]);
  if (faces[1] >= 0)
  {
    emit(&w, t[1], outside, faces[1]);
  }
  return w.count;
}

/* ---- both ---- */

size_t mlim_oracle_crossings_between(
  const mlim_oracle* oracle, const mlim_segment* segment, size_t capacity, mlim_crossing* out)
{
  const size_t count =
    oracle->mode == MLIM_ORACLE_EXACT ? cross_exact(oracle, segment, capacity, out) : 0;
  /* With an end within rounding of the interface, on the side that the walk did not see, bisection
     finds what the walk did not. */
  const int is_done =
    oracle->mode == MLIM_ORACLE_EXACT && (count > 0 || segment->labels[0] == segment->labels[1]);
  return is_done ? count
                 : mlim_oracle_crossings_by_bisection(
                     oracle, segment->ends[0], segment->ends[1], capacity, out);
}

size_t mlim_oracle_crossings(const mlim_oracle* oracle, const double start[3], const double end[3],
  size_t capacity, mlim_crossing* out)
{
  const mlim_segment segment = { .ends = { start, end },
    .labels = { mlim_field_label(oracle->field, start), mlim_field_label(oracle->field, end) } };
  return mlim_oracle_crossings_between(oracle, &segment, capacity, out);
}
