/* The same scene in other clothes: other label orders, axes and scales. */
#include "audit.h"
#include "shapes.h"

/* Meshes of mirrored samples differ in their vertices, not in what they render. */
static const double SAME_VOLUME = 0.01;

/* How the scene is turned before it is sampled, and in which order its labels come. */
typedef struct view
{
  int axis[3];     /* axis of the scene along each axis of the image */
  int is_mirrored; /* along the first of them */
  double scale;
  int order[8]; /* label of each array */
} view;

static const view PLAIN = { { 0, 1, 2 }, 0, 1, { 0, 1, 2, 3, 4, 5, 6, 7 } };

static image* sample_view(const shape* s, const view* v)
{
  image* im = shape_sample(s);
  const size_t count = (size_t)s->dims[0] * (size_t)s->dims[1] * (size_t)s->dims[2];
  for (int k = 0; k < 3; ++k)
  {
    im->grid.dims[k] = s->dims[v->axis[k]];
    im->grid.spacing[k] = v->scale;
  }
  for (int a = 0; a < s->label_count; ++a)
  {
    const int label = v->order[a];
    double* values = im->values + count * (size_t)a;
    for (size_t p = 0; p < count; ++p)
    {
      const size_t nx = (size_t)im->grid.dims[0];
      const size_t ny = (size_t)im->grid.dims[1];
      const size_t place[3] = { p % nx, p / nx % ny, p / nx / ny };
      double at[3];
      for (int k = 0; k < 3; ++k)
      {
        at[v->axis[k]] = (double)place[k];
      }
      const int mirrored = v->axis[0];
      at[mirrored] = v->is_mirrored ? s->dims[mirrored] - 1 - at[mirrored] : at[mirrored];
      values[p] = s->function(at, label);
    }
    im->arrays[a].id = label == s->background ? 0 : label + 1;
    im->grid.background_array = label == s->background ? (size_t)a : im->grid.background_array;
  }
  return im;
}

/* Returns whether there is a mesh. */
static int run_view(const shape* s, const view* v, run* r)
{
  const mlim_options options = run_options(v->scale);
  mlim_context context = { 0 };
  image* im = sample_view(s, v);
  const mlim_status status = run_grid(&im->grid, &options, &context, r);
  CHECK(status == MLIM_OK);
  if (status == MLIM_OK)
  {
    audit_mesh(r->field, &r->balls, &r->options, &r->mesh);
  }
  image_free(im);
  return status == MLIM_OK;
}

static int32_t label_of_id(const mlim_field* field, int32_t id)
{
  int32_t label = 0;
  while (label < mlim_field_label_count(field) && mlim_field_label_id(field, label) != id)
  {
    ++label;
  }
  return label;
}

/* Everything that does not depend on where the vertices are. */
static void compare_topology(const run* a, const run* b)
{
  CHECK_COUNT(b->curves.curve_count, a->curves.curve_count);
  CHECK_COUNT(b->curves.junction_count, a->curves.junction_count);
  CHECK_COUNT(b->mesh.patch_count, a->mesh.patch_count);
  CHECK_COUNT(b->mesh.junction_count, a->mesh.junction_count);
  CHECK_COUNT(b->mesh.certificate.component_count, a->mesh.certificate.component_count);
  for (int32_t l = 0; l < mlim_field_label_count(a->field); ++l)
  {
    const int32_t m = label_of_id(b->field, mlim_field_label_id(a->field, l));
    CHECK(m < mlim_field_label_count(b->field));
    CHECK(audit_euler(b->field, &b->mesh, m) == audit_euler(a->field, &a->mesh, l));
    const double volume = a->mesh.volumes[l];
    CHECK_BELOW(fabs(b->mesh.volumes[m] - volume), SAME_VOLUME * volume);
  }
}

