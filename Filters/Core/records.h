/* Labels of new cells and records of their facets. Insertions leave both undone; once a batch of them is
   through, all that is there is brought up to date: what came and went in between is never looked at, and
   what is left can be looked at in parallel.

   Looking along duals, the longest part, needs nothing of the complex but copies. It can be done beside the
   next batch of insertions, and its records come a batch later. Same records for any number of threads. */
#ifndef mlim_records_h
#define mlim_records_h

#include "dual.h"

enum
{
  MLIM_RECORD_PIECES = 128 /* between two looks at the host, about 5 ms */
};

/* Duals on their way. All 0 to begin with. */
typedef struct mlim_records
{
  mlim_dual* duals; /* room for all facets of a piece's cells, piece after piece */
  size_t dual_capacity;
  int32_t* stale; /* records that the new labels contradict, in the same way */
  size_t stale_capacity;
  size_t piece_count;
  uint16_t dual_counts[MLIM_RECORD_PIECES];
  uint16_t stale_counts[MLIM_RECORD_PIECES];
} mlim_records;

void mlim_records_free(mlim_records* records);

/* Labels the cells made since the last time and finds what is new about their facets: the records that do
   not hold any more go, and the duals to look along are copied. Nothing may be on its way. `done` is reported as
   the share of the surface's stage. */
mlim_status mlim_records_begin(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context);

/* Looks along one of `parts` equal parts of what is on its way. Parts may run at the same time, and beside
   insertions into the complex. */
void mlim_records_cross(
  mlim_records* records, const mlim_oracle* oracle, size_t part, size_t parts);

/* Records what was found, as far as its facets are still there; fresh lists the new records, too. All parts
   have been looked along. */
mlim_status mlim_records_end(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context);

/* What is on its way, to the end. */
mlim_status mlim_records_finish(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context);

/* All of it: what is on its way and what is new. */
mlim_status mlim_records_update(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context);

/* Whether a live record's crossing still lies on its dual, which insertions since the last time may have
   shortened. 0 also where that is not known before the next time. */
int mlim_records_hold(const mlim_complex* complex, const mlim_facet* facet);

#endif
