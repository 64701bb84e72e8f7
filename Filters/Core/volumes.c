#include "volumes.h"

#include "ahead.h"
#include "field_index.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <string.h>

typedef struct volume_job
{
  const mlim_field* field;
  size_t label_count;
  size_t* eighths; /* of cells; label_count a slice of cells */
} volume_job;

/* The values a quarter and three quarters of the way between the two of each pair. Done thrice, along x, y and
   z, it makes those at the middles of a cell's eighths of those at its corners. */
static void halve(const double pairs[8], double out[8])
{
  for (int k = 0; k < 4; ++k)
  {
    const double low = pairs[2 * k];
    const double step = pairs[2 * k + 1] - low;
    out[k] = low + 0.25 * step;
    out[4 + k] = low + 0.75 * step;
  }
}

/* As field_mixed_label would tell at each middle, with a third of the work. */
static void add_pair_cell(const uint32_t* entry, size_t* eighths)
{
  double corners[8];
  double values[8];
  for (int c = 0; c < 8; ++c)
  {
    corners[c] = (double)field_float(entry[1 + c]);
  }
  halve(corners, values);
  halve(values, corners);
  halve(corners, values);
  size_t first = 0;
  for (int c = 0; c < 8; ++c)
  {
    first += values[c] >= 0;
  }
  eighths[entry[0] & 0xffffu] += first;
  eighths[entry[0] >> 16] += 8 - first;
}

static void add_mixed_cell(
  const mlim_field* field, const int32_t cell[3], uint32_t word, size_t* eighths)
{
  const uint32_t* entry = field_pool_entry(field, cell, word);
  if (!(word & (uint32_t)MANY))
  {
    add_pair_cell(entry, eighths);
    return;
  }
  for (int c = 0; c < 8; ++c)
  {
    const double at[3] = { c & 1 ? 0.75 : 0.25, c & 2 ? 0.75 : 0.25, c & 4 ? 0.75 : 0.25 };
    ++eighths[field_mixed_label(entry, word, at)];
  }
}

/* The cells of a row that lie in one brick, which begins with this one. */
static void add_brick_row(const mlim_field* field, const int32_t first[3], size_t* eighths)
{
  const uint32_t brick = field->coarse[field_brick_of(field, first)];
  const int32_t left = field->grid.cells[0] - first[0];
  const int32_t count = left < BRICK ? left : BRICK;
  if (!(brick & (uint32_t)MIXED))
  {
    eighths[brick] += 8 * (size_t)count;
    return;
  }
  const uint32_t* words =
    field->layers[first[2] / BRICK].words + (brick & DETAIL) * BRICK_CELLS + field_slot_of(first);
  for (int32_t k = 0; k < count; ++k)
  {
    if (words[k] & (uint32_t)MIXED)
    {
      add_mixed_cell(field, first, words[k], eighths);
    }
    else
    {
      eighths[words[k]] += 8;
    }
  }
}

static void volume_body(void* data, size_t begin, size_t end)
{
  const volume_job* job = (const volume_job*)data;
  const int32_t* cells = job->field->grid.cells;
  for (size_t z = begin; z < end; ++z)
  {
    int32_t cell[3] = { 0, 0, (int32_t)z };
    for (cell[1] = 0; cell[1] < cells[1]; ++cell[1])
    {
      for (cell[0] = 0; cell[0] < cells[0]; cell[0] += BRICK)
      {
        add_brick_row(job->field, cell, job->eighths + z * job->label_count);
      }
    }
  }
}

static size_t sum_slices(const size_t* counts, size_t label, size_t label_count, size_t slices)
{
  size_t sum = 0;
  for (size_t z = 0; z < slices; ++z)
  {
    sum += counts[z * label_count + label];
  }
  return sum;
}

