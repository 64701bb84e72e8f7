/* Protecting balls in a grid, for finding those near a place. */
#ifndef mlim_ball_grid_h
#define mlim_ball_grid_h

#include "point_grid.h"

/* All 0 is a valid argument of _free. */
typedef struct mlim_ball_grid
{
  mlim_point_grid points; /* items are the balls */
  double largest;         /* radius of a ball */
} mlim_ball_grid;

/* An empty grid for these balls, and one that has them all. */
mlim_status mlim_ball_grid_create(const mlim_balls* balls, mlim_ball_grid* out);
mlim_status mlim_ball_grid_fill(const mlim_balls* balls, mlim_ball_grid* out);
void mlim_ball_grid_free(mlim_ball_grid* grid);

#endif
