/* The last word on topology, where the data are finer than the smallest distance: sheets that come
   closer than vertices may, wedges that run out, specks. The labels of a few small cells there are
   changed so that vertices keep to their sheets and stars are disks. The mesh stays a labelled
   partition, so every region stays closed; vertices do not move. */
#ifndef mlim_tidy_h
#define mlim_tidy_h

#include "boundary.h"
#include "refine.h"

/* The boundary follows the labels. *count: cells whose label was changed; *stray_count: facets between two
   labels of which a vertex is not on their sheet, all the same. `done`, here and below, is reported as the
   share of the certificate's stage. */
mlim_status mlim_tidy_run(mlim_refinement* refinement, mlim_boundary* boundary, double done,
  mlim_context* context, size_t* count, size_t* stray_count);

/* That number again: once vertices have become others. */
mlim_status mlim_tidy_count_strays(const mlim_complex* complex, const mlim_boundary* boundary,
  double done, mlim_context* context, size_t* count);

#endif
