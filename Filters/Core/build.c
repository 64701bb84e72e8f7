/* From balls to the mesh: the order of the stages of refinement. */
#include "balls_prune.h"
#include "bends.h"
#include "boundary.h"
#include "certificate.h"
#include "memory.h"
#include "mesh.h"
#include "pinch.h"
#include "quality.h"
#include "refine.h"
#include "refine_contacts.h"
#include "refine_disks.h"
#include "seeds.h"
#include "spots.h"
#include "status.h"
#include "tidy.h"
#include "unresolved.h"
#include "vector.h"
#include "verify.h"
#include "volume.h"
#include "volumes.h"

#include <math.h>

typedef struct build
{
  const mlim_field* field;
  const mlim_options* options;
  mlim_context* context;
  mlim_oracle oracle;
  mlim_components components;
  double* volumes; /* of the field, a label */
  size_t* voxels;
  mlim_refinement refinement;
  mlim_balls balls; /* own: after pruning and splitting */
  const mlim_balls* used_balls;
  size_t hidden_ball_count;
  mlim_tidied tidied;
  int has_volume;         /* wanted: the complex is needed to the end */
  double done;            /* of the certificate's stage */
  mlim_boundary boundary; /* of the finished complex */
  mlim_edges edges;       /* of the mesh */
  int32_t* mesh_vertices; /* of each of the complex's vertices, for the volume */
} build;

static mlim_status check_balls(
  const mlim_balls* balls, const mlim_options* options, mlim_context* context)
{
  if (balls->ball_count > options->vertex_limit)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "VertexLimit is %zu, but there are %zu protecting balls; it has to be larger.",
      options->vertex_limit, balls->ball_count);
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    const double* c = balls->centers + 3 * b;
    if (!isfinite(c[0]) || !isfinite(c[1]) || !isfinite(c[2]) || !isfinite(balls->radii[b]) ||
        !(balls->radii[b] > 0))
    {
      return mlim_fail(context, MLIM_INVALID_ARGUMENT,
        "Protecting ball %zu at (%g, %g, %g) has the radius %g; both have to be finite, the radius "
        "above 0.",
        b, c[0], c[1], c[2], balls->radii[b]);
    }
  }
  return MLIM_OK;
}

/* Seeds are no closer to each other than facets of the wanted size would be. */
static mlim_status seed(build* b, int has_points)
{
  size_t count;
  mlim_complex* complex = &b->refinement.complex;
  const mlim_status status = mlim_seeds_on_components(
    complex, &b->components, NULL, b->options->min_component_voxels, b->context, &count);
  b->refinement.insertion_count += count;
  /* Points that are known already stand on every sheet. */
  return status != MLIM_OK || has_points ? status
                                         : mlim_seeds_on_sheets(complex, 2 * b->options->facet_size,
                                             b->refinement.progress, b->context, &count);
}

/* Replaces the balls by others made from them. */
static void take_balls(build* b, const mlim_balls* balls)
{
  mlim_balls_free(&b->balls);
  b->balls = *balls;
  b->used_balls = &b->balls;
}

/* Puts balls into the triangulation; those that hide others or are hidden are marked and counted. */
typedef mlim_status (*ball_step)(build* b, unsigned char* is_hidden, size_t* count);

static mlim_status start(build* b, unsigned char* is_hidden, size_t* count)
{
  const double progress = b->refinement.progress;
  mlim_refine_free(&b->refinement);
  return mlim_refine_start(
    &b->refinement, &b->oracle, b->used_balls, b->options, progress, b->context, is_hidden, count);
}

static mlim_status enter(build* b, unsigned char* is_hidden, size_t* count)
{
  return mlim_contacts_enter(&b->refinement, b->context, is_hidden, count);
}

