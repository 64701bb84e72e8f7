#include "diffusion.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Squared gradients below this part of the squared slope are flat: nothing moves there. */
static const float FLAT = 1e-8F;

/* The 27 neighbours of a point, as offsets that stop at the block's faces. */
typedef struct place
{
  const float* centre;
  ptrdiff_t low[3], high[3]; /* to the neighbours along each axis */
} place;

static float central(const mlim_diffusion* d, const place* at, const float* from, int axis)
{
  return 0.5F * d->inverse[axis] * (from[at->high[axis]] - from[at->low[axis]]);
}

/* Flux of the unit normal, slowed down where it is steep, through the middle of one side. */
static float flux(const mlim_diffusion* d, const place* at, int axis, ptrdiff_t side, float slope)
{
  float squared = slope * slope;
  for (int k = 0; k < 3; ++k)
  {
    if (k != axis)
    {
      const float mean =
        0.5F * (central(d, at, at->centre, k) + central(d, at, at->centre + side, k));
      squared += mean * mean;
    }
  }
  const float steepest = d->slope * d->slope;
  return squared > FLAT * steepest ? slope / (sqrtf(squared) * (1 + squared / steepest)) : 0;
}

static float change(const mlim_diffusion* d, const place* at)
{
  float speed = 0;
  float rising = 0;
  float falling = 0;
  for (int k = 0; k < 3; ++k)
  {
    const float before = d->inverse[k] * (at->centre[0] - at->centre[at->low[k]]);
    const float after = d->inverse[k] * (at->centre[at->high[k]] - at->centre[0]);
    speed +=
      d->inverse[k] * (flux(d, at, k, at->high[k], after) - flux(d, at, k, at->low[k], before));
    const float up[2] = { before < 0 ? before : 0, after > 0 ? after : 0 };
    const float down[2] = { before > 0 ? before : 0, after < 0 ? after : 0 };
    rising += up[0] * up[0] + up[1] * up[1];
    falling += down[0] * down[0] + down[1] * down[1];
  }
  const float time = d->step * d->min_spacing * d->min_spacing;
  return time * speed * sqrtf(speed > 0 ? rising : falling);
}

void mlim_diffusion_run(
  const mlim_diffusion* diffusion, const int32_t size[3], float* values, float* scratch)
{
  const ptrdiff_t steps[3] = { 1, size[0], (ptrdiff_t)size[0] * size[1] };
  const size_t count = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
  for (int32_t n = 0; n < diffusion->iterations; ++n)
  {
    memcpy(scratch, values, count * sizeof *values);
    size_t i = 0;
    for (int32_t z = 0; z < size[2]; ++z)
    {
      for (int32_t y = 0; y < size[1]; ++y)
      {
        for (int32_t x = 0; x < size[0]; ++x, ++i)
        {
          const int32_t at[3] = { x, y, z };
          place p = { .centre = scratch + i };
          for (int k = 0; k < 3; ++k)
          {
            p.low[k] = at[k] > 0 ? -steps[k] : 0;
            p.high[k] = at[k] < size[k] - 1 ? steps[k] : 0;
          }
          values[i] += change(diffusion, &p);
        }
      }
    }
  }
}
