/* How far the field is uniform round a cell or a brick: what lets walks skip empty space. */
#ifndef mlim_clearance_h
#define mlim_clearance_h

#include "field_index.h"

/* Fills the clearances into the words of cells and bricks. `distance`, one a cell: 0 in mixed cells,
   MAX_CLEARANCE in others; overwritten. */
mlim_status mlim_clearance_measure(mlim_field* field, uint8_t* distance, mlim_context* context);

#endif
