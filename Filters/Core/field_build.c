/* Builds the field's index from the arrays: the winner at every grid point, the words of all cells,
   and the clearances for skipping empty space. */
#include "clearance.h"
#include "field_cell.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>

/* ---- winners ---- */

typedef struct build_job
{
  const mlim_samples* samples;
  mlim_field* field;
  mlim_plateau plateau;
  uint8_t* distance; /* a cell: Chebyshev distance to the nearest mixed one or to the outside */
  int has_failed;
} build_job;

/* One run of points along x whose labels are the same list. */
typedef struct win_run
{
  size_t first, count;
  const uint16_t* labels; /* ascending, at least one */
  size_t label_count;
  double *best, *value; /* scratch, `count` each */
} win_run;

static void win_along(const mlim_samples* samples, const win_run* run, uint16_t* win)
{
  mlim_samples_row(samples, run->labels[0], run->first, run->count, run->best);
  for (size_t x = 0; x < run->count; ++x)
  {
    win[x] = run->labels[0];
  }
  for (size_t n = 1; n < run->label_count; ++n)
  {
    const uint16_t label = run->labels[n];
    mlim_samples_row(samples, label, run->first, run->count, run->value);
    for (size_t x = 0; x < run->count; ++x)
    {
      const int is_better = run->value[x] > run->best[x];
      const int is_tied = run->value[x] == run->best[x];
      run->best[x] = is_better ? run->value[x] : run->best[x];
      win[x] = is_better ? label : is_tied ? (uint16_t)(win[x] | MLIM_TIED_FLAG) : win[x];
    }
  }
}

static int win_slice(const mlim_samples* samples, size_t z, uint16_t* winners)
{
  const size_t nx = (size_t)samples->grid->dims[0];
  const size_t ny = (size_t)samples->grid->dims[1];
  double* best = mlim_allocate(2 * nx, sizeof *best);
  uint16_t* labels = mlim_allocate((size_t)samples->label_count + 1, sizeof *labels);
  const int has_memory = best != NULL && labels != NULL;
  for (size_t y = 0; y < ny && has_memory; ++y)
  {
    win_run run = { .labels = labels, .best = best, .value = best + nx };
    for (size_t x = 0; x < nx; x += run.count)
    {
      run.first = x + nx * (y + ny * z);
      run.count = mlim_samples_run(samples, x);
      run.label_count = mlim_samples_list(samples, &run.first, 1, labels);
      win_along(samples, &run, winners + run.first);
    }
  }
  mlim_release(best);
  mlim_release(labels);
  return !has_memory;
}

static void win_body(void* data, size_t begin, size_t end)
{
  build_job* job = (build_job*)data;
  for (size_t z = begin; z < end; ++z)
  {
    if (win_slice(job->samples, z, job->field->winners))
    {
      job->has_failed = 1;
    }
  }
}

/* ---- bricks ---- */

static void corner_offsets(const mlim_field* field, size_t corner[8])
{
  const size_t nx = (size_t)field->grid.dims[0];
  const size_t slice = nx * (size_t)field->grid.dims[1];
  for (size_t c = 0; c < 8; ++c)
  {
    corner[c] = (c & 1) + nx * (c >> 1 & 1) + slice * (c >> 2 & 1);
  }
}

static void fill_brick(const build_job* job, const int32_t brick[3], const size_t corner[8])
{
  mlim_field* field = job->field;
  field_layer* layer = &field->layers[brick[2]];
  const mlim_field_source source = { job->samples, field, &job->plateau };
  uint32_t words[BRICK_CELLS] = { 0 };
  uint32_t uniform = UINT32_MAX;
  int is_plain = 1;
  for (uint32_t slot = 0; slot < BRICK_CELLS; ++slot)
  {
    const int32_t cell[3] = { 4 * brick[0] + (int32_t)(slot & 3),
      4 * brick[1] + (int32_t)(slot >> 2 & 3), 4 * brick[2] + (int32_t)(slot >> 4) };
    if (cell[0] >= field->grid.cells[0] || cell[1] >= field->grid.cells[1] ||
        cell[2] >= field->grid.cells[2])
    {
      continue;
    }
    const size_t first =
      (size_t)cell[0] + (size_t)field->grid.dims[0] *
                          ((size_t)cell[1] + (size_t)field->grid.dims[1] * (size_t)cell[2]);
    const uint16_t* win = field->winners + first;
    int differs = 0;
    for (int c = 1; c < 8; ++c)
    {
      differs |= (win[corner[c]] ^ win[0]) & ~MLIM_TIED_FLAG;
    }
    words[slot] = differs ? mlim_field_add_mixed(&source, layer, first, corner)
                          : (uint32_t)(win[0] & ~MLIM_TIED_FLAG);
    if (layer->has_failed)
    {
      return;
    }
    uniform = uniform == UINT32_MAX ? words[slot] : uniform;
    is_plain &= !differs && words[slot] == uniform;
    const size_t at =
      (size_t)cell[0] + (size_t)field->grid.cells[0] *
                          ((size_t)cell[1] + (size_t)field->grid.cells[1] * (size_t)cell[2]);
    job->distance[at] = differs ? 0 : MAX_CLEARANCE;
  }
  uint32_t* coarse =
    &field->coarse[(size_t)brick[0] +
                   (size_t)field->bricks[0] *
                     ((size_t)brick[1] + (size_t)field->bricks[1] * (size_t)brick[2])];
  if (is_plain)
  {
    *coarse = uniform;
    return;
  }
  if (mlim_reserve(&layer->words, &layer->brick_capacity, layer->brick_count + 1, sizeof words))
  {
    layer->has_failed = 1;
    return;
  }
  memcpy(layer->words + layer->brick_count * BRICK_CELLS, words, sizeof words);
  *coarse = (uint32_t)MIXED | (uint32_t)layer->brick_count;
  ++layer->brick_count;
}

