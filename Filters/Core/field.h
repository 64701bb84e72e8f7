/* The indicator field: an index over the grid's cells that answers "which label here?" and hands
   the interpolation of a cell to those who look inside it. Dey, Janoos, Levine, section 3.1.

   A cell is uniform (one label wins everywhere in it) or mixed. A mixed cell lists its candidates:
   the labels that no single other label beats at all 8 corners. Ties are resolved as if label l had
   an infinitesimal bonus that falls with l, everywhere in the core, so "beats" is a total order at
   every grid point, and two cells that share a face agree on the labels that can win on it. */
#ifndef mlim_field_h
#define mlim_field_h

#include "mlim.h"

/* The candidates of a mixed cell. Corner c of the cell (i, j, k) is the grid point
   (i + (c & 1), j + (c >> 1 & 1), k + (c >> 2 & 1)). Values are indicators minus the best one at
   the grid point, scaled by one power of two for the whole field: at most 0, 0 for the best. A
   grid point has the same values in all cells that list the label. */
typedef struct mlim_candidates
{
  int32_t count;          /* 1: uniform; values is NULL then */
  const uint16_t* labels; /* borrowed; ascending */
  const float* values;    /* borrowed; 8 per label, in the order of labels */
} mlim_candidates;

typedef struct mlim_field_grid
{
  int32_t dims[3];  /* points */
  int32_t cells[3]; /* dims - 1 */
  double spacing[3];
  double inverse_spacing[3];
  double size[3]; /* the box is [0, size] */
  double unit;    /* cube root of the voxel's volume: what "spacing" means as a length */
  double min_spacing;
} mlim_field_grid;

const mlim_field_grid* mlim_field_grid_of(const mlim_field* field);

/* Candidates of a cell. Buffers are the caller's, as large as the field's largest count. */
size_t mlim_field_max_candidates(const mlim_field* field);
typedef struct mlim_cell_buffer
{
  uint16_t* labels; /* max_candidates */
  float* values;    /* 8 * max_candidates */
} mlim_cell_buffer;
mlim_candidates mlim_field_cell(
  const mlim_field* field, const int32_t cell[3], const mlim_cell_buffer* buffer);

/* The first cell of a row along x, from one on, with three candidates or more: its place along x; as many as
   there are cells when there is none. */
int32_t mlim_field_find_many(const mlim_field* field, const int32_t from[3]);

/* Label of a grid point (the best one there), and the labels of all of them, x fastest; borrowed. */
int32_t mlim_field_point_label(const mlim_field* field, const int32_t point[3]);
const uint16_t* mlim_field_point_labels(const mlim_field* field);

/* mlim_field_label of some points, 3 numbers each, which wait for memory together. */
void mlim_field_labels(
  const mlim_field* field, const double* points, size_t count, int32_t* labels);

/* What there is at a point: mlim_field_label, and half the side, in cells, of a cube round the point all of
   which has this label; 0 in a mixed cell. */
typedef struct mlim_field_look
{
  const double* point; /* in; borrowed */
  int32_t label;
  float clearance;
} mlim_field_look;

/* Looks at many points, which is faster than one after the other: the time goes into waiting for memory,
   and they wait for it together. */
void mlim_field_look_at(const mlim_field* field, mlim_field_look* looks, size_t count);

/* Asks for what there is at a point before it is looked at: first for where it is, some looks later for it.
   Nothing changes but the time. */
void mlim_field_ahead(const mlim_field* field, const double point[3], int is_second);

/* The direction, of length 1, in which the first of two labels gains most on the second at a point. 0: there
   is none, or the point's cell does not list both. */
int mlim_field_normal(
  const mlim_field* field, const double point[3], int32_t first, int32_t second, double out[3]);

#endif
