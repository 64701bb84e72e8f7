/* Connected components of the labels on the grid, 26-connected: what must not get lost. */
#ifndef mlim_components_h
#define mlim_components_h

#include "field.h"

typedef struct mlim_component
{
  int32_t label;
  size_t voxel_count;
  int32_t extremes[6][3]; /* a grid point that is least / most along x, y, z */
} mlim_component;

/* Grid points of one row that belong to a lesser component of their label. */
typedef struct mlim_component_run
{
  int32_t begin, end; /* x of the first point, and past the last */
  int32_t component;
} mlim_component_run;

/* Nearly all grid points are in the largest component of their label: only the others are listed. */
typedef struct mlim_components
{
  size_t count;
  mlim_component* components; /* in the order of their first grid points */
  int32_t* largest;           /* of each label; -1: it has no grid point */
  int32_t* rows;              /* first run of each row of grid points, and past the last */
  mlim_component_run* runs;   /* ascending in their row */
} mlim_components;

mlim_status mlim_components_find(
  const mlim_field* field, mlim_context* context, mlim_components* out);

/* The component of a grid point of the same field. */
int32_t mlim_components_at(
  const mlim_components* components, const mlim_field* field, const int32_t point[3]);

/* The grid points of each label. */
void mlim_components_count_voxels(
  const mlim_components* components, size_t label_count, size_t* voxels);

void mlim_components_free(mlim_components* components);

#endif
