#include "climb.h"

#include "vector.h"

#include <math.h>

enum
{
  MAX_CLIMBS = 5,
  MAX_HALVINGS = 6
};

/* The first step of a climb, as part of the distance to the nearest vertex of the hull. */
static const double FIRST_STEP = 0.4;
/* Length for derivatives, as part of the same. */
static const double DERIVATIVE_STEP = 1e-4;
/* How much cells above the worst count in the climb's direction: e to the minus this times the
   difference of shapes. Less blurs the worst, more stalls where two cells are equally bad. */
static const double SHARPNESS = 12;
/* A climb ends where the worst angle's sine is this times its bound. */
static const double GOOD_ENOUGH = 1.1;

double mlim_climb_worst(const mlim_solid* solid, mlim_solid_change* change, double above)
{
  double worst = INFINITY;
  for (size_t c = 0; c < change->new_count && worst > above; ++c)
  {
    change->new_shapes[c] = mlim_solid_shape(solid, change->new_cells[c]);
    worst = mlim_min(worst, change->new_shapes[c]);
  }
  return worst;
}

static double smooth_worst(const mlim_solid* solid, const mlim_solid_change* change, double worst)
{
  double sum = 0;
  for (size_t c = 0; c < change->new_count; ++c)
  {
    /* What is far above the worst has no say. */
    if (change->new_shapes[c] - worst < 0.5)
    {
      sum += exp(-SHARPNESS * (mlim_solid_shape(solid, change->new_cells[c]) - worst));
    }
  }
  return sum;
}

static double nearest_distance(
  const mlim_solid* solid, const mlim_solid_change* change, int32_t vertex)
{
  const double* point = solid->points + 3 * (size_t)vertex;
  double least = INFINITY;
  for (size_t c = 0; c < change->new_count; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      const int32_t v = change->new_cells[c][k];
      if (v != vertex)
      {
        least = mlim_min(least, mlim_distance_squared(point, solid->points + 3 * (size_t)v));
      }
    }
  }
  return sqrt(least);
}

/* Direction in which the worst cells become better. Returns 0 where there is none. */
static int find_direction(const mlim_solid* solid, const mlim_solid_change* change, int32_t vertex,
  double worst, double step, double out[3])
{
  double* point = solid->points + 3 * (size_t)vertex;
  const double here = smooth_worst(solid, change, worst);
  for (int k = 0; k < 3; ++k)
  {
    const double x = point[k];
    point[k] = x + step;
    out[k] = here - smooth_worst(solid, change, worst);
    point[k] = x;
  }
  const double length = sqrt(mlim_dot(out, out));
  if (!(length > 0) || !isfinite(length))
  {
    return 0;
  }
  for (int k = 0; k < 3; ++k)
  {
    out[k] /= length;
  }
  return 1;
}

double mlim_climb(mlim_solid* solid, mlim_solid_change* change, int32_t vertex)
{
  const double enough = 1 + GOOD_ENOUGH * solid->bound.sine;
  double* point = solid->points + 3 * (size_t)vertex;
  double worst = mlim_climb_worst(solid, change, -INFINITY);
  double step = FIRST_STEP * nearest_distance(solid, change, vertex);
  for (int n = 0; n < MAX_CLIMBS && worst < enough && step > 0; ++n)
  {
    double direction[3];
    if (!find_direction(
          solid, change, vertex, worst, step * DERIVATIVE_STEP / FIRST_STEP, direction))
    {
      break;
    }
    double from[3];
    mlim_copy(point, from);
    double there = -INFINITY;
    for (int h = 0; h < MAX_HALVINGS; ++h, step *= 0.5)
    {
      for (int k = 0; k < 3; ++k)
      {
        point[k] = from[k] + step * direction[k];
      }
      there = mlim_climb_worst(solid, change, worst);
      if (there > worst)
      {
        break;
      }
    }
    if (!(there > worst))
    {
      mlim_copy(from, point);
      break;
    }
    worst = there;
  }
  return mlim_climb_worst(solid, change, -INFINITY);
}
