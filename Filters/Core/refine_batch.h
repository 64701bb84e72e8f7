/* Works the queue off, batch after batch: the facets get their points, some hundred at a time, while the duals that
   the points before have left are looked along. */
#ifndef mlim_refine_batch_h
#define mlim_refine_batch_h

#include "refine.h"

/* Afterwards all is recorded and judged. */
mlim_status mlim_batches_work(mlim_refinement* refinement, mlim_context* context);

#endif
