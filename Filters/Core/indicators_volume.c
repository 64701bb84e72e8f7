#include "indicators_volume.h"

#include "memory.h"
#include "status.h"

#include <math.h>
#include <string.h>

enum
{
  SIDE = MLIM_BRICK + 1, /* points along a window: a brick and the first points of the next ones */
  WINDOW = SIDE * SIDE * SIDE,
  PARTS = 4,   /* of a layer of bricks: what one thread works on */
  SAMPLES = 8, /* of a mixed cell: the middles of its eighths */
  ROUNDS = 5   /* each takes the difference to about a fifth */
};

/* A sample stands for an eighth of a cell, in which the lead over the next label changes by about this
   part of the unit to either side. Where the lead is smaller both labels have a share of it, so that
   volumes change smoothly with the constants, also where an interface is parallel to the grid. */
static const double NEAR_PART = 0.5;

/* What one part of a layer of bricks adds up; one of each for a label. */
typedef struct part_sums
{
  double* volume; /* in voxels */
  double* near;   /* samples near the interface, in voxels */
  unsigned char* has;
  int has_failed;
} part_sums;

typedef struct measure_job
{
  const mlim_indicators* indicators;
  const float* shift; /* a label: the constant so far */
  part_sums* parts;
} measure_job;

/* One brick's points, those of the next bricks at its far faces among them. */
typedef struct window
{
  uint16_t* labels;
  size_t label_count, label_capacity;
  float* values; /* WINDOW a label */
  size_t value_capacity;
  uint16_t winners[WINDOW]; /* indices into labels */
  int32_t cells[3];         /* cells that have all their corners in the image */
} window;

static int list_labels(const measure_job* job, const int32_t brick[3], window* w)
{
  w->label_count = 0;
  for (int n = 0; n < 8; ++n)
  {
    const int32_t at[3] = { brick[0] + (n & 1), brick[1] + (n >> 1 & 1), brick[2] + (n >> 2) };
    const int32_t* bricks = job->indicators->bricks;
    if (at[0] >= bricks[0] || at[1] >= bricks[1] || at[2] >= bricks[2])
    {
      continue;
    }
    const mlim_brick_list list = mlim_indicators_brick(job->indicators, at);
    if (mlim_reserve(
          &w->labels, &w->label_capacity, w->label_count + list.count, sizeof *w->labels))
    {
      return 0;
    }
    const int32_t* dims = job->indicators->dims;
    const size_t point =
      (size_t)(8 * at[0]) +
      (size_t)dims[0] * ((size_t)(8 * at[1]) + (size_t)dims[1] * (size_t)(8 * at[2]));
    w->label_count = mlim_indicators_list(job->indicators, point, w->labels, w->label_count);
  }
  return mlim_reserve(&w->values, &w->value_capacity, w->label_count * WINDOW, sizeof *w->values) ==
         0;
}

static void read_values(const measure_job* job, const int32_t brick[3], size_t label, window* w)
{
  const mlim_indicators* in = job->indicators;
  const float shift = job->shift[w->labels[label]];
  float* out = w->values + label * WINDOW;
  for (int32_t z = 0; z <= w->cells[2]; ++z)
  {
    for (int32_t y = 0; y <= w->cells[1]; ++y)
    {
      double row[SIDE];
      const size_t first =
        (size_t)(8 * brick[0]) +
        (size_t)in->dims[0] *
          ((size_t)(8 * brick[1] + y) + (size_t)in->dims[1] * (size_t)(8 * brick[2] + z));
      mlim_indicators_row(in, w->labels[label], first, (size_t)w->cells[0] + 1, row);
      for (int32_t x = 0; x <= w->cells[0]; ++x)
      {
        const float v = (float)row[x];
        out[x + SIDE * (y + SIDE * z)] = v > in->floor ? v + shift : v;
      }
    }
  }
}

static void find_winners(window* w)
{
  memset(w->winners, 0, sizeof w->winners);
  for (size_t l = 1; l < w->label_count; ++l)
  {
    const float* value = w->values + l * WINDOW;
    for (size_t i = 0; i < WINDOW; ++i)
    {
      w->winners[i] =
        value[i] > w->values[w->winners[i] * (size_t)WINDOW + i] ? (uint16_t)l : w->winners[i];
    }
  }
}

static int read_window(const measure_job* job, const int32_t brick[3], window* w)
{
  for (int k = 0; k < 3; ++k)
  {
    const int32_t left = job->indicators->dims[k] - 1 - 8 * brick[k];
    w->cells[k] = left < MLIM_BRICK ? left : MLIM_BRICK;
  }
  if (!list_labels(job, brick, w))
  {
    return 0;
  }
  memset(w->values, 0, w->label_count * WINDOW * sizeof *w->values);
  for (size_t l = 0; l < w->label_count; ++l)
  {
    read_values(job, brick, l, w);
  }
  find_winners(w);
  return 1;
}

