/* The last word on topology, where the data are finer than the smallest distance: sheets that come
   closer than vertices may, wedges that run out, specks. The labels of a few small cells there are
   changed so that vertices keep to their sheets and stars are disks. The mesh stays a labelled
   partition, so every region stays closed; vertices do not move. Where that would lay misshapen triangles open,
   a few vertices are inserted first. */
#ifndef mlim_tidy_h
#define mlim_tidy_h

#include "boundary.h"
#include "refine.h"

typedef struct mlim_tidied
{
  size_t change_count; /* of cells' labels */
  size_t
    stray_count; /* facets between two labels of which a vertex is not on their sheet, all the same */
  int is_limited; /* the vertex limit kept it from inserting what it wanted */
} mlim_tidied;

/* For a refinement that is done, or was stopped by the vertex limit. The boundary follows the labels and cells.
   `done`, here and below, is reported as the share of the certificate's stage. */
mlim_status mlim_tidy_run(mlim_refinement* refinement, mlim_boundary* boundary, double done,
  mlim_context* context, mlim_tidied* out);

/* Whether a facet, if it is between two labels, is a stray. */
int mlim_tidy_is_stray(const mlim_complex* complex, int32_t cell, int index);

#endif
