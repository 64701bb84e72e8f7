/* How far the field is uniform round a cell: what lets walks skip empty space. */
#ifndef mlim_clearance_h
#define mlim_clearance_h

#include "field_index.h"

/* Measures the field's clearances, which are 0 in mixed cells and MAX_CLEARANCE in others, row after row; orders
   them by bricks. */
mlim_status mlim_clearance_measure(mlim_field* field, mlim_context* context);

#endif
