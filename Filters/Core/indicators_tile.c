/* Each label of the map near the tile gets a block: its bounding box with room for all that the
   filters reach. In the block: mask, median, dilation, distance, kernel, diffusion; then the tile's
   part of it is cut into bricks. Beyond its faces the map goes on as its mirror image, so that
   interfaces meet the box at right angles. */
#include "indicators_tile.h"

#include "indicators_brick.h"
#include "memory.h"
#include "morphology.h"

#include <string.h>

/* Values this near (relative to floor or ceiling) are what a constant becomes by rounding. */
static const float ROUNDING = 1e-5F;

enum
{
  NOBODY = 0xffff /* of the thin points: no label */
};

/* A label near the tile. */
typedef struct tile_label
{
  uint16_t label;
  int32_t low[3], high[3]; /* bounding box in the region */
} tile_label;

typedef struct tile_work
{
  const mlim_indicator_plan* plan;
  int32_t core[3];   /* points of the tile */
  int32_t origin[3]; /* its first point in the image */
  int32_t region[3]; /* with the halo */
  int32_t bricks[3]; /* in the tile, that hold points */
  uint16_t* map;     /* of the region */
  tile_label* labels;
  size_t label_count, label_capacity;
  /* One block: two of floats and one more for scratch (also int32), three of bytes. */
  float* values;
  float* scratch;
  unsigned char* mask;
  unsigned char* bytes;
  uint16_t* thin; /* a point of the tile: the label that is thin there */
  mlim_brick_writer writer;
} tile_work;

/* ---- the map round the tile ---- */

/* Mirrors an index into 0 .. length - 1 at the outermost points. */
static int32_t fold(int32_t at, int32_t length)
{
  const int32_t period = 2 * (length - 1);
  const int32_t in = (at % period + period) % period;
  return in < length ? in : period - in;
}

static void read_map(tile_work* work)
{
  const mlim_label_map* map = work->plan->map;
  const int32_t* halo = work->plan->halo;
  size_t i = 0;
  for (int32_t z = 0; z < work->region[2]; ++z)
  {
    const size_t from_z = (size_t)fold(work->origin[2] - halo[2] + z, map->dims[2]);
    for (int32_t y = 0; y < work->region[1]; ++y)
    {
      const size_t from_y = (size_t)fold(work->origin[1] - halo[1] + y, map->dims[1]);
      const uint16_t* row =
        map->labels + (size_t)map->dims[0] * (from_y + (size_t)map->dims[1] * from_z);
      for (int32_t x = 0; x < work->region[0]; ++x)
      {
        work->map[i++] = row[fold(work->origin[0] - halo[0] + x, map->dims[0])];
      }
    }
  }
}

static int add_label(tile_work* work, size_t at, uint16_t label, const int32_t point[3])
{
  if (mlim_reserve(
        &work->labels, &work->label_capacity, work->label_count + 1, sizeof *work->labels))
  {
    return 0;
  }
  memmove(
    work->labels + at + 1, work->labels + at, (work->label_count - at) * sizeof *work->labels);
  work->labels[at].label = label;
  memcpy(work->labels[at].low, point, sizeof work->labels[at].low);
  memcpy(work->labels[at].high, point, sizeof work->labels[at].high);
  ++work->label_count;
  return 1;
}

/* The labels of the region, ascending, with their bounding boxes; a run of points at a time. */
static int find_labels(tile_work* work)
{
  for (int32_t z = 0; z < work->region[2]; ++z)
  {
    for (int32_t y = 0; y < work->region[1]; ++y)
    {
      const uint16_t* row =
        work->map + (size_t)work->region[0] * ((size_t)y + (size_t)work->region[1] * (size_t)z);
      int32_t end;
      for (int32_t x = 0; x < work->region[0]; x = end)
      {
        for (end = x + 1; end < work->region[0] && row[end] == row[x]; ++end)
        {
        }
        const int32_t first[3] = { x, y, z };
        const int32_t last[3] = { end - 1, y, z };
        const size_t at =
          mlim_label_place(work->labels, sizeof *work->labels, work->label_count, row[x]);
        const int is_known = at < work->label_count && work->labels[at].label == row[x];
        if (!is_known && !add_label(work, at, row[x], first))
        {
          return 0;
        }
        tile_label* label = &work->labels[at];
        for (int k = 0; k < 3; ++k)
        {
          label->low[k] = first[k] < label->low[k] ? first[k] : label->low[k];
          label->high[k] = last[k] > label->high[k] ? last[k] : label->high[k];
        }
      }
    }
  }
  return 1;
}

