/* The public header's contract. test_api_cxx.cxx includes it as C++. */
#include "shapes.h"

int test_api_cxx(void);

/* Each has a text of its own, and what is no value has one too. */
static void test_texts(void)
{
  const char* statuses[MLIM_STATUS_END + 1];
  for (int k = 0; k <= MLIM_STATUS_END; ++k)
  {
    statuses[k] = mlim_status_text((mlim_status)k);
    CHECK(statuses[k] != NULL && statuses[k][0] != '\0');
    for (int j = 0; j < k; ++j)
    {
      CHECK(strcmp(statuses[k], statuses[j]) != 0);
    }
  }
  const char* stages[MLIM_STAGE_END + 1];
  for (int k = 0; k <= MLIM_STAGE_END; ++k)
  {
    stages[k] = mlim_stage_text((mlim_stage)k);
    CHECK(stages[k] != NULL && stages[k][0] != '\0');
    for (int j = 0; j < k; ++j)
    {
      CHECK(strcmp(stages[k], stages[j]) != 0);
    }
  }
}

/* ---- options ---- */

typedef struct range_row
{
  const char* name; /* as users know it: the message has to say it */
  size_t offset;
  double inside;
  double below;
  double above; /* 0: no bound */
} range_row;

static const double INF = (double)INFINITY;
static const double BELOW_ZERO = -1e-300;

static void check_option(
  const mlim_field* field, const range_row* row, double value, mlim_status expected)
{
  mlim_context context = { 0 };
  mlim_options options = mlim_options_default(field);
  *(double*)((char*)&options + row->offset) = value;
  const mlim_status status = mlim_options_complete(field, &context, &options);
  CHECK(status == expected);
  if (status != expected || (expected != MLIM_OK && strstr(context.message, row->name) == NULL))
  {
    CHECK(0 && "an option's range or message");
    fprintf(stderr, "%s = %g: \"%s\"\n", row->name, value, context.message);
  }
}

static void test_ranges(const mlim_field* field)
{
  /* 0 asks for a length's default, so the value just outside is below it. */
  const range_row rows[] = {
    { "FacetSize", offsetof(mlim_options, facet_size), 1e-300, BELOW_ZERO, INF },
    { "FacetDistance", offsetof(mlim_options, facet_distance), 1e-300, BELOW_ZERO, INF },
    { "EdgeSize", offsetof(mlim_options, edge_size), 1e-300, BELOW_ZERO, INF },
    { "CrossingTolerance", offsetof(mlim_options, crossing_tolerance), 1e-300, BELOW_ZERO, INF },
    { "SmallestDistance", offsetof(mlim_options, smallest_distance), 1e-300, BELOW_ZERO, INF },
    { "JunctionMergeTolerance", offsetof(mlim_options, junction_merge_tolerance), 0, (double)NAN,
      INF },
    { "FacetRadiusEdgeRatio", offsetof(mlim_options, facet_radius_edge_ratio), 0.6, 0.5999999,
      INF },
    { "VolumeTolerance", offsetof(mlim_options, volume_tolerance), 0, BELOW_ZERO, 1 },
    { "CellSize", offsetof(mlim_options, cell_size), 1e-300, BELOW_ZERO, INF },
    { "CellRadiusEdgeRatio", offsetof(mlim_options, cell_radius_edge_ratio), 1, 0.9999999, INF },
    { "BallRadiusScale", offsetof(mlim_options, ball_radius_scale), 1, 0, 1.0000001 },
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    check_option(field, &rows[k], rows[k].inside, MLIM_OK);
    check_option(field, &rows[k], rows[k].below, MLIM_INVALID_ARGUMENT);
    check_option(field, &rows[k], rows[k].above, MLIM_INVALID_ARGUMENT);
    check_option(field, &rows[k], (double)NAN, MLIM_INVALID_ARGUMENT);
    check_option(field, &rows[k], -INF,
      rows[k].offset == offsetof(mlim_options, junction_merge_tolerance) ? MLIM_OK
                                                                         : MLIM_INVALID_ARGUMENT);
  }
}