static void layer_body(void* data, size_t begin, size_t end)
{
  const build_job* job = (const build_job*)data;
  size_t corner[8];
  corner_offsets(job->field, corner);
  for (size_t z = begin; z < end; ++z)
  {
    field_layer* layer = &job->field->layers[z];
    layer->list = mlim_allocate((size_t)job->samples->label_count + 1, sizeof *layer->list);
    layer->has_failed = layer->list == NULL;
    for (int32_t y = 0; y < job->field->bricks[1] && !layer->has_failed; ++y)
    {
      for (int32_t x = 0; x < job->field->bricks[0] && !layer->has_failed; ++x)
      {
        fill_brick(job, (const int32_t[3]){ x, y, (int32_t)z }, corner);
      }
    }
    mlim_release(layer->list);
    layer->list = NULL;
  }
}

/* ---- all of it ---- */

double mlim_spacing_unit(const double spacing[3])
{
  if (spacing[0] == spacing[1] && spacing[1] == spacing[2])
  {
    return spacing[0];
  }
  /* Of numbers near 1, so that powers of two for a spacing give all its digits. */
  int exponent;
  (void)frexp(spacing[0], &exponent);
  double volume = 1;
  for (int k = 0; k < 3; ++k)
  {
    volume *= ldexp(spacing[k], 1 - exponent);
  }
  return ldexp(cbrt(volume), exponent - 1);
}

static mlim_status start_field(
  const mlim_samples* samples, mlim_context* context, mlim_field* field)
{
  const mlim_grid* grid = samples->grid;
  mlim_field_grid* g = &field->grid;
  size_t points = 1;
  size_t bricks = 1;
  for (int k = 0; k < 3; ++k)
  {
    g->dims[k] = grid->dims[k];
    g->cells[k] = grid->dims[k] - 1;
    g->spacing[k] = grid->spacing[k];
    g->size[k] = g->cells[k] * g->spacing[k];
    g->inverse_spacing[k] = 1 / g->spacing[k];
    field->bricks[k] = (g->cells[k] + BRICK - 1) / BRICK;
    points *= (size_t)g->dims[k];
    bricks *= (size_t)field->bricks[k];
  }
  g->unit = mlim_spacing_unit(g->spacing);
  g->min_spacing = mlim_min(g->spacing[0], mlim_min(g->spacing[1], g->spacing[2]));
  field->outside_label = samples->outside_label;
  field->label_count =
    samples->label_count + (samples->outside_label == samples->label_count ? 1 : 0);
  field->layer_count = (size_t)field->bricks[2];
  field->ids = mlim_allocate((size_t)field->label_count, sizeof *field->ids);
  field->winners = mlim_allocate(points, sizeof *field->winners);
  field->coarse = mlim_allocate_zeroed(bricks, sizeof *field->coarse);
  field->layers = mlim_allocate_zeroed(field->layer_count, sizeof *field->layers);
  if (field->ids == NULL || field->winners == NULL || field->coarse == NULL ||
      field->layers == NULL)
  {
    return mlim_fail_memory(context, "the field's index");
  }
  for (int32_t l = 0; l < field->label_count; ++l)
  {
    const int32_t a = l - samples->first_array;
    field->ids[l] = a >= 0 && (size_t)a < grid->array_count ? grid->arrays[a].id : 0;
  }
  field->ids[field->outside_label] = 0;
  return MLIM_OK;
}

