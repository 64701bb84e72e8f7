/* One mixed cell on its way into the field's index. Private to the files that build it. */
#ifndef mlim_field_cell_h
#define mlim_field_cell_h

#include "field_index.h"
#include "plateau.h"
#include "samples.h"

/* What the field is made from, once the winners at the grid points are known. */
typedef struct mlim_field_source
{
  const mlim_samples* samples;
  const mlim_field* field;
  const mlim_plateau* plateau;
} mlim_field_source;

/* Appends the candidates of the cell with the first corner `first` to the layer's pool; the result is
   the cell's word. Sets the layer's has_failed without memory, or if the pool is full. */
uint32_t mlim_field_add_mixed(
  const mlim_field_source* source, field_layer* layer, size_t first, const size_t corner[8]);

#endif
