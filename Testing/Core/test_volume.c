/* Volumes of shapes that are known beforehand. */
#include "audit_volume.h"
#include "shapes.h"

static mlim_status make(const image* im, const mlim_options* options, run* out)
{
  mlim_context context = { 0 };
  const mlim_status status = run_volume(&im->grid, options, &context, out);
  if (status != MLIM_OK && status != MLIM_VERTEX_LIMIT)
  {
    fprintf(stderr, "%s\n", context.message);
  }
  return status;
}

static int is_same_mesh(const mlim_mesh* a, const mlim_mesh* b)
{
  return a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
         memcmp(a->vertices, b->vertices, 3 * a->vertex_count * sizeof *a->vertices) == 0 &&
         memcmp(a->triangles, b->triangles, 3 * a->triangle_count * sizeof *a->triangles) == 0 &&
         memcmp(a->triangle_labels, b->triangle_labels,
           2 * a->triangle_count * sizeof *a->triangle_labels) == 0 &&
         memcmp(&a->report, &b->report, sizeof a->report) == 0 &&
         memcmp(&a->certificate, &b->certificate, sizeof a->certificate) == 0;
}

typedef struct figures
{
  double min_angle, max_angle;
  size_t slivers; /* below 10 degrees or above 170 */
  size_t large;   /* cells above a size, by label */
  size_t large_of[16];
  size_t long_ones; /* above the ratio, without a ball's vertex */
  double max_ratio; /* of them all */
} figures;

static figures measure(const run* r, double size)
{
  figures f = { .min_angle = 180 };
  for (size_t c = 0; c < r->volume.cell_count; ++c)
  {
    double angles[2];
    double radius;
    double shortest;
    audit_angles(&r->volume, c, angles);
    audit_radius(&r->volume, c, &radius, &shortest);
    f.min_angle = fmin(f.min_angle, angles[0]);
    f.max_angle = fmax(f.max_angle, angles[1]);
    f.slivers += angles[0] < 10 || angles[1] > 170;
    f.large += radius > size;
    f.large_of[r->volume.cell_labels[c]] += radius > size;
    int has_ball = 0;
    for (int k = 0; k < 4; ++k)
    {
      const size_t v = (size_t)r->volume.cells[4 * c + (size_t)k];
      has_ball |= v < r->mesh.vertex_count && r->mesh.node_types[v] % 10 != MLIM_NODE_INTERFACE;
    }
    f.long_ones += !has_ball && radius > r->options.cell_radius_edge_ratio * shortest;
    f.max_ratio = has_ball ? f.max_ratio : fmax(f.max_ratio, radius / shortest);
  }
  return f;
}

/* The volume is whole and well shaped, its report true, and the surface is the one without it. */
static void test_shape(int kind)
{
  const int before = check_failures;
  const shape s = shape_of(kind);
  image* im = shape_sample(&s);
  const mlim_options options = run_options(1);
  run alone;
  run r;
  CHECK(run_grid(&im->grid, &options, NULL, &alone) == MLIM_OK);
  CHECK(make(im, &options, &r) == MLIM_OK);
  CHECK(is_same_mesh(&alone.mesh, &r.mesh));
  audit_volume_of(r.field, &r.mesh, &r.volume, 0);
  CHECK((r.volume.cell_count == 0) == (r.mesh.triangle_count == 0));
  for (int l = 0; l < s.label_count; ++l)
  {
    if (s.volume[l] > 0)
    {
      CHECK_BELOW(fabs(r.volume.label_volumes[l] / s.volume[l] - 1), 0.03);
    }
  }
  const figures f = measure(&r, r.options.cell_size);
  const mlim_volume_report* report = &r.volume.report;
  if (r.volume.cell_count > 0)
  {
    CHECK_BELOW(fabs(report->min_dihedral_angle - f.min_angle), 1e-4);
    CHECK_BELOW(fabs(report->max_dihedral_angle - f.max_angle), 1e-4);
    CHECK_BELOW(fabs(report->max_radius_edge_ratio - f.max_ratio), 1e-6 * f.max_ratio);
    CHECK(report->min_cell_volume > 0);
    /* None of these shapes is sharp. */
    CHECK(f.min_angle >= 10);
    CHECK(f.max_angle <= 170);
  }
  CHECK_COUNT(f.slivers, 0);
  CHECK_COUNT(f.long_ones, 0);
  CHECK_COUNT(report->unresolved_sliver_count, 0);
  CHECK_COUNT(report->unresolved_ratio_count, 0);
  run_free(&alone);
  run_free(&r);
  image_free(im);
  shape_report(s.name, before);
}

