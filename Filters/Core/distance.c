/* Exact squared Euclidean distances, one axis at a time: out(p) = min over q of in(q) + cost(|p - q|).
   The band is a few points wide, so looking at each of them is faster than lower envelopes of
   parabolas, and the compiler makes vectors of it. */
#include "distance.h"

#include <math.h>
#include <string.h>

int mlim_distance_cost_of(const double spacing[3], double band, mlim_distance_cost* out)
{
  *out = (mlim_distance_cost){ .band = (float)band };
  for (int k = 0; k < 3; ++k)
  {
    const double points = ceil(band / spacing[k] + 0.5);
    if (!(points <= MLIM_MAX_RADIUS))
    {
      return 0;
    }
    out->radius[k] = (int32_t)points;
    for (int32_t step = 1; step <= out->radius[k]; ++step)
    {
      const double length = spacing[k] * (step - 0.5);
      out->squared[k][step] = (float)(length * length);
    }
  }
  return 1;
}

static void lower(float* restrict out, const float* restrict in, size_t count, float cost)
{
  for (size_t i = 0; i < count; ++i)
  {
    const float v = in[i] + cost;
    out[i] = v < out[i] ? v : out[i];
  }
}

/* Rows of `row` values that follow each other make lines of `length` rows along an axis. */
static void reach_along(size_t lines, size_t length, size_t row, const float* cost, size_t radius,
  const float* in, float* out)
{
  memcpy(out, in, lines * length * row * sizeof *out);
  for (size_t line = 0; line < lines; ++line)
  {
    const float* from = in + line * length * row;
    float* to = out + line * length * row;
    for (size_t step = 1; step <= radius && step < length; ++step)
    {
      const size_t offset = step * row;
      const size_t count = (length - step) * row;
      lower(to + offset, from, count, cost[step]);
      lower(to, from + offset, count, cost[step]);
    }
  }
}

/* Squared distances from 0 where there is a source and `far` elsewhere. */
static void reach(
  const mlim_distance_cost* cost, const int32_t size[3], float* values, float* scratch)
{
  const size_t n[3] = { (size_t)size[0], (size_t)size[1], (size_t)size[2] };
  reach_along(n[1] * n[2], n[0], 1, cost->squared[0], (size_t)cost->radius[0], values, scratch);
  reach_along(n[2], n[1], n[0], cost->squared[1], (size_t)cost->radius[1], scratch, values);
  reach_along(1, n[2], n[0] * n[1], cost->squared[2], (size_t)cost->radius[2], values, scratch);
}

void mlim_distance_signed(const mlim_distance_cost* cost, const int32_t size[3],
  const unsigned char* mask, float* scratch, float* out)
{
  const size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
  const float far = cost->band * cost->band;
  float* other = scratch + count;
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = mask[i] ? far : 0;
  }
  reach(cost, size, out, scratch);
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = mask[i] ? 0 : far;
  }
  reach(cost, size, out, other);
  for (size_t i = 0; i < count; ++i)
  {
    const float inside = scratch[i] < far ? scratch[i] : far;
    const float outside = other[i] < far ? other[i] : far;
    out[i] = sqrtf(inside) - sqrtf(outside);
  }
}
