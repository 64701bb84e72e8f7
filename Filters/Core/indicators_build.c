/* Makes the indicators of a label map: all tiles, then what concerns whole labels. */
#include "indicators_tile.h"
#include "indicators_volume.h"
#include "memory.h"
#include "status.h"

#include <math.h>
#include <string.h>

/* The largest constant for a label's volume, in the smallest spacing: the interfaces move by half. */
static const double MOST_SHIFT = 0.6;

/* The default, in spacings of each axis. At 1 gentle slopes show terraces one voxel high; at 2 more sheets
   of two voxels break up. */
static const double SIGMA = 1.5;

/* A band this much longer than the voxel's diagonal keeps every label that wins somewhere near a cell
   above the floor at its corners. */
static const double DIAGONALS = 1;

enum
{
  MAX_MORPHOLOGY = 8, /* grid points; so that a halo cannot become larger than some tiles */
  MAX_ITERATIONS = 64,
  THIN_REACH = 3, /* how far mlim_morphology_thin looks */
  MAX_HALO = 64,  /* grid points; a tile with its halo has 25 times as many as without */
  BATCH = 8       /* tiles between two looks at the host: below a tenth of a second */
};

mlim_indicator_options mlim_indicator_options_default(void)
{
  return (mlim_indicator_options){ .method = MLIM_INDICATOR_DISTANCE,
    .diffusion_time_step = 0.0625,
    .keeps_volume = 1,
    .keeps_thin = 1 };
}

/* ---- the plan ---- */

static mlim_status check_range(const char* name, int32_t value, int32_t most, mlim_context* context)
{
  return value >= 0 && value <= most
           ? MLIM_OK
           : mlim_fail(context, MLIM_INVALID_ARGUMENT, "%s is %d; it has to be from 0 to %d.", name,
               (int)value, (int)most);
}

static mlim_status check_options(const mlim_indicator_options* options, mlim_context* context)
{
  mlim_status status =
    check_range("median_radius", options->median_radius, MAX_MORPHOLOGY, context);
  status = status == MLIM_OK
             ? check_range("dilate_radius", options->dilate_radius, MAX_MORPHOLOGY, context)
             : status;
  status = status == MLIM_OK ? check_range("diffusion_iterations", options->diffusion_iterations,
                                 MAX_ITERATIONS, context)
                             : status;
  if (status == MLIM_OK &&
      !(options->diffusion_time_step > 0 && options->diffusion_time_step <= 0.125))
  {
    status = mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "diffusion_time_step is %g; it has to be above 0 and at most 0.125.",
      options->diffusion_time_step);
  }
  if (status == MLIM_OK && (unsigned)options->method > MLIM_INDICATOR_MASK)
  {
    status = mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The indicator method is %d; it has to be 0 (distance) or 1 (mask).", (int)options->method);
  }
  return status;
}

static mlim_status plan_distance(mlim_indicator_plan* plan, mlim_context* context)
{
  const double* h = plan->map->spacing;
  const double least = DIAGONALS * sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]);
  const double given = plan->options.distance_band;
  const double band = given == 0 ? 3 * fmax(h[0], fmax(h[1], h[2])) : given;
  if (!(band >= least) || !mlim_distance_cost_of(h, band, &plan->cost))
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "distance_band is %g%s; it has to be at least a voxel's diagonal, %g, and at most 60 "
      "spacings along each axis.",
      band, given == 0 ? ", 3 of the largest spacings" : "", least);
  }
  return MLIM_OK;
}

static mlim_status plan_kernels(mlim_indicator_plan* plan, mlim_context* context)
{
  const mlim_indicator_options* options = &plan->options;
  const int is_level = options->keeps_volume && options->method == MLIM_INDICATOR_DISTANCE;
  for (int k = 0; k < 3; ++k)
  {
    const double h = plan->map->spacing[k];
    const double sigma = options->gaussian_sigma == 0  ? SIGMA
                         : options->gaussian_sigma > 0 ? options->gaussian_sigma / h
                                                       : 0;
    if (!(options->gaussian_sigma == options->gaussian_sigma) ||
        !mlim_kernel_gaussian(sigma, is_level, &plan->kernels[k]))
    {
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "gaussian_sigma is %g; along axis %d it has to be at most 15 spacings of %g.",
        options->gaussian_sigma, k, h);
    }
  }
  return MLIM_OK;
}