/* With all balls that do not hide each other. */
static mlim_status put_balls(build* b, ball_step step)
{
  enum
  {
    MAX_TRIES = 16 /* each takes balls out, nearly always all of them at the first */
  };
  mlim_status status = MLIM_OK;
  for (int try = 0; try < MAX_TRIES && status == MLIM_OK; ++try)
  {
    unsigned char* is_hidden = mlim_allocate(b->used_balls->ball_count, 1);
    size_t count = 0;
    status = is_hidden == NULL ? mlim_fail_memory(b->context, "the protecting balls")
                               : mlim_balls_find_held(b->used_balls, b->context, is_hidden, &count);
    if (status == MLIM_OK && count == 0)
    {
      status = step(b, is_hidden, &count);
    }
    mlim_balls pruned = { 0 };
    if (status == MLIM_OK && count > 0)
    {
      status = mlim_balls_prune(b->used_balls, is_hidden, b->context, &pruned);
    }
    mlim_release(is_hidden);
    if (status != MLIM_OK || count == 0)
    {
      return status;
    }
    b->hidden_ball_count += count;
    take_balls(b, &pruned);
  }
  return mlim_fail(b->context, MLIM_INVALID_ARGUMENT,
    "The protecting balls hide each other; no ball may hold the centre of another one.");
}

static mlim_status refine_from_balls(build* b, ball_step step)
{
  mlim_status status = put_balls(b, step);
  if (status == MLIM_OK)
  {
    status = seed(b, step == enter);
  }
  return status == MLIM_OK ? mlim_refine_run(&b->refinement, MLIM_GOAL_TOPOLOGY, b->context)
                           : status;
}

static mlim_status cover_spots(build* b, size_t* count)
{
  mlim_balls balls;
  const mlim_status status =
    mlim_spots_cover(&b->refinement, b->used_balls, b->context, &balls, count);
  if (status != MLIM_OK || *count == 0)
  {
    return status;
  }
  take_balls(b, &balls);
  return refine_from_balls(b, enter);
}

/* Topology first, while the triangulation is small: what cannot be resolved is covered by contacts, and
   sampled anew round them. */
static mlim_status refine_topology(build* b)
{
  enum
  {
    MAX_ROUNDS = 2 /* a third one finds a fifth of the first, and changes little */
  };
  mlim_balls trimmed;
  mlim_status status = mlim_bends_trim(b->field, b->used_balls, b->options, b->context, &trimmed);
  if (status == MLIM_OK)
  {
    take_balls(b, &trimmed);
    status = refine_from_balls(b, start);
  }
  size_t count = 1;
  for (int round = 0; round < MAX_ROUNDS && status == MLIM_OK && count > 0; ++round)
  {
    status = cover_spots(b, &count);
  }
  return status;
}

static mlim_status refine_all(build* b)
{
  enum
  {
    /* Most meshes are done after two or three; each later one changes less. */
    MAX_ROUNDS = 8
  };
  mlim_status status = refine_topology(b);
  mlim_verification verification = { .refinement = &b->refinement,
    .components = &b->components,
    .volumes = b->volumes,
    .voxels = b->voxels };
  size_t found = 1;
  for (int round = 0; round < MAX_ROUNDS && status == MLIM_OK && found > 0; ++round)
  {
    status = mlim_refine_run(&b->refinement, MLIM_GOAL_QUALITY, b->context);
    if (status == MLIM_OK)
    {
      verification.round = round;
      status = mlim_verify_round(&verification, b->context, &found);
    }
  }
  mlim_verify_free(&verification);
  return status == MLIM_OK && found > 0
           ? mlim_refine_run(&b->refinement, MLIM_GOAL_QUALITY, b->context)
           : status;
}

static mlim_status find_boundary(build* b, mlim_mesh* out)
{
  (void)out;
  return mlim_boundary_find(&b->refinement.complex, b->done, b->context, &b->boundary);
}

static mlim_status tidy(build* b, mlim_mesh* out)
{
  (void)out;
  return mlim_tidy_run(&b->refinement, &b->boundary, b->done, b->context, &b->tidied);
}

static mlim_status settle_pinches(build* b, mlim_mesh* out)
{
  (void)out;
  mlim_balls balls;
  size_t count;
  const mlim_status status =
    mlim_pinch_run(&b->refinement, b->done, b->context, &balls, &count, &b->tidied.stray_count);
  if (status != MLIM_OK || count == 0)
  {
    return status;
  }
  mlim_balls_free(&b->balls);
  b->balls = balls;
  b->used_balls = &b->balls;
  b->refinement.complex.balls = &b->balls;
  return MLIM_OK;
}

