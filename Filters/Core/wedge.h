/* Thin regions of two kinds. In a film the two sheets run beside each other; in a wedge they run together
   in an edge, with the regions beyond them face to face behind it, as at a curve where three regions
   meet. A film can do with fewer vertices where it is flat; a wedge needs them to keep its angle. */
#ifndef mlim_wedge_h
#define mlim_wedge_h

#include "complex.h"

/* Whether a thin region is a sharp wedge at a pair of vertices, one straight across from the other on the
   region's two sheets: the planes of the sheets meet at 15 degrees at most where the region ends, and
   half-way there it is half as thick. */
int mlim_wedge_is_at(
  const mlim_oracle* oracle, const mlim_vertex* vertex, const mlim_vertex* partner);

#endif
