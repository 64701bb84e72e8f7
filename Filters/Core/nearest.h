/* Distance of points to a triangle mesh, through a grid of bins. */
#ifndef mlim_nearest_h
#define mlim_nearest_h

#include "mlim.h"

typedef struct mlim_nearest
{
  const mlim_mesh* mesh; /* borrowed */
  double bin;            /* side of a bin */
  int32_t bins[3];
  size_t* offsets; /* bins + 1, into triangles */
  int32_t* triangles;
} mlim_nearest;

/* Bins of about this side over the box [0, size]. */
mlim_status mlim_nearest_create(const mlim_mesh* mesh, const double size[3], double side,
  mlim_context* context, mlim_nearest* out);
void mlim_nearest_free(mlim_nearest* nearest);

/* Distance to the mesh if it is below `limit`, else limit. Stops early at `enough`: the result is
   then at most that. */
double mlim_nearest_distance(
  const mlim_nearest* nearest, const double point[3], double enough, double limit);

/* Whether a triangle is at most `bound` away. */
int mlim_nearest_is_within(const mlim_nearest* nearest, const double point[3], double bound);

#endif
