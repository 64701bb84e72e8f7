#include "known.h"

#include "ball_grid.h"
#include "criteria.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

/* Radii round a contact within which no vertex stays. */
static const double ANEW = 3;

enum
{
  LOOK_EVERY = 16384 /* vertices between two looks at the host: about 10 ms */
};

void mlim_known_free(mlim_known* known)
{
  mlim_release(known->points);
  mlim_release(known->sheets);
  *known = (mlim_known){ 0 };
}

/* Squared radii round a ball within which no vertex stays. */
static double factor_of(const mlim_balls* balls, size_t ball)
{
  return balls->ball_curves[ball] == MLIM_CONTACT ? ANEW * ANEW : 1 + MLIM_NEAR_GUARD;
}

static int may_stay(
  const mlim_balls* balls, const mlim_ball_grid* grid, double reach, const double point[3])
{
  mlim_point_walk walk;
  for (int32_t b = mlim_point_grid_first(&grid->points, point, reach, &walk); b >= 0;
       b = mlim_point_grid_next(&grid->points, &walk))
  {
    const double d = mlim_distance_squared(balls->centers + 3 * (size_t)b, point);
    if (d < factor_of(balls, (size_t)b) * balls->radii[b] * balls->radii[b])
    {
      return 0;
    }
  }
  return 1;
}

mlim_status mlim_known_keep(const mlim_complex* complex, const mlim_balls* balls, double progress,
  mlim_context* context, mlim_known* out)
{
  *out = (mlim_known){ .progress = progress,
    .points = mlim_allocate(complex->vertex_count, 3 * sizeof *out->points),
    .sheets = mlim_allocate(complex->vertex_count, sizeof *out->sheets) };
  mlim_ball_grid grid = { 0 };
  mlim_status status = out->points != NULL && out->sheets != NULL
                         ? mlim_ball_grid_fill(balls, &grid)
                         : MLIM_OUT_OF_MEMORY;
  if (status)
  {
    status = mlim_fail_memory(context, "the triangulation");
  }
  double reach = 0;
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    reach = mlim_max(reach, sqrt(factor_of(balls, b)) * balls->radii[b]);
  }
  for (size_t v = 0; v < complex->vertex_count && status == MLIM_OK; ++v)
  {
    const mlim_vertex* vertex = &complex->vertices[v];
    if (vertex->kind == MLIM_VERTEX_SURFACE && may_stay(balls, &grid, reach, vertex->point))
    {
      mlim_copy(vertex->point, out->points + 3 * out->count);
      out->sheets[out->count++] = vertex->sheet;
    }
    if (v % LOOK_EVERY == 0)
    {
      status = mlim_progress(context, MLIM_STAGE_SURFACE, progress);
    }
  }
  mlim_ball_grid_free(&grid);
  if (status != MLIM_OK)
  {
    mlim_known_free(out);
  }
  return status;
}
