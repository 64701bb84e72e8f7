/* What is wrong with the facets between two labels, kept as labels change. Private to tidying. */
#ifndef mlim_tidy_looks_h
#define mlim_tidy_looks_h

#include "tidy.h"

enum
{
  TIDY_STRAYS = 15,  /* bit k: facet k has a vertex that is not on its sheet */
  TIDY_BAD_SHIFT = 4 /* bit 4 + k: its triangle is misshapen, or off its interface */
};

typedef struct tidy_looks
{
  mlim_refinement* refinement; /* borrowed */
  mlim_boundary* boundary;     /* borrowed, kept up to date */
  unsigned char* bits;         /* a byte a cell; for both cells of a facet */
} tidy_looks;

/* Before any label has changed. `done` is reported as the share of the certificate's stage. */
mlim_status tidy_looks_create(mlim_refinement* refinement, mlim_boundary* boundary, double done,
  mlim_context* context, tidy_looks* out);
void tidy_looks_free(tidy_looks* looks);

/* A cell has a new label. */
void tidy_looks_update(tidy_looks* looks, int32_t id);

#endif