/* ---- options ---- */

/* Cells above their size are few and counted, and a smaller size makes more cells. */
static void test_size(void)
{
  const shape s = shape_of(SHAPE_TWO_SPHERES);
  image* im = shape_sample(&s);
  size_t cells = 0;
  for (double size = 4; size > 0.9; size *= 0.5)
  {
    mlim_options options = run_options(1);
    options.cell_size = size;
    options.remove_slivers = 0;
    run r;
    CHECK(make(im, &options, &r) == MLIM_OK);
    audit_volume_of(r.field, &r.mesh, &r.volume, 0);
    const figures f = measure(&r, size * (1 + 1e-9));
    CHECK_COUNT(f.large, r.volume.report.unresolved_size_count);
    CHECK_BELOW((double)f.large, 0.01 * (double)r.volume.cell_count);
    CHECK(r.volume.cell_count > cells);
    cells = r.volume.cell_count;
    run_free(&r);
  }
  image_free(im);
}

/* A size of its own for one label leaves the others as they are. */
static void test_label_size(void)
{
  const shape s = shape_of(SHAPE_TWO_SPHERES);
  image* im = shape_sample(&s);
  const mlim_label_size sizes[] = { { .id = 3, .size = 1 }, { .id = 99, .size = 0.01 } };
  mlim_options options = run_options(1);
  options.cell_size = 5;
  run plain;
  run r;
  CHECK(make(im, &options, &plain) == MLIM_OK);
  options.label_sizes = sizes;
  options.label_size_count = 2;
  CHECK(make(im, &options, &r) == MLIM_OK);
  audit_volume_of(r.field, &r.mesh, &r.volume, 0);
  size_t counts[2][3] = { { 0 } };
  for (size_t c = 0; c < plain.volume.cell_count; ++c)
  {
    ++counts[0][plain.volume.cell_labels[c]];
  }
  for (size_t c = 0; c < r.volume.cell_count; ++c)
  {
    ++counts[1][r.volume.cell_labels[c]];
  }
  CHECK(counts[1][2] > 3 * counts[0][2]);
  CHECK_BELOW(fabs((double)counts[1][1] / (double)counts[0][1] - 1), 0.1);
  const figures f = measure(&r, 1.3);
  CHECK(f.large_of[2] < counts[1][2] / 20);
  CHECK(f.large_of[1] > counts[1][1] / 20);
  run_free(&plain);
  run_free(&r);
  image_free(im);
}

/* What the removal of slivers does, and that it is off when it is off. */
static void test_slivers(void)
{
  const shape s = shape_of(SHAPE_TORUS);
  image* im = shape_sample(&s);
  mlim_options options = run_options(1);
  options.cell_size = 1.5;
  run with;
  run without;
  CHECK(make(im, &options, &with) == MLIM_OK);
  options.remove_slivers = 0;
  CHECK(make(im, &options, &without) == MLIM_OK);
  audit_volume_of(without.field, &without.mesh, &without.volume, 0);
  CHECK(measure(&without, 1).slivers > 0);
  CHECK_COUNT(without.volume.report.exchange_count, 0);
  CHECK_COUNT(without.volume.report.added_vertex_count, 0);
  CHECK_COUNT(measure(&with, 1).slivers, 0);
  CHECK(with.volume.report.exchange_count > 0);
  CHECK_COUNT(with.volume.report.sliver_count, measure(&without, 1).slivers);
  run_free(&with);
  run_free(&without);
  image_free(im);
}

/* A tighter ratio makes more cells, and worse ones rarer. */
static void test_ratio(void)
{
  const shape s = shape_of(SHAPE_SPHERE);
  image* im = shape_sample(&s);
  mlim_options options = run_options(1);
  options.cell_size = 20;
  run loose;
  run tight;
  options.cell_radius_edge_ratio = 4;
  CHECK(make(im, &options, &loose) == MLIM_OK);
  options.cell_radius_edge_ratio = 1.5;
  CHECK(make(im, &options, &tight) == MLIM_OK);
  CHECK(tight.volume.report.insertion_count > loose.volume.report.insertion_count);
  CHECK(tight.volume.report.max_radius_edge_ratio < loose.volume.report.max_radius_edge_ratio);
  CHECK_COUNT(measure(&tight, 20).long_ones, tight.volume.report.unresolved_ratio_count);
  run_free(&tight);
  /* Refinement alone leaves some along the surface, whose centres would destroy triangles. */
  options.remove_slivers = 0;
  CHECK(make(im, &options, &tight) == MLIM_OK);
  const size_t left = measure(&tight, 20).long_ones;
  CHECK_COUNT(left, tight.volume.report.unresolved_ratio_count);
  CHECK(left < tight.volume.cell_count / 50);
  run_free(&loose);
  run_free(&tight);
  image_free(im);
}

