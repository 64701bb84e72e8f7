#include "measure.h"

#include "bulk.h"
#include "clock.h"
#include "process.h"
#include "threads.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- stages ---- */

/* Adds time to the stage that is on. */
typedef struct stopwatch
{
  bench_figures* figures;
  mlim_stage stage; /* MLIM_STAGE_END: none */
  double begin;
  size_t memory_before; /* of the surface's stage */
} stopwatch;

static void see_peak(stopwatch* watch)
{
  const size_t peak = bench_memory_peak();
  bench_figures* f = watch->figures;
  f->peak_memory = peak > f->peak_memory ? peak : f->peak_memory;
  if (watch->stage == MLIM_STAGE_SURFACE && peak > watch->memory_before)
  {
    f->refinement_memory = peak - watch->memory_before;
  }
}

/* Looking at the memory takes time, which no stage pays. */
static void switch_to(stopwatch* watch, mlim_stage stage)
{
  if (watch->stage != MLIM_STAGE_END)
  {
    watch->figures->user[watch->stage] += bench_clock_user() - watch->begin;
  }
  see_peak(watch);
  if (stage == MLIM_STAGE_SURFACE)
  {
    bench_memory_reset();
    watch->memory_before = bench_memory_now();
  }
  watch->stage = stage;
  watch->begin = bench_clock_user();
}

static int on_progress(void* user, mlim_stage stage, double fraction)
{
  stopwatch* watch = user;
  (void)fraction;
  if (stage != watch->stage)
  {
    switch_to(watch, stage);
  }
  return 0;
}

/* ---- the whole core ---- */

typedef struct products
{
  mlim_field* field;
  mlim_options options;
  mlim_curves curves;
  mlim_balls balls;
  mlim_mesh mesh;
} products;

static void free_products(products* p)
{
  mlim_mesh_free(&p->mesh);
  mlim_balls_free(&p->balls);
  mlim_curves_free(&p->curves);
  mlim_field_free(p->field);
  *p = (products){ 0 };
}

static double smallest_spacing(const mlim_grid* grid)
{
  return fmin(grid->spacing[0], fmin(grid->spacing[1], grid->spacing[2]));
}

mlim_status bench_options(const mlim_grid* grid, const mlim_field* field,
  const bench_demand* demand, mlim_context* context, mlim_options* out)
{
  *out = mlim_options_default(field);
  if (demand->facet_size > 0)
  {
    out->facet_size = demand->facet_size * smallest_spacing(grid);
    /* These follow from it anew. */
    out->facet_distance = 0;
    out->edge_size = 0;
    out->smallest_distance = 0;
    out->cell_size = 0;
  }
  if (demand->has_bounds_only)
  {
    out->volume_tolerance = 0;
  }
  return mlim_options_complete(field, context, out);
}

static mlim_status run_stages(
  const mlim_grid* grid, const bench_demand* demand, stopwatch* watch, products* p, char* message)
{
  mlim_context context = { .progress = on_progress,
    .parallel_for = demand->thread_count > 0 ? bench_threads_for : NULL,
    .user = watch };
  const double user_begin = bench_clock_user();
  const double wall_begin = bench_clock_wall();
  switch_to(watch, MLIM_STAGE_FIELD);
  mlim_status status = mlim_field_create(grid, &context, &p->field);
  if (status == MLIM_OK)
  {
    status = bench_options(grid, p->field, demand, &context, &p->options);
  }
  if (status == MLIM_OK)
  {
    switch_to(watch, MLIM_STAGE_CURVES);
    status = mlim_curves_extract(p->field, &p->options, &context, &p->curves);
  }
  if (status == MLIM_OK)
  {
    switch_to(watch, MLIM_STAGE_BALLS);
    status = mlim_balls_cover(&p->curves, &p->options, &context, &p->balls);
  }
  if (status == MLIM_OK)
  {
    switch_to(watch, MLIM_STAGE_SURFACE);
    status = mlim_mesh_refine(p->field, &p->balls, &p->options, &context, &p->mesh);
  }
  switch_to(watch, MLIM_STAGE_END);
  watch->figures->total_user = bench_clock_user() - user_begin;
  watch->figures->total_wall = bench_clock_wall() - wall_begin;
  if (status != MLIM_OK)
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "%s", context.message);
  }
  return status;
}

/* ---- the final weighted points ---- */

