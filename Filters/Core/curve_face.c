#include "curve_face.h"
#include "memory.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Ties are broken by a bonus that falls with the label, as in the whole core (field.h). Here it is
   a number, not a symbol, because it has to move points: exact ties (lattices, curves that run in a
   face) become general position, the points move by about BONUS / slope, and welding closes what it
   opened. In units of the field's values (at most about 1). Larger: visible shifts where indicators
   are flat. Smaller: lost in rounding (1e-16). */
static const double BONUS = 1e-10;
/* Makes differences of bonuses incommensurable, so that no four labels tie again: golden ratio. */
static const double BONUS_PHASE = 0.6180339887498949;
/* A root this far outside the square still counts, in units of the square: both squares at an edge
   may find the point, which is welded, but neither may lose it. */
static const double ROOT_TOLERANCE = 1e-9;
/* Another label this far above the tie does not count as above; rounding of the values only. */
static const double ABOVE_TOLERANCE = 1e-13;

enum
{
  MAX_TRIPLE_LABELS = 8, /* more labels than this: look at quarters first; n^3 against 4 n^2 */
  MAX_QUARTER_DEPTH = 5
};

static double bonus(int32_t label)
{
  const double phase = label * BONUS_PHASE;
  return -BONUS * (label + 0.5 * (phase - floor(phase)));
}

void mlim_face_work_free(mlim_face_work* work)
{
  mlim_release(work->points);
  mlim_release(work->edge_points);
  mlim_release(work->labels);
  mlim_release(work->values);
  *work = (mlim_face_work){ 0 };
}

/* Does label a win against b at every corner? The rule of the field: values, then lower index. */
static int beats(const double* a, const double* b, int is_lower, size_t corner_count)
{
  for (size_t c = 0; c < corner_count; ++c)
  {
    if (a[c] < b[c] || (!is_lower && !(a[c] > b[c])))
    {
      return 0;
    }
  }
  return 1;
}

/* Copies the labels that no other one beats at all corners. Returns how many. The relation is
   transitive, so it does not matter that the beaten also take part. */
static size_t prune(const mlim_corners* from, size_t corner_count, int32_t* labels, double* values)
{
  size_t kept = 0;
  for (size_t l = 0; l < from->count; ++l)
  {
    const double* value = from->values + corner_count * l;
    size_t j = 0;
    while (j < from->count &&
           (j == l || !beats(from->values + corner_count * j, value, j < l, corner_count)))
    {
      ++j;
    }
    if (j == from->count)
    {
      labels[kept] = from->labels[l];
      memmove(values + corner_count * kept, value, corner_count * sizeof(double));
      ++kept;
    }
  }
  return kept;
}

/* a[0] + a[1] u + a[2] v + a[3] u v, the difference of two labels. */
static void difference(const double* f, const double* g, double a[4])
{
  const double d[4] = { f[0] - g[0], f[1] - g[1], f[2] - g[2], f[3] - g[3] };
  a[0] = d[0];
  a[1] = d[1] - d[0];
  a[2] = d[2] - d[0];
  a[3] = (d[3] - d[2]) - (d[1] - d[0]);
}

static double bilinear(const double* f, const double at[2])
{
  const double low = f[0] + at[0] * (f[1] - f[0]);
  const double high = f[2] + at[0] * (f[3] - f[2]);
  return low + at[1] * (high - low);
}

/* One Newton step: takes the error of the elimination out of the root. */
static void polish(const double a[4], const double b[4], double at[2])
{
  const double g = a[0] + a[1] * at[0] + (a[2] + a[3] * at[0]) * at[1];
  const double h = b[0] + b[1] * at[0] + (b[2] + b[3] * at[0]) * at[1];
  const double gu = a[1] + a[3] * at[1];
  const double gv = a[2] + a[3] * at[0];
  const double hu = b[1] + b[3] * at[1];
  const double hv = b[2] + b[3] * at[0];
  const double determinant = gu * hv - gv * hu;
  const double du = (g * hv - h * gv) / determinant;
  const double dv = (h * gu - g * hu) / determinant;
  if (fabs(du) < MLIM_WELD_DISTANCE && fabs(dv) < MLIM_WELD_DISTANCE)
  {
    at[0] -= du;
    at[1] -= dv;
  }
}

/* Points where both differences vanish: u is eliminated, which leaves a quadratic in v. Where it
   vanishes identically the two share a whole curve, and there is no point to find. A division by 0
   gives an infinity or a NaN, which no range accepts. */
