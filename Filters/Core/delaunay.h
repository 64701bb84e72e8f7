/* Weighted Delaunay triangulation of points that are added one at a time. Its decisions are exact.

   Cells and vertices have dense ids. Eight far vertices (ids 0 to 7) stand round the box, so that
   every point of the box and every cell's power centre that matters is inside; a neighbour beyond
   them is MLIM_NO_CELL. The order of ids and cells depends on the order of insertions alone. */
#ifndef mlim_delaunay_h
#define mlim_delaunay_h

#include "mlim.h"

enum
{
  MLIM_NO_CELL = -1,
  MLIM_FAR_VERTICES = 8
};

typedef struct mlim_delaunay mlim_delaunay;

/* Around the box [0, size]. */
mlim_status mlim_delaunay_create(const double size[3], mlim_context* context, mlim_delaunay** out);
void mlim_delaunay_free(mlim_delaunay* delaunay);

/* Positions of the far vertices. */
void mlim_delaunay_far_vertex(const mlim_delaunay* delaunay, int32_t vertex, double out[3]);

/* A cell that was made: a positively oriented tetrahedron. */
typedef struct mlim_delaunay_cell
{
  int32_t id;
  int32_t vertices[4];
  int32_t neighbors[4]; /* neighbour k is opposite to vertex k */
  double center[3];     /* power centre (weighted circumcentre) */
} mlim_delaunay_cell;

/* The cells of the new triangulation, borrowed until the next call. */
typedef struct mlim_delaunay_cells
{
  size_t count;
  const mlim_delaunay_cell* cells;
} mlim_delaunay_cells;

/* All cells there are, in ascending id. */
mlim_status mlim_delaunay_all(
  mlim_delaunay* delaunay, mlim_context* context, mlim_delaunay_cells* out);

/* First half of an insertion: the cells that would die, borrowed until the next call. None if the
   point would be hidden by others, or would hide one. `start`: a cell whose power sphere may hold
   the point, or any cell near it, with is_near telling which. Nothing changes. */
typedef enum mlim_delaunay_start
{
  MLIM_START_IN_CONFLICT, /* start is tried alone: no search */
  MLIM_START_NEAR         /* the point is located from start on; MLIM_NO_CELL: from the last one */
} mlim_delaunay_start;

typedef struct mlim_delaunay_zone
{
  size_t count;
  const int32_t* cells;
} mlim_delaunay_zone;

mlim_status mlim_delaunay_find(mlim_delaunay* delaunay, const double point[3], double weight,
  int32_t start, mlim_delaunay_start kind, mlim_context* context, mlim_delaunay_zone* out);

/* Second half: inserts the point of the last find. Its vertex has the next id. Cells of the zone
   are dead and their ids may be used again by the new cells, all of which have the new vertex.
   out == NULL: the cells are not asked for, which saves the time for their centres. */
mlim_status mlim_delaunay_fill(
  mlim_delaunay* delaunay, mlim_context* context, mlim_delaunay_cells* out);

#endif
