/* Refinement as a fixed point, its bounds one by one, and its vertex limit. */
#include "audit.h"
#include "mesh.h"
#include "refine.h"
#include "refine_disks.h"
#include "seeds.h"
#include "shapes.h"
#include "tidy_disks.h"

static mlim_status run_shape(int kind, const mlim_options* options, run* out)
{
  const shape s = shape_of(kind);
  image* im = shape_sample(&s);
  mlim_context context = { 0 };
  const mlim_status status = run_grid(&im->grid, options, &context, out);
  image_free(im);
  return status;
}

/* ---- fixed point ---- */

/* Refining what is finished inserts nothing. */
/* What the loop has noted of each vertex's disk is what a look at all of them says. */
static void check_disks(mlim_refinement* refinement)
{
  mlim_complex* complex = &refinement->complex;
  CHECK(mlim_disks_settle(refinement, 0, NULL) == MLIM_OK);
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
  {
    mlim_disk disk;
    CHECK(mlim_disk_check(
            complex, &refinement->links, (int32_t)v, &refinement->star, NULL, &disk) == MLIM_OK);
    CHECK(complex->vertices[v].is_broken == (disk == MLIM_DISK_FAILS));
  }
}

/* Each vertex that fails is listed once, by place and type. */
static void check_listed(const mlim_complex* complex)
{
  mlim_mesh mesh = { 0 };
  size_t at = 0;
  CHECK(mlim_mesh_list_failures(complex, NULL, &mesh) == MLIM_OK);
  CHECK_COUNT(mesh.certificate.disk_failure_count, mlim_complex_count_broken(complex));
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
  {
    const mlim_vertex* vertex = &complex->vertices[v];
    if (vertex->is_broken && at < mesh.certificate.disk_failure_count)
    {
      const int32_t type = mesh.disk_failure_types[at] % MLIM_NODE_ON_BOX;
      CHECK(mlim_distance(vertex->point, mesh.disk_failures + 3 * at) == 0);
      CHECK((type == MLIM_NODE_INTERFACE) == (vertex->kind == MLIM_VERTEX_SURFACE));
      ++at;
    }
  }
  CHECK_COUNT(at, mesh.certificate.disk_failure_count);
  mlim_mesh_free(&mesh);
}

/* What tidying remembers of the disks of a cell's vertices is what a check of them says. */
static size_t check_asked(tidy_disks* disks, const mlim_cell* cell)
{
  size_t failed_count = 0;
  for (int k = 0; k < 4; ++k)
  {
    int is_asked;
    int is_checked;
    CHECK(tidy_disks_ask(disks, cell->vertices[k], NULL, &is_asked) == MLIM_OK);
    CHECK(tidy_disks_check(disks, cell->vertices[k], NULL, &is_checked) == MLIM_OK);
    CHECK(is_asked == is_checked);
    failed_count += is_asked != 0;
  }
  return failed_count;
}

/* Also when a label changes and changes back. */
static void ask_disks(mlim_refinement* refinement)
{
  mlim_complex* complex = &refinement->complex;
  tidy_disks disks;
  size_t broken_count = 0;
  CHECK(tidy_disks_create(refinement, NULL, &disks) == MLIM_OK);
  for (size_t c = 0; c < complex->cell_count; c += 97)
  {
    mlim_cell* cell = &complex->cells[c];
    const int32_t label = cell->label;
    for (int way = 0; way < 2 && cell->vertices[0] >= MLIM_FAR_VERTICES && label != 0; ++way)
    {
      CHECK(way == 1 || check_asked(&disks, cell) == 0);
      cell->label = way == 0 ? 0 : label;
      mlim_complex_touch_cell(complex, (int32_t)c);
      tidy_disks_update(&disks, (int32_t)c);
      const size_t count = check_asked(&disks, cell);
      CHECK(way == 0 || count == 0);
      broken_count += count;
    }
  }
  CHECK(broken_count > 0);
  tidy_disks_free(&disks);
}

/* A cell with a label of its own breaks disks, which are noticed once it is said to have changed. */
static void break_disks(mlim_refinement* refinement)
{
  mlim_complex* complex = &refinement->complex;
  size_t changed = 0;
  for (size_t c = 0; c < complex->cell_count && changed < 20; c += 97)
  {
    mlim_cell* cell = &complex->cells[c];
    if (cell->vertices[0] >= MLIM_FAR_VERTICES && cell->label != 0)
    {
      cell->label = 0;
      mlim_complex_touch_cell(complex, (int32_t)c);
      ++changed;
    }
  }
  check_disks(refinement);
  CHECK(mlim_complex_count_broken(complex) > 0);
  check_listed(complex);
}

