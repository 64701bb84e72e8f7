#include "certificate.h"

#include "memory.h"
#include "nearest.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* A label needs this many voxels before its volume is compared: below, the staircase of the voxels
   alone is a few percent. */
static const size_t MIN_VOLUME_VOXELS = 1000;

/* ---- components ---- */

/* The component of a corner that has the cell's label; all such corners touch each other. */
static int32_t component_at(
  const mlim_field* field, const mlim_components* components, const mlim_cell* cell)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  int32_t low[3];
  for (int k = 0; k < 3; ++k)
  {
    if (!(cell->center[k] >= 0 && cell->center[k] <= grid->size[k]))
    {
      return -1;
    }
    low[k] = (int32_t)(cell->center[k] / grid->spacing[k]);
    low[k] = low[k] >= grid->cells[k] ? grid->cells[k] - 1 : low[k];
  }
  for (int c = 0; c < 8; ++c)
  {
    const int32_t p[3] = { low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2 & 1) };
    if (mlim_field_point_label(field, p) == cell->label)
    {
      return components
        ->of_point[(size_t)p[0] +
                   (size_t)grid->dims[0] * ((size_t)p[1] + (size_t)grid->dims[1] * (size_t)p[2])];
    }
  }
  return -1;
}

static int touches_box(const mlim_field_grid* grid, const mlim_component* component)
{
  for (int side = 0; side < 6; ++side)
  {
    const int32_t at = component->extremes[side][side >> 1];
    if (at == (side & 1 ? grid->dims[side >> 1] - 1 : 0))
    {
      return 1;
    }
  }
  return 0;
}

void mlim_certificate_find_components(const mlim_complex* complex,
  const mlim_components* components, size_t min_voxels, unsigned char* is_found, size_t* lost)
{
  const mlim_field* field = complex->oracle.field;
  memset(is_found, 0, components->count);
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    const int32_t component = cell->vertices[0] >= 0 ? component_at(field, components, cell) : -1;
    if (component >= 0)
    {
      is_found[component] = 1;
    }
  }
  *lost = 0;
  for (size_t c = 0; c < components->count; ++c)
  {
    const mlim_component* component = &components->components[c];
    /* Background that reaches the box is one with the outside. */
    is_found[c] |= component->label == mlim_field_outside_label(field) &&
                   touches_box(mlim_field_grid_of(field), component);
    *lost += component->voxel_count >= min_voxels && !is_found[c];
  }
}

static void count_labels(const mlim_components* components, size_t min_voxels,
  const unsigned char* is_found, const mlim_mesh* mesh, unsigned char* state, mlim_certificate* out)
{
  memset(state, 0, mesh->label_count);
  for (size_t c = 0; c < components->count; ++c)
  {
    const mlim_component* component = &components->components[c];
    if (component->voxel_count >= min_voxels)
    {
      ++out->component_count;
      state[component->label] |= is_found[c] ? 3 : 1;
    }
  }
  for (size_t l = 0; l < mesh->label_count; ++l)
  {
    out->label_count += state[l] != 0;
    out->lost_label_count += state[l] == 1;
  }
}

/* ---- grid crossings ---- */

typedef struct slice_result
{
  size_t count, far_count;
  double most;
} slice_result;

typedef struct distance_job
{
  const mlim_complex* complex;
  const mlim_nearest* nearest;
  double bound, limit;
  slice_result* slices;
} distance_job;

static void measure_edge(
  const distance_job* job, const int32_t point[3], int axis, slice_result* result)
{
  enum
  {
    MAX_CROSSINGS = 8
  };
  const mlim_field_grid* grid = mlim_field_grid_of(job->complex->oracle.field);
  double start[3];
  double end[3];
  for (int k = 0; k < 3; ++k)
  {
    start[k] = point[k] * grid->spacing[k];
    end[k] = (point[k] + (k == axis)) * grid->spacing[k];
  }
  const mlim_oracle exact = { .field = job->complex->oracle.field,
    .tolerance = job->complex->oracle.tolerance,
    .mode = MLIM_ORACLE_EXACT };
  mlim_crossing crossing[MAX_CROSSINGS];
  const size_t count = mlim_oracle_crossings(&exact, start, end, MAX_CROSSINGS, crossing);
  for (size_t c = 0; c < count; ++c)
  {
    const double d = mlim_nearest_distance(job->nearest, crossing[c].point, job->bound, job->limit);
    ++result->count;
    result->far_count += d > job->bound;
    result->most = mlim_max(result->most, d);
  }
}

static void distance_body(void* data, size_t begin, size_t end)
{
  const distance_job* job = (const distance_job*)data;
  const mlim_field* field = job->complex->oracle.field;
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  for (size_t z = begin; z < end; ++z)
  {
    int32_t p[3] = { 0, 0, (int32_t)z };
    for (p[1] = 0; p[1] < dims[1]; ++p[1])
    {
      for (p[0] = 0; p[0] < dims[0]; ++p[0])
      {
        const int32_t label = mlim_field_point_label(field, p);
        for (int axis = 0; axis < 3; ++axis)
        {
          int32_t q[3] = { p[0], p[1], p[2] };
          ++q[axis];
          if (q[axis] < dims[axis] && mlim_field_point_label(field, q) != label)
          {
            measure_edge(job, p, axis, &job->slices[z]);
          }
        }
      }
    }
  }
}

