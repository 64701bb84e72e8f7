/* The last word on topology, where the data are finer than the smallest distance: sheets that come
   closer than vertices may, wedges that run out, specks. The labels of a few small cells there are
   changed so that vertices keep to their sheets and stars are disks. The mesh stays a labelled
   partition, so every region stays closed; vertices do not move. */
#ifndef mlim_tidy_h
#define mlim_tidy_h

#include "refine.h"

/* *count: cells whose label was changed. */
mlim_status mlim_tidy_run(mlim_refinement* refinement, mlim_context* context, size_t* count);

/* Facets between two labels of which a vertex is not on their sheet. */
size_t mlim_tidy_count_strays(const mlim_complex* complex);

#endif
