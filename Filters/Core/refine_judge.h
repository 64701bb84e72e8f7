/* Which restricted facets are bad by the refinement's goal, and how bad: they go into its queue. */
#ifndef mlim_refine_judge_h
#define mlim_refine_judge_h

#include "refine.h"

/* Of the records made last, or of all: those that were not judged since they were made or is_judged was
   taken back, and may be mended, are queued. */
mlim_status mlim_judge_fresh(mlim_refinement* refinement, mlim_context* context);
mlim_status mlim_judge_all(mlim_refinement* refinement, mlim_context* context);

/* The same for what is on its way: a part's duals are judged once they are looked along, beside insertions too,
   and queued once they have records. */
void mlim_judge_duals(const mlim_refinement* refinement, size_t part);
mlim_status mlim_judge_settled(mlim_refinement* refinement, mlim_context* context);

#endif
