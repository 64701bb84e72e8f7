/* The cells of the volume as a plain mesh: no longer Delaunay, so that they can be exchanged freely.

   A face between two labels, or with nothing beyond it, belongs to the surface and stays. All else
   may change: a set of cells of one label gives way to other cells that fill the same space. */
#ifndef mlim_solid_h
#define mlim_solid_h

#include "mlim.h"

#include "shape.h"

enum
{
  MLIM_SOLID_NOTHING = -1,                         /* beyond a face */
  MLIM_SOLID_MAX_OLD = 192,                        /* cells that one exchange takes out */
  MLIM_SOLID_MAX_NEW = 2 * MLIM_SOLID_MAX_OLD + 2, /* and puts in: the faces round that many */
  MLIM_SOLID_TABLE = 4096 /* twice the faces of the new cells, a power of 2 */
};

typedef struct mlim_solid_cell
{
  int32_t vertices[4]; /* positively oriented; vertices[0] < 0: no cell */
  int32_t neighbors[4];
  int32_t label;
  uint32_t mark;
  double shape; /* mlim_shape_of */
} mlim_solid_cell;

typedef struct mlim_solid_face
{
  int32_t vertices[3]; /* ascending */
  int32_t cell;        /* index among the new cells */
  uint32_t stamp;
  unsigned char index;
  unsigned char is_matched;
} mlim_solid_face;

/* An exchange that is being prepared. */
typedef struct mlim_solid_change
{
  int32_t old_cells[MLIM_SOLID_MAX_OLD];
  size_t old_count;
  int32_t new_cells[MLIM_SOLID_MAX_NEW][4]; /* vertices; after the exchange see new_ids */
  double new_shapes[MLIM_SOLID_MAX_NEW];
  int32_t new_ids[MLIM_SOLID_MAX_NEW];
  size_t new_count;
} mlim_solid_change;

typedef struct mlim_solid
{
  mlim_shape_bound bound;
  double* points; /* 3 a vertex */
  size_t vertex_count, vertex_capacity;
  size_t fixed_count;           /* the first vertices are the surface's and stay where they are */
  const unsigned char* is_ball; /* borrowed; per fixed vertex: its cells may have any ratio */
  mlim_solid_cell* cells;
  size_t cell_count, cell_capacity;
  int32_t* free_cells;
  size_t free_count, free_capacity;
  uint32_t stamp;
  mlim_solid_face* table;      /* MLIM_SOLID_TABLE */
  int32_t (*new_neighbors)[4]; /* MLIM_SOLID_MAX_NEW */
  int32_t (*outer)[2];         /* cell and index beyond each face of a new cell */
  uint32_t table_stamp;
} mlim_solid;

/* Room for so many vertices and cells, none of which is there yet. */
mlim_status mlim_solid_create(
  size_t vertices, size_t cells, mlim_context* context, mlim_solid* out);
void mlim_solid_free(mlim_solid* solid);

double mlim_solid_shape(const mlim_solid* solid, const int32_t vertices[4]);

/* Whether the face of a cell opposite to vertex `index` lies inside its label. */
int mlim_solid_is_open(const mlim_solid* solid, const mlim_solid_cell* cell, int index);

/* The cells of a vertex that is not fixed, from one of them on, into change->old_cells. Returns 0 if
   they are too many, or the vertex is on the surface after all. */
int mlim_solid_star(mlim_solid* solid, int32_t cell, int32_t vertex, mlim_solid_change* change);

/* Whether all new cells are positively oriented (mlim_shape_is_positive). */
int mlim_solid_is_positive(const mlim_solid* solid, const mlim_solid_change* change);

/* Takes out the old cells and puts in the new ones, all of which get `label`. Returns 0, and nothing has
   changed, when not all new cells are positively oriented or their faces do not fit; -1 when out of
   memory. Cells of one orientation whose faces fit fill the old ones' space once. */
int mlim_solid_exchange(mlim_solid* solid, mlim_solid_change* change, int32_t label);

#endif