static mlim_status make_plan(const mlim_label_map* map, const mlim_indicator_options* options,
  mlim_context* context, mlim_indicator_plan* out)
{
  *out = (mlim_indicator_plan){ .map = map, .options = *options, .floor = 0, .ceiling = 1 };
  mlim_status status = check_options(options, context);
  const int is_distance = options->method == MLIM_INDICATOR_DISTANCE;
  if (status == MLIM_OK && is_distance)
  {
    status = plan_distance(out, context);
    out->floor = -out->cost.band;
    out->ceiling = out->cost.band;
  }
  status = status == MLIM_OK ? plan_kernels(out, context) : status;
  const double* h = map->spacing;
  const double least = fmin(h[0], fmin(h[1], h[2]));
  out->diffusion = (mlim_diffusion){ .iterations = options->diffusion_iterations,
    .step = (float)options->diffusion_time_step,
    .slope = (float)(is_distance ? 1 : 0.5 / least),
    .min_spacing = (float)least };
  for (int k = 0; k < 3; ++k)
  {
    out->diffusion.inverse[k] = (float)(1 / h[k]);
    const int32_t filters = options->dilate_radius + (is_distance ? out->cost.radius[k] : 0) +
                            out->kernels[k].radius + options->diffusion_iterations;
    out->halo[k] = options->median_radius + (filters > THIN_REACH ? filters : THIN_REACH);
    if (status == MLIM_OK && out->halo[k] > MAX_HALO)
    {
      status = mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "The filters together reach %d grid points along axis %d (distance_band %d, gaussian_sigma "
        "%d); at most %d are allowed.",
        (int)out->halo[k], k, is_distance ? (int)out->cost.radius[k] : 0,
        (int)out->kernels[k].radius, (int)MAX_HALO);
    }
  }
  return status;
}

/* ---- the tiles ---- */

typedef struct tiles_job
{
  const mlim_indicator_plan* plan;
  mlim_indicators* indicators;
  size_t first;
  unsigned char* has_failed; /* a tile of the batch */
} tiles_job;

static void tile_body(void* data, size_t begin, size_t end)
{
  const tiles_job* job = (const tiles_job*)data;
  const int32_t* tiles = job->indicators->tiles;
  for (size_t n = begin; n < end; ++n)
  {
    const size_t t = job->first + n;
    const int32_t tile[3] = { (int32_t)(t % (size_t)tiles[0]),
      (int32_t)(t / (size_t)tiles[0] % (size_t)tiles[1]),
      (int32_t)(t / ((size_t)tiles[0] * (size_t)tiles[1])) };
    job->has_failed[n] =
      !mlim_indicators_make_tile(job->plan, job->indicators, tile, &job->indicators->tile[t]);
  }
}

static mlim_status make_tiles(const mlim_indicator_plan* plan, mlim_indicators* indicators,
  double from, double to, mlim_context* context)
{
  const size_t count =
    (size_t)indicators->tiles[0] * (size_t)indicators->tiles[1] * (size_t)indicators->tiles[2];
  for (size_t first = 0; first < count; first += BATCH)
  {
    unsigned char has_failed[BATCH] = { 0 };
    const size_t share = count - first < BATCH ? count - first : BATCH;
    mlim_parallel_for(context, share, tile_body,
      &(tiles_job){
        .plan = plan, .indicators = indicators, .first = first, .has_failed = has_failed });
    for (size_t n = 0; n < share; ++n)
    {
      if (has_failed[n])
      {
        return mlim_fail_memory(context, "the indicators");
      }
    }
    const double done = (double)(first + share) / (double)count;
    const mlim_status status =
      mlim_progress(context, MLIM_STAGE_INDICATORS, from + done * (to - from));
    if (status != MLIM_OK)
    {
      return status;
    }
  }
  return MLIM_OK;
}

/* ---- labels that win nowhere ---- */

/* Gives a label the lead that its voxels have before smoothing, at all of them in one brick. */
static void bring_back(
  mlim_indicators* indicators, const mlim_label_map* map, const int32_t brick[3], int32_t label)
{
  size_t place;
  const mlim_tile* tile = mlim_indicators_tile(indicators, brick, &place);
  const mlim_brick_list list = mlim_indicators_brick(indicators, brick);
  const mlim_brick_entry* own = mlim_brick_find(&list, label);
  if (own == NULL || own->is_uniform)
  {
    return;
  }
  float* values = tile->values;
  for (int32_t slot = 0; slot < MLIM_BRICK_POINTS; ++slot)
  {
    const int32_t at[3] = { 8 * brick[0] + (slot & 7), 8 * brick[1] + (slot >> 3 & 7),
      8 * brick[2] + (slot >> 6) };
    if (at[0] >= map->dims[0] || at[1] >= map->dims[1] || at[2] >= map->dims[2] ||
        map->labels[(size_t)at[0] + (size_t)map->dims[0] *
                                      ((size_t)at[1] + (size_t)map->dims[1] * (size_t)at[2])] !=
          label)
    {
      continue;
    }
    float best = indicators->floor;
    for (size_t n = 0; n < list.count; ++n)
    {
      const mlim_brick_entry* entry = &list.entries[n];
      const float v = values[entry->first + (entry->is_uniform ? 0 : (size_t)slot)];
      best = entry != own && v > best ? v : best;
    }
    values[own->first + (size_t)slot] = best + indicators->unit;
    indicators->has[label] = 1;
  }
}

