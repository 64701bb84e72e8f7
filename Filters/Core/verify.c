#include "verify.h"

#include "ahead.h"
#include "certificate.h"
#include "crossings.h"
#include "memory.h"
#include "nearest.h"
#include "seeds.h"
#include "sides.h"
#include "skin.h"
#include "status.h"
#include "vector.h"
#include "volumes.h"

#include <math.h>

/* A label needs this many voxels before its volume is looked at. */
static const size_t MIN_VOLUME_VOXELS = 1000;

/* Regions are brought to this part of the volume tolerance, so that rounding and what is left undone
   do not bring them over it. */
static const double VOLUME_TARGET = 0.75;

/* The lost volume grows with the distance bound; one round lowers a bound at most to this part. */
static const double MOST_TIGHTENING = 0.3;

/* Share of the grid crossings that may stay far from the mesh: single voxels' noise. Each of them
   would cost about 6 vertices. */
static const double FAR_SHARE = 0.005;

enum
{
  FAR_ROUNDS = 4,    /* the later ones find nearly nothing */
  LOOK_EVERY = 65536 /* facets between two reports: some milliseconds */
};

/* ---- far crossings ---- */

/* The crossings of one slice that were far at the last look. Refinement only adds, so later looks are
   at these alone. */
struct mlim_far_list
{
  mlim_crossing* crossings;
  size_t count, capacity;
  size_t seen_count; /* crossings looked at */
  int has_failed;
};

typedef struct mlim_far_list far_list;

typedef struct far_job
{
  const mlim_verification* verification;
  const mlim_nearest* nearest;
  mlim_oracle oracle;
  double bound;
  size_t min_voxels;
  far_list* lists; /* one a slice */
  int is_listed;   /* not the first look */
} far_job;

typedef struct far_visit
{
  const far_job* job;
  far_list* list;
  mlim_nearest_hints hints;
} far_visit;

static int is_small(const far_job* job, const int32_t point[3])
{
  const mlim_components* components = job->verification->components;
  const int32_t at = mlim_components_at(components, job->oracle.field, point);
  return components->components[at].voxel_count < job->min_voxels;
}

static int is_far(const far_job* job, const mlim_crossing* crossing, int32_t* hint)
{
  return !mlim_nearest_is_within(job->nearest, crossing->point, job->bound, hint);
}

static void visit_crossing(far_visit* visit, const mlim_grid_crossing* at)
{
  const far_job* job = visit->job;
  far_list* list = visit->list;
  if (is_small(job, at->low) || is_small(job, at->high))
  {
    return;
  }
  ++list->seen_count;
  if (!is_far(job, &at->crossing, mlim_nearest_hint_at(&visit->hints, at->low[0])))
  {
    return;
  }
  if (mlim_reserve(&list->crossings, &list->capacity, list->count + 1, sizeof *list->crossings))
  {
    list->has_failed = 1;
    return;
  }
  list->crossings[list->count++] = at->crossing;
}

static void visit_crossings(void* user, const mlim_grid_crossing* crossings, size_t count)
{
  far_visit* visit = (far_visit*)user;
  const mlim_nearest_points from = { .count = count,
    .points = crossings->crossing.point,
    .stride = sizeof *crossings / sizeof(double) };
  mlim_nearest_ahead(visit->job->nearest, &from);
  for (size_t k = 0; k < count; ++k)
  {
    visit_crossing(visit, &crossings[k]);
  }
}

static void look_again(const far_job* job, far_list* list)
{
  size_t kept = 0;
  int32_t hint = -1;
  for (size_t k = 0; k < list->count; ++k)
  {
    if (is_far(job, &list->crossings[k], &hint))
    {
      list->crossings[kept++] = list->crossings[k];
    }
  }
  list->count = kept;
}

static void far_body(void* data, size_t begin, size_t end)
{
  const far_job* job = (const far_job*)data;
  for (size_t z = begin; z < end; ++z)
  {
    if (job->is_listed)
    {
      look_again(job, &job->lists[z]);
      continue;
    }
    far_visit visit = { .job = job, .list = &job->lists[z] };
    mlim_nearest_hints_clear(&visit.hints);
    mlim_crossings_of_slice(&job->oracle, (int32_t)z, visit_crossings, &visit);
  }
}

