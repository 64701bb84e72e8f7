/* Random indicator fields for tests, and the naive answer: an argmax over all arrays. */
#ifndef random_field_h
#define random_field_h

#include "mlim.h"

#include <stdint.h>

enum
{
  RANDOM_MAX_LABELS = 12,
  RANDOM_MAX_POINTS = 1000
};

typedef struct random_field
{
  int32_t dims[3];
  double spacing[3];
  int32_t label_count;
  float values[RANDOM_MAX_LABELS][RANDOM_MAX_POINTS];
  mlim_array arrays[RANDOM_MAX_LABELS];
  mlim_grid grid;
} random_field;

/* A fixed linear congruential sequence: tests must not differ from run to run. */
static inline double random_unit(uint64_t* state)
{
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

/* steps > 0: values on a lattice of that many steps, so that ties are common. */
static inline void random_field_make(
  random_field* f, int32_t labels, int32_t side, int steps, uint64_t seed)
{
  f->label_count = labels;
  for (int k = 0; k < 3; ++k)
  {
    f->dims[k] = side + k;
    f->spacing[k] = 0.5 + 0.25 * k;
  }
  const int count = f->dims[0] * f->dims[1] * f->dims[2];
  for (int32_t l = 0; l < labels; ++l)
  {
    for (int i = 0; i < count; ++i)
    {
      const double v = random_unit(&seed);
      f->values[l][i] = (float)(steps > 0 ? (int)(v * steps) : v);
    }
    f->arrays[l] = (mlim_array){
      .values = f->values[l], .type = MLIM_FLOAT32, .stride = 1, .id = l, .name = "random"
    };
  }
  f->grid = (mlim_grid){ .array_count = (size_t)labels,
    .arrays = f->arrays,
    .background = MLIM_BACKGROUND_ARRAY,
    .background_array = 0,
    .tie_breaking = MLIM_TIE_LOWEST_INDEX,
    .unseen = MLIM_UNSEEN_KEEP };
  for (int k = 0; k < 3; ++k)
  {
    f->grid.dims[k] = f->dims[k];
    f->grid.spacing[k] = f->spacing[k];
  }
}

/* The best label, and how far it is ahead of the second. */
static inline int32_t random_field_label(
  const random_field* f, const double point[3], double* margin)
{
  int32_t cell[3];
  double at[3];
  for (int k = 0; k < 3; ++k)
  {
    const double g = point[k] / f->spacing[k];
    if (!(g >= 0 && g <= f->dims[k] - 1))
    {
      *margin = 1;
      return 0;
    }
    cell[k] = (int32_t)g < f->dims[k] - 1 ? (int32_t)g : f->dims[k] - 2;
    at[k] = g - cell[k];
  }
  double best = -1e300;
  double second = -1e300;
  int32_t winner = 0;
  for (int32_t l = 0; l < f->label_count; ++l)
  {
    double sum = 0;
    for (int c = 0; c < 8; ++c)
    {
      const int x = cell[0] + (c & 1);
      const int y = cell[1] + (c >> 1 & 1);
      const int z = cell[2] + (c >> 2 & 1);
      const double weight =
        (c & 1 ? at[0] : 1 - at[0]) * (c & 2 ? at[1] : 1 - at[1]) * (c & 4 ? at[2] : 1 - at[2]);
      sum += weight * (double)f->values[l][x + f->dims[0] * (y + f->dims[1] * z)];
    }
    second = sum > best ? best : sum > second ? sum : second;
    winner = sum > best ? l : winner;
    best = sum > best ? sum : best;
  }
  *margin = best - second;
  return winner;
}

#endif
