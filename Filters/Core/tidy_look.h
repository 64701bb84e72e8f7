/* What is wrong with the facets between two labels, a byte for each cell. Private to tidy's files. */
#ifndef mlim_tidy_look_h
#define mlim_tidy_look_h

#include "boundary.h"
#include "refine.h"

enum
{
  TIDY_STRAYS = 15,  /* bit k: facet k has a vertex that is not on its sheet */
  TIDY_BAD_SHIFT = 4 /* bit 4 + k: its triangle is misshapen, or off its interface */
};

typedef struct tidy_looks
{
  const mlim_refinement* refinement;
  mlim_boundary* boundary; /* follows the labels and cells, as the looks do */
  unsigned char* bits;
} tidy_looks;

/* Afterwards the caller releases `bits`. `done` is reported as the share of the certificate's stage. */
mlim_status tidy_look_at_all(tidy_looks* looks, double done, mlim_context* context);

/* A cell, its label or that of a neighbour is new. */
void tidy_look_again(tidy_looks* looks, int32_t id);

/* The same after cells have come and gone, for the `count` cells where there is something new. */
mlim_status tidy_look_at_cells(
  tidy_looks* looks, const int32_t* cells, size_t count, mlim_context* context);

size_t tidy_count_looked_strays(const tidy_looks* looks);

#endif