mlim_status mlim_volumes_of_field(const mlim_field* field, mlim_context* context, double* volumes)
{
  const size_t labels = (size_t)mlim_field_label_count(field);
  const size_t slices = (size_t)mlim_field_grid_of(field)->cells[2];
  const double* spacing = mlim_field_grid_of(field)->spacing;
  const int fits = labels < SIZE_MAX / (slices + 1);
  volume_job job = { .field = field,
    .label_count = labels,
    .eighths = fits ? mlim_allocate_zeroed(labels * slices, sizeof *job.eighths) : NULL };
  const mlim_stage_work work = {
    .count = slices, .body = volume_body, .job = &job, .stage = MLIM_STAGE_SURFACE
  };
  const mlim_status status = job.eighths != NULL
                               ? mlim_parallel_stage(context, &work)
                               : mlim_fail_memory(context, "the volumes of the labels");
  for (size_t l = 0; l < labels && status == MLIM_OK; ++l)
  {
    const size_t eighths = sum_slices(job.eighths, l, labels, slices);
    volumes[l] = (double)eighths / 8 * (spacing[0] * spacing[1] * spacing[2]);
  }
  mlim_release(job.eighths);
  return status;
}

/* ---- of the complex ---- */

enum
{
  CELLS_A_PIECE = 1 << 14 /* measured before they are added up, when they are still in the cache */
};

typedef struct cell_job
{
  const mlim_complex* complex;
  const unsigned char* is_wanted; /* a label */
  size_t first;                   /* cell of volumes[0] */
  double* volumes;
} cell_job;

/* Far vertices stand outside the box. */
static int is_measured(const cell_job* job, const mlim_cell* cell)
{
  const int32_t* id = cell->vertices;
  return id[0] >= 0 && job->is_wanted[cell->label] && id[0] >= MLIM_FAR_VERTICES &&
         id[1] >= MLIM_FAR_VERTICES && id[2] >= MLIM_FAR_VERTICES && id[3] >= MLIM_FAR_VERTICES;
}

static double volume_of_cell(const mlim_complex* complex, const mlim_cell* cell)
{
  const int32_t* id = cell->vertices;
  double edge[3][3];
  for (int k = 0; k < 3; ++k)
  {
    mlim_subtract(complex->vertices[id[k + 1]].point, complex->vertices[id[0]].point, edge[k]);
  }
  double normal[3];
  mlim_cross(edge[0], edge[1], normal);
  return mlim_dot(normal, edge[2]) / 6;
}

static void ask_ahead(const cell_job* job, size_t k, size_t end)
{
  if (k + MLIM_CELLS_AHEAD < end)
  {
    const mlim_cell* cell = &job->complex->cells[job->first + k + MLIM_CELLS_AHEAD];
    for (int v = 0; v < 4 && is_measured(job, cell); ++v)
    {
      mlim_prefetch(&job->complex->vertices[cell->vertices[v]]);
    }
  }
}

static void cell_body(void* data, size_t begin, size_t end)
{
  const cell_job* job = (const cell_job*)data;
  for (size_t k = begin; k < end; ++k)
  {
    const mlim_cell* cell = &job->complex->cells[job->first + k];
    ask_ahead(job, k, end);
    job->volumes[k] = is_measured(job, cell) ? volume_of_cell(job->complex, cell) : 0;
  }
}

mlim_status mlim_volumes_of_complex(const mlim_complex* complex, const unsigned char* is_wanted,
  double done, mlim_context* context, double* volumes)
{
  memset(volumes, 0, (size_t)mlim_field_label_count(complex->oracle.field) * sizeof *volumes);
  cell_job job = { .complex = complex,
    .is_wanted = is_wanted,
    .volumes = mlim_allocate(CELLS_A_PIECE, sizeof *job.volumes) };
  mlim_status status =
    job.volumes != NULL ? MLIM_OK : mlim_fail_memory(context, "the volumes of the labels");
  for (; job.first < complex->cell_count && status == MLIM_OK; job.first += CELLS_A_PIECE)
  {
    const size_t left = complex->cell_count - job.first;
    const size_t count = left < CELLS_A_PIECE ? left : CELLS_A_PIECE;
    mlim_parallel_for(context, count, cell_body, &job);
    /* One after the other, whoever measured them: sums depend on their order. */
    for (size_t k = 0; k < count; ++k)
    {
      const mlim_cell* cell = &complex->cells[job.first + k];
      volumes[cell->vertices[0] < 0 ? 0 : cell->label] += job.volumes[k];
    }
    status = mlim_progress(context, MLIM_STAGE_SURFACE, done);
  }
  mlim_release(job.volumes);
  return status;
}
