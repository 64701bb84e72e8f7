#include "climb.h"
#include "exchange.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* The mean of the other vertices of the cells. */
static void find_mean(
  const mlim_solid* solid, const mlim_solid_change* change, int32_t vertex, double out[3])
{
  double sum[3] = { 0 };
  for (size_t c = 0; c < change->new_count; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      const int32_t v = change->new_cells[c][k];
      for (int x = 0; x < 3 && v != vertex; ++x)
      {
        sum[x] += solid->points[3 * (size_t)v + (size_t)x];
      }
    }
  }
  for (int x = 0; x < 3; ++x)
  {
    out[x] = sum[x] / (3.0 * (double)change->new_count);
  }
}

int mlim_exchange_move(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index)
{
  const int32_t vertex = solid->cells[cell].vertices[index];
  if ((size_t)vertex < solid->fixed_count || !mlim_solid_star(solid, cell, vertex, change))
  {
    return 0;
  }
  double worst = INFINITY;
  change->new_count = 0;
  for (size_t c = 0; c < change->old_count; ++c)
  {
    const mlim_solid_cell* old = &solid->cells[change->old_cells[c]];
    memcpy(change->new_cells[change->new_count++], old->vertices, sizeof old->vertices);
    worst = mlim_min(worst, old->shape);
  }
  double* point = solid->points + 3 * (size_t)vertex;
  double from[3];
  mlim_copy(point, from);
  find_mean(solid, change, vertex, point);
  if (!(mlim_climb_worst(solid, change, worst) > worst))
  {
    mlim_copy(from, point);
  }
  if (!(mlim_climb(solid, change, vertex) > mlim_exchange_least(worst)) ||
      !mlim_solid_is_positive(solid, change))
  {
    mlim_copy(from, point);
    return 0;
  }
  for (size_t c = 0; c < change->new_count; ++c)
  {
    change->new_ids[c] = change->old_cells[c];
    solid->cells[change->old_cells[c]].shape = change->new_shapes[c];
  }
  return 1;
}
