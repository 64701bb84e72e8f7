/* Indicators of label maps against naive ones, and what the field makes of them. */
#include "check.h"
#include "field.h"
#include "label_scenes.h"
#include "volumes.h"

static const double CUBE[3] = { 1, 1, 1 };
static const double SLAB[3] = { 0.5, 0.7, 1.3 };

static mlim_indicator_options bare_options(void)
{
  mlim_indicator_options options = mlim_indicator_options_default();
  options.gaussian_sigma = -1;
  options.keeps_volume = 0;
  options.keeps_thin = 0;
  return options;
}

static mlim_indicators* make(
  const mlim_label_map* map, const mlim_indicator_options* options, mlim_context* context)
{
  mlim_indicators* indicators = NULL;
  CHECK(mlim_indicators_create(map, options, context, &indicators) == MLIM_OK);
  return indicators;
}

/* ---- values ---- */

static double largest_error(const mlim_indicators* indicators, int32_t label,
  const double* expected, size_t count, float* values)
{
  double worst = 0;
  mlim_indicators_write(indicators, label, values);
  for (size_t p = 0; p < count; ++p)
  {
    worst = fmax(worst, fabs((double)values[p] - expected[p]));
  }
  return worst;
}

static void naive_distances(const label_scene* s, int32_t id, double band, double* out)
{
  for (size_t p = 0; p < s->count; ++p)
  {
    const int32_t at[3] = { (int32_t)(p % (size_t)s->dims[0]),
      (int32_t)(p / (size_t)s->dims[0] % (size_t)s->dims[1]),
      (int32_t)(p / ((size_t)s->dims[0] * (size_t)s->dims[1])) };
    out[p] = label_distance(s, at, id, band);
  }
}

/* Along one axis, mirrored at the ends: G, or 2 G - G * G as G applied twice; radius 2. */
static void naive_gauss(
  const label_scene* s, int axis, double sigma, int radius, const double* in, double* out)
{
  double total = 0;
  for (int step = -radius; step <= radius; ++step)
  {
    total += exp(-0.5 * step * step / (sigma * sigma));
  }
  for (size_t p = 0; p < s->count; ++p)
  {
    int32_t at[3] = { (int32_t)(p % (size_t)s->dims[0]),
      (int32_t)(p / (size_t)s->dims[0] % (size_t)s->dims[1]),
      (int32_t)(p / ((size_t)s->dims[0] * (size_t)s->dims[1])) };
    const int32_t middle = at[axis];
    double sum = 0;
    for (int step = -radius; step <= radius; ++step)
    {
      at[axis] = middle + step;
      sum += exp(-0.5 * step * step / (sigma * sigma)) * in[label_point(s, at[0], at[1], at[2])];
    }
    out[p] = sum / total;
  }
}

static void naive_level(const label_scene* s, double* values)
{
  double* once = malloc(s->count * sizeof *once);
  double* twice = malloc(s->count * sizeof *twice);
  for (int axis = 0; axis < 3; ++axis)
  {
    naive_gauss(s, axis, 1, 2, values, once);
    naive_gauss(s, axis, 1, 2, once, twice);
    for (size_t p = 0; p < s->count; ++p)
    {
      values[p] = 2 * once[p] - twice[p];
    }
  }
  free(once);
  free(twice);
}

/* More than one tile along each axis, the last ones of a few points. */
static void test_values(const double spacing[3], const int32_t dims[3], int is_smooth)
{
  label_scene scene = label_scene_make(dims, spacing, label_rule_blocks);
  mlim_label_map map = label_scene_read(&scene, NULL);
  mlim_indicator_options options = bare_options();
  const double band = options.distance_band = 2.3;
  mlim_indicators* indicators = NULL;
  double* expected = malloc(scene.count * sizeof *expected);
  float* values = malloc(scene.count * sizeof *values);
  options.gaussian_sigma = is_smooth ? 1 : -1;
  if (is_smooth)
  {
    /* The level kernel alone: volumes are not corrected with dilation, which is off by its radius. */
    options.keeps_volume = 1;
    options.dilate_radius = 0;
  }
  indicators = make(&map, &options, NULL);
  for (int32_t l = 0; l < map.label_count; ++l)
  {
    naive_distances(&scene, map.ids[l], band, expected);
    if (is_smooth)
    {
      naive_level(&scene, expected);
      /* Up to the constant for the volume, which one point far from the ends tells. */
      mlim_indicators_write(indicators, l, values);
      size_t middle = 0;
      for (size_t p = 0; p < scene.count; ++p)
      {
        middle = fabs(expected[p]) < fabs(expected[middle]) ? p : middle;
      }
      const double shift = (double)values[middle] - expected[middle];
      CHECK_BELOW(fabs(shift), 0.6001 * spacing[0]);
      for (size_t p = 0; p < scene.count; ++p)
      {
        /* At the floor rounding decides whether there is a constant. */
        const int is_floor = expected[p] < -band + 1e-4;
        expected[p] = is_floor ? (double)values[p] : fmin(expected[p], band) + shift;
        CHECK(!is_floor || (double)values[p] < -band + 1e-3 + fmax(shift, 0));
      }
    }
    CHECK_BELOW(largest_error(indicators, l, expected, scene.count, values), 3e-4);
  }
  mlim_indicators_free(indicators);
  mlim_label_map_free(&map);
  free(expected);
  free(values);
  free(scene.values);
}

