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

typedef struct mlim_components
{
  size_t count;
  mlim_component* components; /* in the order of their first grid points */
  int32_t* of_point;          /* component of each grid point */
} mlim_components;

mlim_status mlim_components_find(
  const mlim_field* field, mlim_context* context, mlim_components* out);
void mlim_components_free(mlim_components* components);

#endif
