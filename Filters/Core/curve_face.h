/* Where labels tie on a square of the grid (three or more) and on an edge of it (two).

   The indicators are bilinear on a square and linear on an edge, so both are closed forms. What is
   found depends on the corner values only, never on who asks: the two cells of a face find the same
   points, bit for bit. Dey, Janoos, Levine, section 3.2, on the true tie of the interpolants. */
#ifndef mlim_curve_face_h
#define mlim_curve_face_h

#include "label_sets.h"

/* Points closer than this, in units of a cell, are one point. It is far above the rounding of the
   roots and the shift by the bonus (about 1e-9), far below anything a mesh can show. */
#define MLIM_WELD_DISTANCE 1e-6

/* Labels and their values at the corners; borrowed. */
typedef struct mlim_corners
{
  size_t count;
  const int32_t* labels; /* ascending */
  const double* values;  /* 2 or 4 per label, x fastest */
} mlim_corners;

typedef struct mlim_face_point
{
  double at[2]; /* in the unit square */
  int32_t set;
} mlim_face_point;

typedef struct mlim_edge_point
{
  double at; /* in [0, 1] */
  int32_t before;
  int32_t after;
} mlim_edge_point;

/* What is found, and room to work in. All 0 is a valid start. */
typedef struct mlim_face_work
{
  mlim_face_point* points;
  size_t point_count;
  size_t point_capacity;
  mlim_edge_point* edge_points;
  size_t edge_point_count;
  size_t edge_point_capacity;
  int32_t first_label; /* winner at the start of the edge */
  int32_t* labels;
  size_t label_capacity;
  double* values;
  size_t value_capacity;
} mlim_face_work;

void mlim_face_work_free(mlim_face_work* work);

/* Finds the points of the unit square where three or more labels tie and no other is above. */
mlim_status mlim_face_find(const mlim_corners* square, mlim_set_table* sets, mlim_face_work* work);

/* Finds where the winner changes along the unit edge, ascending. */
mlim_status mlim_edge_find(const mlim_corners* edge, mlim_face_work* work);

#endif
