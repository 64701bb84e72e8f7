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
  double* volumes; /* label_count a slice of cells */
} volume_job;

static void add_mixed_cell(
  const mlim_field* field, const int32_t cell[3], double part, double* volumes)
{
  const double* spacing = field->grid.spacing;
  for (int c = 0; c < 8; ++c)
  {
    const double at[3] = { (cell[0] + (c & 1 ? 0.75 : 0.25)) * spacing[0],
      (cell[1] + (c & 2 ? 0.75 : 0.25)) * spacing[1],
      (cell[2] + (c & 4 ? 0.75 : 0.25)) * spacing[2] };
    volumes[mlim_field_label(field, at)] += part;
  }
}

static void volume_body(void* data, size_t begin, size_t end)
{
  const volume_job* job = (const volume_job*)data;
  const mlim_field_grid* grid = &job->field->grid;
  const double whole = grid->spacing[0] * grid->spacing[1] * grid->spacing[2];
  for (size_t z = begin; z < end; ++z)
  {
    double* volumes = job->volumes + z * job->label_count;
    int32_t cell[3] = { 0, 0, (int32_t)z };
    for (cell[1] = 0; cell[1] < grid->cells[1]; ++cell[1])
    {
      for (cell[0] = 0; cell[0] < grid->cells[0]; ++cell[0])
      {
        const uint32_t word = field_cell_word(job->field, cell, NULL);
        if (word & (uint32_t)MIXED)
        {
          add_mixed_cell(job->field, cell, whole / 8, volumes);
        }
        else
        {
          volumes[word] += whole;
        }
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
  memset(volumes, 0, labels * sizeof *volumes);
  memset(voxels, 0, labels * sizeof *voxels);
  /* A sum a slice, added up in order: the result must not depend on the threads. */
  double* sums =
    labels < SIZE_MAX / slices ? mlim_allocate_zeroed(labels * slices, sizeof *sums) : NULL;
  if (sums == NULL)
  {
    return mlim_fail_memory(context, "the volumes of the labels");
  }
  volume_job job = { .field = field, .label_count = labels, .volumes = sums };
  const mlim_status status = mlim_parallel_stage(
    context, &(mlim_stage_work){
               .count = slices, .body = volume_body, .job = &job, .stage = MLIM_STAGE_SURFACE });
  for (size_t z = 0; z < slices; ++z)
  {
    for (size_t l = 0; l < labels; ++l)
    {
      volumes[l] += sums[z * labels + l];
    }
  }
  mlim_release(sums);
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
