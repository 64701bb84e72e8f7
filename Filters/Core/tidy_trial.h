/* What tidying changes is on trial. Where other labels lay triangles above the radius-edge bound open, they are
   taken back, and a crossing that was too near to other vertices for refinement goes in after all: what was
   tidied there is gone then. It costs a vertex or two for each, where to be so near at all places like these
   would cost a percent of all and better nothing. Private to tidy's files. */
#ifndef mlim_tidy_trial_h
#define mlim_tidy_trial_h

#include "refine.h"

typedef struct tidy_change
{
  int32_t cell;
  int32_t before, after; /* its labels */
} tidy_change;

/* All 0 to begin with. */
typedef struct tidy_trial
{
  tidy_change* changes; /* in their order; a cell may have several */
  size_t change_count, change_capacity;
  int32_t* records; /* whose crossings are asked for */
  size_t record_count, record_capacity;
  int32_t* cells; /* with a vertex of a cell that refinement has made, ascending */
  size_t cell_count, cell_capacity;
  unsigned char* is_near; /* a vertex: of one of these */
  int is_limited;         /* the vertex limit is reached */
} tidy_trial;

void tidy_trial_free(tidy_trial* trial);

/* Notes that a cell's label was changed. Returns 1 when out of memory. */
int tidy_trial_note(tidy_trial* trial, int32_t cell, int32_t before, int32_t after);

/* Asks for a crossing in place of the changes that lay facet `index` of a cell open, if there is one with
   room. Returns 1 when out of memory. */
int tidy_trial_ask(tidy_trial* trial, const mlim_refinement* refinement, int32_t cell, int index);

/* Takes all changes back, refines with what was asked for, and makes the changes again but for the cells
   listed then, whose facets have to be looked at anew. *is_refined 0: all is as it was. `done` is reported
   as the share of the certificate's stage. */
mlim_status tidy_trial_refine(tidy_trial* trial, mlim_refinement* refinement, double done,
  mlim_context* context, int* is_refined);

#endif
