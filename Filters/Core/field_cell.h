/* One mixed cell on its way into the field's index. Private to the files that build it. */
#ifndef mlim_field_cell_h
#define mlim_field_cell_h

#include "field_brick.h"
#include "field_index.h"

/* A mixed cell: its first corner's index among the grid points, the offsets of the others, and its place
   in its brick. */
typedef struct mlim_field_place
{
  size_t first;
  const size_t* corner; /* borrowed; 8 */
  uint32_t slot;
} mlim_field_place;

/* Appends the candidates of the cell to the layer's pool; the result is the cell's word. `brick` holds the
   values of its brick; of indicators, it is not read. Sets the layer's has_failed without memory, or if the
   pool is full. */
uint32_t mlim_field_add_mixed(const mlim_field_source* source, const mlim_field_brick* brick,
  field_layer* layer, const mlim_field_place* place);

#endif
