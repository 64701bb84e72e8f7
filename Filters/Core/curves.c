#include "crease.h"
#include "grow.h"
#include "memory.h"
#include "vector.h"

#include <string.h>

enum
{
  CREASE_ITEMS = 9,     /* six faces of the box, three directions of its edges */
  MAX_CLEAN_ROUNDS = 6, /* a merge may make a merge; more than two or three rounds are rare */
  BATCHES = 16          /* between reports of progress; more: threads wait for each other */
};

/* Of the stage's time; the rest is welding and growing. For the progress bar only. */
static const double TRACING_SHARE = 0.9;

/* Length on both sides of a corner over which its angle is seen, in spacings: below a cell, above the
   noise of the interpolants' kinks on the faces of cells. */
static const double CORNER_REACH = 0.4;
/* Width of a detour, of junction_merge_tolerance: small against what merging changes, and as wide as
   the smallest balls can cover. */
static const double DETOUR_SHARE = 0.4;

void mlim_curves_free(mlim_curves* curves)
{
  mlim_release(curves->points);
  mlim_release(curves->curve_offsets);
  mlim_release(curves->curve_points);
  mlim_release(curves->curve_sets);
  mlim_release(curves->junction_points);
  mlim_release(curves->junction_sets);
  mlim_sets_free(&curves->sets);
  *curves = (mlim_curves){ 0 };
}

/* One item a layer of cells, then the faces and edges of the box. Each has a network of its own;
   they are put together in the order of the items, so threads leave no trace. */
typedef struct tracing
{
  const mlim_field* field;
  size_t first; /* item */
  mlim_network* networks;
  mlim_status* statuses;
} tracing;

/* A cell of two labels has no curve inside. */
static mlim_status trace_layer(mlim_cell_work* work, int32_t layer)
{
  mlim_status status = MLIM_OK;
  int32_t cell[3] = { 0, 0, layer };
  for (cell[1] = 0; cell[1] < work->grid->cells[1]; ++cell[1])
  {
    cell[0] = 0;
    cell[0] = mlim_field_find_many(work->field, cell);
    while (cell[0] < work->grid->cells[0] && !status)
    {
      status = mlim_cell_trace(work, cell);
      ++cell[0];
      cell[0] = mlim_field_find_many(work->field, cell);
    }
  }
  return status;
}

static void trace_items(void* data, size_t begin, size_t end)
{
  tracing* job = data;
  const size_t layers = (size_t)mlim_field_grid_of(job->field)->cells[2];
  mlim_cell_work work = { 0 };
  const mlim_status created = mlim_cell_work_create(job->field, NULL, &work);
  for (size_t i = begin; i < end; ++i)
  {
    const size_t item = job->first + i;
    mlim_status status = created;
    work.network = job->networks + i;
    if (!status && item < layers)
    {
      status = trace_layer(&work, (int32_t)item);
    }
    else if (!status)
    {
      const int crease = (int)(item - layers);
      status = crease < 6 ? mlim_crease_trace_face(&work, crease)
                          : mlim_crease_trace_edges(&work, crease - 6);
    }
    job->statuses[i] = status;
  }
  mlim_cell_work_free(&work);
}

/* Traces everything into one network, in batches for the sake of progress. */
static mlim_status trace_all(const mlim_field* field, mlim_context* context, mlim_network* out)
{
  const size_t item_count = (size_t)mlim_field_grid_of(field)->cells[2] + CREASE_ITEMS;
  const size_t batch = item_count / BATCHES + 1;
  tracing job = { .field = field,
    .networks = mlim_allocate_zeroed(batch, sizeof(mlim_network)),
    .statuses = mlim_allocate_zeroed(batch, sizeof(mlim_status)) };
  mlim_status status = job.networks && job.statuses ? MLIM_OK : MLIM_OUT_OF_MEMORY;
  for (; job.first < item_count && !status; job.first += batch)
  {
    const size_t count = job.first + batch < item_count ? batch : item_count - job.first;
    mlim_parallel_for(context, count, trace_items, &job);
    for (size_t i = 0; i < count; ++i)
    {
      status = status ? status : job.statuses[i];
      status = status ? status : mlim_network_append(out, job.networks + i);
      mlim_network_free(job.networks + i);
    }
    if (!status)
    {
      const double done = (double)(job.first + count) / (double)item_count;
      status = mlim_progress(context, MLIM_STAGE_CURVES, TRACING_SHARE * done);
    }
  }
  mlim_release(job.networks);
  mlim_release(job.statuses);
  return status;
}

static mlim_status regrow(
  const mlim_network* network, const unsigned char* is_corner, mlim_chains* chains)
{
  mlim_chains_free(chains);
  return mlim_chains_grow(network, is_corner, chains);
}

/* Welds, takes out detours, then cleans until nothing is too small. */
static mlim_status make_chains(
  const mlim_field_grid* grid, const mlim_options* options, mlim_network* network, mlim_chains* out)
{
  const double weld_distance = MLIM_WELD_DISTANCE * grid->min_spacing;
  const double tolerance = options->junction_merge_tolerance;
  mlim_status status = mlim_network_weld(network, weld_distance);
  status = status ? status : regrow(network, NULL, out);
  int has_changed = 1;
  for (int round = 0; round < MAX_CLEAN_ROUNDS && has_changed && !status; ++round)
  {
    int is_cut = 0;
    status = mlim_network_clean(network, out, tolerance, grid->size, &has_changed);
    status = status ? status : mlim_network_weld(network, weld_distance);
    status = status ? status : regrow(network, NULL, out);
    status =
      status ? status : mlim_network_cut_detours(network, out, DETOUR_SHARE * tolerance, &is_cut);
    status = status ? status : mlim_network_weld(network, weld_distance);
    status = status ? status : regrow(network, NULL, out);
    has_changed = has_changed || is_cut;
  }
  return status;
}