static int32_t rule_constant(const int32_t at[3])
{
  return at[0] * 0 + 12;
}

static void test_constant(void)
{
  static const int32_t dims[3] = { 9, 2, 40 };
  label_scene scene = label_scene_make(dims, SLAB, rule_constant);
  mlim_label_map map = label_scene_read(&scene, NULL);
  const mlim_indicator_options options = mlim_indicator_options_default();
  mlim_indicators* indicators = make(&map, &options, NULL);
  float values[9 * 2 * 40];
  mlim_indicators_write(indicators, 0, values);
  CHECK(mlim_indicators_has(indicators, 0));
  for (size_t p = 0; p < scene.count; ++p)
  {
    CHECK(values[p] == (float)(3 * SLAB[2]));
  }
  mlim_indicators_free(indicators);
  mlim_label_map_free(&map);
  free(scene.values);
}

/* ---- thin parts ---- */

/* A speck of one voxel, id 1; a sheet one voxel thick, id 2; a 2 x 2 x 2 block, id 3. */
static int32_t rule_thin(const int32_t at[3])
{
  const int is_block =
    at[0] >= 12 && at[0] < 14 && at[1] >= 4 && at[1] < 6 && at[2] >= 4 && at[2] < 6;
  return at[0] == 4 && at[1] == 5 && at[2] == 5 ? 1 : at[2] == 9 ? 2 : is_block ? 3 : 0;
}

static int32_t* win_ids(const mlim_label_map* map, const mlim_indicators* indicators, size_t count)
{
  mlim_array arrays[8];
  const mlim_grid grid = label_grid(map, indicators, arrays);
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&grid, NULL, &field) == MLIM_OK);
  int32_t* ids = malloc(count * sizeof *ids);
  for (size_t p = 0; p < count; ++p)
  {
    ids[p] = mlim_field_label_id(field, mlim_field_point_labels(field)[p]);
  }
  mlim_field_free(field);
  return ids;
}

static void test_thin(void)
{
  static const int32_t dims[3] = { 18, 12, 14 };
  label_scene scene = label_scene_make(dims, CUBE, rule_thin);
  mlim_label_map map = label_scene_read(&scene, NULL);
  mlim_indicator_options options = mlim_indicator_options_default();
  mlim_indicators* kept = make(&map, &options, NULL);
  int32_t* ids = win_ids(&map, kept, scene.count);
  for (size_t p = 0; p < scene.count; ++p)
  {
    /* Specks and sheets keep their points; the block at least one. */
    CHECK((scene.values[p] != 1 && scene.values[p] != 2) || ids[p] == scene.values[p]);
  }
  for (int32_t l = 0; l < map.label_count; ++l)
  {
    CHECK(mlim_indicators_has(kept, l));
  }
  options.keeps_thin = 0;
  mlim_indicators* lost = make(&map, &options, NULL);
  CHECK(!mlim_indicators_has(lost, 1));
  CHECK(mlim_indicators_has(lost, 0));
  CHECK(!mlim_indicators_has(lost, 99));
  free(ids);
  mlim_indicators_free(kept);
  mlim_indicators_free(lost);
  mlim_label_map_free(&map);
  free(scene.values);
}

/* The median takes all three away before there is a distance; they come back where they were. */
static void test_thin_after_median(void)
{
  static const int32_t dims[3] = { 18, 12, 14 };
  label_scene scene = label_scene_make(dims, CUBE, rule_thin);
  mlim_label_map map = label_scene_read(&scene, NULL);
  mlim_indicator_options options = mlim_indicator_options_default();
  options.median_radius = 1;
  mlim_indicators* kept = make(&map, &options, NULL);
  int32_t* ids = win_ids(&map, kept, scene.count);
  for (size_t p = 0; p < scene.count; ++p)
  {
    CHECK(scene.values[p] == 0 || ids[p] == scene.values[p]);
  }
  free(ids);
  mlim_indicators_free(kept);
  mlim_label_map_free(&map);
  free(scene.values);
}

