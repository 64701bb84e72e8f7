#include "certificate.h"

#include "crossings.h"
#include "memory.h"
#include "nearest.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* A label needs this many voxels before its volume is compared. */
static const size_t MIN_VOLUME_VOXELS = 1000;

/* ---- components ---- */

/* The component of a corner that has the cell's label; all such corners touch each other. */
static int32_t component_at(
  const mlim_complex* complex, const mlim_components* components, int32_t cell)
{
  const mlim_field* field = complex->oracle.field;
  const double* center = mlim_complex_center(complex, cell);
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  int32_t low[3];
  for (int k = 0; k < 3; ++k)
  {
    if (!(center[k] >= 0 && center[k] <= grid->size[k]))
    {
      return -1;
    }
    low[k] = (int32_t)(center[k] / grid->spacing[k]);
    low[k] = low[k] >= grid->cells[k] ? grid->cells[k] - 1 : low[k];
  }
  for (int c = 0; c < 8; ++c)
  {
    const int32_t p[3] = { low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2 & 1) };
    if (mlim_field_point_label(field, p) == complex->cells[cell].label)
    {
      return mlim_components_at(components, field, p);
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

/* Marks small components, of which none is asked for, and background that reaches the box, which is one
   with the outside. The number of the others. */
static size_t count_wanted(const mlim_field* field, const mlim_components* components,
  size_t min_voxels, unsigned char* is_found)
{
  size_t count = 0;
  for (size_t c = 0; c < components->count; ++c)
  {
    const mlim_component* component = &components->components[c];
    is_found[c] =
      component->voxel_count < min_voxels || (component->label == mlim_field_outside_label(field) &&
                                               touches_box(mlim_field_grid_of(field), component));
    count += !is_found[c];
  }
  return count;
}

void mlim_certificate_find_components(const mlim_complex* complex,
  const mlim_components* components, size_t min_voxels, unsigned char* is_found, size_t* lost)
{
  *lost = count_wanted(complex->oracle.field, components, min_voxels, is_found);
  for (size_t c = 0; c<complex->cell_count&& * lost> 0; ++c)
  {
    const int32_t component =
      complex->cells[c].vertices[0] >= 0 ? component_at(complex, components, (int32_t)c) : -1;
    if (component >= 0 && !is_found[component])
    {
      is_found[component] = 1;
      --*lost;
    }
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

mlim_status mlim_certificate_count_components(const mlim_complex* complex,
  const mlim_components* components, size_t min_voxels, mlim_context* context, mlim_mesh* mesh)
{
  unsigned char* is_found = mlim_allocate(components->count, 1);
  unsigned char* state = mlim_allocate(mesh->label_count, 1);
  mlim_status status = MLIM_OK;
  if (is_found == NULL || state == NULL)
  {
    status = mlim_fail_memory(context, "the certificate");
  }
  else
  {
    mlim_certificate_find_components(
      complex, components, min_voxels, is_found, &mesh->certificate.lost_component_count);
    count_labels(components, min_voxels, is_found, mesh, state, &mesh->certificate);
  }
  mlim_release(is_found);
  mlim_release(state);
  return status;
}

/* ---- grid crossings ---- */

enum
{
  BATCHES = 32 /* of slices, between which the host is looked at */
};

typedef struct slice_result
{
  size_t count, far_count;
  double most;
} slice_result;

typedef struct distance_job
{
  const mlim_oracle* oracle;
  const mlim_nearest* nearest;
  double bound, limit;
  size_t slice_count;
  slice_result* slices;
  double most; /* of the batches before */
} distance_job;

typedef struct distance_visit
{
  const distance_job* job;
  slice_result* result;
  mlim_nearest_hints hints;
} distance_visit;

/* What is not farther than the farthest before needs no exact distance. */
static void visit_crossings(void* user, const mlim_grid_crossing* crossings, size_t count)
{
  distance_visit* visit = (distance_visit*)user;
  const distance_job* job = visit->job;
  slice_result* result = visit->result;
  const mlim_nearest_points from = { .count = count,
    .points = crossings->crossing.point,
    .stride = sizeof *crossings / sizeof(double) };
  mlim_nearest_ahead(job->nearest, &from);
  for (size_t k = 0; k < count; ++k)
  {
    const double d = mlim_nearest_distance(job->nearest, crossings[k].crossing.point,
      mlim_min(job->bound, mlim_max(job->most, result->most)), job->limit,
      mlim_nearest_hint_at(&visit->hints, crossings[k].low[0]));
    result->far_count += d > job->bound;
    result->most = mlim_max(result->most, d);
  }
  result->count += count;
}

static void distance_body(void* data, size_t begin, size_t end)
{
  const distance_job* job = (const distance_job*)data;
  const mlim_oracle exact = {
    .field = job->oracle->field, .tolerance = job->oracle->tolerance, .mode = MLIM_ORACLE_EXACT
  };
  for (size_t z = begin; z < end; ++z)
  {
    distance_visit visit = { .job = job, .result = &job->slices[z] };
    mlim_nearest_hints_clear(&visit.hints);
    mlim_crossings_of_slice(&exact, (int32_t)z, visit_crossings, &visit);
  }
}

static mlim_status take_slices(void* data, size_t begin, size_t end, mlim_context* context)
{
  distance_job* job = (distance_job*)data;
  for (size_t z = begin; z < end; ++z)
  {
    job->most = mlim_max(job->most, job->slices[z].most);
  }
  const double share = (double)end / (double)job->slice_count;
  return mlim_progress(
    context, MLIM_STAGE_CERTIFICATE, MLIM_CERTIFY_FROM + share * (1 - MLIM_CERTIFY_FROM));
}

static mlim_status measure_distances(
  const mlim_oracle* oracle, const mlim_options* options, mlim_context* context, mlim_mesh* mesh)
{
  const mlim_field_grid* grid = mlim_field_grid_of(oracle->field);
  const mlim_triangles triangles = mlim_triangles_of(mesh);
  mlim_nearest nearest;
  mlim_status status = mlim_nearest_create(&triangles, grid->size, grid->unit, context, &nearest);
  if (status != MLIM_OK)
  {
    return status;
  }
  const size_t slices = (size_t)grid->dims[2];
  distance_job job = { .oracle = oracle,
    .nearest = &nearest,
    .bound = options->facet_distance,
    .limit = 4 * options->facet_distance + 2 * grid->unit,
    .slice_count = slices,
    .slices = mlim_allocate_zeroed(slices, sizeof *job.slices) };
  if (job.slices == NULL)
  {
    status = mlim_fail_memory(context, "the distances of the certificate");
  }
  else
  {
    status = mlim_parallel_batches(context, &(mlim_batches){ .count = slices,
                                              .size = slices / BATCHES + 1,
                                              .body = distance_body,
                                              .finish = take_slices,
                                              .job = &job });
    for (size_t z = 0; z < slices; ++z)
    {
      mesh->certificate.grid_crossing_count += job.slices[z].count;
      mesh->certificate.far_crossing_count += job.slices[z].far_count;
    }
    mesh->certificate.max_crossing_distance = job.most;
  }
  mlim_release(job.slices);
  mlim_nearest_free(&nearest);
  return status;
}

/* ---- volumes ---- */

static void compare_volumes(
  const mlim_field* field, const double* volumes, const size_t* voxels, mlim_mesh* mesh)
{
  for (size_t l = 0; l < mesh->label_count; ++l)
  {
    if (voxels[l] >= MIN_VOLUME_VOXELS && (int32_t)l != mlim_field_outside_label(field))
    {
      mesh->certificate.max_volume_difference = mlim_max(
        mesh->certificate.max_volume_difference, fabs(mesh->volumes[l] - volumes[l]) / volumes[l]);
    }
  }
}

mlim_status mlim_certificate_measure(
  const mlim_certificate_input* input, mlim_context* context, mlim_mesh* mesh)
{
  compare_volumes(input->oracle->field, input->volumes, input->voxels, mesh);
  const mlim_status status = mlim_progress(context, MLIM_STAGE_CERTIFICATE, MLIM_CERTIFY_FROM);
  return status == MLIM_OK ? measure_distances(input->oracle, input->options, context, mesh)
                           : status;
}