/* Two labels of one id would be told apart in the mesh and not in its arrays. */
static mlim_status check_ids(
  const mlim_samples* samples, mlim_context* context, const mlim_field* field)
{
  for (int32_t l = 0; l < field->label_count; ++l)
  {
    for (int32_t m = 0; m < l; ++m)
    {
      if (field->ids[l] == field->ids[m])
      {
        char name[64];
        const size_t a = (size_t)(l - samples->first_array);
        mlim_array_name(samples->grid, a < samples->grid->array_count ? a : a - 1, name);
        return mlim_fail(context, MLIM_INVALID_ARGUMENT,
          "The label id %d is used twice (the second time near array \"%s\"); ids have to differ, "
          "and 0 is the background's.",
          (int)field->ids[l], name);
      }
    }
  }
  return MLIM_OK;
}

static mlim_status build_index(build_job* job, mlim_context* context)
{
  mlim_field* field = job->field;
  mlim_status status =
    mlim_parallel_stage(context, &(mlim_stage_work){ .count = (size_t)field->grid.dims[2],
                                   .body = win_body,
                                   .job = job,
                                   .stage = MLIM_STAGE_FIELD,
                                   .from = 0.1,
                                   .to = 0.4 });
  if (status != MLIM_OK)
  {
    return status;
  }
  if (job->has_failed)
  {
    return mlim_fail_memory(context, "the labels of the grid points");
  }
  status = mlim_plateau_find(job->samples, context, field->winners, &job->plateau);
  if (status != MLIM_OK)
  {
    return status;
  }
  status = mlim_progress(context, MLIM_STAGE_FIELD, 0.4);
  if (status != MLIM_OK)
  {
    return status;
  }
  status = mlim_parallel_stage(context, &(mlim_stage_work){ .count = field->layer_count,
                                          .body = layer_body,
                                          .job = job,
                                          .stage = MLIM_STAGE_FIELD,
                                          .from = 0.4,
                                          .to = 0.9 });
  if (status != MLIM_OK)
  {
    return status;
  }
  for (size_t z = 0; z < field->layer_count; ++z)
  {
    if (field->layers[z].has_failed)
    {
      return mlim_fail_memory(context, "the field's mixed cells");
    }
    if (field->layers[z].max_candidates > field->max_candidates)
    {
      field->max_candidates = field->layers[z].max_candidates;
    }
  }
  const size_t points =
    (size_t)field->grid.dims[0] * (size_t)field->grid.dims[1] * (size_t)field->grid.dims[2];
  for (size_t p = 0; p < points; ++p)
  {
    field->winners[p] = (uint16_t)(field->winners[p] & ~MLIM_TIED_FLAG);
  }
  status = mlim_progress(context, MLIM_STAGE_FIELD, 0.9);
  if (status == MLIM_OK)
  {
    mlim_clearance_measure(field, job->distance);
  }
  return status;
}

mlim_status mlim_field_create(const mlim_grid* grid, mlim_context* context, mlim_field** out)
{
  if (out == NULL || grid == NULL)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT, "The grid or its result is NULL.");
  }
  *out = NULL;
  build_job job = { 0 };
  mlim_samples samples;
  mlim_field* field = NULL;
  mlim_status status = mlim_progress(context, MLIM_STAGE_FIELD, 0);
  if (status == MLIM_OK)
  {
    status = mlim_samples_open(grid, context, &samples);
  }
  if (status != MLIM_OK)
  {
    goto done;
  }
  status = MLIM_OUT_OF_MEMORY;
  field = mlim_allocate_zeroed(1, sizeof *field);
  if (field == NULL)
  {
    (void)mlim_fail_memory(context, "the field");
    goto done;
  }
  status = start_field(&samples, context, field);
  if (status == MLIM_OK)
  {
    status = check_ids(&samples, context, field);
  }
  if (status != MLIM_OK)
  {
    goto done;
  }
  job = (build_job){ .samples = &samples, .field = field };
  job.distance = mlim_allocate(
    (size_t)field->grid.cells[0] * (size_t)field->grid.cells[1] * (size_t)field->grid.cells[2], 1);
  if (job.distance == NULL)
  {
    status = mlim_fail_memory(context, "the field's clearances");
    goto done;
  }
  status = build_index(&job, context);
  if (status == MLIM_OK)
  {
    status = mlim_progress(context, MLIM_STAGE_FIELD, 1);
  }
done:
  mlim_plateau_free(&job.plateau);
  mlim_release(job.distance);
  if (status != MLIM_OK)
  {
    mlim_field_free(field);
    return status;
  }
  *out = field;
  return MLIM_OK;
}
