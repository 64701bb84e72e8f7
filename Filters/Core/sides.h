/* Whether a triangle of the mesh lies between the two labels that it separates. */
#ifndef mlim_sides_h
#define mlim_sides_h

#include "complex.h"

/* Looks from the middle of facet `index` of a cell along its normal, to both sides, at several lengths
   up to the reach: 1 if the labels are met, `inner` on the cell's side and `outer` on the other. */
int mlim_sides_are_seen(
  const mlim_complex* complex, int32_t cell, int index, int32_t inner, int32_t outer, double reach);

#endif
