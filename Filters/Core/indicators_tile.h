/* One tile of the indicators, made from the label map round it alone: the same values whatever the
   other tiles are. */
#ifndef mlim_indicators_tile_h
#define mlim_indicators_tile_h

#include "diffusion.h"
#include "indicators.h"
#include "kernel.h"

/* What is done to every label, and how far it reaches. */
typedef struct mlim_indicator_plan
{
  const mlim_label_map* map;
  mlim_indicator_options options;
  mlim_distance_cost cost;
  mlim_kernel kernels[3];
  mlim_diffusion diffusion;
  int32_t halo[3]; /* points round a tile that its values depend on */
  float floor, ceiling;
} mlim_indicator_plan;

/* Makes the lists and values of one tile. 0: out of memory; the tile can be freed all the same. */
int mlim_indicators_make_tile(const mlim_indicator_plan* plan, const mlim_indicators* indicators,
  const int32_t tile[3], mlim_tile* out);

#endif
