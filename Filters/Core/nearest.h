/* Distance of points to a triangle mesh, through a grid of bins. */
#ifndef mlim_nearest_h
#define mlim_nearest_h

#include "mlim.h"

/* Triangles of points wherever these are. Borrowed. */
typedef struct mlim_triangles
{
  size_t count;
  const int32_t* vertices; /* 3 each */
  const double* points;
  size_t stride; /* from one point to the next */
} mlim_triangles;

static inline mlim_triangles mlim_triangles_of(const mlim_mesh* mesh)
{
  return (mlim_triangles){ .count = mesh->triangle_count,
    .vertices = mesh->triangles,
    .points = mesh->vertices,
    .stride = 3 };
}

typedef struct mlim_nearest
{
  mlim_triangles mesh;
  double bin; /* side of a bin */
  int32_t bins[3];
  uint32_t* offsets; /* bins + 1, into triangles */
  int32_t* triangles;
} mlim_nearest;

/* Bins of about this side over the box [0, size]. */
mlim_status mlim_nearest_create(const mlim_triangles* triangles, const double size[3], double side,
  mlim_context* context, mlim_nearest* out);
void mlim_nearest_free(mlim_nearest* nearest);

/* Distance to the mesh if it is below `limit`, else limit. Stops early at `enough`: the result is
   then at most that. */
double mlim_nearest_distance(
  const mlim_nearest* nearest, const double point[3], double enough, double limit);

/* Whether a triangle is at most `bound` away. */
int mlim_nearest_is_within(const mlim_nearest* nearest, const double point[3], double bound);

#endif
