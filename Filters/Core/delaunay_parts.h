/* What the triangulation holds. Private to the files that start it, find zones and fill them. */
#ifndef mlim_delaunay_parts_h
#define mlim_delaunay_parts_h

#include "delaunay.h"

enum
{
  DELAUNAY_FEW = 64 /* vertices of a border with a table of edges; larger ones are hashed */
};

/* A facet between a dead cell and one that lives, or the outside. Its normal points out of the dead one. */
typedef struct delaunay_facet
{
  int32_t outer, index; /* facet `index` of a cell, or MLIM_NO_CELL */
  int32_t vertices[3];
  int32_t places[3]; /* of the vertices in `around` */
} delaunay_facet;

typedef struct delaunay_point
{
  double at[4]; /* coordinates and weight */
} delaunay_point;

struct mlim_delaunay
{
  double size[3]; /* of the box */
  void* cell_memory;
  mlim_cell* cells; /* in it */
  mlim_power_sphere* spheres;
  size_t cell_count, cell_capacity, sphere_capacity;
  int32_t* free_cells; /* ids of dead cells, last in first out */
  size_t free_count, free_capacity;
  mlim_vertex* vertices;
  int32_t* places; /* a vertex: its place in `around`, if it is there */
  size_t vertex_count, vertex_capacity, place_capacity;
  int32_t last; /* a cell of the last insertion: what is asked for next is often near */
  uint32_t stamp;

  /* The last find. */
  delaunay_point point;
  int has_zone;
  int32_t* zone; /* cells */
  size_t zone_count, zone_capacity;
  delaunay_facet* border;
  size_t border_count, border_capacity;
  int32_t* around; /* vertices of the border */
  size_t around_count, around_capacity;

  /* The last fill. */
  int32_t* made; /* cell k on facet k of the border */
  size_t made_capacity;
  int32_t* slots; /* hashed edges of a large border */
  size_t slot_capacity;
  unsigned char edges[DELAUNAY_FEW][DELAUNAY_FEW]; /* of a small one: the facet that has the edge */
};

static inline void delaunay_corners(const mlim_delaunay* d, int32_t cell, const double* out[4])
{
  for (int k = 0; k < 4; ++k)
  {
    out[k] = d->vertices[d->cells[cell].vertices[k]].at;
  }
}

/* The three vertices of facet `index`, so that its normal points out of the cell. */
static inline void delaunay_facet_of(const mlim_cell* cell, int index, int32_t out[3])
{
  static const unsigned char order[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
  for (int k = 0; k < 3; ++k)
  {
    out[k] = cell->vertices[order[index][k]];
  }
}

/* Center, level and bound of each cell's sphere; of all of them, also when one fails. */
mlim_status delaunay_make_spheres(
  mlim_delaunay* d, const int32_t* cells, size_t count, mlim_context* context);

/* Room for so many more cells and vertices. Not 0: out of memory, or of ids. */
int delaunay_reserve_cells(mlim_delaunay* d, size_t count);
int delaunay_reserve_vertices(mlim_delaunay* d, size_t count);

#endif
