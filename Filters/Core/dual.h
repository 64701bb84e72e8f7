/* The dual of a facet, copied out of the complex: it can be looked along while the triangulation changes.
   Dey, Janoos, Levine, section 3.2. */
#ifndef mlim_dual_h
#define mlim_dual_h

#include "complex.h"

typedef struct mlim_dual
{
  double ends[2][3]; /* power centres of the two cells */
  float clearances[2];
  int32_t cells[2];
  int32_t labels[2];     /* of the cells */
  int32_t vertices[3];   /* of the facet, in the order of mlim_complex_facet_vertices */
  int32_t stale;         /* record that the labels contradict; 0: none */
  unsigned char index;   /* of the facet in the first cell */
  unsigned char is_open; /* there may be a crossing that is not known */
  /* What mlim_duals_cross finds. */
  unsigned char crosses;
  unsigned char is_multiple; /* more often than the labels tell */
  signed char bin;           /* the user's own, like the next */
  unsigned char is_good;
  mlim_sheet sheet;   /* crossed */
  int32_t record;     /* of the facet, once it is made; 0: none */
  double crossing[3]; /* the one farthest from the facet */
} mlim_dual;

/* Looks along those that are open. */
void mlim_duals_cross(
  const mlim_oracle* oracle, const mlim_vertex* vertices, mlim_dual* duals, size_t count);

#endif
