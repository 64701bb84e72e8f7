#include "samples.h"

#include "indicators.h"
#include "memory.h"
#include "scalars.h"
#include "status.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* Blanked points belong to the outside: its label gets a value above every other one there, and
   below every other one elsewhere, so the interface runs half-way between. */
static double blank_value(const mlim_samples* samples, size_t point)
{
  const double reach = samples->range > 0 ? samples->range : 1;
  return samples->grid->is_outside[point] ? 2 * reach : -2 * reach;
}

static const mlim_array* array_of(const mlim_samples* samples, int32_t label)
{
  const int32_t k = label - samples->first_array;
  return k >= 0 && (size_t)k < samples->grid->array_count ? &samples->grid->arrays[k] : NULL;
}

/* A label without an array: constant or complement background, or the outside of blanked points.
   One row, by adding up all arrays when it is a complement. */
static void rule_row(const mlim_samples* samples, size_t first, size_t count, double* out)
{
  const mlim_grid* grid = samples->grid;
  const double value_here = grid->background == MLIM_BACKGROUND_CONSTANT ? grid->background_value
                            : grid->background == MLIM_BACKGROUND_COMPLEMENT
                              ? samples->total
                              : -2 * samples->range - 1;
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = value_here;
  }
  if (grid->background == MLIM_BACKGROUND_COMPLEMENT)
  {
    double value[64];
    for (size_t a = 0; a < grid->array_count; ++a)
    {
      for (size_t i = 0; i < count; i += 64)
      {
        const size_t n = count - i < 64 ? count - i : 64;
        mlim_scalars_read(&grid->arrays[a], first + i, n, value);
        for (size_t k = 0; k < n; ++k)
        {
          out[i + k] -= value[k];
        }
      }
    }
  }
}

void mlim_samples_row(
  const mlim_samples* samples, int32_t label, size_t first, size_t count, double* out)
{
  const mlim_array* array = array_of(samples, label);
  if (array != NULL && samples->grid->indicators != NULL)
  {
    mlim_indicators_row(samples->grid->indicators, label - samples->first_array, first, count, out);
  }
  else if (array != NULL)
  {
    mlim_scalars_read(array, first, count, out);
  }
  else
  {
    rule_row(samples, first, count, out);
  }
  if (label == samples->outside_label && samples->grid->is_outside != NULL)
  {
    for (size_t i = 0; i < count; ++i)
    {
      const double blank = blank_value(samples, first + i);
      out[i] = blank > 0 || array == NULL ? (blank > out[i] ? blank : out[i]) : out[i];
    }
  }
}

size_t mlim_samples_run(const mlim_samples* samples, size_t x)
{
  const size_t left = (size_t)samples->grid->dims[0] - x;
  const size_t room = MLIM_BRICK - x % MLIM_BRICK;
  return left < room ? left : room;
}

size_t mlim_samples_list(
  const mlim_samples* samples, const size_t* points, size_t count, uint16_t* out)
{
  const int has_blank = samples->grid->is_outside != NULL;
  size_t found = 0;
  for (size_t n = 0; n < count; ++n)
  {
    found = mlim_indicators_list(samples->grid->indicators, points[n], out, found);
  }
  size_t at = 0;
  while (at < found && out[at] < samples->outside_label)
  {
    ++at;
  }
  if (has_blank && (at == found || out[at] != samples->outside_label))
  {
    memmove(out + at + 1, out + at, (found - at) * sizeof *out);
    out[at] = (uint16_t)samples->outside_label;
    ++found;
  }
  return found;
}

void mlim_samples_corners(const mlim_samples* samples, int32_t label, size_t first, double out[8])
{
  const size_t nx = (size_t)samples->grid->dims[0];
  const size_t slice = nx * (size_t)samples->grid->dims[1];
  mlim_samples_row(samples, label, first, 2, out);
  mlim_samples_row(samples, label, first + nx, 2, out + 2);
  mlim_samples_row(samples, label, first + slice, 2, out + 4);
  mlim_samples_row(samples, label, first + slice + nx, 2, out + 6);
}

void mlim_array_name(const mlim_grid* grid, size_t array, char out[64])
{
  const char* name = grid->arrays[array].name;
  size_t n = 0;
  for (; name != NULL && name[n] != '\0' && n + 1 < 64; ++n)
  {
    out[n] = name[n];
  }
  out[n] = '\0';
}

/* ---- what is refused ---- */

mlim_status mlim_samples_check(const mlim_samples* samples, mlim_context* context)
{
  const mlim_grid* grid = samples->grid;
  const size_t nx = (size_t)grid->dims[0];
  const size_t ny = (size_t)grid->dims[1];
  const size_t points = nx * ny * (size_t)grid->dims[2];
  for (size_t a = 0; a < grid->array_count; ++a)
  {
    size_t count = 0;
    size_t where = 0;
    for (size_t i = 0; i < points; ++i)
    {
      double value;
      mlim_scalars_read(&grid->arrays[a], i, 1, &value);
      if (!isfinite(value))
      {
        where = count == 0 ? i : where;
        ++count;
      }
    }
    if (count > 0)
    {
      char name[64];
      mlim_array_name(grid, a, name);
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "Array %zu \"%s\" has %zu values that are not finite, the first at point (%zu, %zu, %zu); "
        "all values have to be finite.",
        a, name, count, where % nx, where / nx % ny, where / (nx * ny));
    }
  }
  return MLIM_OK;
}

