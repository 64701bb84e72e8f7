/* From samples to the mesh, on shapes of known topology and volume: Dey, Janoos, Levine, section 3. */
#include "audit.h"
#include "shapes.h"

/* A vertex lies on the interface: two labels meet within this many spacings of it. */
static const double ON_INTERFACE = 1e-4;

/* Trilinear interpolation and flat triangles together lose up to 2 % at radii of 7 spacings. */
static const double VOLUME_TOLERANCE = 0.02;

static int sees_two_labels(const run* r, const double point[3], double reach)
{
  int32_t first = -1;
  for (int k = 0; k < 27; ++k)
  {
    const double direction[3] = { k % 3 - 1.0, k / 3 % 3 - 1.0, k / 9 - 1.0 };
    double at[3];
    for (int j = 0; j < 3; ++j)
    {
      at[j] = point[j] + reach * direction[j];
    }
    const int32_t label = mlim_field_label(r->field, at);
    if (first >= 0 && label != first)
    {
      return 1;
    }
    first = label;
  }
  return 0;
}

static void check_vertices(const run* r)
{
  size_t off = 0;
  for (size_t v = 0; v < r->mesh.vertex_count; ++v)
  {
    off += !sees_two_labels(
      r, r->mesh.vertices + 3 * v, ON_INTERFACE * mlim_field_grid_of(r->field)->unit);
  }
  CHECK_COUNT(off, 0);
}

static void check_certificate(const mlim_certificate* c)
{
  CHECK_COUNT(c->lost_label_count, 0);
  CHECK_COUNT(c->lost_component_count, 0);
  CHECK_COUNT(c->disk_failure_count, 0);
  CHECK_COUNT(c->open_edge_count, 0);
  CHECK_BELOW((double)c->far_crossing_count, 0.01 * (double)c->grid_crossing_count);
}

static void check_report(const mlim_report* report)
{
  CHECK_COUNT(report->unresolved_crossing_count, 0);
  CHECK_COUNT(report->unresolved_patch_count, 0);
  CHECK_COUNT(report->unresolved_ratio_count, 0);
}

/* facet_size 0: the default, too coarse to compare volumes. */
static void test_shape(int kind, double facet_size)
{
  const int before = check_failures;
  const shape s = shape_of(kind);
  const mlim_options options = run_options(facet_size);
  mlim_context context = { 0 };
  image* im = shape_sample(&s);
  run r;
  const mlim_status status = run_grid(&im->grid, &options, &context, &r);
  CHECK(status == MLIM_OK);
  if (status == MLIM_OK)
  {
    audit_mesh(r.field, &r.balls, &r.options, &r.mesh);
    check_vertices(&r);
    check_certificate(&r.mesh.certificate);
    check_report(&r.mesh.report);
    for (int32_t l = 0; l < s.label_count; ++l)
    {
      CHECK(audit_euler(r.field, &r.mesh, l) == s.euler[l]);
      if (s.volume[l] > 0 && facet_size > 0)
      {
        CHECK_BELOW(fabs(r.mesh.volumes[l] / s.volume[l] - 1), VOLUME_TOLERANCE);
      }
    }
    CHECK((r.mesh.triangle_count == 0) == (kind == SHAPE_EMPTY));
  }
  else
  {
    fprintf(stderr, "%s\n", context.message);
  }
  run_free(&r);
  image_free(im);
  shape_report(s.name, before);
}

/* Where every label is a region, the regions fill the box. */
static void test_filled_box(int kind, double facet_size)
{
  const shape s = shape_of(kind);
  const mlim_options options = run_options(facet_size);
  image* im = shape_sample(&s);
  run r;
  const mlim_status status = run_grid(&im->grid, &options, NULL, &r);
  CHECK(status == MLIM_OK);
  double sum = 0;
  double box = 1;
  for (int32_t l = 0; l < s.label_count && status == MLIM_OK; ++l)
  {
    sum += r.mesh.volumes[l];
  }
  for (int k = 0; k < 3; ++k)
  {
    box *= s.dims[k] - 1;
  }
  CHECK_BELOW(fabs(sum - box), 1e-9 * box);
  run_free(&r);
  image_free(im);
}

int main(void)
{
  for (int kind = 0; kind < SHAPE_COUNT; ++kind)
  {
    test_shape(kind, 0);
    test_shape(kind, 0.7);
  }
  test_filled_box(SHAPE_SECTORS, 1);
  test_filled_box(SHAPE_OCTANTS, 1);
  test_filled_box(SHAPE_HALVES, 1);
  return check_result();
}
