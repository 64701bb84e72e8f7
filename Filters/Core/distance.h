/* Distances in a block of grid points, to the boundary of voxels: a grid point stands for the box of
   one spacing round it. */
#ifndef mlim_distance_h
#define mlim_distance_h

#include <stddef.h>
#include <stdint.h>

enum
{
  MLIM_MAX_RADIUS = 64 /* of one filter along one axis, in grid points */
};

/* What a step of k points along each axis costs: the squared distance from a point to the nearest
   face of the box k steps away. */
typedef struct mlim_distance_cost
{
  int32_t radius[3];
  float squared[3][MLIM_MAX_RADIUS + 1];
  float band; /* distances are cut off there */
} mlim_distance_cost;

/* 0: the band reaches farther than MLIM_MAX_RADIUS points along some axis. */
int mlim_distance_cost_of(const double spacing[3], double band, mlim_distance_cost* out);

/* Distance of each point outside the mask to the nearest box of the mask, of each point inside to the
   nearest box outside; positive inside, within [-band, band]. Where the block ends the world ends.
   out, scratch: as large as the block; 2 scratch blocks, one after the other. */
void mlim_distance_signed(const mlim_distance_cost* cost, const int32_t size[3],
  const unsigned char* mask, float* scratch, float* out);

#endif
