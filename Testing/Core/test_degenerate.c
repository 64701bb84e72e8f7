/* Input that is nowhere in general position, or no input at all: it ends, within a vertex limit, in
   a labelled partition or in one sentence that says what is wrong. */
#include "audit.h"
#include "audit_volume.h"
#include "random_field.h"
#include "shapes.h"

static const size_t LIMIT = 20000;
static const double SPACING[3] = { 1, 1, 1 };

typedef enum expectation
{
  EXPECT_PARTITION, /* finished or not: closed regions */
  EXPECT_MESH       /* everything that is asked of a good mesh */
} expectation;

static void check_run(const mlim_grid* grid, double facet_size, expectation expected)
{
  mlim_options options = run_options(facet_size);
  options.vertex_limit = LIMIT;
  mlim_context context = { 0 };
  run r;
  const mlim_status status = run_volume(grid, &options, &context, &r);
  CHECK(status == MLIM_OK || (status == MLIM_VERTEX_LIMIT && expected == EXPECT_PARTITION));
  if (status == MLIM_OK || status == MLIM_VERTEX_LIMIT)
  {
    CHECK_BELOW((double)r.mesh.vertex_count, (double)LIMIT);
    if (expected == EXPECT_MESH)
    {
      audit_mesh(r.field, &r.balls, &r.options, &r.mesh);
      audit_volume_of(r.field, &r.mesh, &r.volume, 0);
      CHECK_COUNT(r.mesh.certificate.lost_component_count, 0);
    }
    else
    {
      audit_partition(r.field, &r.mesh);
      audit_volume_of(r.field, &r.mesh, &r.volume, 0);
    }
  }
  else
  {
    fprintf(stderr, "%s: %s\n", mlim_status_text(status), context.message);
  }
  run_free(&r);
}

/* ---- fields ---- */

static double all_tie(const double at[3], int label)
{
  (void)at;
  (void)label;
  return 1;
}

static double checkerboard(const double at[3], int label)
{
  const int odd = ((int)at[0] + (int)at[1] + (int)at[2]) % 2;
  return label == odd;
}

/* Every voxel of a 2 x 2 x 3 grid is a label of its own. */
static double voxels(const double at[3], int label)
{
  return (int)at[0] + 2 * (int)at[1] + 4 * (int)at[2] == label;
}

/* Every third voxel along each axis is an island. */
static double islands(const double at[3], int label)
{
  const int is_island = (int)at[0] % 3 == 1 && (int)at[1] % 3 == 1 && (int)at[2] % 3 == 1;
  return label == is_island;
}

/* Two spheres of radius 5 that all but touch, or touch a little, on a line askew to the axes. */
static double sphere_gap;

static double near_spheres(const double at[3], int label)
{
  const double u[3] = { 0.96, 0.24, 0.144 };
  const double side = label == 1 ? -0.5 : 0.5;
  double squared = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double center = (k == 0 ? 11.5 : 7.3) + side * (10 + sphere_gap) * u[k];
    squared += (at[k] - center) * (at[k] - center);
  }
  return label == 0 ? 0 : 5 - sqrt(squared);
}

static double wall_on_points(const double at[3], int label)
{
  return label == 0 ? 3 - at[0] : at[0] - 3;
}

/* The two tie on the face x = 0 of the box alone. */
static double tie_on_face(const double at[3], int label)
{
  return label == 0 ? 0 : at[0];
}

static double sphere_touches_face(const double at[3], int label)
{
  return label == 0 ? 0 : 3 - shape_distance(at, 3, 4, 4);
}

static double sphere_leaves_corner(const double at[3], int label)
{
  return label == 0 ? 0 : 4.3 - shape_distance(at, 0.2, 0.1, 0.3);
}

static double diagonal_wall(const double at[3], int label)
{
  return label == 0 ? at[0] + at[1] - 6 : 6 - at[0] - at[1];
}

static double octants_on_points(const double at[3], int label)
{
  return (label & 1 ? 1 : -1) * (at[0] - 3) + (label & 2 ? 1 : -1) * (at[1] - 3) +
         (label & 4 ? 1 : -1) * (at[2] - 3);
}

/* A sheet half a spacing thick, between two sides of another label. */
static double thin_sheet(const double at[3], int label)
{
  return label == 0 ? 0 : 0.25 - fabs(at[0] - 3);
}

static double plateau(const double at[3], int label)
{
  const double inner = at[0] < 2 ? 0 : at[0] > 5 ? 1 : 0.5;
  return label == 0 ? 1 - inner : inner;
}

