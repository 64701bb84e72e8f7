/* Sheets that bend within the protecting balls. Refinement puts no vertex there, so the triangles beside a
   curve are as large as its balls, and cut off what bends between the curve and the rim of the balls. */
#ifndef mlim_bends_h
#define mlim_bends_h

#include "field.h"
#include "status.h"

/* A copy of the balls, in which those are smaller that join an edge of a curve beside which a triangle
   would be farther than facet_distance from its sheet: as small as they can be and overlap. Where sheets
   come within twice the smallest distance of each other at the rim of the balls, these stay: they cover
   what could not be resolved. */
mlim_status mlim_bends_trim(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, mlim_context* context, mlim_balls* out);

#endif
