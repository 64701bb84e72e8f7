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

enum
{
  MLIM_NEAREST_HINTS = 512 /* more columns than that of the grid share them */
};

/* Triangles near the last points of each column of the grid, those of equal x: the next one's is nearly
   always among them. For the points of one slice, row after row. */
typedef struct mlim_nearest_hints
{
  int32_t triangles[MLIM_NEAREST_HINTS]; /* -1: none */
} mlim_nearest_hints;

static inline void mlim_nearest_hints_clear(mlim_nearest_hints* hints)
{
  for (int k = 0; k < MLIM_NEAREST_HINTS; ++k)
  {
    hints->triangles[k] = -1;
  }
}

static inline int32_t* mlim_nearest_hint_at(mlim_nearest_hints* hints, int32_t column)
{
  return &hints->triangles[column % MLIM_NEAREST_HINTS];
}

/* Points to look from, wherever they are. Borrowed. */
typedef struct mlim_nearest_points
{
  size_t count;
  const double* points;
  size_t stride; /* from one point to the next */
} mlim_nearest_points;

/* Asks for what looking from these points will read. Nothing changes but the time. */
void mlim_nearest_ahead(const mlim_nearest* nearest, const mlim_nearest_points* from);

/* Distance to the mesh if it is below `limit`, else limit. Stops early at `enough`: the result is
   then at most that. *hint: a triangle that may be near, looked at first, or -1; the one that was found
   takes its place. It changes the time, and what is told below `enough`. */
double mlim_nearest_distance(
  const mlim_nearest* nearest, const double point[3], double enough, double limit, int32_t* hint);

/* Whether a triangle is at most `bound` away. */
int mlim_nearest_is_within(
  const mlim_nearest* nearest, const double point[3], double bound, int32_t* hint);

#endif