static void test_fields(void)
{
  const struct
  {
    const char* name;
    int32_t dims[3];
    int label_count;
    int background;
    shape_function function;
    expectation expected;
  } rows[] = {
    { "all tie, background", { 5, 5, 5 }, 3, 0, all_tie, EXPECT_MESH },
    { "all tie", { 5, 5, 5 }, 3, -1, all_tie, EXPECT_MESH },
    { "checkerboard, background", { 5, 5, 5 }, 2, 0, checkerboard, EXPECT_PARTITION },
    { "checkerboard", { 5, 5, 5 }, 2, -1, checkerboard, EXPECT_PARTITION },
    { "one-voxel labels", { 2, 2, 3 }, 12, -1, voxels, EXPECT_PARTITION },
    { "islands", { 8, 8, 8 }, 2, 0, islands, EXPECT_MESH },
    { "constant", { 4, 4, 4 }, 1, -1, shape_constant, EXPECT_MESH },
    { "two points along x", { 2, 9, 9 }, 2, -1, diagonal_wall, EXPECT_MESH },
    { "two points along y", { 9, 2, 9 }, 2, -1, wall_on_points, EXPECT_MESH },
    { "two points along z", { 9, 9, 2 }, 2, -1, diagonal_wall, EXPECT_MESH },
    { "one cell", { 2, 2, 2 }, 1, -1, shape_constant, EXPECT_MESH },
    { "wall on grid points", { 7, 7, 7 }, 2, -1, wall_on_points, EXPECT_MESH },
    { "tie on a face", { 5, 5, 5 }, 2, -1, tie_on_face, EXPECT_PARTITION },
    { "sphere touches a face", { 8, 9, 9 }, 2, 0, sphere_touches_face, EXPECT_PARTITION },
    { "sphere leaves at a corner", { 8, 8, 8 }, 2, 0, sphere_leaves_corner, EXPECT_MESH },
    { "diagonal wall through box edges", { 7, 7, 7 }, 2, -1, diagonal_wall, EXPECT_PARTITION },
    { "octants on grid points", { 7, 7, 7 }, 8, -1, octants_on_points, EXPECT_MESH },
    { "thin sheet", { 7, 7, 7 }, 2, 0, thin_sheet, EXPECT_PARTITION },
    { "plateau", { 8, 6, 6 }, 2, -1, plateau, EXPECT_PARTITION },
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    const int before = check_failures;
    image* im = image_sample(
      rows[k].dims, SPACING, rows[k].label_count, rows[k].background, rows[k].function);
    im->grid.tie_breaking = MLIM_TIE_SMOOTH;
    check_run(&im->grid, 0, rows[k].expected);
    im->grid.tie_breaking = MLIM_TIE_LOWEST_INDEX;
    check_run(&im->grid, 0, rows[k].expected);
    image_free(im);
    shape_report(rows[k].name, before);
  }
}

/* The film between the spheres, or their contact, is thinner than the smallest distance of two vertices,
   over a disc of 7 square spacings: pairs of vertices across it, and contacts where it is thinner than a
   tenth of that, bring the topology in order. */
static void check_near_spheres(const mlim_grid* grid)
{
  const mlim_options options = run_options(0);
  mlim_context context = { 0 };
  run r;
  CHECK(run_grid(grid, &options, &context, &r) == MLIM_OK);
  audit_partition(r.field, &r.mesh);
  CHECK_COUNT(r.mesh.certificate.lost_component_count, 0);
  CHECK_COUNT(r.mesh.certificate.disk_failure_count, 0);
  CHECK_COUNT(r.mesh.report.off_curve_edge_count, 0);
  CHECK_BELOW((double)r.mesh.contact_count, 40);
  CHECK_BELOW((double)r.mesh.report.relabeled_ratio_count, 3);
  run_free(&r);
}

static void test_near_spheres(void)
{
  const double gaps[] = { 0.05, 0.01, 0, -0.01, -0.05 };
  const int32_t dims[3] = { 24, 15, 15 };
  for (size_t k = 0; k < sizeof gaps / sizeof *gaps; ++k)
  {
    const int before = check_failures;
    sphere_gap = gaps[k];
    image* im = image_sample(dims, SPACING, 3, 0, near_spheres);
    check_near_spheres(&im->grid);
    image_free(im);
    shape_report("near spheres", before);
  }
}

static void check_noise(int32_t labels, uint64_t seed)
{
  static random_field f;
  const int before = check_failures;
  random_field_make(&f, labels, 4, labels % 2 ? 2 : 0, seed);
  f.grid.background = labels % 2 ? MLIM_BACKGROUND_ARRAY : MLIM_BACKGROUND_NONE;
  for (int32_t l = 0; l < labels; ++l)
  {
    f.arrays[l].id = labels % 2 ? l : l + 1;
  }
  check_run(&f.grid, 0, EXPECT_PARTITION);
  shape_report("noise", before);
}

static void test_noise(void)
{
  for (int32_t labels = 2; labels <= 5; ++labels)
  {
    check_noise(labels, (uint64_t)labels);
  }
  /* Vertices so close together that the shapes of cells are lost in rounding. */
  check_noise(3, 34);
}

/* ---- scales ---- */