/* ---- one label ---- */

/* A block of the region: points low .. low + size. */
typedef struct block
{
  int32_t low[3], size[3];
} block;

/* 0: the label does not reach the tile. */
static int place_block(const tile_work* work, const tile_label* label, block* out)
{
  const int32_t* halo = work->plan->halo;
  for (int k = 0; k < 3; ++k)
  {
    const int32_t low = label->low[k] - halo[k];
    const int32_t high = label->high[k] + halo[k];
    if (low >= halo[k] + work->core[k] || high < halo[k])
    {
      return 0;
    }
    out->low[k] = low < 0 ? 0 : low;
    out->size[k] = (high < work->region[k] ? high + 1 : work->region[k]) - out->low[k];
  }
  return 1;
}

static size_t block_count(const block* b)
{
  return (size_t)b->size[0] * (size_t)b->size[1] * (size_t)b->size[2];
}

static void read_mask(const tile_work* work, uint16_t label, const block* b)
{
  unsigned char* mask = work->mask;
  for (int32_t z = 0; z < b->size[2]; ++z)
  {
    for (int32_t y = 0; y < b->size[1]; ++y)
    {
      const uint16_t* row =
        work->map + (size_t)b->low[0] +
        (size_t)work->region[0] *
          ((size_t)(b->low[1] + y) + (size_t)work->region[1] * (size_t)(b->low[2] + z));
      for (int32_t x = 0; x < b->size[0]; ++x)
      {
        *mask++ = row[x] == label;
      }
    }
  }
}

/* The part of a block that lies in the tile, point by point. */
typedef void (*visit_point)(tile_work* work, size_t in_block, const int32_t at[3], void* user);

static void visit_core(tile_work* work, const block* b, visit_point visit, void* user)
{
  const int32_t* halo = work->plan->halo;
  int32_t low[3];
  int32_t high[3];
  for (int k = 0; k < 3; ++k)
  {
    low[k] = b->low[k] > halo[k] ? 0 : halo[k] - b->low[k];
    const int32_t end = halo[k] + work->core[k] - b->low[k];
    high[k] = end < b->size[k] ? end : b->size[k];
  }
  for (int32_t z = low[2]; z < high[2]; ++z)
  {
    for (int32_t y = low[1]; y < high[1]; ++y)
    {
      for (int32_t x = low[0]; x < high[0]; ++x)
      {
        const int32_t at[3] = { b->low[0] + x - halo[0], b->low[1] + y - halo[1],
          b->low[2] + z - halo[2] };
        visit(work, (size_t)x + (size_t)b->size[0] * ((size_t)y + (size_t)b->size[1] * (size_t)z),
          at, user);
      }
    }
  }
}

static void count_voxel(tile_work* work, size_t in_block, const int32_t at[3], void* user)
{
  double weight = work->mask[in_block];
  for (int k = 0; k < 3; ++k)
  {
    const int32_t image = work->origin[k] + at[k];
    weight *= image == 0 || image == work->plan->map->dims[k] - 1 ? 0.5 : 1;
  }
  *(double*)user += weight;
}

static size_t slot_in_tile(const int32_t at[3])
{
  return (size_t)at[0] | (size_t)at[1] << 5 | (size_t)at[2] << 10;
}

static void note_thin(tile_work* work, size_t in_block, const int32_t at[3], void* user)
{
  if (work->bytes[in_block])
  {
    work->thin[slot_in_tile(at)] = *(const uint16_t*)user;
  }
}

static void fill_block(tile_work* work, const block* b)
{
  const mlim_indicator_plan* plan = work->plan;
  const size_t count = block_count(b);
  if (plan->options.method == MLIM_INDICATOR_DISTANCE)
  {
    mlim_distance_signed(&plan->cost, b->size, work->mask, work->scratch, work->values);
  }
  else
  {
    for (size_t i = 0; i < count; ++i)
    {
      work->values[i] = work->mask[i];
    }
  }
  if (plan->kernels[0].radius + plan->kernels[1].radius + plan->kernels[2].radius > 0)
  {
    mlim_kernel_apply(plan->kernels, b->size, work->values, work->scratch);
  }
  mlim_diffusion_run(&plan->diffusion, b->size, work->values, work->scratch);
  const float margin = ROUNDING * (plan->ceiling - plan->floor);
  for (size_t i = 0; i < count; ++i)
  {
    const float v = work->values[i];
    work->values[i] = v < plan->floor + margin     ? plan->floor
                      : v > plan->ceiling - margin ? plan->ceiling
                                                   : v;
  }
}

