/* Labels of new cells and records of their facets. Insertions leave both undone; once a batch of them is
   through, all that is there is brought up to date: what came and went in between is never looked at, and
   what is left can be looked at in parallel. Same records for any number of threads. */
#ifndef mlim_records_h
#define mlim_records_h

#include "complex.h"

/* Labels the cells made since the last time, and records their facets. fresh lists the new records. `done` is
   reported as the share of the surface's stage. */
mlim_status mlim_records_update(mlim_complex* complex, double done, mlim_context* context);

/* Whether a live record's crossing still lies on its dual, which insertions since the last time may have
   shortened. 0 also where that is not known before the next time. */
int mlim_records_hold(const mlim_complex* complex, const mlim_facet* facet);

#endif
