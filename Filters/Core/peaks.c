#include "peaks.h"

#include "memory.h"
#include "status.h"

#include <math.h>
#include <string.h>

mlim_status mlim_peaks_create(const mlim_samples* samples, mlim_context* context, mlim_peaks* out)
{
  const mlim_grid* grid = samples->grid;
  *out = (mlim_peaks){ .samples = samples, .array_count = grid->array_count };
  size_t count = grid->array_count;
  for (int k = 0; k < 3; ++k)
  {
    out->blocks[k] = (grid->dims[k] + MLIM_PEAK_BLOCK - 1) / MLIM_PEAK_BLOCK;
    count *= (size_t)out->blocks[k];
  }
  out->values = mlim_allocate(count, sizeof *out->values);
  if (out->values == NULL)
  {
    *out = (mlim_peaks){ 0 };
    return mlim_fail_memory(context, "the largest values of the arrays");
  }
  for (size_t n = 0; n < count; ++n)
  {
    out->values[n] = -INFINITY;
  }
  return MLIM_OK;
}

void mlim_peaks_free(mlim_peaks* peaks)
{
  mlim_release(peaks->values);
  *peaks = (mlim_peaks){ 0 };
}

void mlim_peaks_raise(float* peak, double value)
{
  const float near = (float)value;
  const float above = (double)near < value ? nextafterf(near, INFINITY) : near;
  *peak = above > *peak ? above : *peak;
}

/* The blocks that hold the box. */
typedef struct block_set
{
  size_t count;
  const float* peaks[8];
} block_set;

/* Of a box that is no longer than a block along any axis. */
static void find_blocks(const mlim_peaks* peaks, const mlim_point_box* box, block_set* out)
{
  int32_t low[3];
  int32_t high[3];
  for (int k = 0; k < 3; ++k)
  {
    low[k] = box->first[k] / MLIM_PEAK_BLOCK;
    high[k] = box->last[k] / MLIM_PEAK_BLOCK;
  }
  out->count = 0;
  for (int32_t n = 0; n < 8; ++n)
  {
    const int32_t at[3] = { low[0] + (n & 1), low[1] + (n >> 1 & 1), low[2] + (n >> 2) };
    if (at[0] <= high[0] && at[1] <= high[1] && at[2] <= high[2])
    {
      out->peaks[out->count++] = mlim_peaks_of(peaks, at[0], at[1], at[2]);
    }
  }
}

size_t mlim_peaks_list(
  const mlim_peaks* peaks, const mlim_point_box* box, double floor, uint16_t* out)
{
  enum
  {
    CHUNK = 64
  };
  const mlim_samples* samples = peaks->samples;
  const int32_t rule = mlim_samples_rule_label(samples);
  block_set blocks;
  find_blocks(peaks, box, &blocks);
  size_t found = 0;
  if (rule == 0 && samples->first_array == 1)
  {
    out[found++] = 0;
  }
  for (size_t first = 0; first < peaks->array_count; first += CHUNK)
  {
    const size_t left = peaks->array_count - first;
    const size_t count = left < CHUNK ? left : CHUNK;
    float top[CHUNK];
    memcpy(top, blocks.peaks[0] + first, count * sizeof *top);
    for (size_t b = 1; b < blocks.count; ++b)
    {
      const float* peak = blocks.peaks[b] + first;
      for (size_t n = 0; n < count; ++n)
      {
        top[n] = peak[n] > top[n] ? peak[n] : top[n];
      }
    }
    for (size_t n = 0; n < count; ++n)
    {
      const int32_t label = (int32_t)(first + n) + samples->first_array;
      if ((double)top[n] >= floor || label == rule)
      {
        out[found++] = (uint16_t)label;
      }
    }
  }
  if (rule == samples->first_array + (int32_t)peaks->array_count)
  {
    out[found++] = (uint16_t)rule;
  }
  return found;
}
