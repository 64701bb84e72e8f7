/* The winner at every grid point: the label with the largest value there. */
#ifndef mlim_winners_h
#define mlim_winners_h

#include "peaks.h"

/* Reads all values, once unless there is a complement, and refuses those that are not finite. `winners`:
   the lowest of the labels that have the largest value at a grid point, with MLIM_TIED_FLAG if there are
   several. Also measures the samples, and finds the peaks of arrays; of indicators they stay empty. */
mlim_status mlim_winners_find(
  mlim_samples* samples, mlim_context* context, uint16_t* winners, mlim_peaks* peaks);

#endif
