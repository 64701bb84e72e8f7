/* Whether a triangle lies between the two labels that it separates. */
#ifndef mlim_sides_h
#define mlim_sides_h

#include "complex.h"

/* Looks from the middle of a triangle along its normal, of length 1, to both sides, at several lengths up to
   the reach: 1 if the labels are met, labels[1] on the normal's side and labels[0] on the other. */
int mlim_sides_are_seen_from(const mlim_field* field, const double middle[3],
  const double normal[3], const int32_t labels[2], double reach);

/* The same for facet `index` of a cell: `inner` on the cell's side and `outer` on the other. */
int mlim_sides_are_seen(
  const mlim_complex* complex, int32_t cell, int index, int32_t inner, int32_t outer, double reach);

#endif