static int solve(const double a[4], const double b[4], double roots[2][2])
{
  const double c0 = b[0] * a[1] - b[1] * a[0];
  const double c1 = b[0] * a[3] + b[2] * a[1] - b[1] * a[2] - b[3] * a[0];
  const double c2 = b[2] * a[3] - b[3] * a[2];
  const double discriminant = c1 * c1 - 4 * c0 * c2;
  if (!(discriminant >= 0))
  {
    return 0;
  }
  const double q = -0.5 * (c1 + copysign(sqrt(discriminant), c1));
  const double v[2] = { q / c2, c0 / q };
  int count = 0;
  for (int r = 0; r < 2; ++r)
  {
    if (!(v[r] >= -ROOT_TOLERANCE && v[r] <= 1 + ROOT_TOLERANCE))
    {
      continue;
    }
    const double da = a[1] + a[3] * v[r];
    const double db = b[1] + b[3] * v[r];
    double* at = roots[count];
    at[0] = fabs(da) >= fabs(db) ? -(a[0] + a[2] * v[r]) / da : -(b[0] + b[2] * v[r]) / db;
    at[1] = v[r];
    if (at[0] >= -ROOT_TOLERANCE && at[0] <= 1 + ROOT_TOLERANCE)
    {
      polish(a, b, at);
      ++count;
    }
  }
  return count;
}

