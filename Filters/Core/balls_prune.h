/* Takes balls out of a cover. */
#ifndef mlim_balls_prune_h
#define mlim_balls_prune_h

#include "mlim.h"

/* The balls without the marked ones (one byte each). Neighbours of a ball that goes become each
   other's. A junction's ball may be marked too: its curves then end at their next balls. */
mlim_status mlim_balls_prune(
  const mlim_balls* balls, const unsigned char* is_marked, mlim_context* context, mlim_balls* out);

#endif
