/* Arrays are read tile by tile, a tile being a row of blocks that fits the cache: there the best value of
   each point waits for all arrays. What is not an array's alone comes afterwards, since it depends on the
   range of all values. */
#include "winners.h"

#include "memory.h"
#include "plateau.h"
#include "scalars.h"
#include "status.h"
#include "winners_row.h"

#include <float.h>

enum
{
  TILE_ROWS = MLIM_PEAK_BLOCK * MLIM_PEAK_BLOCK
};

/* Between two looks at the host: some hundredths of a second. */
static const double PIECE_VALUES = 3e7;

/* What one row of blocks says of all values. */
typedef struct unit_range
{
  mlim_sample_range range;
  int has_bad;    /* values that are not finite */
  int has_failed; /* out of memory */
} unit_range;

typedef struct win_job
{
  const mlim_samples* samples;
  uint16_t* winners;
  mlim_peaks* peaks;
  mlim_width width;
  size_t group; /* rows of a tile that are read of one array before the next */
  unit_range* units;
} win_job;

typedef struct tile
{
  const win_job* job;
  int32_t block[3]; /* the first one */
  size_t count;     /* points along x */
  size_t row_count;
  size_t first[TILE_ROWS]; /* a row: its first grid point */
  char* best;              /* MLIM_ROW values a row */
  double* sum;             /* the same, with a complement; else NULL */
  mlim_row low, peak;
  double most; /* the largest value */
  int has_bad;
} tile;

/* ---- arrays ---- */

static void add_to_sum(const tile* t, const mlim_array* array, size_t row)
{
  double value[MLIM_ROW];
  double* sum = t->sum + row * MLIM_ROW;
  mlim_scalars_read(array, t->first[row], t->count, value);
  for (size_t i = 0; i < t->count; ++i)
  {
    sum[i] += value[i];
  }
}

static void raise_peaks(tile* t, size_t array)
{
  const size_t size = mlim_width_size(t->job->width);
  const char* row = (const char*)&t->peak;
  for (size_t i = 0; i < t->count; i += MLIM_PEAK_BLOCK)
  {
    double most = -DBL_MAX;
    for (size_t n = i; n < t->count && n < i + MLIM_PEAK_BLOCK; ++n)
    {
      const double value = mlim_row_value(t->job->width, row + n * size);
      most = value > most ? value : most;
    }
    const int32_t x = t->block[0] + (int32_t)(i / MLIM_PEAK_BLOCK);
    t->most = most > t->most ? most : t->most;
    mlim_peaks_raise(mlim_peaks_of(t->job->peaks, x, t->block[1], t->block[2]) + array, most);
  }
}

/* All arrays in some rows of the tile. */
static void win_rows(tile* t, size_t begin, size_t end)
{
  const win_job* job = t->job;
  const mlim_grid* grid = job->samples->grid;
  const size_t size = mlim_width_size(job->width);
  for (size_t a = 0; a < grid->array_count; ++a)
  {
    mlim_row_fill_least(job->width, &t->peak);
    for (size_t row = begin; row < end; ++row)
    {
      const mlim_row_work work = { .array = &grid->arrays[a],
        .width = job->width,
        .first = t->first[row],
        .count = t->count,
        .label = (uint16_t)(a + (size_t)job->samples->first_array),
        .is_first = a == 0 };
      const mlim_row_state state = { .best = t->best + row * MLIM_ROW * size,
        .winners = job->winners + t->first[row],
        .low = &t->low,
        .peak = &t->peak };
      t->has_bad |= mlim_row_win(&work, &state);
      if (t->sum != NULL)
      {
        add_to_sum(t, &grid->arrays[a], row);
      }
    }
    raise_peaks(t, a);
  }
}

static void note_range(const tile* t, unit_range* out)
{
  const mlim_width width = t->job->width;
  const size_t size = mlim_width_size(width);
  mlim_sample_range* range = &out->range;
  for (size_t i = 0; i < t->count; ++i)
  {
    const double low = mlim_row_value(width, (const char*)&t->low + i * size);
    range->min = low < range->min ? low : range->min;
  }
  range->max = t->most > range->max ? t->most : range->max;
  for (size_t row = 0; t->sum != NULL && row < t->row_count; ++row)
  {
    for (size_t i = 0; i < t->count; ++i)
    {
      const double sum = t->sum[row * MLIM_ROW + i];
      range->max_sum = sum > range->max_sum ? sum : range->max_sum;
    }
  }
  out->has_bad |= t->has_bad;
}