/* Sharp corners become junctions. */
static mlim_status cut_at_corners(
  const mlim_field_grid* grid, const mlim_network* network, mlim_chains* chains)
{
  unsigned char* is_corner = mlim_allocate_zeroed(network->point_count, 1);
  mlim_status status = MLIM_OUT_OF_MEMORY;
  if (is_corner)
  {
    mlim_chains_mark_corners(network, chains, CORNER_REACH * grid->unit, is_corner);
    status = regrow(network, is_corner, chains);
  }
  mlim_release(is_corner);
  return status;
}

static mlim_status allocate_curves(
  const mlim_network* network, const mlim_chains* chains, mlim_curves* out)
{
  const size_t chain_points = chains->count > 0 ? chains->offsets[chains->count] : 0;
  out->points = mlim_allocate(network->point_count, 3 * sizeof(double));
  out->curve_offsets = mlim_allocate(chains->count + 1, sizeof(size_t));
  out->curve_points = mlim_allocate(chain_points, sizeof(int32_t));
  out->curve_sets = mlim_allocate(chains->count, sizeof(int32_t));
  out->junction_points = mlim_allocate(network->point_count, sizeof(int32_t));
  out->junction_sets = mlim_allocate(network->point_count, sizeof(int32_t));
  return out->points && out->curve_offsets && out->curve_points && out->curve_sets &&
             out->junction_points && out->junction_sets
           ? MLIM_OK
           : MLIM_OUT_OF_MEMORY;
}

/* Junctions have the labels of all their curves. */
static mlim_status join_junction_sets(mlim_network* network, const mlim_chains* chains)
{
  mlim_status status = MLIM_OK;
  for (size_t c = 0; c < chains->count; ++c)
  {
    for (int end = 0; end < 2 && !status; ++end)
    {
      const size_t at = end ? chains->offsets[c + 1] - 1 : chains->offsets[c];
      int32_t* set = network->point_sets + chains->points[at];
      status = mlim_set_table_join(&network->table, *set, chains->sets[c], set);
    }
  }
  return status;
}

/* Numbers the points that chains use in their order, and the sets in use in theirs. */
static mlim_status write_curves(
  const mlim_network* network, const mlim_chains* chains, mlim_curves* out)
{
  int32_t* numbers = mlim_allocate(network->point_count, sizeof(int32_t));
  int32_t* use = mlim_allocate_zeroed(network->table.sets.count, sizeof(int32_t));
  mlim_status status = allocate_curves(network, chains, out);
  if (status || !numbers || !use)
  {
    status = MLIM_OUT_OF_MEMORY;
    goto done;
  }
  memset(numbers, -1, network->point_count * sizeof(int32_t));
  out->curve_offsets[0] = 0;
  out->curve_count = chains->count;
  for (size_t c = 0; c < chains->count; ++c)
  {
    out->curve_offsets[c + 1] = chains->offsets[c + 1];
    out->curve_sets[c] = chains->sets[c];
    use[chains->sets[c]] = 1;
    for (size_t i = chains->offsets[c]; i < chains->offsets[c + 1]; ++i)
    {
      int32_t* number = numbers + chains->points[i];
      if (*number < 0)
      {
        *number = (int32_t)out->point_count;
        mlim_copy(
          network->points + 3 * (size_t)chains->points[i], out->points + 3 * out->point_count);
        ++out->point_count;
      }
      out->curve_points[i] = *number;
    }
  }
  for (size_t p = 0; p < network->point_count; ++p)
  {
    if (chains->is_junction[p])
    {
      out->junction_points[out->junction_count] = numbers[p];
      out->junction_sets[out->junction_count] = network->point_sets[p];
      ++out->junction_count;
      use[network->point_sets[p]] = 1;
    }
  }
  status = mlim_sets_compact(&network->table.sets, use, &out->sets);
  for (size_t c = 0; c < out->curve_count && !status; ++c)
  {
    out->curve_sets[c] = use[out->curve_sets[c]] - 1;
  }
  for (size_t j = 0; j < out->junction_count && !status; ++j)
  {
    out->junction_sets[j] = use[out->junction_sets[j]] - 1;
  }

done:
  mlim_release(numbers);
  mlim_release(use);
  return status;
}

mlim_status mlim_curves_extract(
  const mlim_field* field, const mlim_options* options, mlim_context* context, mlim_curves* out)
{
  *out = (mlim_curves){ 0 };
  if (!field || !options || !(options->junction_merge_tolerance >= 0))
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "curves need a field, and options with a junction_merge_tolerance of at least 0");
  }
  mlim_network network = { 0 };
  mlim_chains chains = { 0 };
  mlim_curves curves = { 0 };
  mlim_status status = mlim_progress(context, MLIM_STAGE_CURVES, 0);
  status = status ? status : trace_all(field, context, &network);
  status = status ? status : make_chains(mlim_field_grid_of(field), options, &network, &chains);
  status = status ? status : cut_at_corners(mlim_field_grid_of(field), &network, &chains);
  status = status ? status : join_junction_sets(&network, &chains);
  status = status ? status : write_curves(&network, &chains, &curves);
  status = status ? status : mlim_progress(context, MLIM_STAGE_CURVES, 1);
  if (status == MLIM_OUT_OF_MEMORY)
  {
    mlim_fail_memory(context, "the curves");
  }
  if (!status)
  {
    *out = curves;
    curves = (mlim_curves){ 0 };
  }
  mlim_curves_free(&curves);
  mlim_chains_free(&chains);
  mlim_network_free(&network);
  return status;
}
