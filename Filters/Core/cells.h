/* Refinement of the cells inside the regions, once the interfaces stand: the power centres of cells
   that are too large or badly shaped are inserted, as long as no facet between two labels dies. Dey,
   Janoos, Levine, section 5. The new cells of a zone have the zone's one label. */
#ifndef mlim_cells_h
#define mlim_cells_h

#include "complex.h"

typedef struct mlim_cells_result
{
  size_t insertion_count;
  size_t unresolved_size_count;  /* cells above their size that no point could mend */
  size_t unresolved_ratio_count; /* cells above the radius-edge ratio, without a ball vertex */
  size_t unresolved_box_count;   /* cells of the background that reach out of the box */
} mlim_cells_result;

/* Refines the complex, whose records of facets are void afterwards. `done` is the share of the
   volume's stage that is over when this is. MLIM_VERTEX_LIMIT: stopped early, all is valid. */
mlim_status mlim_cells_refine(mlim_complex* complex, const mlim_options* options, double done,
  mlim_context* context, mlim_cells_result* out);

/* Whether a cell belongs to the volume: of a region, or of the background if that is kept, and
   without a far vertex. */
int mlim_cells_is_inside(
  const mlim_complex* complex, const mlim_options* options, const mlim_cell* cell);

#endif
