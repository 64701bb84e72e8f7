/* The bonuses of tied labels before they are scaled. Private to the files of plateaus. */
#ifndef mlim_plateau_smooth_h
#define mlim_plateau_smooth_h

#include "plateau.h"

/* Of the field's stage, while there are plateaus to be found. */
static const double MLIM_PLATEAU_PROGRESS = 0.4;

/* Gives each tie the mean of its six neighbours: the same label's bonus where it is tied too, else its value
   relative to the largest one there. */
mlim_status mlim_plateau_smooth(const mlim_samples* samples, mlim_context* context,
  const uint16_t* winners, mlim_plateau* plateau);

#endif
