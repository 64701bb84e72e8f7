/* Pinches: vertices whose star no change of labels makes a disk, while all its regions come within
   twice the smallest distance of the vertex. They are contacts without a spot found before. */
#ifndef mlim_pinch_h
#define mlim_pinch_h

#include "refine.h"

/* Makes contacts of the pinches. *count: how many; if there are any, `out` are all balls, which take the
   place of the complex's: the caller lets complex.balls point to where it keeps them. *stray_count: as tidied,
   brought up to date. `done` is reported as the share of the certificate's stage. */
mlim_status mlim_pinch_run(mlim_refinement* refinement, double done, mlim_context* context,
  mlim_balls* out, size_t* count, size_t* stray_count);

#endif