/* The middles of the eighths of a cell, from its corner values. */
static void sample_cell(const float* value, float out[SAMPLES])
{
  float edge[8];
  float face[8];
  for (int c = 0; c < 8; ++c)
  {
    const float near = value[(c & 1) + SIDE * ((c >> 1 & 1) + SIDE * (c >> 2))];
    const float far = value[(~c & 1) + SIDE * ((c >> 1 & 1) + SIDE * (c >> 2))];
    edge[c] = 0.75F * near + 0.25F * far;
  }
  for (int c = 0; c < 8; ++c)
  {
    face[c] = 0.75F * edge[c] + 0.25F * edge[c ^ 2];
  }
  for (int c = 0; c < 8; ++c)
  {
    out[c] = 0.75F * face[c] + 0.25F * face[c ^ 4];
  }
}

static void measure_cell(const measure_job* job, const window* w, size_t first, part_sums* sums)
{
  float best[SAMPLES];
  float second[SAMPLES];
  size_t winner[SAMPLES] = { 0 };
  size_t next[SAMPLES] = { 0 };
  sample_cell(w->values + first, best);
  for (int s = 0; s < SAMPLES; ++s)
  {
    second[s] = job->indicators->floor;
  }
  for (size_t l = 1; l < w->label_count; ++l)
  {
    float value[SAMPLES];
    sample_cell(w->values + l * WINDOW + first, value);
    for (int s = 0; s < SAMPLES; ++s)
    {
      if (value[s] > best[s])
      {
        second[s] = best[s];
        next[s] = winner[s];
        best[s] = value[s];
        winner[s] = l;
      }
      else if (value[s] > second[s])
      {
        second[s] = value[s];
        next[s] = l;
      }
    }
  }
  const double width = NEAR_PART * (double)job->indicators->unit;
  for (int s = 0; s < SAMPLES; ++s)
  {
    const double lead = (double)(best[s] - second[s]) / width;
    const int is_near = lead < 1;
    const double part = (is_near ? 0.5 + 0.5 * lead : 1) / SAMPLES;
    sums->volume[w->labels[winner[s]]] += part;
    sums->volume[w->labels[next[s]]] += 1.0 / SAMPLES - part;
    sums->near[w->labels[winner[s]]] += is_near ? 1.0 / SAMPLES : 0;
    sums->near[w->labels[next[s]]] += is_near ? 1.0 / SAMPLES : 0;
  }
}

static void measure_window(const measure_job* job, const window* w, part_sums* sums)
{
  for (int32_t z = 0; z <= w->cells[2]; ++z)
  {
    for (int32_t y = 0; y <= w->cells[1]; ++y)
    {
      for (int32_t x = 0; x <= w->cells[0]; ++x)
      {
        const size_t first = (size_t)(x + SIDE * (y + SIDE * z));
        sums->has[w->labels[w->winners[first]]] = 1;
        if (x == w->cells[0] || y == w->cells[1] || z == w->cells[2])
        {
          continue;
        }
        int differs = 0;
        for (int c = 1; c < 8; ++c)
        {
          const int corner = (c & 1) + SIDE * ((c >> 1 & 1) + SIDE * (c >> 2));
          differs |= w->winners[first + (size_t)corner] != w->winners[first];
        }
        if (differs)
        {
          measure_cell(job, w, first, sums);
        }
        else
        {
          sums->volume[w->labels[w->winners[first]]] += 1;
        }
      }
    }
  }
}

static void part_body(void* data, size_t begin, size_t end)
{
  const measure_job* job = (const measure_job*)data;
  const int32_t* bricks = job->indicators->bricks;
  window w = { 0 };
  for (size_t n = begin; n < end; ++n)
  {
    part_sums* sums = &job->parts[n];
    const int32_t part = (int32_t)(n % PARTS);
    for (int32_t y = bricks[1] * part / PARTS; y < bricks[1] * (part + 1) / PARTS; ++y)
    {
      for (int32_t x = 0; x < bricks[0] && !sums->has_failed; ++x)
      {
        const int32_t brick[3] = { x, y, (int32_t)(n / PARTS) };
        sums->has_failed |= !read_window(job, brick, &w);
        if (!sums->has_failed)
        {
          measure_window(job, &w, sums);
        }
      }
    }
  }
  mlim_release(w.labels);
  mlim_release(w.values);
}

/* ---- all parts ---- */

static void free_parts(part_sums* parts, size_t count)
{
  for (size_t n = 0; parts != NULL && n < count; ++n)
  {
    mlim_release(parts[n].volume);
    mlim_release(parts[n].near);
    mlim_release(parts[n].has);
  }
  mlim_release(parts);
}

static part_sums* make_parts(size_t count, size_t labels)
{
  part_sums* parts = mlim_allocate_zeroed(count, sizeof *parts);
  int has_failed = parts == NULL;
  for (size_t n = 0; n < count && !has_failed; ++n)
  {
    parts[n].volume = mlim_allocate_zeroed(labels, sizeof *parts[n].volume);
    parts[n].near = mlim_allocate_zeroed(labels, sizeof *parts[n].near);
    parts[n].has = mlim_allocate_zeroed(labels, 1);
    has_failed = parts[n].volume == NULL || parts[n].near == NULL || parts[n].has == NULL;
  }
  if (has_failed)
  {
    free_parts(parts, count);
    return NULL;
  }
  return parts;
}