/* ---- the other filters ---- */

static size_t count_id(const int32_t* ids, size_t count, int32_t id)
{
  size_t found = 0;
  for (size_t p = 0; p < count; ++p)
  {
    found += ids[p] == id;
  }
  return found;
}

static void test_morphology(void)
{
  static const int32_t dims[3] = { 18, 12, 14 };
  label_scene scene = label_scene_make(dims, CUBE, rule_thin);
  mlim_label_map map = label_scene_read(&scene, NULL);
  mlim_indicator_options options = bare_options();
  options.median_radius = 1;
  mlim_indicators* indicators = make(&map, &options, NULL);
  int32_t* ids = win_ids(&map, indicators, scene.count);
  CHECK_COUNT(count_id(ids, scene.count, 1), 0);
  CHECK(!mlim_indicators_has(indicators, 1));
  mlim_indicators_free(indicators);
  free(ids);
  /* All masks grow, so where they overlap distances decide; a speck's stays below the background's. */
  options.median_radius = 0;
  options.dilate_radius = 2;
  indicators = make(&map, &options, NULL);
  float* values = malloc(scene.count * sizeof *values);
  mlim_indicators_write(indicators, 1, values);
  CHECK(fabs((double)values[4 + 18 * (5 + 12 * 5)] - sqrt(2.5)) < 1e-4); /* edge at (1.5, 0.5, 0) */
  CHECK(fabs((double)values[8 + 18 * (5 + 12 * 5)] + 1.5) < 1e-4);
  mlim_indicators_free(indicators);
  free(values);
  mlim_label_map_free(&map);
  free(scene.values);
}

static int32_t rule_ball(const int32_t at[3])
{
  const double r = hypot(hypot(at[0] - 9.3, at[1] - 9.1), at[2] - 8.9);
  return r < 6.3 ? 4 : 0;
}

/* Volume of the ball's region over that of its voxels, less 1. */
static double ball_volume(const mlim_indicator_options* options)
{
  static const int32_t dims[3] = { 19, 19, 19 };
  label_scene scene = label_scene_make(dims, CUBE, rule_ball);
  mlim_label_map map = label_scene_read(&scene, NULL);
  mlim_indicators* indicators = make(&map, options, NULL);
  mlim_array arrays[2];
  const mlim_grid grid = label_grid(&map, indicators, arrays);
  mlim_field* field = NULL;
  double volumes[2];
  CHECK(mlim_field_create(&grid, NULL, &field) == MLIM_OK);
  CHECK(mlim_volumes_of_field(field, NULL, volumes) == MLIM_OK);
  const double result = volumes[1] / (double)count_id(scene.values, scene.count, 4) - 1;
  mlim_field_free(field);
  mlim_indicators_free(indicators);
  mlim_label_map_free(&map);
  free(scene.values);
  return result;
}

static void test_volume(void)
{
  mlim_indicator_options options = mlim_indicator_options_default();
  CHECK_BELOW(fabs(ball_volume(&options)), 0.005);
  options.keeps_volume = 0;
  CHECK(ball_volume(&options) < -0.05); /* a Gaussian pulls it in */
  options.gaussian_sigma = -1;
  CHECK_BELOW(fabs(ball_volume(&options)), 0.02);
  options.diffusion_iterations = 20;
  const double diffused = ball_volume(&options);
  CHECK(diffused < -0.02 && diffused > -0.3); /* so does the flow by curvature */
}

static int32_t rule_halves(const int32_t at[3])
{
  return at[0] < 10 ? 3 : 8;
}

/* A flat boundary stays where it is, half-way, through all filters. */
static void test_flat(void)
{
  static const int32_t dims[3] = { 20, 6, 7 };
  label_scene scene = label_scene_make(dims, SLAB, rule_halves);
  mlim_label_map map = label_scene_read(&scene, NULL);
  for (int method = 0; method < 2; ++method)
  {
    mlim_indicator_options options = mlim_indicator_options_default();
    options.method = (mlim_indicator_method)method;
    options.diffusion_iterations = 10;
    options.median_radius = 1;
    mlim_indicators* indicators = make(&map, &options, NULL);
    float values[2][20 * 6 * 7];
    mlim_indicators_write(indicators, 0, values[0]);
    mlim_indicators_write(indicators, 1, values[1]);
    for (size_t p = 9; p < scene.count; p += 20)
    {
      const double before = (double)(values[0][p] - values[1][p]);
      const double after = (double)(values[0][p + 1] - values[1][p + 1]);
      CHECK(before > 0 && after < 0);
      CHECK_BELOW(fabs(before + after), 1e-4);
    }
    mlim_indicators_free(indicators);
  }
  mlim_label_map_free(&map);
  free(scene.values);
}

