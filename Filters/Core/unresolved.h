/* What refinement had to leave as it is: facets that still fail a criterion. */
#ifndef mlim_unresolved_h
#define mlim_unresolved_h

#include "criteria.h"

/* Fills the counts of crossings, sizes, distances and ratios of the report. `done` is reported as the
   share of the certificate's stage. */
mlim_status mlim_unresolved_count(const mlim_complex* complex, const mlim_options* options,
  double done, mlim_context* context, mlim_report* out);

#endif
