/* Covering one curve from end to end: where the centres stand and how large the balls are.

   Centres are 1.5 radii apart, so a radius is two thirds of the distance as in the paper; the length
   in units of that spacing is divided into equal parts. Dey, Janoos, Levine, section 3.4. */
#ifndef mlim_span_h
#define mlim_span_h

#include "status.h"

/* Largest radius at a length along the curve, > 0; grows by less than 1 per length. */
typedef double (*mlim_span_radius)(void* user, double arc);

typedef struct mlim_span
{
  double length;
  int is_closed;       /* no balls at the ends: the cover goes round */
  double end_radii[2]; /* of the balls at the ends, unless closed */
  size_t min_count;    /* balls between the ends, or in all if closed; at least 1 */
  size_t step_count;   /* of the integral; > 0 */
  mlim_span_radius radius;
  void* user; /* borrowed; handed to radius */
} mlim_span;

/* The balls between the ends, in order. All 0 is a valid start; reused from span to span. */
typedef struct mlim_span_cover
{
  size_t count;
  size_t arc_capacity;
  size_t radius_capacity;
  double* arcs;
  double* radii;
  double* sums;
  size_t sum_capacity;
} mlim_span_cover;

mlim_status mlim_span_cover_make(const mlim_span* span, mlim_span_cover* cover);
void mlim_span_cover_free(mlim_span_cover* cover);

#endif