static mlim_status insert_far(const mlim_verification* v, mlim_context* context, size_t* count)
{
  mlim_complex* complex = &v->refinement->complex;
  const size_t slices = (size_t)mlim_field_grid_of(complex->oracle.field)->dims[2];
  const mlim_options* options = v->refinement->options;
  /* The first rounds take few of the crossings that lie together; what they do not bring near is
     left for the later ones, which look closer. */
  const double distance =
    mlim_max(options->smallest_distance, 0.25 * options->facet_size * pow(0.5, v->round));
  mlim_seeds seeds;
  mlim_status status = mlim_seeds_start(complex, distance, context, &seeds);
  for (size_t z = 0; z < slices && status == MLIM_OK; ++z)
  {
    for (size_t k = 0; k < v->far[z].count && status == MLIM_OK; ++k)
    {
      status = mlim_seeds_insert(&seeds, &v->far[z].crossings[k], context, count);
      if (status == MLIM_OK && k % 256 == 255)
      {
        status = mlim_refine_report(v->refinement, context);
      }
    }
  }
  mlim_seeds_free(&seeds);
  return status;
}

static int has_failed(const far_job* job, size_t slices)
{
  int failed = 0;
  for (size_t z = 0; z < slices; ++z)
  {
    failed = failed || job->lists[z].has_failed;
  }
  return failed;
}

static int has_many_far(const mlim_verification* v)
{
  const int32_t slices = mlim_field_grid_of(v->refinement->complex.oracle.field)->dims[2];
  double far = 0;
  double seen = 0;
  for (int32_t z = 0; z < slices; ++z)
  {
    far += (double)v->far[z].count;
    seen += (double)v->far[z].seen_count;
  }
  return far > FAR_SHARE * seen;
}

/* The triangles among which a crossing may find one that is near: all, or those near the crossings that
   were far at the last look and have come since. */
static mlim_status read_skin(const mlim_verification* v, mlim_context* context, mlim_skin* out)
{
  mlim_complex* complex = &v->refinement->complex;
  const mlim_field_grid* grid = mlim_field_grid_of(complex->oracle.field);
  mlim_skin_blocks blocks = { 0 };
  if (v->far != NULL)
  {
    const mlim_status status =
      mlim_skin_blocks_create(grid->size, v->refinement->options->facet_distance, context, &blocks);
    if (status != MLIM_OK)
    {
      return status;
    }
    for (size_t z = 0; z < (size_t)grid->dims[2]; ++z)
    {
      for (size_t k = 0; k < v->far[z].count; ++k)
      {
        mlim_skin_blocks_add(&blocks, v->far[z].crossings[k].point);
      }
    }
  }
  const mlim_status status =
    mlim_skin_read(complex, &blocks, v->refinement->progress, context, out);
  mlim_skin_blocks_free(&blocks);
  return status;
}

static mlim_status look_at_slices(
  mlim_verification* v, const mlim_nearest* nearest, mlim_context* context)
{
  const mlim_complex* complex = &v->refinement->complex;
  const mlim_options* options = v->refinement->options;
  const size_t slices = (size_t)mlim_field_grid_of(complex->oracle.field)->dims[2];
  const int is_listed = v->far != NULL;
  v->far = is_listed ? v->far : mlim_allocate_zeroed(slices, sizeof *v->far);
  if (v->far == NULL)
  {
    return mlim_fail_memory(context, "the crossings far from the mesh");
  }
  far_job job = { .verification = v,
    .nearest = nearest,
    .oracle = { .field = complex->oracle.field,
      .tolerance = complex->oracle.tolerance,
      .mode = MLIM_ORACLE_EXACT },
    .bound = options->facet_distance,
    .min_voxels = options->min_component_voxels,
    .lists = v->far,
    .is_listed = is_listed };
  const mlim_stage_work work = { .count = slices,
    .body = far_body,
    .job = &job,
    .stage = MLIM_STAGE_SURFACE,
    .from = v->refinement->progress,
    .to = v->refinement->progress };
  mlim_status status = mlim_parallel_stage(context, &work);
  if (status == MLIM_OK && has_failed(&job, slices))
  {
    status = mlim_fail_memory(context, "the crossings far from the mesh");
  }
  return status;
}

static mlim_status look_for_far(mlim_verification* v, mlim_context* context, size_t* count)
{
  const mlim_field_grid* grid = mlim_field_grid_of(v->refinement->complex.oracle.field);
  mlim_skin skin = { 0 };
  mlim_nearest nearest = { 0 };
  mlim_status status = mlim_refine_report(v->refinement, context);
  status = status == MLIM_OK ? read_skin(v, context, &skin) : status;
  status = status == MLIM_OK ? mlim_refine_report(v->refinement, context) : status;
  if (status == MLIM_OK)
  {
    const mlim_triangles triangles = { .count = skin.triangle_count,
      .vertices = skin.triangles,
      .points = v->refinement->complex.vertices->point,
      .stride = sizeof(mlim_vertex) / sizeof(double) };
    status = mlim_nearest_create(&triangles, grid->size, grid->unit, context, &nearest);
  }
  if (status == MLIM_OK)
  {
    status = look_at_slices(v, &nearest, context);
  }
  mlim_nearest_free(&nearest);
  mlim_skin_free(&skin);
  return status == MLIM_OK && has_many_far(v) ? insert_far(v, context, count) : status;
}

