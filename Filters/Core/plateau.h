/* Ties: grid points at which two or more indicators share the largest value, as integer-valued data
   have them by the thousand, up to plateaus of whole cells. "The lowest index wins" would make specks
   of no volume at single points, and put the interface on voxel faces through a plateau. Instead each
   tied indicator gets a bonus from a smooth (discretely harmonic) continuation of the indicators
   round the tie. The bonus is scaled down so far that the interface does not move visibly where data
   decide; on a plateau its zero set is the interface. */
#ifndef mlim_plateau_h
#define mlim_plateau_h

#include "peaks.h"

/* A label that ties at a grid point; ascending by point and label. */
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

/* winners: label of each grid point, with MLIM_TIED_FLAG where several tie. The flags stay; the labels change to
   the new winners of plateaus. Of indicators the peaks are empty. */
mlim_status mlim_plateau_find(const mlim_samples* samples, const mlim_peaks* peaks,
  mlim_context* context, uint16_t* winners, mlim_plateau* out);
void mlim_plateau_free(mlim_plateau* plateau);

/* The bonus of a label at a grid point with MLIM_TIED_FLAG. */
double mlim_plateau_bonus(const mlim_plateau* plateau, size_t point, int32_t label);

#endif