static void win_tile(tile* t, unit_range* out)
{
  const win_job* job = t->job;
  mlim_row_fill_largest(job->width, &t->low);
  for (size_t n = 0; t->sum != NULL && n < TILE_ROWS * MLIM_ROW; ++n)
  {
    t->sum[n] = 0;
  }
  t->has_bad = 0;
  t->most = -DBL_MAX;
  for (size_t row = 0; row < t->row_count; row += job->group)
  {
    const size_t left = t->row_count - row;
    win_rows(t, row, row + (left < job->group ? left : job->group));
  }
  note_range(t, out);
}

/* All tiles of a row of blocks along x. */
static void win_unit(tile* t, unit_range* out)
{
  const mlim_grid* grid = t->job->samples->grid;
  const size_t nx = (size_t)grid->dims[0];
  const size_t parts = (nx + MLIM_ROW - 1) / MLIM_ROW;
  const size_t width =
    ((nx + parts - 1) / parts + MLIM_PEAK_BLOCK - 1) / MLIM_PEAK_BLOCK * MLIM_PEAK_BLOCK;
  const int32_t y = MLIM_PEAK_BLOCK * t->block[1];
  const int32_t z = MLIM_PEAK_BLOCK * t->block[2];
  *out = (unit_range){ .range = { .min = DBL_MAX, .max = -DBL_MAX, .max_sum = -DBL_MAX } };
  for (size_t x = 0; x < nx; x += width)
  {
    t->block[0] = (int32_t)(x / MLIM_PEAK_BLOCK);
    t->count = nx - x < width ? nx - x : width;
    t->row_count = 0;
    for (int32_t n = 0; n < TILE_ROWS; ++n)
    {
      const int32_t at[2] = { y + n % MLIM_PEAK_BLOCK, z + n / MLIM_PEAK_BLOCK };
      if (at[0] < grid->dims[1] && at[1] < grid->dims[2])
      {
        t->first[t->row_count++] = x + nx * ((size_t)at[0] + (size_t)grid->dims[1] * (size_t)at[1]);
      }
    }
    win_tile(t, out);
  }
}

static void win_body(void* data, size_t begin, size_t end)
{
  const win_job* job = (const win_job*)data;
  const int has_sum = job->samples->grid->background == MLIM_BACKGROUND_COMPLEMENT;
  tile* t = mlim_allocate(1, sizeof *t);
  char* best = mlim_allocate((size_t)TILE_ROWS * MLIM_ROW, sizeof(double));
  double* sum = has_sum ? mlim_allocate((size_t)TILE_ROWS * MLIM_ROW, sizeof *sum) : NULL;
  const int has_memory = t != NULL && best != NULL && (sum != NULL || !has_sum);
  for (size_t n = begin; n < end; ++n)
  {
    if (has_memory)
    {
      const int32_t along = job->peaks->blocks[1];
      *t = (tile){
        .job = job, .block = { 0, (int32_t)n % along, (int32_t)n / along }, .best = best, .sum = sum
      };
      win_unit(t, &job->units[n]);
    }
    else
    {
      job->units[n].has_failed = 1;
    }
  }
  mlim_release(t);
  mlim_release(best);
  mlim_release(sum);
}

static mlim_status gather_range(
  const win_job* job, size_t unit_count, mlim_context* context, mlim_sample_range* out)
{
  unit_range all = job->units[0];
  for (size_t n = 0; n < unit_count; ++n)
  {
    const mlim_sample_range* range = &job->units[n].range;
    all.range.min = range->min < all.range.min ? range->min : all.range.min;
    all.range.max = range->max > all.range.max ? range->max : all.range.max;
    all.range.max_sum = range->max_sum > all.range.max_sum ? range->max_sum : all.range.max_sum;
    all.has_bad |= job->units[n].has_bad;
    all.has_failed |= job->units[n].has_failed;
  }
  *out = all.range;
  return all.has_failed ? mlim_fail_memory(context, "the labels of the grid points")
         : all.has_bad  ? mlim_samples_check(job->samples, context)
                        : MLIM_OK;
}

