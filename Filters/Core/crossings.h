/* The crossings of the grid's own edges: where neighbouring grid points differ in label. They are
   what a mesh has to come near, however coarse it is. */
#ifndef mlim_crossings_h
#define mlim_crossings_h

#include "oracle.h"

typedef struct mlim_grid_crossing
{
  mlim_crossing crossing;
  int32_t low[3]; /* the edge's grid points */
  int32_t high[3];
} mlim_grid_crossing;

/* Called for a few crossings at a time: what they look for in memory they can wait for together. */
typedef void (*mlim_crossings_visit)(void* user, const mlim_grid_crossing* crossings, size_t count);

/* The crossings on edges that start in slice z of grid points, in a fixed order. */
void mlim_crossings_of_slice(
  const mlim_oracle* oracle, int32_t z, mlim_crossings_visit visit, void* user);

#endif