static mlim_status read(build* b, mlim_mesh* out)
{
  const size_t count = b->refinement.complex.vertex_count;
  b->mesh_vertices = mlim_allocate(count, sizeof *b->mesh_vertices);
  return b->mesh_vertices == NULL ? mlim_fail_memory(b->context, "the mesh")
                                  : mlim_mesh_read(&b->refinement.complex, &b->boundary, b->done,
                                      b->context, b->mesh_vertices, out);
}

static mlim_status count_unresolved(build* b, mlim_mesh* out)
{
  mlim_report* report = &out->report;
  const mlim_status status =
    mlim_unresolved_count(&b->refinement.complex, b->options, b->done, b->context, report);
  report->insertion_count = b->refinement.insertion_count;
  report->relabeled_cell_count = b->tidied.change_count;
  report->hidden_ball_count = b->hidden_ball_count;
  report->unresolved_patch_count = b->tidied.stray_count;
  return status;
}

static mlim_status count_disks(build* b, mlim_mesh* out)
{
  const mlim_status status = mlim_disks_settle(&b->refinement, MLIM_CERTIFY_FROM, b->context);
  return status == MLIM_OK ? mlim_mesh_list_failures(&b->refinement.complex, b->context, out)
                           : status;
}

static mlim_status count_components(build* b, mlim_mesh* out)
{
  return mlim_certificate_count_components(
    &b->refinement.complex, &b->components, b->options->min_component_voxels, b->context, out);
}

/* Room for what the mesh alone is measured with. */
static mlim_status release_complex(build* b, mlim_mesh* out)
{
  (void)out;
  mlim_boundary_free(&b->boundary);
  mlim_components_free(&b->components);
  mlim_complex_free_records(&b->refinement.complex);
  if (!b->has_volume)
  {
    mlim_refine_free(&b->refinement);
  }
  return MLIM_OK;
}

static mlim_status find_edges(build* b, mlim_mesh* out)
{
  return mlim_edges_create(out, b->done, b->context, &b->edges);
}

static mlim_status find_patches(build* b, mlim_mesh* out)
{
  return mlim_quality_find_patches(out, &b->edges, b->context);
}

static mlim_status settle_edges(build* b, mlim_mesh* out)
{
  return mlim_quality_settle_edges(out, &b->edges, b->context);
}

static mlim_status measure_quality(build* b, mlim_mesh* out)
{
  const mlim_status status =
    mlim_quality_measure(out, &b->edges, b->options->facet_radius_edge_ratio, b->done, b->context);
  mlim_report* report = &out->report;
  const size_t known = report->unresolved_ratio_count;
  report->relabeled_ratio_count -=
    known < report->relabeled_ratio_count ? known : report->relabeled_ratio_count;
  return status;
}

static mlim_status count_open_edges(build* b, mlim_mesh* out)
{
  return mlim_quality_count_open_edges(
    out, &b->edges, b->done, b->context, &out->certificate.open_edge_count);
}

static mlim_status certify(build* b, mlim_mesh* out)
{
  const mlim_certificate_input input = {
    .oracle = &b->oracle, .options = b->options, .volumes = b->volumes, .voxels = b->voxels
  };
  return mlim_certificate_measure(&input, b->context, out);
}

static mlim_status read_and_measure(build* b, mlim_mesh* out)
{
  /* Certifying reports the rest of the stage itself. */
  mlim_status (*const steps[])(build*, mlim_mesh*) = { find_boundary, tidy, settle_pinches, read,
    count_unresolved, count_disks, count_components, release_complex, find_edges, find_patches,
    settle_edges, measure_quality, count_open_edges, certify };
  const size_t count = sizeof steps / sizeof *steps;
  /* Seeding may have ended at the vertex limit. */
  mlim_status status = mlim_refine_update(&b->refinement, b->context);
  for (size_t k = 0; k < count && status == MLIM_OK; ++k)
  {
    b->done = MLIM_CERTIFY_FROM * (double)k / (double)count;
    status = mlim_progress(b->context, MLIM_STAGE_CERTIFICATE, b->done);
    status = status == MLIM_OK ? steps[k](b, out) : status;
  }
  return status == MLIM_OK ? mlim_progress(b->context, MLIM_STAGE_CERTIFICATE, 1) : status;
}

