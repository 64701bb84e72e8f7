/* Volumes of the regions that indicators make, and the constants that correct them. */
#ifndef mlim_indicators_volume_h
#define mlim_indicators_volume_h

#include "indicators.h"

/* Adds to each label a constant of at most `most`, the same everywhere above the floor, such that its
   region's volume comes close to its voxels'. Then finds out which labels win somewhere, with
   progress from `from` to `to`. most may be 0. */
mlim_status mlim_indicators_settle(
  mlim_indicators* indicators, double most, double from, double to, mlim_context* context);

#endif