/* Notes a point; one that coincides with an earlier one adds its labels to it. */
static mlim_status note_point(
  const double at[2], const int32_t triple[3], mlim_set_table* sets, mlim_face_work* work)
{
  int32_t set;
  const mlim_status status = mlim_set_table_add(sets, triple, 3, &set);
  if (status)
  {
    return status;
  }
  for (size_t p = 0; p < work->point_count; ++p)
  {
    mlim_face_point* point = work->points + p;
    if (fabs(point->at[0] - at[0]) < MLIM_WELD_DISTANCE &&
        fabs(point->at[1] - at[1]) < MLIM_WELD_DISTANCE)
    {
      return mlim_set_table_join(sets, point->set, set, &point->set);
    }
  }
  if (mlim_reserve(
        &work->points, &work->point_capacity, work->point_count + 1, sizeof(mlim_face_point)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  mlim_face_point* point = work->points + work->point_count;
  point->at[0] = fmin(fmax(at[0], 0), 1);
  point->at[1] = fmin(fmax(at[1], 0), 1);
  point->set = set;
  ++work->point_count;
  return MLIM_OK;
}

static int is_highest(const mlim_corners* square, size_t i, const double at[2])
{
  const double top = bilinear(square->values + 4 * i, at) + ABOVE_TOLERANCE;
  for (size_t l = 0; l < square->count; ++l)
  {
    if (bilinear(square->values + 4 * l, at) > top)
    {
      return 0;
    }
  }
  return 1;
}

/* All triples of a (sub)square whose values have the bonus in them. */
static mlim_status find_triples(const mlim_corners* square, const double low[2], double size,
  mlim_set_table* sets, mlim_face_work* work)
{
  for (size_t i = 0; i < square->count; ++i)
  {
    for (size_t j = i + 1; j < square->count; ++j)
    {
      double a[4];
      difference(square->values + 4 * i, square->values + 4 * j, a);
      for (size_t k = j + 1; k < square->count; ++k)
      {
        double b[4];
        difference(square->values + 4 * i, square->values + 4 * k, b);
        double roots[2][2];
        const int root_count = solve(a, b, roots);
        for (int r = 0; r < root_count; ++r)
        {
          const double at[2] = { low[0] + size * roots[r][0], low[1] + size * roots[r][1] };
          const int32_t triple[3] = { square->labels[i], square->labels[j], square->labels[k] };
          const mlim_status status =
            is_highest(square, i, roots[r]) ? note_point(at, triple, sets, work) : MLIM_OK;
          if (status)
          {
            return status;
          }
        }
      }
    }
  }
  return MLIM_OK;
}

/* Depth d works in row d of the two buffers, each as wide as the first square. */
static mlim_status find_in_square(size_t count, size_t width, int depth, const double low[2],
  mlim_set_table* sets, mlim_face_work* work)
{
  int32_t* labels = work->labels + (size_t)depth * width;
  double* values = work->values + 4 * (size_t)depth * width;
  const mlim_corners here = { .count = count, .labels = labels, .values = values };
  const double size = ldexp(1, -depth);
  if (count < 3)
  {
    return MLIM_OK;
  }
  if (count <= MAX_TRIPLE_LABELS || depth == MAX_QUARTER_DEPTH)
  {
    return find_triples(&here, low, size, sets, work);
  }
  for (int quarter = 0; quarter < 4; ++quarter)
  {
    const double from[2] = { 0.5 * (quarter & 1), 0.5 * (quarter >> 1) };
    double* sub_values = values + 4 * width;
    for (size_t l = 0; l < count; ++l)
    {
      for (int c = 0; c < 4; ++c)
      {
        const double at[2] = { from[0] + 0.5 * (c & 1), from[1] + 0.5 * (c >> 1) };
        sub_values[4 * l + (size_t)c] = bilinear(values + 4 * l, at);
      }
    }
    const mlim_corners sub = { .count = count, .labels = labels, .values = sub_values };
    const size_t kept = prune(&sub, 4, labels + width, sub_values);
    const double sub_low[2] = { low[0] + size * from[0], low[1] + size * from[1] };
    const mlim_status status = find_in_square(kept, width, depth + 1, sub_low, sets, work);
    if (status)
    {
      return status;
    }
  }
  return MLIM_OK;
}

/* Adds the bonus and prunes, in row 0 of the buffers. In this order: a label that another one beats by
   less than the bonuses' difference, as rounding makes it where two tie, has to stay. */
static mlim_status start(
  const mlim_corners* from, size_t corner_count, mlim_face_work* work, size_t* count)
{
  const size_t rows = MAX_QUARTER_DEPTH + 1;
  if (mlim_reserve(&work->labels, &work->label_capacity, rows * from->count, sizeof(int32_t)) ||
      mlim_reserve(&work->values, &work->value_capacity, 4 * rows * from->count, sizeof(double)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  for (size_t l = 0; l < from->count; ++l)
  {
    work->labels[l] = from->labels[l];
    for (size_t c = 0; c < corner_count; ++c)
    {
      work->values[corner_count * l + c] =
        from->values[corner_count * l + c] + bonus(from->labels[l]);
    }
  }
  const mlim_corners all = { .count = from->count, .labels = work->labels, .values = work->values };
  *count = prune(&all, corner_count, work->labels, work->values);
  return MLIM_OK;
}

static int compare_points(const void* a, const void* b)
{
  const mlim_face_point* p = a;
  const mlim_face_point* q = b;
  for (int k = 0; k < 2; ++k)
  {
    if (p->at[k] < q->at[k] || p->at[k] > q->at[k])
    {
      return p->at[k] < q->at[k] ? -1 : 1;
    }
  }
  return 0;
}

/* The points are sorted by place, so that their order does not depend on that of the labels. */
mlim_status mlim_face_find(const mlim_corners* square, mlim_set_table* sets, mlim_face_work* work)
{
  work->point_count = 0;
  size_t count;
  mlim_status status = start(square, 4, work, &count);
  const double low[2] = { 0, 0 };
  status = status ? status : find_in_square(count, square->count, 0, low, sets, work);
  if (work->point_count > 1)
  {
    qsort(work->points, work->point_count, sizeof(mlim_face_point), compare_points);
  }
  return status;
}

/* The upper envelope of lines, walked from 0 to 1: the next winner is the one that overtakes the
   present one first; of those that do so together, the steepest. */
mlim_status mlim_edge_find(const mlim_corners* edge, mlim_face_work* work)
{
  assert(edge->count > 0);
  work->edge_point_count = 0;
  size_t count;
  const mlim_status status = start(edge, 2, work, &count);
  if (status)
  {
    return status;
  }
  if (mlim_reserve(&work->edge_points, &work->edge_point_capacity, count, sizeof(mlim_edge_point)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  const double* values = work->values;
  size_t winner = 0;
  for (size_t l = 1; l < count; ++l)
  {
    winner = values[2 * l] > values[2 * winner] ? l : winner;
  }
  work->first_label = work->labels[winner];
  for (size_t step = 0; step + 1 < count; ++step)
  {
    size_t next = count;
    double at = 0;
    double rise = 0;
    for (size_t l = 0; l < count; ++l)
    {
      const double begin = values[2 * winner] - values[2 * l];
      const double end = values[2 * l + 1] - values[2 * winner + 1];
      const double t = begin / (begin + end);
      if (end > 0 && begin + end > 0 && (next == count || t < at || (!(t > at) && end > rise)))
      {
        next = l;
        at = t;
        rise = end;
      }
    }
    if (next == count)
    {
      break;
    }
    work->edge_points[work->edge_point_count] = (mlim_edge_point){
      .at = fmin(fmax(at, 0), 1), .before = work->labels[winner], .after = work->labels[next]
    };
    ++work->edge_point_count;
    winner = next;
  }
  return MLIM_OK;
}
