/* Volumes of the labels: of the interpolated indicators, and of the complex. */
#ifndef mlim_volumes_h
#define mlim_volumes_h

#include "complex.h"

/* Per label: the part of the box where it wins, from the middles of the eighths of each mixed cell. The
   outside's counts what is in the box. */
mlim_status mlim_volumes_of_field(const mlim_field* field, mlim_context* context, double* volumes);

/* Per label: the cells that have it. Those with a far vertex do not count, nor those of labels that are not
   wanted (a byte a label). `done` is reported as the share of the surface's stage. */
mlim_status mlim_volumes_of_complex(const mlim_complex* complex, const unsigned char* is_wanted,
  double done, mlim_context* context, double* volumes);

#endif
