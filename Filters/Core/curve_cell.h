/* The curves inside one cell of the grid, and inside one square of the box's faces. */
#ifndef mlim_curve_cell_h
#define mlim_curve_cell_h

#include "curve_face.h"
#include "field.h"
#include "network.h"
#include "tie.h"

/* A point of the cell at hand, in the unit cube. */
typedef struct mlim_cell_point
{
  double at[3];
  int32_t set;
  int32_t number; /* in the network; -1: not there yet */
  int axis;       /* it was found on a square across this axis */
  int is_inner;   /* inside the square, not on its edges (creases only) */
} mlim_cell_point;

/* One cell after another; all 0 except field and network is a valid start. */
typedef struct mlim_cell_work
{
  const mlim_field* field;     /* borrowed */
  const mlim_field_grid* grid; /* borrowed */
  mlim_network* network;       /* borrowed; takes what is found */
  int32_t label_count;         /* codes from here on are faces of the box */
  mlim_cell_buffer buffer;
  int32_t cell[3];
  size_t count;
  int32_t* labels; /* max_candidates */
  double* values;  /* 8 * max_candidates */
  double* corners; /* 4 * max_candidates */
  mlim_face_work face;
  mlim_cell_point* points;
  size_t point_count;
  size_t point_capacity;
  int32_t* stack; /* lists of points, the list at hand on top */
  size_t stack_count;
  size_t stack_capacity;
} mlim_cell_work;

mlim_status mlim_cell_work_create(
  const mlim_field* field, mlim_network* network, mlim_cell_work* out);
void mlim_cell_work_free(mlim_cell_work* work);

/* Reads the candidates of a cell. */
void mlim_cell_load(mlim_cell_work* work, const int32_t cell[3]);

/* Finds the points of a square of the cell where labels tie: across `axis` at `offset`, its low
   corner at `low`. They are left in work->face, in units of the square. */
mlim_status mlim_cell_find_square(
  mlim_cell_work* work, int axis, const double low[3], double size, double offset);

/* The same for an edge along `axis` from `low`. */
mlim_status mlim_cell_find_edge(mlim_cell_work* work, int axis, const double low[3], double size);

mlim_status mlim_cell_push_point(mlim_cell_work* work, const mlim_cell_point* point);

/* Puts a point on top of the stack. */
mlim_status mlim_cell_push_index(mlim_cell_work* work, int32_t point);

/* Makes coincident points of the list [begin, top of the stack) one. */
mlim_status mlim_cell_weld(mlim_cell_work* work, size_t begin);

/* Emits a segment between two points, refined until it follows the tie. */
mlim_status mlim_cell_emit(mlim_cell_work* work, int32_t a, int32_t b, int32_t set);

/* Joins the points of the list [begin, top of the stack) in pairs of equal sets if each set occurs
   exactly twice; *is_done tells. */
mlim_status mlim_cell_join_pairs(mlim_cell_work* work, size_t begin, int* is_done);

/* Emits one point in the middle of the list [begin, top of the stack), with the labels of all and
   joined to all. */
mlim_status mlim_cell_emit_star(mlim_cell_work* work, size_t begin, double size);

/* Adds the curves inside the cell to the network: where three labels or more tie. */
mlim_status mlim_cell_trace(mlim_cell_work* work, const int32_t cell[3]);

#endif