static mlim_status win_arrays(
  mlim_samples* samples, mlim_context* context, uint16_t* winners, mlim_peaks* peaks)
{
  const mlim_grid* grid = samples->grid;
  win_job job = { .samples = samples,
    .winners = winners,
    .peaks = peaks,
    .width = mlim_width_of(grid->arrays, grid->array_count),
    .group = TILE_ROWS };
  for (size_t a = 0; a < grid->array_count; ++a)
  {
    /* Where arrays lie interleaved, they share their cache lines. */
    job.group = grid->arrays[a].stride == 1 ? job.group : 1;
  }
  const double value_count =
    (double)grid->dims[0] * grid->dims[1] * grid->dims[2] * (double)grid->array_count;
  const size_t unit_count = (size_t)peaks->blocks[1] * (size_t)peaks->blocks[2];
  job.units = mlim_allocate_zeroed(unit_count, sizeof *job.units);
  if (job.units == NULL)
  {
    return mlim_fail_memory(context, "reading the arrays");
  }
  mlim_status status = mlim_parallel_stage(
    context, &(mlim_stage_work){ .count = unit_count,
               .body = win_body,
               .job = &job,
               .stage = MLIM_STAGE_FIELD,
               .from = 0,
               .to = 0.3,
               .step = unit_count / (32 + (size_t)(value_count / PIECE_VALUES)) + 1 });
  mlim_sample_range range;
  if (status == MLIM_OK)
  {
    status = gather_range(&job, unit_count, context, &range);
  }
  if (status == MLIM_OK)
  {
    mlim_samples_measure(samples, &range);
  }
  mlim_release(job.units);
  return status;
}

/* ---- the label by rule ---- */

/* The values of arrays at some points of a row, each point having its own array. */
static void read_winners(
  const mlim_samples* samples, size_t first, size_t count, const uint16_t* winners, double* out)
{
  size_t run;
  for (size_t i = 0; i < count; i += run)
  {
    const int32_t label = winners[i] & ~MLIM_TIED_FLAG;
    run = 1;
    while (i + run < count && (winners[i + run] & ~MLIM_TIED_FLAG) == label)
    {
      ++run;
    }
    mlim_scalars_read(
      &samples->grid->arrays[label - samples->first_array], first + i, run, out + i);
  }
}

/* Lets the label by rule compete with the best array of each point. */
static void rule_row(const mlim_samples* samples, size_t first, uint16_t* winners)
{
  const mlim_grid* grid = samples->grid;
  const int32_t label = mlim_samples_rule_label(samples);
  const int32_t array = label - samples->first_array;
  const int is_array = array >= 0 && (size_t)array < grid->array_count;
  double value[MLIM_ROW];
  double best[MLIM_ROW];
  double own[MLIM_ROW];
  for (size_t x = 0; x < (size_t)grid->dims[0]; x += MLIM_ROW)
  {
    const size_t left = (size_t)grid->dims[0] - x;
    const size_t count = left < MLIM_ROW ? left : MLIM_ROW;
    uint16_t* win = winners + first + x;
    mlim_samples_row(samples, label, first + x, count, value);
    read_winners(samples, first + x, count, win, best);
    if (is_array)
    {
      mlim_scalars_read(&grid->arrays[array], first + x, count, own);
    }
    for (size_t i = 0; i < count; ++i)
    {
      if (is_array && value[i] == own[i])
      {
        continue; /* it has competed */
      }
      if (value[i] > best[i])
      {
        win[i] = (uint16_t)label;
      }
      else if (value[i] == best[i])
      {
        const int32_t lowest = win[i] & ~MLIM_TIED_FLAG;
        win[i] = (uint16_t)((lowest < label ? lowest : label) | MLIM_TIED_FLAG);
      }
    }
  }
}

static void rule_body(void* data, size_t begin, size_t end)
{
  const win_job* job = (const win_job*)data;
  const size_t nx = (size_t)job->samples->grid->dims[0];
  const size_t ny = (size_t)job->samples->grid->dims[1];
  for (size_t row = begin * ny; row < end * ny; ++row)
  {
    rule_row(job->samples, row * nx, job->winners);
  }
}