/* ---- bricks ---- */

/* A brick's points beyond the image: no value that the image does not have. */
static void fill_beyond(
  const tile_work* work, const int32_t brick[3], float value, float values[MLIM_BRICK_POINTS])
{
  for (int32_t slot = 0; slot < MLIM_BRICK_POINTS; ++slot)
  {
    const int is_beyond = 8 * brick[0] + (slot & 7) >= work->core[0] ||
                          8 * brick[1] + (slot >> 3 & 7) >= work->core[1] ||
                          8 * brick[2] + (slot >> 6) >= work->core[2];
    values[slot] = is_beyond ? value : values[slot];
  }
}

/* Copies a brick's part of the block; what the block does not hold is at the floor. */
static int cut_brick(tile_work* work, uint16_t label, const block* b, const int32_t brick[3])
{
  const int32_t* halo = work->plan->halo;
  const float floor = work->plan->floor;
  float values[MLIM_BRICK_POINTS];
  float first = floor;
  int is_uniform = 1;
  int has_label = 0;
  int has_any = 0;
  for (int32_t slot = 0; slot < MLIM_BRICK_POINTS; ++slot)
  {
    const int32_t at[3] = { 8 * brick[0] + (slot & 7), 8 * brick[1] + (slot >> 3 & 7),
      8 * brick[2] + (slot >> 6) };
    values[slot] = floor;
    if (at[0] >= work->core[0] || at[1] >= work->core[1] || at[2] >= work->core[2])
    {
      continue;
    }
    const int32_t in[3] = { at[0] + halo[0] - b->low[0], at[1] + halo[1] - b->low[1],
      at[2] + halo[2] - b->low[2] };
    if (in[0] >= 0 && in[1] >= 0 && in[2] >= 0 && in[0] < b->size[0] && in[1] < b->size[1] &&
        in[2] < b->size[2])
    {
      values[slot] =
        work->values[(size_t)in[0] +
                     (size_t)b->size[0] * ((size_t)in[1] + (size_t)b->size[1] * (size_t)in[2])];
      has_label |= work->map[(size_t)(at[0] + halo[0]) +
                             (size_t)work->region[0] *
                               ((size_t)(at[1] + halo[1]) +
                                 (size_t)work->region[1] * (size_t)(at[2] + halo[2]))] == label;
    }
    first = has_any ? first : values[slot];
    has_any = 1;
    is_uniform &= values[slot] == first;
  }
  if (is_uniform && first == floor && !has_label)
  {
    return 1;
  }
  fill_beyond(work, brick, first, values);
  /* A label that is at the floor where the map has it may have to be brought back. */
  const int is_single = is_uniform && first != floor;
  values[0] = is_single ? first : values[0];
  const size_t at = (size_t)(brick[0] | brick[1] << 2 | brick[2] << 4);
  return mlim_brick_add(&work->writer, label, at, values, is_single);
}

static int make_label(tile_work* work, const tile_label* label, double* voxels)
{
  const mlim_indicator_options* options = &work->plan->options;
  block b;
  if (!place_block(work, label, &b))
  {
    return 1;
  }
  read_mask(work, label->label, &b);
  if (options->median_radius > 0)
  {
    /* Two blocks of floats hold two of counts. */
    mlim_morphology_median(options->median_radius, b.size, work->mask, (int32_t*)work->scratch);
  }
  visit_core(work, &b, count_voxel, voxels);
  if (options->keeps_thin &&
      mlim_morphology_thin(b.size, work->mask, work->bytes + block_count(&b), work->bytes) > 0)
  {
    uint16_t name = label->label;
    visit_core(work, &b, note_thin, &name);
  }
  if (options->dilate_radius > 0)
  {
    mlim_morphology_dilate(options->dilate_radius, b.size, work->mask, work->bytes);
  }
  fill_block(work, &b);
  int is_ok = 1;
  for (int32_t z = 0; z < work->bricks[2] && is_ok; ++z)
  {
    for (int32_t y = 0; y < work->bricks[1] && is_ok; ++y)
    {
      for (int32_t x = 0; x < work->bricks[0] && is_ok; ++x)
      {
        is_ok = cut_brick(work, label->label, &b, (const int32_t[3]){ x, y, z });
      }
    }
  }
  return is_ok;
}

