/* The decisions of the triangulation, in exact arithmetic. A weighted point is its coordinates and its
   weight. */
#ifndef mlim_predicates_h
#define mlim_predicates_h

#include "mlim.h"

/* *out: 1, 0, -1 as d is on the positive side of the plane through a, b, c, in it, or on the negative one;
   that is, the tetrahedron is positively oriented, flat, negatively. */
mlim_status mlim_predicates_orientation(const double a[3], const double b[3], const double c[3],
  const double d[3], mlim_context* context, int* out);

/* *out: 1 when a weighted point is in conflict with a positively oriented cell, that is, inside its power
   sphere, and 0 when it is outside or on it. */
mlim_status mlim_predicates_conflict(
  const double* const cell[4], const double point[4], mlim_context* context, int* out);

/* The power centre (weighted circumcentre) of a cell that is not flat, each coordinate right to a few
   units in its last place. */
mlim_status mlim_predicates_center(
  const double* const cell[4], mlim_context* context, double out[3]);

#endif