/* A point and its weight: by x, y, z. */
static int compare_points(const void* a, const void* b)
{
  const double* p = a;
  const double* q = b;
  for (int k = 0; k < 3; ++k)
  {
    if (p[k] < q[k] || p[k] > q[k])
    {
      return p[k] < q[k] ? -1 : 1;
    }
  }
  return 0;
}

static double* sorted_balls(const mlim_balls* balls)
{
  double* sorted = malloc((balls->ball_count + 1) * 4 * sizeof *sorted);
  for (size_t b = 0; sorted != NULL && b < balls->ball_count; ++b)
  {
    memcpy(sorted + 4 * b, balls->centers + 3 * b, 3 * sizeof *sorted);
    sorted[4 * b + 3] = balls->radii[b] * balls->radii[b];
  }
  if (sorted != NULL)
  {
    qsort(sorted, balls->ball_count, 4 * sizeof *sorted, compare_points);
  }
  return sorted;
}

/* The mesh's vertices. Those at the centre of a ball, digit for digit, have its weight; the others
   have none. NULL: not enough memory. */
static double* weighted_points(const products* p, size_t* unweighted_count)
{
  const mlim_mesh* mesh = &p->mesh;
  double* points = malloc((mesh->vertex_count + 1) * 4 * sizeof *points);
  double* balls = sorted_balls(&p->balls);
  *unweighted_count = 0;
  for (size_t v = 0; points != NULL && balls != NULL && v < mesh->vertex_count; ++v)
  {
    double* point = points + 4 * v;
    memcpy(point, mesh->vertices + 3 * v, 3 * sizeof *point);
    const double* ball =
      bsearch(point, balls, p->balls.ball_count, 4 * sizeof *balls, compare_points);
    point[3] = ball == NULL ? 0 : ball[3];
    const int is_on_curve = mesh->node_types[v] % MLIM_NODE_ON_BOX != MLIM_NODE_INTERFACE;
    *unweighted_count += is_on_curve && ball == NULL;
  }
  if (balls == NULL)
  {
    free(points);
    points = NULL;
  }
  free(balls);
  return points;
}

/* ---- a run ---- */

static void copy_counts(const products* p, const mlim_grid* grid, bench_figures* f)
{
  f->facet_size = p->options.facet_size / smallest_spacing(grid);
  f->vertex_count = p->mesh.vertex_count;
  f->triangle_count = p->mesh.triangle_count;
  f->insertion_count = p->mesh.report.insertion_count;
  f->curve_count = p->curves.curve_count;
  f->ball_count = p->balls.ball_count;
}

static void run_case(const bench_demand* demand, const char* folder, bench_figures* out)
{
  *out = (bench_figures){ 0 };
  bench_image image;
  products made = { 0 };
  if (demand->thread_count > 0)
  {
    bench_threads_set(demand->thread_count);
  }
  if (bench_case_load(demand->one, folder, out->message, &image))
  {
    out->has_failed = 1;
    return;
  }
  bench_memory_reset();
  out->input_memory = bench_memory_now();
  stopwatch watch = { .figures = out, .stage = MLIM_STAGE_END };
  const mlim_status status = run_stages(&image.grid, demand, &watch, &made, out->message);
  out->has_failed = status != MLIM_OK && status != MLIM_VERTEX_LIMIT;
  double* points = NULL;
  copy_counts(&made, &image.grid, out);
  if (!out->has_failed)
  {
    points = weighted_points(&made, &out->unweighted_count);
  }
  free_products(&made);
  if (image.release != NULL)
  {
    image.release(image.owner);
  }
  if (!out->has_failed)
  {
    out->bulk = points == NULL ? -1 : bench_bulk_seconds(points, out->vertex_count, 1);
  }
  free(points);
}

/* ---- its process ---- */

typedef struct job
{
  const bench_demand* demand;
  const char* folder;
} job;

static void work(const void* given, void* out)
{
  const job* one = given;
  run_case(one->demand, one->folder, out);
}

void bench_measure(const bench_demand* demand, const char* folder, bench_figures* out)
{
  const job one = { demand, folder };
  char message[BENCH_MESSAGE_SIZE];
  if (bench_process_run(work, &one, 0, sizeof *out, out, message))
  {
    *out = (bench_figures){ .has_failed = 1 };
    memcpy(out->message, message, sizeof message);
  }
}
