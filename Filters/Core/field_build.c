/* Builds the field's index from the winners at the grid points: the words of all cells, and the clearances
   for skipping empty space. */
#include "clearance.h"
#include "field_cell.h"
#include "memory.h"
#include "status.h"
#include "vector.h"
#include "winners.h"

#include <math.h>

typedef struct build_job
{
  mlim_field_source source;
  mlim_field* field;
} build_job;

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

/* A brick on its way into a layer. */
typedef struct brick_work
{
  int32_t at[3];
  const size_t* corner; /* borrowed; the offsets of a cell's corners */
  uint32_t words[BRICK_CELLS];
  uint64_t mixed; /* a bit a slot */
  int is_plain;   /* uniform, with one label, all of it */
} brick_work;

/* Its cell in a slot. 0: the brick sticks out of the grid there. */
static int find_cell(
  const mlim_field* field, const brick_work* work, uint32_t slot, int32_t cell[3])
{
  cell[0] = BRICK * work->at[0] + (int32_t)(slot & 3);
  cell[1] = BRICK * work->at[1] + (int32_t)(slot >> 2 & 3);
  cell[2] = BRICK * work->at[2] + (int32_t)(slot >> 4);
  return cell[0] < field->grid.cells[0] && cell[1] < field->grid.cells[1] &&
         cell[2] < field->grid.cells[2];
}

static size_t first_corner(const mlim_field* field, const int32_t cell[3])
{
  return (size_t)cell[0] + (size_t)field->grid.dims[0] *
                             ((size_t)cell[1] + (size_t)field->grid.dims[1] * (size_t)cell[2]);
}

/* Whether all grid points of a brick that does not stick out have one label. */
static int has_one_label(const mlim_field* field, const int32_t first[3])
{
  const uint16_t* win = field->winners + first_corner(field, first);
  const size_t nx = (size_t)field->grid.dims[0];
  const size_t slice = nx * (size_t)field->grid.dims[1];
  int differs = 0;
  for (size_t row = 0; row < BRICK_SIDE * BRICK_SIDE && !differs; ++row)
  {
    const uint16_t* at = win + nx * (row % BRICK_SIDE) + slice * (row / BRICK_SIDE);
    for (size_t x = 0; x < BRICK_SIDE; ++x)
    {
      differs |= (at[x] ^ win[0]) & ~MLIM_TIED_FLAG;
    }
  }
  return !differs;
}

/* The same result as tell_mixed, for most bricks of an image. */
static int tell_plain(const build_job* job, brick_work* work)
{
  const mlim_field* field = job->field;
  const int32_t* cells = field->grid.cells;
  const int32_t first[3] = { BRICK * work->at[0], BRICK * work->at[1], BRICK * work->at[2] };
  if (first[0] + BRICK > cells[0] || first[1] + BRICK > cells[1] || first[2] + BRICK > cells[2] ||
      !has_one_label(field, first))
  {
    return 0;
  }
  work->mixed = 0;
  work->is_plain = 1;
  work->words[0] = (uint32_t)(field->winners[first_corner(field, first)] & ~MLIM_TIED_FLAG);
  for (int32_t row = 0; row < BRICK * BRICK; ++row)
  {
    const size_t y = (size_t)(first[1] + row % BRICK);
    const size_t z = (size_t)(first[2] + row / BRICK);
    memset(
      job->field->clearances + (size_t)first[0] + (size_t)cells[0] * (y + (size_t)cells[1] * z),
      MAX_CLEARANCE, BRICK);
  }
  return 1;
}

/* The words of uniform cells, and which ones are mixed. */
static void tell_mixed(const build_job* job, brick_work* work)
{
  const mlim_field* field = job->field;
  uint32_t uniform = UINT32_MAX;
  work->mixed = 0;
  work->is_plain = 1;
  for (uint32_t slot = 0; slot < BRICK_CELLS; ++slot)
  {
    int32_t cell[3];
    work->words[slot] = 0;
    if (!find_cell(field, work, slot, cell))
    {
      continue;
    }
    const uint16_t* win = field->winners + first_corner(field, cell);
    int differs = 0;
    for (int c = 1; c < 8; ++c)
    {
      differs |= (win[work->corner[c]] ^ win[0]) & ~MLIM_TIED_FLAG;
    }
    work->mixed |= (uint64_t)(differs != 0) << slot;
    work->words[slot] = differs ? 0 : (uint32_t)(win[0] & ~MLIM_TIED_FLAG);
    uniform = uniform == UINT32_MAX ? work->words[slot] : uniform;
    work->is_plain &= !differs && work->words[slot] == uniform;
    const size_t at =
      (size_t)cell[0] + (size_t)field->grid.cells[0] *
                          ((size_t)cell[1] + (size_t)field->grid.cells[1] * (size_t)cell[2]);
    job->field->clearances[at] = differs ? 0 : MAX_CLEARANCE;
  }
}