static void keep_lost(mlim_indicators* indicators, const mlim_label_map* map)
{
  const size_t bricks =
    (size_t)indicators->bricks[0] * (size_t)indicators->bricks[1] * (size_t)indicators->bricks[2];
  for (int32_t l = 0; l < map->label_count; ++l)
  {
    const int is_lost = !indicators->has[l]; /* the first of its bricks changes that */
    for (size_t b = 0; is_lost && b < bricks; ++b)
    {
      const int32_t brick[3] = { (int32_t)(b % (size_t)indicators->bricks[0]),
        (int32_t)(b / (size_t)indicators->bricks[0] % (size_t)indicators->bricks[1]),
        (int32_t)(b / ((size_t)indicators->bricks[0] * (size_t)indicators->bricks[1])) };
      bring_back(indicators, map, brick, l);
    }
  }
}

/* ---- all of it ---- */

static void find_range(mlim_indicators* indicators)
{
  const size_t tiles =
    (size_t)indicators->tiles[0] * (size_t)indicators->tiles[1] * (size_t)indicators->tiles[2];
  double low = INFINITY;
  double high = -INFINITY;
  for (size_t t = 0; t < tiles; ++t)
  {
    const mlim_tile* tile = &indicators->tile[t];
    for (size_t i = 0; i < tile->value_count; ++i)
    {
      low = (double)tile->values[i] < low ? (double)tile->values[i] : low;
      high = (double)tile->values[i] > high ? (double)tile->values[i] : high;
    }
    for (size_t b = 0; b < MLIM_TILE_BRICKS; ++b)
    {
      const size_t count = tile->first[b + 1] - tile->first[b];
      const int has_floor = count > 0 && count < (size_t)indicators->label_count;
      low = has_floor && (double)indicators->floor < low ? (double)indicators->floor : low;
    }
  }
  indicators->range[0] = low;
  indicators->range[1] = high;
}

static int open_indicators(const mlim_indicator_plan* plan, mlim_indicators* out)
{
  const double* h = plan->map->spacing;
  size_t tiles = 1;
  for (int k = 0; k < 3; ++k)
  {
    out->dims[k] = plan->map->dims[k];
    out->bricks[k] = (out->dims[k] + MLIM_BRICK - 1) / MLIM_BRICK;
    out->tiles[k] = (out->dims[k] + MLIM_TILE - 1) / MLIM_TILE;
    tiles *= (size_t)out->tiles[k];
  }
  out->label_count = plan->map->label_count;
  out->floor = plan->floor;
  out->unit =
    plan->options.method == MLIM_INDICATOR_DISTANCE ? (float)fmin(h[0], fmin(h[1], h[2])) : 1;
  out->tile = mlim_allocate_zeroed(tiles, sizeof *out->tile);
  out->has = mlim_allocate_zeroed((size_t)out->label_count, 1);
  return out->tile != NULL && out->has != NULL;
}

mlim_status mlim_indicators_create(const mlim_label_map* map, const mlim_indicator_options* options,
  mlim_context* context, mlim_indicators** out)
{
  if (map == NULL || map->labels == NULL || options == NULL || out == NULL)
  {
    return mlim_fail(
      context, MLIM_INVALID_ARGUMENT, "The label map, its options or its result is NULL.");
  }
  *out = NULL;
  mlim_indicator_plan plan;
  mlim_status status = make_plan(map, options, context, &plan);
  if (status != MLIM_OK)
  {
    return status;
  }
  mlim_indicators* indicators = mlim_allocate_zeroed(1, sizeof *indicators);
  if (indicators == NULL || !open_indicators(&plan, indicators))
  {
    status = mlim_fail_memory(context, "the indicators");
    goto done;
  }
  status = make_tiles(&plan, indicators, 0.04, 0.6, context);
  if (status == MLIM_OK)
  {
    const int corrects = options->keeps_volume && options->dilate_radius == 0 &&
                         options->method == MLIM_INDICATOR_DISTANCE;
    status = mlim_indicators_settle(
      indicators, corrects ? MOST_SHIFT * (double)indicators->unit : 0, 0.6, 0.99, context);
  }
  if (status == MLIM_OK)
  {
    if (options->keeps_thin)
    {
      keep_lost(indicators, map);
    }
    find_range(indicators);
    status = mlim_progress(context, MLIM_STAGE_INDICATORS, 1);
  }
done:
  if (status != MLIM_OK)
  {
    mlim_indicators_free(indicators);
    return status;
  }
  *out = indicators;
  return MLIM_OK;
}
