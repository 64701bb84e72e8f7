/* The crossings of the grid's own edges: where neighbouring grid points differ in label. They are
   what a mesh has to come near, however coarse it is. */
#ifndef mlim_crossings_h
#define mlim_crossings_h

#include "oracle.h"

/* Called for each crossing of an edge between two grid points. */
typedef void (*mlim_crossing_visit)(
  void* user, const int32_t low[3], const int32_t high[3], const mlim_crossing* crossing);

/* The crossings on edges that start in slice z of grid points, in a fixed order. */
void mlim_crossings_of_slice(
  const mlim_oracle* oracle, int32_t z, mlim_crossing_visit visit, void* user);

#endif
