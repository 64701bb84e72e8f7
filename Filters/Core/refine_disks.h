/* The disk condition of all vertices whose stars have changed. */
#ifndef mlim_refine_disks_h
#define mlim_refine_disks_h

#include "refine.h"

/* Afterwards no vertex is dirty, and is_broken is up to date. The farthest crossings of the stars that fail
   are queued. */
mlim_status mlim_disks_check(mlim_refinement* refinement, mlim_context* context);

/* The same without queueing anything. `done` is reported as the share of the certificate's stage. */
mlim_status mlim_disks_settle(mlim_refinement* refinement, double done, mlim_context* context);

#endif
