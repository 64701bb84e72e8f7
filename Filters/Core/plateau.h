/* Plateaus: whole cells in which two or more indicators tie for the largest value, as integer-valued
   data have them. "The lowest index wins" would put the interface on voxel faces there. Instead each
   tied indicator gets a small bonus from a smooth (discretely harmonic) continuation of the
   indicators round the plateau, so the interface runs smoothly through it. Nothing changes where no
   cell is a plateau, and the bonus is far below the differences round one. */
#ifndef mlim_plateau_h
#define mlim_plateau_h

#include "samples.h"

/* The tied labels of one grid point on a plateau; ascending by point and label. */
typedef struct mlim_tied
{
  size_t point;
  int32_t label;
  double bonus; /* at most 0; added to the label's value */
} mlim_tied;

typedef struct mlim_plateau
{
  size_t count;
  mlim_tied* tied;
} mlim_plateau;

enum
{
  MLIM_TIED_FLAG = 0x8000 /* on a winner: another label has the same value there */
};

/* winners: label of each grid point, with MLIM_TIED_FLAG where several tie. Clears the flags and
   names the new winners of plateaus. */
mlim_status mlim_plateau_find(
  const mlim_samples* samples, mlim_context* context, uint16_t* winners, mlim_plateau* out);
void mlim_plateau_free(mlim_plateau* plateau);

/* Adds the bonuses to a label's values at the corners of the cell with that first point. */
void mlim_plateau_correct(
  const mlim_plateau* plateau, const mlim_grid* grid, int32_t label, size_t first, double out[8]);

#endif
