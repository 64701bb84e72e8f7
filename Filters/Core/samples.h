/* The caller's arrays as doubles: every scalar type, and the labels that exist only by rule
   (constant and complement background, blanked points). Read-only and borrowed. */
#ifndef mlim_samples_h
#define mlim_samples_h

#include "mlim.h"

typedef struct mlim_samples
{
  const mlim_grid* grid;
  int32_t label_count;
  int32_t outside_label;
  int32_t first_array; /* label of arrays[0]: 1 with an extra background label, else 0 */
  double total;        /* with a complement: the largest sum of the arrays */
  double scale;        /* power of two that brings all values below 1 */
  double range;        /* largest minus smallest value */
} mlim_samples;

/* What one reading of all values finds. */
typedef struct mlim_sample_range
{
  double min, max;
  double max_sum; /* of all arrays at one point; only with a complement */
} mlim_sample_range;

/* Checks all but the values. With indicators everything is known then; else what depends on the values
   waits for mlim_samples_measure. */
mlim_status mlim_samples_open(const mlim_grid* grid, mlim_context* context, mlim_samples* out);
void mlim_samples_measure(mlim_samples* samples, const mlim_sample_range* range);

/* MLIM_INVALID_ARGUMENT: how many values are not finite, in which array, and where the first is; MLIM_OK
   if all are. */
mlim_status mlim_samples_check(const mlim_samples* samples, mlim_context* context);

/* The label whose values are not, or not everywhere, those of an array: a constant's, a complement's, or
   the outside's of blanked points. -1: there is none. */
int32_t mlim_samples_rule_label(const mlim_samples* samples);

/* Values of a label at `count` points from grid point index `first` on, along x. */
void mlim_samples_row(
  const mlim_samples* samples, int32_t label, size_t first, size_t count, double* out);

/* The value of a label at one grid point. */
static inline double mlim_samples_value(const mlim_samples* samples, int32_t label, size_t point)
{
  double value;
  mlim_samples_row(samples, label, point, 1, &value);
  return value;
}

/* Of indicators: how many points from x on along a row have the same list. */
size_t mlim_samples_run(const mlim_samples* samples, size_t x);

/* Of indicators: ascending labels among which is every one that can be the largest, or the second, in a
   cell that has the `count` grid points for corners; `out` has room for label_count + 1. */
size_t mlim_samples_list(
  const mlim_samples* samples, const size_t* points, size_t count, uint16_t* out);

/* Values of a label at the 8 corners of the cell whose first point has index `first`. */
void mlim_samples_corners(const mlim_samples* samples, int32_t label, size_t first, double out[8]);

/* The name of an array for messages. */
void mlim_array_name(const mlim_grid* grid, size_t array, char out[64]);

#endif
