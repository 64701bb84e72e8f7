/* The lists of a tile's bricks under construction. Entries come label by label; they go brick by
   brick, with room for no more than there is. */
#ifndef mlim_indicators_brick_h
#define mlim_indicators_brick_h

#include "indicators.h"

typedef struct mlim_brick_writer
{
  mlim_tile* out;
  mlim_brick_entry* entries; /* the writer's, to be released */
  size_t entry_count, entry_capacity;
  size_t value_capacity;
} mlim_brick_writer;

/* Adds a label to a brick of the tile: MLIM_BRICK_POINTS values, or one for all. 0: out of memory. */
int mlim_brick_add(
  mlim_brick_writer* writer, uint16_t label, size_t brick, const float* values, int is_uniform);

/* After the last one. 0: out of memory. */
int mlim_brick_finish(mlim_brick_writer* writer);

/* Gives a label the lead over the others at a point of a finished brick, if it has less and values of
   its own there. */
void mlim_brick_lead(mlim_tile* tile, size_t brick, size_t slot, uint16_t label, float lead);

#endif