/* Only one label near: its indicator is at the ceiling in all of the tile. */
static int make_uniform(tile_work* work, double* voxels)
{
  const float ceiling = work->plan->ceiling;
  double weight = 1;
  for (int k = 0; k < 3; ++k)
  {
    const int32_t last = work->plan->map->dims[k] - 1;
    weight *= work->core[k] -
              0.5 * ((work->origin[k] == 0) + (work->origin[k] + work->core[k] - 1 == last));
  }
  *voxels += weight;
  int is_ok = 1;
  for (size_t brick = 0; brick < MLIM_TILE_BRICKS && is_ok; ++brick)
  {
    const int32_t at[3] = { (int32_t)brick & 3, (int32_t)brick >> 2 & 3, (int32_t)brick >> 4 };
    if (at[0] < work->bricks[0] && at[1] < work->bricks[1] && at[2] < work->bricks[2])
    {
      is_ok = mlim_brick_add(&work->writer, work->labels[0].label, brick, &ceiling, 1);
    }
  }
  return is_ok;
}

/* ---- thin parts ---- */

/* Gives thin parts the lead that their voxels have before smoothing. */
static void lift_thin(tile_work* work, float unit)
{
  for (int32_t z = 0; z < work->core[2]; ++z)
  {
    for (int32_t y = 0; y < work->core[1]; ++y)
    {
      for (int32_t x = 0; x < work->core[0]; ++x)
      {
        const int32_t at[3] = { x, y, z };
        const uint16_t label = work->thin[slot_in_tile(at)];
        if (label != NOBODY)
        {
          mlim_brick_lead(work->writer.out, (size_t)(x >> 3 | (y >> 3) << 2 | (z >> 3) << 4),
            (size_t)((x & 7) | (y & 7) << 3 | (z & 7) << 6), label, unit);
        }
      }
    }
  }
}

/* ---- all of it ---- */

static int open_work(tile_work* work, const mlim_indicators* indicators, const int32_t tile[3])
{
  size_t points = 1;
  for (int k = 0; k < 3; ++k)
  {
    work->origin[k] = MLIM_TILE * tile[k];
    const int32_t left = indicators->dims[k] - work->origin[k];
    work->core[k] = left < MLIM_TILE ? left : MLIM_TILE;
    work->region[k] = work->core[k] + 2 * work->plan->halo[k];
    work->bricks[k] = (work->core[k] + MLIM_BRICK - 1) / MLIM_BRICK;
    points *= (size_t)work->region[k];
  }
  work->map = mlim_allocate(points, sizeof *work->map);
  work->values = mlim_allocate(points, sizeof *work->values);
  work->scratch = mlim_allocate(2 * points, sizeof *work->scratch);
  work->mask = mlim_allocate(points, 1);
  work->bytes = mlim_allocate(2 * points, 1);
  work->thin = mlim_allocate(MLIM_TILE_POINTS, sizeof *work->thin);
  if (work->map == NULL || work->values == NULL || work->scratch == NULL || work->mask == NULL ||
      work->bytes == NULL || work->thin == NULL)
  {
    return 0;
  }
  memset(work->thin, 0xff, MLIM_TILE_POINTS * sizeof *work->thin);
  return 1;
}

static int make_all(tile_work* work)
{
  mlim_tile* tile = work->writer.out;
  if (!find_labels(work))
  {
    return 0;
  }
  tile->voxels = mlim_allocate_zeroed(work->label_count, sizeof *tile->voxels);
  if (tile->voxels == NULL)
  {
    return 0;
  }
  tile->voxels_count = work->label_count;
  int is_ok = 1;
  for (size_t n = 0; n < work->label_count && is_ok; ++n)
  {
    tile->voxels[n].label = work->labels[n].label;
    is_ok = work->label_count == 1 ? make_uniform(work, &tile->voxels[n].count)
                                   : make_label(work, &work->labels[n], &tile->voxels[n].count);
  }
  return is_ok;
}

int mlim_indicators_make_tile(const mlim_indicator_plan* plan, const mlim_indicators* indicators,
  const int32_t tile[3], mlim_tile* out)
{
  tile_work work = { .plan = plan, .writer = { .out = out } };
  int is_ok = open_work(&work, indicators, tile);
  if (is_ok)
  {
    read_map(&work);
    is_ok = make_all(&work) && mlim_brick_finish(&work.writer);
  }
  if (is_ok && plan->options.keeps_thin)
  {
    lift_thin(&work, indicators->unit);
  }
  mlim_release(work.map);
  mlim_release(work.labels);
  mlim_release(work.values);
  mlim_release(work.scratch);
  mlim_release(work.mask);
  mlim_release(work.bytes);
  mlim_release(work.thin);
  mlim_release(work.writer.entries);
  return is_ok;
}
