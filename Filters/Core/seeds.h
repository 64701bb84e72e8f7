/* The first points on the interface, from the grid's own crossings: a few on every component of
   every label, so that a one-voxel island is found, and one on every sheet in every coarse block. */
#ifndef mlim_seeds_h
#define mlim_seeds_h

#include "complex.h"
#include "components.h"
#include "nearby.h"

/* On the components of at least min_voxels: their extreme points along the axes. With is_wanted
   (one byte a component) only on those. Returns through *count the number of points inserted. */
mlim_status mlim_seeds_on_components(mlim_complex* complex, const mlim_components* components,
  const unsigned char* is_wanted, size_t min_voxels, mlim_context* context, size_t* count);

/* One a sheet and block; none closer than `distance` to a vertex that is there. `done` is reported as
   the share of the surface's stage. */
mlim_status mlim_seeds_on_sheets(
  mlim_complex* complex, double distance, double done, mlim_context* context, size_t* count);

/* What seeds go in with: none closer than `distance` to a vertex. All 0 is a valid argument of _free. */
typedef struct mlim_seeds
{
  mlim_complex* complex; /* borrowed */
  double distance;
  mlim_nearby nearby;
} mlim_seeds;

mlim_status mlim_seeds_start(
  mlim_complex* complex, double distance, mlim_context* context, mlim_seeds* out);
void mlim_seeds_free(mlim_seeds* seeds);

/* One point on a crossing unless it is too close to a vertex; ++*count if inserted. */
mlim_status mlim_seeds_insert(
  mlim_seeds* seeds, const mlim_crossing* crossing, mlim_context* context, size_t* count);

#endif