/* ---- the field ---- */

static void swapped_for(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  for (size_t n = count; n-- > 0;)
  {
    body(job, n, n + 1);
  }
}

static void check_same_cells(const mlim_field* a, const mlim_field* b)
{
  const mlim_field_grid* grid = mlim_field_grid_of(a);
  uint16_t labels[2][16];
  float values[2][8 * 16];
  size_t different = 0;
  CHECK(mlim_field_max_candidates(a) <= 16 && mlim_field_max_candidates(b) <= 16);
  for (int32_t z = 0; z < grid->cells[2]; ++z)
  {
    for (int32_t y = 0; y < grid->cells[1]; ++y)
    {
      for (int32_t x = 0; x < grid->cells[0]; ++x)
      {
        const int32_t cell[3] = { x, y, z };
        const mlim_candidates of_a =
          mlim_field_cell(a, cell, &(mlim_cell_buffer){ .labels = labels[0], .values = values[0] });
        const mlim_candidates of_b =
          mlim_field_cell(b, cell, &(mlim_cell_buffer){ .labels = labels[1], .values = values[1] });
        const size_t count = (size_t)of_a.count;
        different += of_a.count != of_b.count ||
                     memcmp(labels[0], labels[1], count * sizeof labels[0][0]) != 0 ||
                     (count > 1 && memcmp(values[0], values[1], 8 * count * sizeof(float)) != 0);
      }
    }
  }
  CHECK_COUNT(different, 0);
}

/* The indicators as arrays give the same field, byte by byte, as the indicators themselves, made by
   threads in another order; with blanked points and whatever happens to unseen labels. */
static void test_same_field(mlim_unseen unseen, int has_blank)
{
  static const int32_t dims[3] = { 37, 20, 34 };
  label_scene scene = label_scene_make(dims, SLAB, label_rule_blocks);
  mlim_label_map map = label_scene_read(&scene, NULL);
  const mlim_indicator_options options = mlim_indicator_options_default();
  mlim_context swapped = { .parallel_for = swapped_for };
  mlim_indicators* one = make(&map, &options, NULL);
  mlim_indicators* other = make(&map, &options, &swapped);
  mlim_array arrays[2][8];
  unsigned char* blank = calloc(scene.count, 1);
  blank[500] = blank[501] = 1;
  mlim_grid sparse = label_grid(&map, one, arrays[0]);
  mlim_grid dense = label_grid(&map, NULL, arrays[1]);
  sparse.unseen = dense.unseen = unseen;
  sparse.is_outside = dense.is_outside = has_blank ? blank : NULL;
  float* values[8];
  for (int32_t l = 0; l < map.label_count; ++l)
  {
    values[l] = malloc(scene.count * sizeof(float));
    mlim_indicators_write(other, l, values[l]);
    arrays[1][l].values = values[l];
  }
  mlim_field* fields[2] = { NULL, NULL };
  CHECK(mlim_field_create(&sparse, NULL, &fields[0]) == MLIM_OK);
  CHECK(mlim_field_create(&dense, NULL, &fields[1]) == MLIM_OK);
  if (fields[0] != NULL && fields[1] != NULL)
  {
    check_same_cells(fields[0], fields[1]);
  }
  for (int32_t l = 0; l < map.label_count; ++l)
  {
    free(values[l]);
  }
  free(blank);
  mlim_field_free(fields[0]);
  mlim_field_free(fields[1]);
  mlim_indicators_free(one);
  mlim_indicators_free(other);
  mlim_label_map_free(&map);
  free(scene.values);
}