static mlim_status measure_distances(
  const mlim_complex* complex, const mlim_options* options, mlim_context* context, mlim_mesh* mesh)
{
  const mlim_field_grid* grid = mlim_field_grid_of(complex->oracle.field);
  mlim_nearest nearest;
  mlim_status status = mlim_nearest_create(
    mesh, grid->size, mlim_max(options->facet_size, grid->unit), context, &nearest);
  if (status != MLIM_OK)
  {
    return status;
  }
  const size_t slices = (size_t)grid->dims[2];
  distance_job job = { .complex = complex,
    .nearest = &nearest,
    .bound = options->facet_distance,
    .limit = 4 * options->facet_distance + 2 * grid->unit,
    .slices = mlim_allocate_zeroed(slices, sizeof *job.slices) };
  if (job.slices == NULL)
  {
    status = mlim_fail_memory(context, "the distances of the certificate");
  }
  else
  {
    mlim_parallel_for(context, slices, distance_body, &job);
    for (size_t z = 0; z < slices; ++z)
    {
      mesh->certificate.grid_crossing_count += job.slices[z].count;
      mesh->certificate.far_crossing_count += job.slices[z].far_count;
      mesh->certificate.max_crossing_distance =
        mlim_max(mesh->certificate.max_crossing_distance, job.slices[z].most);
    }
  }
  mlim_release(job.slices);
  mlim_nearest_free(&nearest);
  return status;
}

/* ---- volumes ---- */

/* Volume of each label in the image: a grid point stands for the part of its voxel in the box. */
static void image_volumes(const mlim_field* field, double* volume, size_t* voxels)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  const double whole = grid->spacing[0] * grid->spacing[1] * grid->spacing[2];
  int32_t p[3];
  for (p[2] = 0; p[2] < grid->dims[2]; ++p[2])
  {
    const double wz = p[2] == 0 || p[2] == grid->cells[2] ? 0.5 : 1;
    for (p[1] = 0; p[1] < grid->dims[1]; ++p[1])
    {
      const double wy = p[1] == 0 || p[1] == grid->cells[1] ? 0.5 : 1;
      for (p[0] = 0; p[0] < grid->dims[0]; ++p[0])
      {
        const double wx = p[0] == 0 || p[0] == grid->cells[0] ? 0.5 : 1;
        const int32_t label = mlim_field_point_label(field, p);
        volume[label] += wx * wy * wz * whole;
        ++voxels[label];
      }
    }
  }
}

static mlim_status compare_volumes(const mlim_field* field, mlim_context* context, mlim_mesh* mesh)
{
  double* volume = mlim_allocate_zeroed(mesh->label_count, sizeof *volume);
  size_t* voxels = mlim_allocate_zeroed(mesh->label_count, sizeof *voxels);
  mlim_status status = MLIM_OK;
  if (volume == NULL || voxels == NULL)
  {
    status = mlim_fail_memory(context, "the volumes of the certificate");
  }
  else
  {
    image_volumes(field, volume, voxels);
    for (size_t l = 0; l < mesh->label_count; ++l)
    {
      if (voxels[l] >= MIN_VOLUME_VOXELS && (int32_t)l != mlim_field_outside_label(field))
      {
        mesh->certificate.max_volume_difference = mlim_max(
          mesh->certificate.max_volume_difference, fabs(mesh->volumes[l] - volume[l]) / volume[l]);
      }
    }
  }
  mlim_release(volume);
  mlim_release(voxels);
  return status;
}

mlim_status mlim_certificate_measure(const mlim_complex* complex, const mlim_components* components,
  const mlim_options* options, mlim_context* context, mlim_mesh* mesh)
{
  unsigned char* is_found = mlim_allocate(components->count, 1);
  unsigned char* state = mlim_allocate(mesh->label_count, 1);
  mlim_status status = MLIM_OK;
  if (is_found == NULL || state == NULL)
  {
    status = mlim_fail_memory(context, "the certificate");
    goto done;
  }
  mlim_certificate_find_components(complex, components, options->min_component_voxels, is_found,
    &mesh->certificate.lost_component_count);
  count_labels(
    components, options->min_component_voxels, is_found, mesh, state, &mesh->certificate);
  status = compare_volumes(complex->oracle.field, context, mesh);
  if (status == MLIM_OK)
  {
    status = mlim_progress(context, MLIM_STAGE_CERTIFICATE, 0.4);
  }
  if (status == MLIM_OK)
  {
    status = measure_distances(complex, options, context, mesh);
  }
done:
  mlim_release(is_found);
  mlim_release(state);
  return status;
}