static mlim_status check_indicators(const mlim_grid* grid, mlim_context* context)
{
  const mlim_indicators* in = grid->indicators;
  if (memcmp(in->dims, grid->dims, sizeof in->dims) != 0 ||
      grid->array_count != (size_t)in->label_count)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The indicators are of %d labels on %d x %d x %d points, the grid of %zu arrays on "
      "%d x %d x %d.",
      (int)in->label_count, (int)in->dims[0], (int)in->dims[1], (int)in->dims[2], grid->array_count,
      (int)grid->dims[0], (int)grid->dims[1], (int)grid->dims[2]);
  }
  if (grid->background == MLIM_BACKGROUND_CONSTANT ||
      grid->background == MLIM_BACKGROUND_COMPLEMENT)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The indicators of a label map hold the background's; it cannot be a constant or a "
      "complement.");
  }
  return MLIM_OK;
}

static mlim_status check_grid(const mlim_grid* grid, mlim_context* context)
{
  double points = 1;
  for (int k = 0; k < 3; ++k)
  {
    if (grid->dims[k] < 2)
    {
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "The image has %d points along axis %d; at least 2 are needed.", (int)grid->dims[k], k);
    }
    if (!(grid->spacing[k] > 0) || !isfinite(grid->spacing[k]))
    {
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "The spacing along axis %d is %g; it has to be finite and above 0.", k, grid->spacing[k]);
    }
    points *= grid->dims[k];
  }
  if (points > 9e15)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The image has %g points; at most 9e15 can be indexed.", points);
  }
  if (grid->array_count < 1 || grid->array_count > 32000)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "There are %zu indicator arrays; 1 to 32000 can be meshed.", grid->array_count);
  }
  if (grid->background == MLIM_BACKGROUND_ARRAY && grid->background_array >= grid->array_count)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The background is array %zu of %zu arrays; it has to be one of them.",
      grid->background_array, grid->array_count);
  }
  if (grid->background == MLIM_BACKGROUND_CONSTANT && !isfinite(grid->background_value))
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The background's value is %g; it has to be finite.", grid->background_value);
  }
  if (grid->indicators != NULL)
  {
    return check_indicators(grid, context);
  }
  for (size_t a = 0; a < grid->array_count; ++a)
  {
    if (grid->arrays[a].values == NULL || grid->arrays[a].type >= MLIM_SCALAR_END ||
        grid->arrays[a].stride == 0)
    {
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "Array %zu has no values, an unknown scalar type or a stride of 0.", a);
    }
  }
  return MLIM_OK;
}

static void name_labels(const mlim_grid* grid, mlim_samples* out)
{
  const int has_extra =
    grid->background == MLIM_BACKGROUND_CONSTANT || grid->background == MLIM_BACKGROUND_COMPLEMENT;
  out->grid = grid;
  out->first_array = has_extra;
  out->label_count = (int32_t)grid->array_count + has_extra;
  out->outside_label = has_extra                                   ? 0
                       : grid->background == MLIM_BACKGROUND_ARRAY ? (int32_t)grid->background_array
                                                                   : out->label_count;
}

int32_t mlim_samples_rule_label(const mlim_samples* samples)
{
  const int has_rule = samples->first_array == 1 || samples->grid->is_outside != NULL;
  return has_rule ? samples->outside_label : -1;
}

void mlim_samples_measure(mlim_samples* samples, const mlim_sample_range* range)
{
  const mlim_grid* grid = samples->grid;
  double low = range->min;
  double high = range->max;
  double largest = 0;
  if (grid->background == MLIM_BACKGROUND_CONSTANT)
  {
    low = grid->background_value < low ? grid->background_value : low;
    high = grid->background_value > high ? grid->background_value : high;
  }
  else if (grid->background == MLIM_BACKGROUND_COMPLEMENT)
  {
    samples->total = range->max_sum;
    largest = fabs(range->max_sum);
  }
  samples->range = high - low;
  largest = fmax(largest, fmax(fabs(low), fabs(high)));
  int exponent = 0;
  (void)frexp(isfinite(samples->range) && largest > 0 ? largest : 1, &exponent);
  samples->scale = ldexp(1.0, -exponent - 3);
}

mlim_status mlim_samples_open(const mlim_grid* grid, mlim_context* context, mlim_samples* out)
{
  *out = (mlim_samples){ 0 };
  const mlim_status status = check_grid(grid, context);
  if (status != MLIM_OK)
  {
    return status;
  }
  name_labels(grid, out);
  if (grid->indicators != NULL)
  {
    const double* range = grid->indicators->range;
    mlim_samples_measure(out, &(mlim_sample_range){ .min = range[0], .max = range[1] });
  }
  return MLIM_OK;
}