/* ---- indicators ---- */

/* One run of points along x whose labels are the same list. */
typedef struct win_run
{
  size_t first, count;
  const uint16_t* labels; /* ascending, at least one */
  size_t label_count;
} win_run;

static void win_along(const mlim_samples* samples, const win_run* run, uint16_t* win)
{
  double best[MLIM_ROW];
  double value[MLIM_ROW];
  mlim_samples_row(samples, run->labels[0], run->first, run->count, best);
  for (size_t x = 0; x < run->count; ++x)
  {
    win[x] = run->labels[0];
  }
  for (size_t n = 1; n < run->label_count; ++n)
  {
    const uint16_t label = run->labels[n];
    mlim_samples_row(samples, label, run->first, run->count, value);
    for (size_t x = 0; x < run->count; ++x)
    {
      const int is_better = value[x] > best[x];
      const int is_tied = value[x] == best[x];
      best[x] = is_better ? value[x] : best[x];
      win[x] = is_better ? label : is_tied ? (uint16_t)(win[x] | MLIM_TIED_FLAG) : win[x];
    }
  }
}

static void indicators_body(void* data, size_t begin, size_t end)
{
  const win_job* job = (const win_job*)data;
  const mlim_samples* samples = job->samples;
  const size_t nx = (size_t)samples->grid->dims[0];
  const size_t ny = (size_t)samples->grid->dims[1];
  uint16_t* labels = mlim_allocate((size_t)samples->label_count + 1, sizeof *labels);
  for (size_t z = begin; z < end; ++z)
  {
    job->units[z].has_failed = labels == NULL;
    for (size_t y = 0; y < ny && labels != NULL; ++y)
    {
      win_run run = { .labels = labels };
      for (size_t x = 0; x < nx; x += run.count)
      {
        run.first = x + nx * (y + ny * z);
        run.count = mlim_samples_run(samples, x);
        run.label_count = mlim_samples_list(samples, &run.first, 1, labels);
        win_along(samples, &run, job->winners + run.first);
      }
    }
  }
  mlim_release(labels);
}

static mlim_status win_indicators(
  const mlim_samples* samples, mlim_context* context, uint16_t* winners)
{
  const size_t slice_count = (size_t)samples->grid->dims[2];
  win_job job = { .samples = samples, .winners = winners };
  job.units = mlim_allocate_zeroed(slice_count, sizeof *job.units);
  if (job.units == NULL)
  {
    return mlim_fail_memory(context, "reading the indicators");
  }
  mlim_status status = mlim_parallel_stage(context, &(mlim_stage_work){ .count = slice_count,
                                                      .body = indicators_body,
                                                      .job = &job,
                                                      .stage = MLIM_STAGE_FIELD,
                                                      .from = 0,
                                                      .to = 0.4 });
  for (size_t z = 0; z < slice_count && status == MLIM_OK; ++z)
  {
    status = job.units[z].has_failed ? mlim_fail_memory(context, "the labels of the grid points")
                                     : MLIM_OK;
  }
  mlim_release(job.units);
  return status;
}

/* ---- all of it ---- */

mlim_status mlim_winners_find(
  mlim_samples* samples, mlim_context* context, uint16_t* winners, mlim_peaks* peaks)
{
  *peaks = (mlim_peaks){ 0 };
  if (samples->grid->indicators != NULL)
  {
    return win_indicators(samples, context, winners);
  }
  mlim_status status = mlim_peaks_create(samples, context, peaks);
  if (status == MLIM_OK)
  {
    status = win_arrays(samples, context, winners, peaks);
  }
  if (status == MLIM_OK && mlim_samples_rule_label(samples) >= 0)
  {
    win_job job = { .samples = samples, .winners = winners };
    status =
      mlim_parallel_stage(context, &(mlim_stage_work){ .count = (size_t)samples->grid->dims[2],
                                     .body = rule_body,
                                     .job = &job,
                                     .stage = MLIM_STAGE_FIELD,
                                     .from = 0.3,
                                     .to = 0.4 });
  }
  if (status != MLIM_OK)
  {
    mlim_peaks_free(peaks);
  }
  return status;
}
