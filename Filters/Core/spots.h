/* Spots that refinement cannot resolve, not with partners across films either: ends of films, and regions
   that touch, below the smallest distance of two vertices. Each is covered by a contact: one ball, at
   which all its sheets meet. The paper has no such spots: it assumes that a ball can always be split. */
#ifndef mlim_spots_h
#define mlim_spots_h

#include "balls.h"
#include "refine.h"

/* The cover with contacts over the facets whose topology is wrong and cannot be mended. *count: how
   many; with none `out` is empty. */
mlim_status mlim_spots_cover(const mlim_refinement* refinement, const mlim_balls* balls,
  mlim_context* context, mlim_balls* out, size_t* count);

#endif