/* The words of mixed cells. */
static void add_mixed(
  const build_job* job, mlim_field_brick* brick, field_layer* layer, brick_work* work)
{
  const mlim_field_source* source = &job->source;
  if (source->samples->grid->indicators == NULL &&
      mlim_field_brick_read(source, work->at, work->mixed, brick))
  {
    layer->has_failed = 1;
    return;
  }
  for (uint32_t slot = 0; slot < BRICK_CELLS && !layer->has_failed; ++slot)
  {
    int32_t cell[3];
    if (work->mixed >> slot & 1 && find_cell(job->field, work, slot, cell))
    {
      const mlim_field_place place = {
        .first = first_corner(job->field, cell), .corner = work->corner, .slot = slot
      };
      work->words[slot] = mlim_field_add_mixed(source, brick, layer, &place);
    }
  }
}

static void fill_brick(const build_job* job, mlim_field_brick* brick, brick_work* work)
{
  mlim_field* field = job->field;
  field_layer* layer = &field->layers[work->at[2]];
  if (!tell_plain(job, work))
  {
    tell_mixed(job, work);
  }
  if (work->mixed != 0)
  {
    add_mixed(job, brick, layer, work);
  }
  if (layer->has_failed)
  {
    return;
  }
  uint32_t* coarse =
    &field->coarse[(size_t)work->at[0] +
                   (size_t)field->bricks[0] *
                     ((size_t)work->at[1] + (size_t)field->bricks[1] * (size_t)work->at[2])];
  if (work->is_plain)
  {
    *coarse = work->words[0];
    return;
  }
  if (mlim_reserve(
        &layer->words, &layer->brick_capacity, layer->brick_count + 1, sizeof work->words))
  {
    layer->has_failed = 1;
    return;
  }
  memcpy(layer->words + layer->brick_count * BRICK_CELLS, work->words, sizeof work->words);
  *coarse = (uint32_t)MIXED | (uint32_t)layer->brick_count;
  ++layer->brick_count;
}

static void layer_body(void* data, size_t begin, size_t end)
{
  const build_job* job = (const build_job*)data;
  size_t corner[8];
  corner_offsets(job->field, corner);
  mlim_field_brick brick;
  const int has_brick = mlim_field_brick_create(&job->source, &brick) == MLIM_OK;
  for (size_t z = begin; z < end; ++z)
  {
    field_layer* layer = &job->field->layers[z];
    layer->list = mlim_allocate((size_t)job->source.samples->label_count + 1, sizeof *layer->list);
    layer->has_failed = layer->list == NULL || !has_brick;
    for (int32_t y = 0; y < job->field->bricks[1] && !layer->has_failed; ++y)
    {
      for (int32_t x = 0; x < job->field->bricks[0] && !layer->has_failed; ++x)
      {
        brick_work work = { .at = { x, y, (int32_t)z }, .corner = corner };
        fill_brick(job, &brick, &work);
      }
    }
    mlim_release(layer->list);
    layer->list = NULL;
  }
  mlim_field_brick_free(&brick);
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

/* The labels of all grid points, and where arrays matter. */
static mlim_status find_points(mlim_samples* samples, mlim_context* context, mlim_field* field,
  mlim_peaks* peaks, mlim_plateau* plateau)
{
  const mlim_status status = mlim_winners_find(samples, context, field->winners, peaks);
  return status != MLIM_OK ? status
                           : mlim_plateau_find(samples, peaks, context, field->winners, plateau);
}

static mlim_status build_index(build_job* job, mlim_context* context)
{
  mlim_field* field = job->field;
  mlim_status status = mlim_progress(context, MLIM_STAGE_FIELD, 0.4);
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
  return status != MLIM_OK ? status : mlim_clearance_measure(field, context);
}

mlim_status mlim_field_create(const mlim_grid* grid, mlim_context* context, mlim_field** out)
{
  if (out == NULL || grid == NULL)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT, "The grid or its result is NULL.");
  }
  *out = NULL;
  mlim_samples samples;
  mlim_peaks peaks = { 0 };
  mlim_plateau plateau = { 0 };
  build_job job = { 0 };
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
  status = find_points(&samples, context, field, &peaks, &plateau);
  if (status != MLIM_OK)
  {
    goto done;
  }
  job = (build_job){ .source = { &samples, field, &plateau, &peaks }, .field = field };
  field->clearances = mlim_allocate(
    (size_t)field->grid.cells[0] * (size_t)field->grid.cells[1] * (size_t)field->grid.cells[2], 1);
  if (field->clearances == NULL)
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
  mlim_plateau_free(&plateau);
  mlim_peaks_free(&peaks);
  if (status != MLIM_OK)
  {
    mlim_field_free(field);
    return status;
  }
  *out = field;
  return MLIM_OK;
}