static void test_wrong_grid(void)
{
  static const int32_t dims[3] = { 9, 8, 7 };
  label_scene scene = label_scene_make(dims, CUBE, label_rule_blocks);
  mlim_label_map map = label_scene_read(&scene, NULL);
  const mlim_indicator_options options = mlim_indicator_options_default();
  mlim_indicators* indicators = make(&map, &options, NULL);
  mlim_array arrays[8];
  mlim_field* field = NULL;
  mlim_grid grid = label_grid(&map, indicators, arrays);
  grid.array_count = 1;
  CHECK(mlim_field_create(&grid, NULL, &field) == MLIM_INVALID_ARGUMENT);
  grid = label_grid(&map, indicators, arrays);
  grid.background = MLIM_BACKGROUND_COMPLEMENT;
  CHECK(mlim_field_create(&grid, NULL, &field) == MLIM_INVALID_ARGUMENT);
  mlim_indicators_free(indicators);
  mlim_label_map_free(&map);
  free(scene.values);
}

/* ---- options ---- */

static void test_options(void)
{
  static const int32_t dims[3] = { 4, 4, 4 };
  label_scene scene = label_scene_make(dims, CUBE, label_rule_blocks);
  mlim_label_map map = label_scene_read(&scene, NULL);
  mlim_indicator_options bad[10];
  for (int n = 0; n < 10; ++n)
  {
    bad[n] = mlim_indicator_options_default();
  }
  bad[0].median_radius = 9;
  bad[1].dilate_radius = -1;
  bad[2].diffusion_iterations = 65;
  bad[3].diffusion_time_step = 0.126;
  bad[4].distance_band = 1.7;
  bad[5].distance_band = 64;
  bad[6].gaussian_sigma = 17;
  bad[7].gaussian_sigma = NAN;
  bad[8].method = (mlim_indicator_method)2;
  bad[9].diffusion_iterations = 60; /* beside distance and Gaussian, too far in all */
  for (int n = 0; n < 10; ++n)
  {
    mlim_context context = { 0 };
    mlim_indicators* indicators = NULL;
    CHECK(mlim_indicators_create(&map, &bad[n], &context, &indicators) == MLIM_INVALID_ARGUMENT);
    CHECK(indicators == NULL && strlen(context.message) > 10);
  }
  mlim_indicator_options good = mlim_indicator_options_default();
  good.median_radius = 8;
  good.dilate_radius = 8;
  good.diffusion_iterations = 10;
  good.diffusion_time_step = 0.125;
  good.distance_band = 1.75;
  good.gaussian_sigma = 1;
  mlim_indicators_free(make(&map, &good, NULL));
  mlim_label_map_free(&map);
  free(scene.values);
}

/* ---- the host ---- */

typedef struct host
{
  int calls, stop_at, bad;
  double fraction;
} host;

static int count_calls(void* user, mlim_stage stage, double fraction)
{
  host* h = (host*)user;
  h->bad += stage != MLIM_STAGE_INDICATORS || fraction < h->fraction || fraction > 1;
  h->fraction = fraction;
  return ++h->calls == h->stop_at;
}

static void test_cancel(void)
{
  static const int32_t dims[3] = { 40, 9, 8 };
  label_scene scene = label_scene_make(dims, CUBE, label_rule_blocks);
  const mlim_indicator_options options = mlim_indicator_options_default();
  int calls = 1;
  for (int stop_at = 0; stop_at <= calls; ++stop_at)
  {
    host h = { .stop_at = stop_at };
    mlim_context context = { .progress = count_calls, .user = &h };
    mlim_label_map map = label_scene_read(&scene, &context);
    mlim_indicators* indicators = NULL;
    if (map.labels != NULL)
    {
      const mlim_status status = mlim_indicators_create(&map, &options, &context, &indicators);
      CHECK(status == (stop_at == 0 ? MLIM_OK : MLIM_CANCELLED));
    }
    CHECK((indicators != NULL) == (stop_at == 0));
    CHECK_COUNT((size_t)h.bad, 0);
    calls = stop_at == 0 ? h.calls : calls;
    CHECK(stop_at == 0 || h.calls == stop_at);
    mlim_indicators_free(indicators);
    mlim_label_map_free(&map);
  }
  CHECK(calls > 8);
  free(scene.values);
}

int main(void)
{
  static const int32_t small[3] = { 9, 8, 7 };
  static const int32_t tiles[3] = { 35, 33, 9 };
  test_values(CUBE, small, 0);
  test_values(SLAB, tiles, 0);
  test_values(CUBE, tiles, 1);
  test_constant();
  test_thin();
  test_thin_after_median();
  test_morphology();
  test_volume();
  test_flat();
  test_same_field(MLIM_UNSEEN_KEEP, 0);
  test_same_field(MLIM_UNSEEN_DROP, 1);
  test_wrong_grid();
  test_options();
  test_cancel();
  return check_result();
}
