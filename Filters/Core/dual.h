/* The dual of a facet, copied out of the complex: it can be looked along while the triangulation changes.
   Dey, Janoos, Levine, section 3.2. */
#ifndef mlim_dual_h
#define mlim_dual_h

#include "complex.h"

typedef struct mlim_dual
{
  double ends[2][3]; /* power centres of the two cells */
  double vertex[3];  /* of the facet, any */
  float clearances[2];
  int32_t cells[2];
  int32_t labels[2];        /* of the cells */
  unsigned char indices[2]; /* of the facet in them */
  /* What mlim_duals_cross finds. */
  unsigned char crosses;
  unsigned char is_multiple; /* more often than the labels tell */
  mlim_sheet sheet;          /* crossed */
  double crossing[3];        /* there: the one farthest from the facet */
} mlim_dual;

/* Whether a facet's dual stays where the field is uniform, as most between cells of one label do. */
int mlim_dual_is_clear(const mlim_complex* complex, int32_t cell, int32_t other);

/* Of facet `index` of a cell. Both cells have labels. */
void mlim_dual_copy(const mlim_complex* complex, int32_t cell, int index, mlim_dual* out);

/* Looks along some. */
void mlim_duals_cross(const mlim_oracle* oracle, mlim_dual* duals, size_t count);

#endif
