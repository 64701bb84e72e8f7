/* What is known of the surface before a triangulation is made anew with other balls. */
#ifndef mlim_known_h
#define mlim_known_h

#include "complex.h"

/* Points on sheets, and the progress that was reported, below which it does not fall. */
typedef struct mlim_known
{
  double progress;
  size_t count;
  double* points; /* 3 each */
  mlim_sheet* sheets;
} mlim_known;

/* The surface vertices of a complex that may stay with these balls: outside all of them and not in the
   neighbourhood of a contact, which is sampled anew. */
mlim_status mlim_known_keep(const mlim_complex* complex, const mlim_balls* balls, double progress,
  mlim_context* context, mlim_known* out);
void mlim_known_free(mlim_known* known);

#endif