/* ---- facets off their interface, or too large for their film ---- */

static int is_open(const mlim_facet* facet)
{
  return facet->is_alive && !facet->is_settled;
}

static void ask_ahead(const mlim_complex* complex, size_t f, size_t end)
{
  const mlim_facet* facets = complex->facets;
  if (f + MLIM_CELLS_AHEAD < end && is_open(&facets[f + MLIM_CELLS_AHEAD]))
  {
    mlim_prefetch(&complex->cells[facets[f + MLIM_CELLS_AHEAD].cell]);
    mlim_field_ahead(complex->oracle.field, facets[f + MLIM_CELLS_AHEAD].crossing, 0);
  }
  if (f + MLIM_VERTICES_AHEAD < end && is_open(&facets[f + MLIM_VERTICES_AHEAD]))
  {
    const mlim_facet* facet = &facets[f + MLIM_VERTICES_AHEAD];
    mlim_ahead_of_vertices(complex, facet->cell, facet->index, 0);
    mlim_ahead_of_neighbor(complex, facet->cell, facet->index);
    mlim_field_ahead(complex->oracle.field, facet->crossing, 1);
  }
}

/* The height of the crossing says nothing about the rest of the facet: a bump of the interface may
   leave it between two places of one label. Nor does it say how far the other sheet of a film is. */
static void judge(const mlim_refinement* r, mlim_facet* const* facets, size_t count)
{
  mlim_sides sides[MLIM_SIDES_TOGETHER];
  for (size_t k = 0; k < count; ++k)
  {
    sides[k] = (mlim_sides){ .facet = facets[k],
      .reach = mlim_criteria_distance(&r->complex, r->options, &facets[k]->sheet) };
  }
  mlim_sides_judge(&r->complex, sides, count);
  for (size_t k = 0; k < count; ++k)
  {
    facets[k]->is_settled = (unsigned char)(sides[k].are_right & 1);
  }
}

static int is_between_labels(const mlim_complex* complex, const mlim_facet* facet)
{
  const mlim_cell* cell = &complex->cells[facet->cell];
  return cell->label != complex->cells[cell->neighbors[facet->index]].label;
}

static void side_body(void* data, size_t begin, size_t end)
{
  mlim_refinement* r = (mlim_refinement*)data;
  mlim_facet* facets[MLIM_SIDES_TOGETHER];
  size_t count = 0;
  for (size_t f = begin; f < end; ++f)
  {
    mlim_facet* facet = &r->complex.facets[f];
    ask_ahead(&r->complex, f, end);
    if (is_open(facet) && is_between_labels(&r->complex, facet))
    {
      facets[count++] = facet;
    }
    else if (is_open(facet))
    {
      facet->is_settled = 1;
    }
    if (count == MLIM_SIDES_TOGETHER)
    {
      judge(r, facets, count);
      count = 0;
    }
  }
  judge(r, facets, count);
}

static mlim_status look_for_sides(const mlim_verification* v, mlim_context* context, size_t* count)
{
  mlim_refinement* r = v->refinement;
  const mlim_complex* complex = &r->complex;
  mlim_status status =
    mlim_parallel_stage(context, &(mlim_stage_work){ .count = complex->facet_count,
                                   .body = side_body,
                                   .job = r,
                                   .stage = MLIM_STAGE_SURFACE,
                                   .from = r->progress,
                                   .to = r->progress,
                                   .step = LOOK_EVERY });
  for (size_t f = 1; f < complex->facet_count && status == MLIM_OK; ++f)
  {
    if (is_open(&complex->facets[f]))
    {
      int is_taken;
      status = mlim_refine_ask(r, (int32_t)f, context, &is_taken);
      *count += (size_t)is_taken;
    }
    if (f % LOOK_EVERY == 0 && status == MLIM_OK)
    {
      status = mlim_refine_report(r, context);
    }
  }
  return status;
}

/* ---- lost volume ---- */