/* The sums of all parts go into the first. */
static mlim_status measure(measure_job* job, double from, double to, mlim_context* context)
{
  const size_t parts = PARTS * (size_t)job->indicators->bricks[2];
  const size_t labels = (size_t)job->indicators->label_count;
  for (size_t n = 0; n < parts; ++n)
  {
    memset(job->parts[n].volume, 0, labels * sizeof *job->parts[n].volume);
    memset(job->parts[n].near, 0, labels * sizeof *job->parts[n].near);
    memset(job->parts[n].has, 0, labels);
  }
  const mlim_status status = mlim_parallel_stage(context, &(mlim_stage_work){ .count = parts,
                                                            .body = part_body,
                                                            .job = job,
                                                            .stage = MLIM_STAGE_INDICATORS,
                                                            .from = from,
                                                            .to = to });
  if (status != MLIM_OK)
  {
    return status;
  }
  part_sums* all = &job->parts[0];
  for (size_t n = 1; n < parts; ++n)
  {
    for (size_t l = 0; l < labels; ++l)
    {
      all->volume[l] += job->parts[n].volume[l];
      all->near[l] += job->parts[n].near[l];
      all->has[l] |= job->parts[n].has[l];
    }
    all->has_failed |= job->parts[n].has_failed;
  }
  return all->has_failed ? mlim_fail_memory(context, "the volumes of the labels") : MLIM_OK;
}

static size_t tile_count(const mlim_indicators* indicators)
{
  return (size_t)indicators->tiles[0] * (size_t)indicators->tiles[1] * (size_t)indicators->tiles[2];
}

static void count_voxels(const mlim_indicators* indicators, double* voxels)
{
  for (size_t t = 0; t < tile_count(indicators); ++t)
  {
    const mlim_tile* tile = &indicators->tile[t];
    for (size_t n = 0; n < tile->voxels_count; ++n)
    {
      voxels[tile->voxels[n].label] += tile->voxels[n].count;
    }
  }
}

/* A constant b changes the share of each sample near the interface by b / (2 width). The neighbours
   move the other way, so half of Newton's step is right. */
static void correct(const mlim_indicators* indicators, const part_sums* sums, const double* voxels,
  double most, float* shift)
{
  const double width = NEAR_PART * (double)indicators->unit;
  for (int32_t l = 0; l < indicators->label_count; ++l)
  {
    if (sums->near[l] > 0)
    {
      const double step = width * (voxels[l] - sums->volume[l]) / sums->near[l];
      const double next = (double)shift[l] + step;
      shift[l] = (float)(next > most ? most : next < -most ? -most : next);
    }
  }
}

static void add_shifts(mlim_indicators* indicators, const float* shift)
{
  for (size_t t = 0; t < tile_count(indicators); ++t)
  {
    mlim_tile* tile = &indicators->tile[t];
    for (size_t n = 0; n < tile->first[MLIM_TILE_BRICKS]; ++n)
    {
      const mlim_brick_entry* entry = &tile->entries[n];
      float* value = tile->values + entry->first;
      for (size_t i = 0; i < (entry->is_uniform ? 1 : MLIM_BRICK_POINTS); ++i)
      {
        value[i] += value[i] > indicators->floor ? shift[entry->label] : 0;
      }
    }
  }
}

mlim_status mlim_indicators_settle(
  mlim_indicators* indicators, double most, double from, double to, mlim_context* context)
{
  const size_t labels = (size_t)indicators->label_count;
  const size_t count = PARTS * (size_t)indicators->bricks[2];
  const int rounds = most > 0 ? ROUNDS : 0;
  double* voxels = mlim_allocate_zeroed(labels, sizeof *voxels);
  float* shift = mlim_allocate_zeroed(labels, sizeof *shift);
  part_sums* parts = make_parts(count, labels);
  mlim_status status = MLIM_OK;
  if (voxels == NULL || shift == NULL || parts == NULL)
  {
    status = mlim_fail_memory(context, "the volumes of the labels");
    goto done;
  }
  count_voxels(indicators, voxels);
  measure_job job = { .indicators = indicators, .shift = shift, .parts = parts };
  for (int round = 0; round <= rounds && status == MLIM_OK; ++round)
  {
    const double begin = from + (to - from) * round / (rounds + 1);
    const double end = from + (to - from) * (round + 1) / (rounds + 1);
    status = measure(&job, begin, end, context);
    if (status == MLIM_OK && round < rounds)
    {
      correct(indicators, parts, voxels, most, shift);
    }
  }
  if (status == MLIM_OK)
  {
    add_shifts(indicators, shift);
    memcpy(indicators->has, parts[0].has, labels);
  }
done:
  mlim_release(voxels);
  mlim_release(shift);
  free_parts(parts, count);
  return status;
}