/* Refinement leaves the balls to the curves. The cells are so small that it would like to enter. */
static void test_balls(void)
{
  const shape s = shape_of(SHAPE_OCTANTS);
  image* im = shape_sample(&s);
  mlim_options options = run_options(1);
  options.cell_size = 0.4;
  options.remove_slivers = 0;
  run r;
  CHECK(make(im, &options, &r) == MLIM_OK);
  CHECK(r.balls.ball_count > 0);
  size_t inside = 0;
  for (size_t v = r.volume.surface_vertex_count; v < r.volume.vertex_count; ++v)
  {
    for (size_t b = 0; b < r.balls.ball_count; ++b)
    {
      inside +=
        mlim_distance(r.volume.vertices + 3 * v, r.balls.centers + 3 * b) < r.balls.radii[b];
    }
  }
  CHECK_COUNT(inside, 0);
  run_free(&r);
  image_free(im);
}

/* The budget holds for the volume as well, whose cells are valid wherever it ends. */
static void test_limit(void)
{
  const shape s = shape_of(SHAPE_SPHERE);
  image* im = shape_sample(&s);
  mlim_options options = run_options(1);
  options.cell_size = 0.8;
  run whole;
  CHECK(make(im, &options, &whole) == MLIM_OK);
  const size_t surface = whole.mesh.vertex_count;
  const size_t limits[] = { 20, surface / 2, surface + 7, whole.volume.vertex_count - 100 };
  for (size_t k = 0; k < sizeof limits / sizeof *limits; ++k)
  {
    options.vertex_limit = limits[k];
    run r;
    CHECK(make(im, &options, &r) == MLIM_VERTEX_LIMIT);
    CHECK(r.volume.vertex_count <= limits[k]);
    CHECK(r.volume.cell_count > 0);
    audit_volume_of(r.field, &r.mesh, &r.volume, 0);
    run_free(&r);
  }
  run_free(&whole);
  image_free(im);
}

/* With the background the box is full, whatever reaches its faces, and the surface is the same. */
static void test_background(int kind)
{
  const int before = check_failures;
  const shape s = shape_of(kind);
  image* im = shape_sample(&s);
  mlim_options options = run_options(1);
  run plain;
  run r;
  CHECK(make(im, &options, &plain) == MLIM_OK);
  options.keep_background = 1;
  CHECK(make(im, &options, &r) == MLIM_OK);
  CHECK(is_same_mesh(&plain.mesh, &r.mesh));
  audit_volume_of(r.field, &r.mesh, &r.volume, 1);
  CHECK_COUNT(r.volume.report.unresolved_box_count, 0);
  double sum = 0;
  for (size_t l = 0; l < r.volume.label_count; ++l)
  {
    sum += r.volume.label_volumes[l];
    if ((int32_t)l != mlim_field_outside_label(r.field))
    {
      const double same = plain.volume.label_volumes[l];
      CHECK_BELOW(fabs(r.volume.label_volumes[l] - same), 1e-9 * same);
    }
  }
  const double box = (s.dims[0] - 1.0) * (s.dims[1] - 1.0) * (s.dims[2] - 1.0);
  CHECK_BELOW(fabs(sum / box - 1), 1e-12);
  CHECK(measure(&r, 1).min_angle >= 5);
  run_free(&plain);
  run_free(&r);
  image_free(im);
  shape_report(s.name, before);
}

/* Every face of a block is flat, and its volume exact. */
static void test_block(void)
{
  const shape s = shape_of(SHAPE_OCTANTS);
  image* im = shape_sample(&s);
  const mlim_options options = run_options(1);
  run r;
  CHECK(make(im, &options, &r) == MLIM_OK);
  double sum = 0;
  for (size_t l = 0; l < r.volume.label_count; ++l)
  {
    sum += r.volume.label_volumes[l];
  }
  CHECK_BELOW(fabs(sum - 9.0 * 9 * 9), 1e-9);
  run_free(&r);
  image_free(im);
}

int main(void)
{
  for (int kind = 0; kind < SHAPE_COUNT; ++kind)
  {
    test_shape(kind);
    test_background(kind);
  }
  test_size();
  test_label_size();
  test_slivers();
  test_ratio();
  test_balls();
  test_limit();
  test_block();
  return check_result();
}