static void test_fixed_point(int kind)
{
  const mlim_options options = run_options(1);
  run r;
  CHECK(run_shape(kind, &options, &r) == MLIM_OK);
  const mlim_oracle oracle = {
    .field = r.field, .tolerance = r.options.crossing_tolerance, .mode = r.options.oracle_mode
  };
  mlim_refinement refinement;
  mlim_components components;
  size_t count;
  CHECK(mlim_components_find(r.field, NULL, &components) == MLIM_OK);
  unsigned char* is_hidden = calloc(r.balls.ball_count + 1, 1);
  CHECK(mlim_refine_start(&refinement, &oracle, &r.balls, &r.options, 0, NULL, is_hidden, &count) ==
        MLIM_OK);
  CHECK_COUNT(count, 0);
  free(is_hidden);
  CHECK(
    mlim_seeds_on_components(&refinement.complex, &components, NULL, 1, NULL, &count) == MLIM_OK);
  CHECK(mlim_refine_run(&refinement, MLIM_GOAL_TOPOLOGY, NULL) == MLIM_OK);
  const size_t coarse = refinement.complex.vertex_count;
  CHECK(mlim_refine_run(&refinement, MLIM_GOAL_TOPOLOGY, NULL) == MLIM_OK);
  CHECK_COUNT(refinement.complex.vertex_count, coarse);
  CHECK(mlim_refine_run(&refinement, MLIM_GOAL_QUALITY, NULL) == MLIM_OK);
  const size_t fine = refinement.complex.vertex_count;
  CHECK(fine > coarse);
  CHECK(mlim_refine_run(&refinement, MLIM_GOAL_QUALITY, NULL) == MLIM_OK);
  CHECK(mlim_refine_run(&refinement, MLIM_GOAL_TOPOLOGY, NULL) == MLIM_OK);
  CHECK_COUNT(refinement.complex.vertex_count, fine);
  check_disks(&refinement);
  CHECK_COUNT(mlim_complex_count_broken(&refinement.complex), 0);
  ask_disks(&refinement);
  break_disks(&refinement);
  mlim_refine_free(&refinement);
  mlim_components_free(&components);
  run_free(&r);
}

/* ---- bounds ---- */

typedef struct measures
{
  double circumradius; /* largest, of triangles without a ball vertex */
  double ratio;
  size_t vertex_count;
} measures;

static measures measure(const run* r)
{
  measures m = { .vertex_count = r->mesh.vertex_count };
  for (size_t t = 0; t < r->mesh.triangle_count; ++t)
  {
    const int32_t* v = r->mesh.triangles + 3 * t;
    double shortest = INFINITY;
    for (int k = 0; k < 3; ++k)
    {
      shortest = fmin(
        shortest, audit_length(audit_point(&r->mesh, v[k]), audit_point(&r->mesh, v[(k + 1) % 3])));
    }
    const double ratio = audit_ratio(&r->mesh, t);
    if (!audit_has_ball(&r->mesh, t))
    {
      m.circumradius = fmax(m.circumradius, ratio * shortest);
      m.ratio = fmax(m.ratio, ratio);
    }
  }
  return m;
}

/* Each tighter bound is met, and costs vertices. */
static void test_bounds(int kind)
{
  const struct
  {
    size_t option;
    double bounds[4];
  } rows[] = {
    { offsetof(mlim_options, facet_size), { 4, 2, 1, 0.5 } },
    { offsetof(mlim_options, facet_distance), { 0.4, 0.1, 0.025, 0.006 } },
    { offsetof(mlim_options, facet_radius_edge_ratio), { 3, 2, 1.4, 1 } },
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    measures last = { .circumradius = INFINITY, .ratio = INFINITY };
    for (int b = 0; b < 4; ++b)
    {
      mlim_options options = run_options(4);
      options.facet_distance = 1;
      options.volume_tolerance = 0; /* it would tighten bounds by itself */
      options.facet_radius_edge_ratio = 3;
      *(double*)((char*)&options + rows[k].option) = rows[k].bounds[b];
      options.edge_size = fmin(1, options.facet_size); /* balls must not be in the way */
      options.smallest_distance = options.facet_size / 8;
      run r;
      if (run_shape(kind, &options, &r) != MLIM_OK)
      {
        CHECK(0 && "a mesh");
        run_free(&r);
        continue;
      }
      audit_mesh(r.field, &r.balls, &r.options, &r.mesh);
      const measures m = measure(&r);
      CHECK(m.vertex_count >= last.vertex_count);
      CHECK(rows[k].option != offsetof(mlim_options, facet_size) ||
            m.circumradius <= r.options.facet_size * (1 + 1e-9));
      CHECK(rows[k].option != offsetof(mlim_options, facet_radius_edge_ratio) ||
            m.ratio <= r.options.facet_radius_edge_ratio + 1e-9);
      CHECK_COUNT(r.mesh.report.unresolved_size_count, 0);
      CHECK_BELOW(fabs(m.ratio - r.mesh.report.max_radius_edge_ratio), 1e-9);
      last = m;
      run_free(&r);
    }
  }
}

