#include "ball_grid.h"

#include "vector.h"

mlim_status mlim_ball_grid_create(const mlim_balls* balls, mlim_ball_grid* out)
{
  *out = (mlim_ball_grid){ 0 };
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    out->largest = mlim_max(out->largest, balls->radii[b]);
  }
  const double cube = out->largest > 0 ? 2 * out->largest : 1;
  return mlim_point_grid_create(cube, balls->ball_count, &out->points);
}

mlim_status mlim_ball_grid_fill(const mlim_balls* balls, mlim_ball_grid* out)
{
  const mlim_status status = mlim_ball_grid_create(balls, out);
  for (size_t b = 0; b < balls->ball_count && !status; ++b)
  {
    mlim_point_grid_add(&out->points, balls->centers + 3 * b, (int32_t)b);
  }
  return status;
}

void mlim_ball_grid_free(mlim_ball_grid* grid)
{
  mlim_point_grid_free(&grid->points);
}
