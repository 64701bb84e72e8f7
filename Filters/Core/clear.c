#include "clear.h"

#include "vector.h"

#include <math.h>

/* Part of the segment in which the boxes overlap at least, so that rounding leaves no gap between them. */
static const double OVERLAP = 1e-6;

/* Inside the grid a clearance of so many whole cells tells that all cells are uniform up to so many from the end's
   own one, along each axis. Of the rest, which is not 0 but where the end is well inside without it, nothing is
   used: the box reaches to the sides of cells, along the segment often much farther than the cube. */
int mlim_clear_between(
  const mlim_field* field, const double* const ends[2], const uint16_t clearances[2])
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  const int32_t reach[2] = { clearances[0] / MLIM_CLEARANCE_PARTS,
    clearances[1] / MLIM_CLEARANCE_PARTS };
  double parts[2] = { INFINITY, INFINITY };
  int is_inside = (clearances[0] > 0) & (clearances[1] > 0);
  for (int k = 0; k < 3 && is_inside; ++k)
  {
    const double from = ends[0][k] * grid->inverse_spacing[k];
    const double to = ends[1][k] * grid->inverse_spacing[k];
    is_inside = (from >= 0) & (to >= 0) & (from < grid->cells[k]) & (to < grid->cells[k]);
    if (is_inside)
    {
      const int is_back = to < from;
      const int32_t leave = (int32_t)from + (is_back ? -reach[0] : 1 + reach[0]);
      const int32_t enter = (int32_t)to + (is_back ? 1 + reach[1] : -reach[1]);
      const double inverse = 1 / (to - from);
      parts[0] = mlim_min((leave - from) * inverse, parts[0]);
      parts[1] = mlim_min((to - enter) * inverse, parts[1]);
    }
  }
  return is_inside && parts[0] + parts[1] >= 1 + OVERLAP;
}
