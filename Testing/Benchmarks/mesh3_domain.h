/* A field of ours as Mesh_3 takes it. */
#ifndef mlim_mesh3_domain_h
#define mlim_mesh3_domain_h

#include "mesh3.h"

#include "mlim.h"

/** First points are on the border of each component of `minVoxels` grid points at least. Borrows the
    field; `curves` may be NULL. */
bench_mesh3_domain bench_mesh3_domain_of(
  const mlim_field* field, const mlim_curves* curves, size_t minVoxels);

#endif