static mlim_status measure_field(build* b)
{
  const size_t labels = (size_t)mlim_field_label_count(b->field);
  b->volumes = mlim_allocate(labels, sizeof *b->volumes);
  b->voxels = mlim_allocate(labels, sizeof *b->voxels);
  if (b->volumes == NULL || b->voxels == NULL)
  {
    return mlim_fail_memory(b->context, "the volumes of the labels");
  }
  mlim_components_count_voxels(&b->components, labels, b->voxels);
  return mlim_volumes_of_field(b->field, b->context, b->volumes);
}

static mlim_status fill_volume(build* b, const mlim_mesh* mesh, size_t count, mlim_volume* out)
{
  const mlim_volume_input input = { .complex = &b->refinement.complex,
    .mesh = mesh,
    .mesh_vertices = b->mesh_vertices,
    .mesh_vertices_count = count,
    .options = b->options };
  return mlim_volume_make(&input, b->context, out);
}

/* `volume` may be NULL: the surface alone. */
static mlim_status refine(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, mlim_context* context, mlim_mesh* out, mlim_volume* volume)
{
  mlim_options complete = *options;
  mlim_status status = mlim_options_complete(field, context, &complete);
  if (status == MLIM_OK)
  {
    status = check_balls(balls, &complete, context);
  }
  if (status != MLIM_OK)
  {
    return status;
  }
  build b = { .field = field,
    .used_balls = balls,
    .options = &complete,
    .context = context,
    .has_volume = volume != NULL,
    .oracle = {
      .field = field, .tolerance = complete.crossing_tolerance, .mode = complete.oracle_mode } };
  status = mlim_progress(context, MLIM_STAGE_SURFACE, 0);
  if (status == MLIM_OK)
  {
    status = mlim_components_find(field, context, &b.components);
  }
  if (status == MLIM_OK)
  {
    status = measure_field(&b);
  }
  mlim_status outcome = status;
  if (status == MLIM_OK)
  {
    outcome = refine_all(&b);
  }
  if (outcome == MLIM_OK || outcome == MLIM_VERTEX_LIMIT)
  {
    status = read_and_measure(&b, out);
    outcome = status != MLIM_OK ? status : b.tidied.is_limited ? MLIM_VERTEX_LIMIT : outcome;
  }
  if (volume != NULL && (outcome == MLIM_OK || outcome == MLIM_VERTEX_LIMIT))
  {
    status = fill_volume(&b, out, b.refinement.complex.vertex_count, volume);
    outcome = status == MLIM_OK ? outcome : status;
  }
  mlim_release(b.mesh_vertices);
  mlim_refine_free(&b.refinement);
  mlim_balls_free(&b.balls);
  mlim_edges_free(&b.edges);
  mlim_boundary_free(&b.boundary);
  mlim_components_free(&b.components);
  mlim_release(b.volumes);
  mlim_release(b.voxels);
  if (outcome != MLIM_OK && outcome != MLIM_VERTEX_LIMIT)
  {
    mlim_mesh_free(out);
  }
  return outcome;
}

static mlim_status check_arguments(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, int has_results, mlim_context* context)
{
  return has_results && field != NULL && balls != NULL && options != NULL
           ? MLIM_OK
           : mlim_fail(context, MLIM_INVALID_ARGUMENT,
               "The field, the balls, the options or the result are NULL.");
}

mlim_status mlim_mesh_refine(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, mlim_context* context, mlim_mesh* out)
{
  const mlim_status status = check_arguments(field, balls, options, out != NULL, context);
  if (status != MLIM_OK)
  {
    return status;
  }
  *out = (mlim_mesh){ 0 };
  return refine(field, balls, options, context, out, NULL);
}

mlim_status mlim_volume_refine(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, mlim_context* context, mlim_mesh* surface, mlim_volume* out)
{
  const mlim_status status =
    check_arguments(field, balls, options, surface != NULL && out != NULL, context);
  if (status != MLIM_OK)
  {
    return status;
  }
  *surface = (mlim_mesh){ 0 };
  *out = (mlim_volume){ 0 };
  return refine(field, balls, options, context, surface, out);
}
