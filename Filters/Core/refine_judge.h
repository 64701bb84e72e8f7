/* Which restricted facets are bad by the refinement's goal, and how bad: they go into its queue. */
#ifndef mlim_refine_judge_h
#define mlim_refine_judge_h

#include "refine.h"

/* Of the records made last, or of all: those that were not judged since they were made or is_judged was
   taken back, and may be mended, are queued. */
mlim_status mlim_judge_fresh(mlim_refinement* refinement, mlim_context* context);
mlim_status mlim_judge_all(mlim_refinement* refinement, mlim_context* context);

#endif