static void test_views(int kind)
{
  const view views[] = {
    { { 0, 1, 2 }, 0, 1, { 2, 0, 1, 3, 4, 5, 6, 7 } }, /* labels in turn */
    { { 0, 1, 2 }, 1, 1, { 0, 1, 2, 3, 4, 5, 6, 7 } }, /* mirrored along each axis */
    { { 1, 0, 2 }, 1, 1, { 0, 1, 2, 3, 4, 5, 6, 7 } },
    { { 2, 0, 1 }, 1, 1, { 0, 1, 2, 3, 4, 5, 6, 7 } },
    { { 1, 2, 0 }, 0, 1, { 0, 1, 2, 3, 4, 5, 6, 7 } }, /* axes in turn */
    { { 0, 2, 1 }, 0, 1, { 1, 2, 0, 7, 6, 5, 4, 3 } },
  };
  const shape s = shape_of(kind);
  const int before = check_failures;
  run plain;
  const int is_plain = run_view(&s, &PLAIN, &plain);
  for (size_t k = 0; k < sizeof views / sizeof *views && is_plain; ++k)
  {
    view v = views[k];
    /* Scenes of two labels have one other order. */
    const int two[2] = { v.order[0] != 0, v.order[0] == 0 };
    if (s.label_count == 2)
    {
      memcpy(v.order, two, sizeof two);
    }
    run r;
    if (run_view(&s, &v, &r))
    {
      compare_topology(&plain, &r);
    }
    run_free(&r);
  }
  run_free(&plain);
  shape_report(s.name, before);
}

static int is_scaled(const double* a, const double* b, size_t count, double scale)
{
  for (size_t k = 0; k < count; ++k)
  {
    const double scaled = a[k] * scale;
    if (memcmp(&scaled, &b[k], sizeof scaled) != 0)
    {
      return 0;
    }
  }
  return 1;
}

/* Powers of two change exponents only, so each digit stays. */
static void test_scales(int kind)
{
  const double scales[] = { 0.25, 16, 1048576 };
  const shape s = shape_of(kind);
  const int before = check_failures;
  run a;
  const int is_plain = run_view(&s, &PLAIN, &a);
  for (size_t k = 0; k < sizeof scales / sizeof *scales && is_plain; ++k)
  {
    view v = PLAIN;
    v.scale = scales[k];
    run b;
    (void)run_view(&s, &v, &b);
    CHECK(is_scaled(&a.options.crossing_tolerance, &b.options.crossing_tolerance, 1, v.scale));
    CHECK(is_scaled(&a.options.smallest_distance, &b.options.smallest_distance, 1, v.scale));
    CHECK_COUNT(b.curves.point_count, a.curves.point_count);
    CHECK_COUNT(b.balls.ball_count, a.balls.ball_count);
    CHECK_COUNT(b.mesh.vertex_count, a.mesh.vertex_count);
    CHECK_COUNT(b.mesh.triangle_count, a.mesh.triangle_count);
    if (check_failures == before)
    {
      CHECK(is_scaled(a.curves.points, b.curves.points, 3 * a.curves.point_count, v.scale));
      CHECK(is_scaled(a.balls.radii, b.balls.radii, a.balls.ball_count, v.scale));
      CHECK(is_scaled(a.mesh.vertices, b.mesh.vertices, 3 * a.mesh.vertex_count, v.scale));
      CHECK(memcmp(a.mesh.triangles, b.mesh.triangles,
              3 * a.mesh.triangle_count * sizeof *a.mesh.triangles) == 0);
    }
    run_free(&b);
  }
  run_free(&a);
  shape_report(s.name, before);
}

int main(void)
{
  const int kinds[] = { SHAPE_TWO_SPHERES, SHAPE_SECTORS, SHAPE_HALVES, SHAPE_ISLAND,
    SHAPE_CUT_SPHERE };
  for (size_t k = 0; k < sizeof kinds / sizeof *kinds; ++k)
  {
    test_views(kinds[k]);
    test_scales(kinds[k]);
  }
  test_scales(SHAPE_OCTANTS);
  return check_result();
}