static void test_scales(void)
{
  const double scales[] = { 1e-12, 1e-3, 1e3, 1e12 };
  const shape s = shape_of(SHAPE_CUT_SPHERE);
  for (size_t k = 0; k < 2 * sizeof scales / sizeof *scales; ++k)
  {
    const int before = check_failures;
    image* im = shape_sample(&s);
    const size_t points = (size_t)s.dims[0] * (size_t)s.dims[1] * (size_t)s.dims[2];
    for (int axis = 0; axis < 3 && k % 2 == 0; ++axis)
    {
      im->grid.spacing[axis] = scales[k / 2];
    }
    for (size_t p = 0; p < 2 * points && k % 2 == 1; ++p)
    {
      im->values[p] *= scales[k / 2];
    }
    check_run(&im->grid, k % 2 == 0 ? scales[k / 2] : 1, EXPECT_MESH);
    image_free(im);
    shape_report(k % 2 == 0 ? "spacing" : "values", before);
  }
}

/* One axis a hundred times as coarse as another. */
static void test_anisotropy(void)
{
  const shape s = shape_of(SHAPE_HALVES);
  image* im = shape_sample(&s);
  im->grid.spacing[0] = 0.1;
  im->grid.spacing[2] = 10;
  check_run(&im->grid, 0, EXPECT_MESH);
  image_free(im);
}

/* ---- refusals ---- */

/* The field is refused with a sentence that holds all the words. */
static void check_refusal(const mlim_grid* grid, const char* const* words, size_t count)
{
  mlim_context context = { 0 };
  mlim_field* field = NULL;
  CHECK(mlim_field_create(grid, &context, &field) == MLIM_INVALID_ARGUMENT);
  CHECK(field == NULL);
  for (size_t k = 0; k < count; ++k)
  {
    const int has_word = strstr(context.message, words[k]) != NULL;
    CHECK(has_word);
    if (!has_word)
    {
      fprintf(stderr, "no \"%s\" in \"%s\"\n", words[k], context.message);
    }
  }
  CHECK(mlim_field_create(grid, NULL, &field) == MLIM_INVALID_ARGUMENT);
}

/* How many, in which array, where the first is. */
static void test_bad_values(void)
{
  const double bad[] = { (double)NAN, (double)INFINITY, -(double)INFINITY };
  const shape s = shape_of(SHAPE_SECTORS);
  for (size_t k = 0; k < sizeof bad / sizeof *bad; ++k)
  {
    image* im = shape_sample(&s);
    const size_t points = 12 * 12 * 12;
    im->arrays[1].name = "cortex";
    im->values[points + 7 + 12 * (5 + 12 * 3)] = bad[k];
    im->values[points + 8 + 12 * (5 + 12 * 3)] = bad[k];
    im->values[points + points - 1] = bad[k];
    const char* words[] = { "cortex", " 3 ", "(7, 5, 3)" };
    check_refusal(&im->grid, words, 3);
    image_free(im);
  }
}

static void test_bad_grids(void)
{
  const double bad[] = { 0, -1, (double)NAN, (double)INFINITY };
  const char* axes[] = { "axis 0", "axis 1", "axis 2" };
  const shape s = shape_of(SHAPE_HALVES);
  for (int axis = 0; axis < 3; ++axis)
  {
    for (size_t k = 0; k < sizeof bad / sizeof *bad; ++k)
    {
      image* im = shape_sample(&s);
      im->grid.spacing[axis] = bad[k];
      const char* words[] = { "spacing", axes[axis] };
      check_refusal(&im->grid, words, 2);
      image_free(im);
    }
    for (int32_t points = -1; points < 2; ++points)
    {
      image* im = shape_sample(&s);
      im->grid.dims[axis] = points;
      const char* words[] = { "points", axes[axis] };
      check_refusal(&im->grid, words, 2);
      image_free(im);
    }
  }
}

static void test_bad_arrays(void)
{
  const shape s = shape_of(SHAPE_HALVES);
  image* im = shape_sample(&s);
  im->grid.array_count = 0;
  check_refusal(&im->grid, (const char*[]){ "array" }, 1);
  im->grid.array_count = 2;
  im->grid.background = MLIM_BACKGROUND_ARRAY;
  im->grid.background_array = 2;
  check_refusal(&im->grid, (const char*[]){ "background", "2" }, 2);
  im->grid.background = MLIM_BACKGROUND_CONSTANT;
  im->grid.background_value = (double)NAN;
  check_refusal(&im->grid, (const char*[]){ "background" }, 1);
  im->grid.background = MLIM_BACKGROUND_NONE;
  im->arrays[1].id = im->arrays[0].id;
  check_refusal(&im->grid, (const char*[]){ "id", "1" }, 2);
  im->arrays[1].id = 0; /* taken by the outside */
  check_refusal(&im->grid, (const char*[]){ "id", "0" }, 2);
  im->arrays[1].id = 2;
  im->arrays[1].type = MLIM_SCALAR_END;
  check_refusal(&im->grid, NULL, 0);
  im->arrays[1].type = MLIM_FLOAT64;
  im->arrays[1].stride = 0;
  check_refusal(&im->grid, NULL, 0);
  im->arrays[1].stride = 1;
  im->arrays[1].values = NULL;
  check_refusal(&im->grid, NULL, 0);
  image_free(im);
}

int main(void)
{
  test_fields();
  test_near_spheres();
  test_noise();
  test_scales();
  test_anisotropy();
  test_bad_values();
  test_bad_grids();
  test_bad_arrays();
  return check_result();
}