static void test_counts(const mlim_field* field)
{
  mlim_context context = { 0 };
  mlim_options options = mlim_options_default(field);
  options.vertex_limit = 0;
  CHECK(mlim_options_complete(field, &context, &options) == MLIM_INVALID_ARGUMENT);
  CHECK(strstr(context.message, "VertexLimit") != NULL);
  options.vertex_limit = 1;
  CHECK(mlim_options_complete(field, &context, &options) == MLIM_OK);
  options.min_component_voxels = 0;
  CHECK(mlim_options_complete(field, &context, &options) == MLIM_INVALID_ARGUMENT);
  CHECK(strstr(context.message, "MinimumComponentVoxels") != NULL);
  options.min_component_voxels = 1;
  options.oracle_mode = (mlim_oracle_mode)(MLIM_ORACLE_BISECTION + 1);
  CHECK(mlim_options_complete(field, &context, &options) == MLIM_INVALID_ARGUMENT);
  CHECK(strstr(context.message, "OracleMode") != NULL);
}

/* The multiples of the spacing that mlim.h states. */
static void test_defaults(const mlim_grid* plain)
{
  const double spacing[3] = { 0.5, 1, 2 }; /* a voxel of volume 1 */
  CHECK(mlim_spacing_unit(spacing) == 1);
  for (int n = 1; n < 50; ++n)
  {
    const double cube[3] = { 1.0 / n, 1.0 / n, 1.0 / n };
    CHECK(mlim_spacing_unit(cube) == cube[0]);
  }
  for (double scale = 1; scale < 10; scale += 4)
  {
    mlim_grid grid = *plain;
    for (int k = 0; k < 3; ++k)
    {
      grid.spacing[k] = scale * spacing[k];
    }
    mlim_field* field = NULL;
    CHECK(mlim_field_create(&grid, NULL, &field) == MLIM_OK);
    const mlim_options o = mlim_options_default(field);
    const double tolerance = 1e-12 * scale;
    CHECK_BELOW(fabs(o.facet_size - 2 * scale), tolerance);
    CHECK_BELOW(fabs(o.facet_distance - 0.25 * scale), tolerance);
    CHECK_BELOW(fabs(o.edge_size - 2 * scale), tolerance);
    CHECK_BELOW(fabs(o.crossing_tolerance - 1e-6 * scale), tolerance);
    CHECK_BELOW(fabs(o.junction_merge_tolerance - 0.25 * scale), tolerance);
    CHECK_BELOW(fabs(o.smallest_distance - 0.25 * scale), tolerance);
    mlim_options again = o;
    CHECK(mlim_options_complete(field, NULL, &again) == MLIM_OK);
    CHECK(memcmp(&again, &o, sizeof o) == 0);
    mlim_options sized = { .facet_size = 4 * scale,
      .facet_radius_edge_ratio = 1,
      .ball_radius_scale = 1,
      .vertex_limit = 1,
      .min_component_voxels = 1 };
    CHECK(mlim_options_complete(field, NULL, &sized) == MLIM_OK);
    CHECK_BELOW(fabs(sized.facet_distance - 0.5 * scale), tolerance);
    CHECK_BELOW(fabs(sized.edge_size - 4 * scale), tolerance);
    CHECK_BELOW(fabs(sized.smallest_distance - 0.25 * scale), tolerance); /* at most */
    sized.facet_size = scale;
    sized.smallest_distance = 0;
    CHECK(mlim_options_complete(field, NULL, &sized) == MLIM_OK);
    CHECK_BELOW(fabs(sized.smallest_distance - 0.125 * scale), tolerance);
    CHECK_BELOW(sized.junction_merge_tolerance, 0); /* 0 means never */
    mlim_field_free(field);
  }
}

