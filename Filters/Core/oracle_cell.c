#include "oracle_walk.h"

#include "cubic.h"
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

void mlim_walk_emit(mlim_walk* w, double t, int32_t to, int32_t face)
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

static double root_precision(const mlim_walk* w, double width)
{
  return ROOT_PART * w->tolerance / (sqrt(w->squared) * width + 1e-300);
}

static int is_short(const mlim_walk* w, double width)
{
  return width * sqrt(w->squared) < w->tolerance;
}

/* Sign changes of f_first - f_second, labels in `pair`. */
static void cross_pair(
  mlim_walk* w, const mlim_cubic* f, const int32_t pair[2], double t, double width, int depth)
{
  const int changes = mlim_cubic_sign_changes(f);
  if (changes == 0)
  {
    return;
  }
  if (changes == 1)
  {
    const double root = mlim_cubic_root(f, root_precision(w, width));
    mlim_walk_emit(w, t + width * root, pair[f->c[3] < 0], -1);
    return;
  }
  if (depth >= MAX_DEPTH || is_short(w, width))
  {
    if ((f->c[0] >= 0) != (f->c[3] >= 0))
    {
      mlim_walk_emit(w, t + 0.5 * width, pair[f->c[3] < 0], -1);
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

static void cross_many(mlim_walk* w, const envelope* e, double t, double width, int depth)
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
  if (depth >= MAX_DEPTH || is_short(w, width))
  {
    if (first != last)
    {
      mlim_walk_emit(w, t + 0.5 * width, e->labels[last], -1);
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
  const int is_kept = count <= MAX_RIVALS; /* what has been found once */
  uint32_t ends[2] = { 0, 0 };
  mlim_cubic top[2];
  top[0] = top[1] = out->f[0] = along(values, s);
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
    if (is_kept)
    {
      out->f[n] = f;
    }
  }
  out->count = 0;
  for (uint32_t n = 0; n < count; ++n)
  {
    const mlim_cubic f = is_kept ? out->f[n] : along(values + 8 * (size_t)n, s);
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

static void cross_entry(mlim_walk* w, const uint32_t* entry, const span* s, int depth)
{
  envelope e;
  if (gather(entry, s, &e))
  {
    mlim_walk_emit(w, s->t, e.labels[winner_at(&e, 0)], -1);
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

void mlim_walk_cross(mlim_walk* w, const int32_t cell[3], double t, double exit)
{
  const uint32_t* entry = w->entry;
  span s = { .t = t, .width = exit - t };
  for (int k = 0; k < 3; ++k)
  {
    s.at[k] = w->start[k] + t * w->direction[k] - cell[k];
    s.by[k] = (exit - t) * w->direction[k];
  }
  if (*w->word & (uint32_t)MANY)
  {
    cross_entry(w, entry, &s, 0);
    return;
  }
  const int32_t pair[2] = { (int32_t)(entry[0] & 0xffffu), (int32_t)(entry[0] >> 16) };
  const mlim_cubic f = along(entry + 1, &s);
  mlim_walk_emit(w, t, pair[f.c[0] < 0], -1);
  cross_pair(w, &f, pair, t, s.width, 0);
  w->label = pair[f.c[3] < 0];
}
