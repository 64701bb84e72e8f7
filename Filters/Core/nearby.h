/* A vertex near any place: where a search may start, and often one that is too close. */
#ifndef mlim_nearby_h
#define mlim_nearby_h

#include "complex.h"

/* One vertex a block of the box. All 0 is a valid argument of _free. */
typedef struct mlim_nearby
{
  double inverse_side[3];
  int32_t counts[3];
  int32_t* vertices; /* -1: none is known */
} mlim_nearby;

/* From the vertices of a complex, the last one of each block. Blocks have about the side wanted, larger ones
   where they would be many more than vertices. */
mlim_status mlim_nearby_create(
  const mlim_complex* complex, double side, mlim_context* context, mlim_nearby* out);
void mlim_nearby_free(mlim_nearby* nearby);

/* The vertex of the block of a point in the box; the caller may put in another one. */
int32_t* mlim_nearby_at(const mlim_nearby* nearby, const double point[3]);

#endif