/* Lowers the bounds of the labels that have lost too much; these stay marked. */
static void tighten(
  const mlim_verification* v, const double* volumes, unsigned char* is_marked, size_t* count)
{
  mlim_complex* complex = &v->refinement->complex;
  const mlim_options* options = v->refinement->options;
  const size_t labels = (size_t)mlim_field_label_count(complex->oracle.field);
  const double target = VOLUME_TARGET * options->volume_tolerance;
  const double least = 0.25 * options->smallest_distance / options->facet_distance;
  for (size_t l = 0; l < labels; ++l)
  {
    const double lost = is_marked[l] ? fabs(volumes[l] - v->volumes[l]) / v->volumes[l] : 0;
    is_marked[l] = lost > target && complex->distance_shares[l] > least;
    if (is_marked[l])
    {
      complex->distance_shares[l] *= mlim_max(MOST_TIGHTENING, 0.9 * target / lost);
      ++*count;
    }
  }
}

static mlim_status look_for_volume(const mlim_verification* v, mlim_context* context, size_t* count)
{
  const mlim_complex* complex = &v->refinement->complex;
  const mlim_field* field = complex->oracle.field;
  const size_t labels = (size_t)mlim_field_label_count(field);
  double* volumes = mlim_allocate(labels, sizeof *volumes);
  unsigned char* is_marked = mlim_allocate(labels, 1);
  if (volumes == NULL || is_marked == NULL)
  {
    mlim_release(volumes);
    mlim_release(is_marked);
    return mlim_fail_memory(context, "the volumes of the labels");
  }
  for (size_t l = 0; l < labels; ++l)
  {
    is_marked[l] =
      v->voxels[l] >= MIN_VOLUME_VOXELS && (int32_t)l != mlim_field_outside_label(field);
  }
  const size_t before = *count;
  const mlim_status status =
    mlim_volumes_of_complex(complex, is_marked, v->refinement->progress, context, volumes);
  if (status == MLIM_OK)
  {
    tighten(v, volumes, is_marked, count);
  }
  if (*count > before)
  {
    mlim_refine_tighten(v->refinement, is_marked);
  }
  mlim_release(volumes);
  mlim_release(is_marked);
  return status;
}

/* ---- lost components ---- */

static mlim_status look_for_components(
  const mlim_verification* v, mlim_context* context, size_t* count)
{
  mlim_complex* complex = &v->refinement->complex;
  const size_t min_voxels = v->refinement->options->min_component_voxels;
  unsigned char* is_wanted = mlim_allocate(v->components->count, 1);
  if (is_wanted == NULL)
  {
    return mlim_fail_memory(context, "the components of the labels");
  }
  size_t lost;
  size_t seeded = 0;
  mlim_status status = MLIM_OK;
  mlim_certificate_find_components(complex, v->components, min_voxels, is_wanted, &lost);
  if (lost > 0)
  {
    for (size_t c = 0; c < v->components->count; ++c)
    {
      is_wanted[c] = !is_wanted[c];
    }
    status =
      mlim_seeds_on_components(complex, v->components, is_wanted, min_voxels, context, &seeded);
    status = status == MLIM_OK ? mlim_refine_update(v->refinement, context) : status;
  }
  *count += seeded;
  mlim_release(is_wanted);
  return status;
}

void mlim_verify_free(mlim_verification* verification)
{
  if (verification->far == NULL)
  {
    return;
  }
  const mlim_field* field = verification->refinement->complex.oracle.field;
  const size_t slices = (size_t)mlim_field_grid_of(field)->dims[2];
  for (size_t z = 0; z < slices; ++z)
  {
    mlim_release(verification->far[z].crossings);
  }
  mlim_release(verification->far);
  verification->far = NULL;
}

mlim_status mlim_verify_round(mlim_verification* verification, mlim_context* context, size_t* count)
{
  *count = 0;
  mlim_status status =
    verification->round == 0 ? look_for_components(verification, context, count) : MLIM_OK;
  if (status == MLIM_OK && !verification->is_near && verification->round < FAR_ROUNDS)
  {
    size_t far = 0;
    status = look_for_far(verification, context, &far);
    status = status == MLIM_OK ? mlim_refine_update(verification->refinement, context) : status;
    verification->is_near = far == 0;
    *count += far;
  }
  if (status == MLIM_OK)
  {
    status = look_for_sides(verification, context, count);
  }
  if (status == MLIM_OK && verification->refinement->options->volume_tolerance > 0)
  {
    status = look_for_volume(verification, context, count);
  }
  /* In later rounds only before the last one: as long as there is something else to do, there is one. */
  if (status == MLIM_OK && verification->round > 0 && *count == 0)
  {
    status = look_for_components(verification, context, count);
  }
  return status;
}
