/* Whether a dual stays where the field is uniform: most between two cells of one label do, and need not be looked
   along. */
#ifndef mlim_clear_h
#define mlim_clear_h

#include "delaunay.h"
#include "field.h"

/* Whether two boxes of the grid's cells that are uniform with one label, round the ends of a segment, cover it
   together. The ends have this label, and the clearances that cells have. 0 does not say that there is a
   crossing. */
int mlim_clear_between(
  const mlim_field* field, const double* const ends[2], const uint16_t clearances[2]);

#endif
