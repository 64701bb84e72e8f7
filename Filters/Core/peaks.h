/* The largest value of each array in every block of 8 x 8 x 8 grid points. Who looks for the labels
   that matter somewhere need not read the others there: a number a block and array, 512 times fewer than
   the values. */
#ifndef mlim_peaks_h
#define mlim_peaks_h

#include "samples.h"

enum
{
  MLIM_PEAK_BLOCK = 8 /* grid points along a block's side */
};

typedef struct mlim_peaks
{
  const mlim_samples* samples; /* borrowed */
  size_t array_count;
  int32_t blocks[3];
  float* values; /* the arrays of a block side by side; blocks x fastest; rounded up */
} mlim_peaks;

/* All peaks below every value. */
mlim_status mlim_peaks_create(const mlim_samples* samples, mlim_context* context, mlim_peaks* out);
void mlim_peaks_free(mlim_peaks* peaks);

/* The arrays' peaks of a block. */
static inline float* mlim_peaks_of(const mlim_peaks* peaks, int32_t x, int32_t y, int32_t z)
{
  const size_t row = (size_t)y + (size_t)peaks->blocks[1] * (size_t)z;
  return peaks->values + ((size_t)x + (size_t)peaks->blocks[0] * row) * peaks->array_count;
}

/* Raises a peak to a value at least. */
void mlim_peaks_raise(float* peak, double value);

/* Grid points `first` to `last` along each axis, both among them. */
typedef struct mlim_point_box
{
  int32_t first[3], last[3];
} mlim_point_box;

/* Ascending labels among which are all that have a value of `floor` or more in the box, and the one that
   does not come from an array alone (mlim_samples_rule_label); `out` has room for label_count + 1. */
size_t mlim_peaks_list(
  const mlim_peaks* peaks, const mlim_point_box* box, double floor, uint16_t* out);

#endif
