/* Weighted Delaunay triangulation of points that are added one at a time. Its decisions are exact.

   Cells and vertices have dense ids. Eight far vertices (ids 0 to 7) stand round the box, so that
   every point of the box and every cell's power centre that matters is inside; a neighbour beyond
   them is MLIM_NO_CELL. The order of ids and cells depends on the order of insertions alone.

   Where a point lies on the power sphere of a cell, the choice is made as if each vertex were lighter
   than it is by an infinitesimal, infinitely larger than those of all before it. So what ties with a new
   point counts as not in conflict. The triangulation is then that of the lighter points, which are in
   general position: the zone of a point is always star-shaped, and no flat cell is made, since a
   facet in whose plane a point lies has both its cells in conflict with it or neither. */
#ifndef mlim_delaunay_h
#define mlim_delaunay_h

#include "mlim.h"
#include "power_sphere.h"

enum
{
  MLIM_NO_CELL = -1,
  MLIM_FAR_VERTICES = 8,
  MLIM_CLEARANCE_PARTS = 256 /* of a cell of the grid */
};

typedef struct mlim_delaunay mlim_delaunay;

/* A piece of interface: the labels of its two sides, the lower first, and the face of the box on
   which it lies, -1 inside. */
typedef struct mlim_sheet
{
  uint16_t low, high;
  signed char face;
} mlim_sheet;

/* A vertex, shared with the client, which has but this one copy of it. 48 bytes. */
typedef struct mlim_vertex
{
  union
  {
    double at[4]; /* the triangulation's own */
    struct
    {
      double point[3];
      double weight;
    };
  };
  /* The client's. All 0 when the vertex is made. */
  int32_t cell;       /* one of the cells that have it */
  int32_t ball;       /* index of its ball, -1 */
  mlim_sheet sheet;   /* of a surface vertex */
  unsigned char kind; /* mlim_vertex_kind; apart from what changes, for other threads */
  unsigned char
    is_dirty : 1; /* its star of restricted facets has changed since the disk was looked at */
  unsigned char is_broken : 1; /* its disk failed at the last look */
} mlim_vertex;

/* A positively oriented tetrahedron, shared with the client. 64 bytes: what a walk from cell to cell needs
   is in one line of the cache, in whose size the time goes. */
typedef struct mlim_cell
{
  int32_t vertices[4];    /* vertices[0] < 0: a dead cell, with nothing else in it */
  int32_t neighbors[4];   /* neighbour k is opposite to vertex k */
  uint32_t seen;          /* the triangulation's own */
  mlim_power_bound bound; /* of the sphere; also the triangulation's own */
  /* The client's. All 0 when the cell is made, but facets[0]. */
  uint16_t clearance; /* mlim_field_look at the centre, in parts of MLIM_CLEARANCE_PARTS, or less */
  uint32_t mark;
  int32_t label;
  /* Record of the facet opposite to vertex k; 0: none. A cell made by an insertion has that of facet 0, which the
     cell beyond has too. */
  int32_t facets[4];
} mlim_cell;

/* All cells by id, dead ones too. Of its sphere a dead cell has nothing. */
typedef struct mlim_delaunay_cells
{
  size_t count;
  mlim_cell* cells;
  const mlim_power_sphere* spheres; /* centre: power centre (weighted circumcentre) */
} mlim_delaunay_cells;

/* Around the box [0, size]. */
mlim_status mlim_delaunay_create(const double size[3], mlim_context* context, mlim_delaunay** out);
void mlim_delaunay_free(mlim_delaunay* delaunay);

/* All vertices by id, the far ones first. Borrowed until the next fill. */
mlim_vertex* mlim_delaunay_vertices(mlim_delaunay* delaunay);

/* Borrowed until the next fill. */
mlim_delaunay_cells mlim_delaunay_all(mlim_delaunay* delaunay);

/* Ids of cells that fill a zone of space. Borrowed until the next call. */
typedef struct mlim_delaunay_zone
{
  size_t count;
  const int32_t* cells;
} mlim_delaunay_zone;

/* Makes room for so many more vertices: until then no fill moves those that are there. */
mlim_status mlim_delaunay_reserve(mlim_delaunay* delaunay, size_t count, mlim_context* context);

/* Cells that are dead now: those of the zones whose ids are not in use again. */
mlim_delaunay_zone mlim_delaunay_dead(const mlim_delaunay* delaunay);

typedef enum mlim_delaunay_start
{
  MLIM_START_IN_CONFLICT, /* start is tried alone: no search */
  MLIM_START_NEAR         /* the point is located from start on; MLIM_NO_CELL: from the last one */
} mlim_delaunay_start;

/* The cell that has the point inside, found by walking from a living one near it: the same from any
   start. MLIM_NO_CELL where the point lies on a facet or out of the hull of the far vertices. */
mlim_status mlim_delaunay_locate(mlim_delaunay* delaunay, const double point[3], int32_t start,
  mlim_context* context, int32_t* out);

/* First half of an insertion: the cells that would die. None if the point would be hidden by others or
   would hide one, or is not inside the hull of the far vertices. `start`: a living cell whose power
   sphere may hold the point, or any near it, with `kind` telling which. No cell changes. */
mlim_status mlim_delaunay_find(mlim_delaunay* delaunay, const double point[3], double weight,
  int32_t start, mlim_delaunay_start kind, mlim_context* context, mlim_delaunay_zone* out);

/* Second half: inserts the point of the last find. Its vertex has the next id. Cells of the zone
   are dead and their ids may be used again by the new cells, which `out`, if it is not NULL, lists. All of
   them have the new vertex, as vertices[0]. MLIM_OUT_OF_MEMORY: nothing has changed, or (where
   exact arithmetic had none) centres are missing. */
mlim_status mlim_delaunay_fill(
  mlim_delaunay* delaunay, mlim_context* context, mlim_delaunay_zone* out);

/* Takes out the marked vertices, one byte each and no far one, as if they had never been inserted. The others
   keep their order and close up: the id of each becomes smaller by the marked ones before it. Cells of marked
   vertices are dead, and `out` lists those in their place; all others keep their ids. `done` is reported as
   the share of the surface's stage. On failure nothing has changed. */
mlim_status mlim_delaunay_remove(mlim_delaunay* delaunay, const unsigned char* is_marked,
  double done, mlim_context* context, mlim_delaunay_zone* out);

#endif
