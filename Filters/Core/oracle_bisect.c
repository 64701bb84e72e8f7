/* The paper's oracle. */
#include "oracle.h"

#include "field_index.h"
#include "vector.h"

#include <math.h>

typedef struct bisection
{
  mlim_label_function label;
  const void* user;
  double tolerance_squared;
  size_t count, capacity;
  mlim_crossing* out;
} bisection;

static void bisect(
  bisection* b, const double start[3], int32_t from, const double end[3], int32_t to, int depth)
{
  double middle[3];
  mlim_interpolate(start, end, 0.5, middle);
  if (depth >= 64 || mlim_distance_squared(start, end) < b->tolerance_squared)
  {
    if (from != to && b->count < b->capacity)
    {
      b->out[b->count] = (mlim_crossing){ .from = from, .to = to, .face = -1 };
      mlim_copy(middle, b->out[b->count].point);
      ++b->count;
    }
    return;
  }
  const int32_t between = b->label(b->user, middle);
  if (from != between)
  {
    bisect(b, start, from, middle, between, depth + 1);
  }
  if (between != to)
  {
    bisect(b, middle, between, end, to, depth + 1);
  }
}

size_t mlim_oracle_bisect(mlim_label_function label, const void* user, const double start[3],
  const double end[3], double tolerance, size_t capacity, mlim_crossing* out)
{
  bisection b = { .label = label,
    .user = user,
    .tolerance_squared = tolerance * tolerance,
    .capacity = capacity,
    .out = out };
  bisect(&b, start, label(user, start), end, label(user, end), 0);
  return b.count;
}

static int32_t field_label(const void* user, const double point[3])
{
  return mlim_field_label((const mlim_field*)user, point);
}

/* A crossing that bisection found next to the box's surface lies on it. */
static void put_on_box(const mlim_field* field, double tolerance, mlim_crossing* crossing)
{
  if (crossing->from != field->outside_label && crossing->to != field->outside_label)
  {
    return;
  }
  for (int face = 0; face < 6; ++face)
  {
    const double plane = face & 1 ? field->grid.size[face >> 1] : 0;
    double within[3];
    mlim_copy(crossing->point, within);
    within[face >> 1] = plane;
    if (fabs(crossing->point[face >> 1] - plane) <= tolerance &&
        mlim_field_label(field, within) != field->outside_label)
    {
      crossing->point[face >> 1] = plane;
      crossing->face = face;
      return;
    }
  }
}

size_t mlim_oracle_crossings_by_bisection(const mlim_oracle* oracle, const double start[3],
  const double end[3], size_t capacity, mlim_crossing* out)
{
  const size_t count =
    mlim_oracle_bisect(field_label, oracle->field, start, end, oracle->tolerance, capacity, out);
  for (size_t c = 0; c < count; ++c)
  {
    put_on_box(oracle->field, oracle->tolerance, &out[c]);
  }
  return count;
}