/* Every stage refuses bad options and leaves its product empty. */
static void test_stages_refuse(const mlim_field* field)
{
  const mlim_options good = mlim_options_default(field);
  mlim_options bad = good;
  bad.facet_size = -1;
  bad.edge_size = -1;
  bad.junction_merge_tolerance = (double)NAN;
  mlim_context context = { 0 };
  mlim_curves curves = { 0 };
  mlim_balls balls = { 0 };
  CHECK(mlim_curves_extract(field, &bad, &context, &curves) == MLIM_INVALID_ARGUMENT);
  CHECK(curves.curve_count == 0 && curves.points == NULL);
  CHECK(mlim_curves_extract(field, &good, &context, &curves) == MLIM_OK);
  CHECK(mlim_balls_cover(&curves, &bad, &context, &balls) == MLIM_INVALID_ARGUMENT);
  CHECK(balls.ball_count == 0 && balls.centers == NULL);
  CHECK(mlim_balls_cover(NULL, &good, &context, &balls) == MLIM_INVALID_ARGUMENT);
  CHECK(mlim_balls_cover(&curves, NULL, &context, &balls) == MLIM_INVALID_ARGUMENT);
  mlim_balls none = { 0 };
  mlim_mesh mesh = { .vertex_count = 7 };
  CHECK(mlim_mesh_refine(field, &none, &bad, &context, &mesh) == MLIM_INVALID_ARGUMENT);
  CHECK(mesh.vertex_count == 0 && mesh.vertices == NULL);
  CHECK(strstr(context.message, "FacetSize") != NULL);
  double center[3] = { 1, 1, 1 };
  double radius = 0;
  int32_t curve = -1;
  int32_t set = 0;
  mlim_balls flat = {
    .ball_count = 1, .centers = center, .radii = &radius, .ball_curves = &curve, .ball_sets = &set
  };
  CHECK(mlim_mesh_refine(field, &flat, &good, &context, &mesh) == MLIM_INVALID_ARGUMENT);
  radius = 1;
  center[1] = (double)NAN;
  CHECK(mlim_mesh_refine(field, &flat, &good, &context, &mesh) == MLIM_INVALID_ARGUMENT);
  CHECK(mlim_mesh_refine(field, NULL, &good, &context, &mesh) == MLIM_INVALID_ARGUMENT);
  CHECK(mlim_mesh_refine(NULL, &none, &good, &context, &mesh) == MLIM_INVALID_ARGUMENT);
  CHECK(mlim_mesh_refine(field, &none, NULL, NULL, &mesh) == MLIM_INVALID_ARGUMENT);
  CHECK(mlim_options_complete(NULL, &context, &bad) == MLIM_INVALID_ARGUMENT);
  CHECK(mlim_options_complete(field, NULL, NULL) == MLIM_INVALID_ARGUMENT);
  mlim_curves_free(&curves);
  CHECK(mlim_curves_extract(NULL, &good, &context, &curves) == MLIM_INVALID_ARGUMENT);
  CHECK(mlim_curves_extract(field, NULL, &context, &curves) == MLIM_INVALID_ARGUMENT);
}

/* What was never made may be freed, and what was freed too. */
static void test_free(void)
{
  run r = { 0 };
  run_free(&r);
  const shape s = shape_of(SHAPE_HALVES);
  image* im = shape_sample(&s);
  const mlim_options options = run_options(1);
  CHECK(run_grid(&im->grid, &options, NULL, &r) == MLIM_OK);
  run_free(&r);
  r.field = NULL;
  CHECK(run_is_empty_from(&r, MLIM_STAGE_FIELD));
  run_free(&r);
  image_free(im);
}

/* ---- labels ---- */

static void test_backgrounds(image* im)
{
  const struct
  {
    mlim_background background;
    int32_t label_count;
    int32_t outside_label;
  } rows[] = { { MLIM_BACKGROUND_NONE, 4, 3 }, { MLIM_BACKGROUND_ARRAY, 3, 1 },
    { MLIM_BACKGROUND_CONSTANT, 4, 0 }, { MLIM_BACKGROUND_COMPLEMENT, 4, 0 } };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    im->grid.background = rows[k].background;
    im->grid.background_array = 1;
    im->grid.background_value = 1e9;
    const int is_array = rows[k].background == MLIM_BACKGROUND_ARRAY;
    im->arrays[1].id = is_array ? 0 : 2;
    mlim_field* field = NULL;
    CHECK(mlim_field_create(&im->grid, NULL, &field) == MLIM_OK);
    CHECK(mlim_field_label_count(field) == rows[k].label_count);
    CHECK(mlim_field_outside_label(field) == rows[k].outside_label);
    CHECK(mlim_field_label_id(field, rows[k].outside_label) == 0);
    CHECK(mlim_field_label_id(field, rows[k].outside_label == 0 ? 1 : 0) == 1);
    const double outside[3] = { -1, 5, 5 };
    CHECK(mlim_field_label(field, outside) == rows[k].outside_label);
    const double inside[3] = { 10, 5.8, 5 }; /* well in sector 0 */
    const int32_t expected = rows[k].background == MLIM_BACKGROUND_COMPLEMENT ? -1 : 0;
    CHECK(expected < 0 || mlim_field_label(field, inside) == expected);
    mlim_field_free(field);
  }
}

int main(void)
{
  const shape s = shape_of(SHAPE_SECTORS);
  image* im = shape_sample(&s);
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&im->grid, NULL, &field) == MLIM_OK);
  test_texts();
  test_ranges(field);
  test_counts(field);
  test_defaults(&im->grid);
  test_stages_refuse(field);
  test_free();
  test_backgrounds(im);
  CHECK(test_api_cxx() == 0);
  mlim_field_free(field);
  image_free(im);
  return check_result();
}