/* Finer facets bring the volume closer to the truth. */
static void test_volume_converges(void)
{
  const double sizes[] = { 4, 2, 1, 0.5 };
  const shape s = shape_of(SHAPE_SPHERE);
  double last = INFINITY;
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; ++k)
  {
    mlim_options options = run_options(sizes[k]);
    options.volume_tolerance = 0;
    run r;
    const mlim_status status = run_shape(SHAPE_SPHERE, &options, &r);
    CHECK(status == MLIM_OK);
    const double error = status == MLIM_OK ? fabs(r.mesh.volumes[1] / s.volume[1] - 1) : INFINITY;
    CHECK(error < last);
    last = error;
    run_free(&r);
  }
}

/* ---- vertex limit ---- */

/* Whatever the limit, what comes back is a labelled partition. */
static void test_vertex_limit(int kind)
{
  const mlim_options free_options = run_options(1);
  run whole;
  CHECK(run_shape(kind, &free_options, &whole) == MLIM_OK);
  for (size_t limit = whole.balls.ball_count + 60; limit < whole.mesh.vertex_count; limit *= 2)
  {
    mlim_options options = run_options(1);
    options.vertex_limit = limit;
    run r;
    const mlim_status status = run_shape(kind, &options, &r);
    CHECK(status == MLIM_VERTEX_LIMIT);
    CHECK(r.mesh.triangle_count > 0);
    CHECK_BELOW((double)r.mesh.vertex_count, (double)limit);
    if (status == MLIM_VERTEX_LIMIT)
    {
      audit_partition(r.field, &r.mesh);
    }
    run_free(&r);
  }
  run_free(&whole);
}

/* A ball's centre in another ball, nearer in power to that one: it is left out, or the next point would
   hide it. */
static void test_held_ball(void)
{
  const shape s = shape_of(SHAPE_SPHERE);
  image* im = shape_sample(&s);
  run r = { 0 };
  CHECK(mlim_field_create(&im->grid, NULL, &r.field) == MLIM_OK);
  r.options = run_options(1);
  CHECK(mlim_options_complete(r.field, NULL, &r.options) == MLIM_OK);
  double centers[] = { 5, 5, 5, 5.9, 5, 5 };
  double radii[] = { 1, 0.05 };
  int32_t curves[] = { MLIM_JUNCTION, MLIM_JUNCTION };
  int32_t ball_sets[] = { 0, 0 };
  size_t offsets[] = { 0, 2 };
  int32_t labels[] = { 0, 1 };
  const mlim_balls balls = { .ball_count = 2,
    .centers = centers,
    .radii = radii,
    .ball_curves = curves,
    .ball_sets = ball_sets,
    .sets = { .count = 1, .offsets = offsets, .labels = labels } };
  CHECK(mlim_mesh_refine(r.field, &balls, &r.options, NULL, &r.mesh) == MLIM_OK);
  CHECK_COUNT(r.mesh.report.hidden_ball_count, 1);
  audit_partition(r.field, &r.mesh);
  run_free(&r);
  image_free(im);
}

int main(void)
{
  const int kinds[] = { SHAPE_SPHERE, SHAPE_TWO_SPHERES, SHAPE_CUT_SPHERE, SHAPE_OCTANTS };
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
  {
    test_fixed_point(kinds[k]);
    test_vertex_limit(kinds[k]);
  }
  test_bounds(SHAPE_SPHERE);
  test_bounds(SHAPE_TWO_SPHERES);
  test_volume_converges();
  test_held_ball();
  return check_result();
}
