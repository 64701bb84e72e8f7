/* Takes balls out of a cover. */
#ifndef mlim_balls_prune_h
#define mlim_balls_prune_h

#include "mlim.h"

/* The balls without the marked ones (one byte each). Neighbours of a ball that goes become each
   other's. A junction's ball may be marked too: its curves then end at their next balls. */
mlim_status mlim_balls_prune(
  const mlim_balls* balls, const unsigned char* is_marked, mlim_context* context, mlim_balls* out);

/* Marks the balls whose centre is nearer in power to another one, and counts them: such a ball owns no
   part of space round its centre, and any point next to it could hide it. */
mlim_status mlim_balls_find_held(
  const mlim_balls* balls, mlim_context* context, unsigned char* is_marked, size_t* count);

#endif
