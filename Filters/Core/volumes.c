#include "volumes.h"

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

static void add_mixed_cell(
  const mlim_field* field, const int32_t cell[3], uint32_t word, size_t* eighths)
{
  const uint32_t* entry = field_pool_entry(field, cell, word);
  for (int c = 0; c < 8; ++c)
  {
    const double at[3] = { c & 1 ? 0.75 : 0.25, c & 2 ? 0.75 : 0.25, c & 4 ? 0.75 : 0.25 };
    ++eighths[field_mixed_label(entry, word, at)];
  }
}

/* Cells from a uniform one on, along x, that are known to be like it: as many as stay within reach of
   its clearance. */
static int32_t count_alike(const mlim_field* field, const int32_t cell[3], int clearance)
{
  const int32_t left = field->grid.cells[0] - cell[0];
  return clearance < left ? clearance : left;
}

static void volume_body(void* data, size_t begin, size_t end)
{
  const volume_job* job = (const volume_job*)data;
  const mlim_field_grid* grid = &job->field->grid;
  for (size_t z = begin; z < end; ++z)
  {
    size_t* eighths = job->eighths + z * job->label_count;
    int32_t cell[3] = { 0, 0, (int32_t)z };
    for (cell[1] = 0; cell[1] < grid->cells[1]; ++cell[1])
    {
      int32_t count = 1;
      for (cell[0] = 0; cell[0] < grid->cells[0]; cell[0] += count)
      {
        int clearance;
        const uint32_t word = field_cell_word(job->field, cell, &clearance);
        count = 1;
        if (word & (uint32_t)MIXED)
        {
          add_mixed_cell(job->field, cell, word, eighths);
          continue;
        }
        count = clearance > 1 ? count_alike(job->field, cell, clearance) : 1;
        eighths[word] += 8 * (size_t)count;
      }
    }
  }
}

static void count_voxels(const mlim_field* field, size_t* voxels)
{
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  const uint16_t* labels = mlim_field_point_labels(field);
  const size_t count = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
  for (size_t p = 0; p < count; ++p)
  {
    ++voxels[labels[p]];
  }
}

mlim_status mlim_volumes_of_field(
  const mlim_field* field, mlim_context* context, double* volumes, size_t* voxels)
{
  const size_t labels = (size_t)mlim_field_label_count(field);
  const size_t slices = (size_t)mlim_field_grid_of(field)->cells[2];
  memset(voxels, 0, labels * sizeof *voxels);
  size_t* eighths =
    labels < SIZE_MAX / slices ? mlim_allocate_zeroed(labels * slices, sizeof *eighths) : NULL;
  if (eighths == NULL)
  {
    return mlim_fail_memory(context, "the volumes of the labels");
  }
  volume_job job = { .field = field, .label_count = labels, .eighths = eighths };
  const mlim_status status = mlim_parallel_stage(
    context, &(mlim_stage_work){
               .count = slices, .body = volume_body, .job = &job, .stage = MLIM_STAGE_SURFACE });
  const double* spacing = mlim_field_grid_of(field)->spacing;
  for (size_t l = 0; l < labels; ++l)
  {
    size_t sum = 0;
    for (size_t z = 0; z < slices; ++z)
    {
      sum += eighths[z * labels + l];
    }
    volumes[l] = (double)sum / 8 * (spacing[0] * spacing[1] * spacing[2]);
  }
  mlim_release(eighths);
  count_voxels(field, voxels);
  return status;
}

void mlim_volumes_of_complex(const mlim_complex* complex, double* volumes)
{
  memset(volumes, 0, (size_t)mlim_field_label_count(complex->oracle.field) * sizeof *volumes);
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const int32_t* id = complex->cells[c].vertices;
    if (id[0] < 0)
    {
      continue;
    }
    int is_far = 0;
    double edge[3][3];
    for (int k = 0; k < 4; ++k)
    {
      is_far |= complex->vertices[id[k]].kind == MLIM_VERTEX_FAR;
    }
    for (int k = 0; k < 3; ++k)
    {
      mlim_subtract(complex->vertices[id[k + 1]].point, complex->vertices[id[0]].point, edge[k]);
    }
    double normal[3];
    mlim_cross(edge[0], edge[1], normal);
    volumes[complex->cells[c].label] += is_far ? 0 : mlim_dot(normal, edge[2]) / 6;
  }
}
