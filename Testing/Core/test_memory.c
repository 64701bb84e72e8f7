/* Fails each allocation in turn, of the core (malloc and its kin are wrapped by the linker) and of
   the triangulation (operator new, test_memory_new.cxx): the right status, empty products, no leak. */
#include "label_scenes.h"
#include "shapes.h"

#include <time.h>

/* ---- the allocator ---- */

static size_t allocation_count;
static size_t failing_allocation; /* from 1; 0: none */

int test_memory_fails(void);
void* __real_malloc(size_t size);
void* __real_calloc(size_t count, size_t size);
void* __real_realloc(void* memory, size_t size);
void* __wrap_malloc(size_t size);
void* __wrap_calloc(size_t count, size_t size);
void* __wrap_realloc(void* memory, size_t size);

/* Also called by operator new. */
int test_memory_fails(void)
{
  return ++allocation_count == failing_allocation;
}

void* __wrap_malloc(size_t size)
{
  return test_memory_fails() ? NULL : __real_malloc(size);
}

void* __wrap_calloc(size_t count, size_t size)
{
  return test_memory_fails() ? NULL : __real_calloc(count, size);
}

void* __wrap_realloc(void* memory, size_t size)
{
  return test_memory_fails() ? NULL : __real_realloc(memory, size);
}

/* ---- the scene ---- */

enum
{
  SIDE = 5
};

/* Two regions and background; the island touches the box, so there are caps and junctions. */
static double indicator(const double at[3], int label)
{
  const double r = shape_distance(at, 1.6, 2.1, 2.2);
  return label == 0 ? 0 : label == 1 ? fmin(1.7 - r, at[0] - 1.4) : fmin(1.7 - r, 1.4 - at[0]);
}

/* Two spheres whose edge is a ring so small that contacts take the place of its balls. */
static double near_spheres(const double at[3], int label)
{
  return label == 0 ? 0 : 2 - shape_distance(at, label == 1 ? 2.3 : 6.2, 2.5, 2.6);
}

static const double SPACING[3] = { 1, 1, 1 };
static const int32_t DIMS[3] = { SIDE, SIDE, SIDE };
static const int32_t LONG_DIMS[3] = { 2 * SIDE, SIDE + 1, SIDE + 1 };

static mlim_status run_failing(const image* im, size_t failing)
{
  const mlim_options options = run_options(0);
  mlim_context context = { 0 };
  run r;
  allocation_count = 0;
  failing_allocation = failing;
  const mlim_status status = run_volume(&im->grid, &options, &context, &r);
  failing_allocation = 0;
  CHECK(r.mesh.vertices == NULL || status == MLIM_OK);
  CHECK(r.volume.vertices == NULL || status == MLIM_OK);
  if (status == MLIM_OUT_OF_MEMORY)
  {
    CHECK(strlen(context.message) > 10);
    CHECK(run_is_empty_from(&r, r.field == NULL ? MLIM_STAGE_FIELD : MLIM_STAGE_SURFACE));
    CHECK(r.field != NULL || run_is_empty_from(&r, MLIM_STAGE_FIELD));
  }
  run_free(&r);
  return status;
}

/* A label map into its field. */
static mlim_status run_map_failing(const label_scene* scene, size_t failing)
{
  mlim_indicator_options options = mlim_indicator_options_default();
  options.median_radius = 1;
  const mlim_array values = { .values = scene->values, .type = MLIM_INT32, .stride = 1 };
  static const int32_t kept[2] = { 5, 17 };
  mlim_context context = { 0 };
  mlim_label_map map = { 0 };
  mlim_indicators* indicators = NULL;
  mlim_field* field = NULL;
  mlim_array arrays[5];
  allocation_count = 0;
  failing_allocation = failing;
  mlim_status status = mlim_label_map_read(scene->dims, scene->spacing, &values, &context, &map);
  CHECK((map.labels != NULL) == (status == MLIM_OK));
  status = status == MLIM_OK ? mlim_label_map_select(&map, kept, 2, 0, &context) : status;
  status =
    status == MLIM_OK ? mlim_indicators_create(&map, &options, &context, &indicators) : status;
  CHECK(status == MLIM_OK || indicators == NULL);
  if (status == MLIM_OK)
  {
    const mlim_grid grid = label_grid(&map, indicators, arrays);
    status = mlim_field_create(&grid, &context, &field);
  }
  failing_allocation = 0;
  CHECK((field != NULL) == (status == MLIM_OK));
  CHECK(status == MLIM_OK || strlen(context.message) > 10);
  mlim_field_free(field);
  mlim_indicators_free(indicators);
  mlim_label_map_free(&map);
  return status;
}

static void test_map(void)
{
  static const int32_t dims[3] = { 6, 5, 34 };
  label_scene scene = label_scene_make(dims, SPACING, label_rule_blocks);
  CHECK(run_map_failing(&scene, 0) == MLIM_OK);
  const size_t count = allocation_count;
  CHECK(count > 30);
  size_t unexpected = 0;
  for (size_t k = 1; k <= count; ++k)
  {
    unexpected += run_map_failing(&scene, k) != MLIM_OUT_OF_MEMORY;
  }
  CHECK_COUNT(unexpected, 0);
  free(scene.values);
}

/* Seconds of processor time a scene: sanitizers are slow, so they try fewer allocations. Runs that
   fail take half as long as the one that is measured. */
static const double TIME_LIMIT = 15;

static void test_scene(const image* im)
{
  CHECK(run_failing(im, 0) == MLIM_OK); /* also makes what is made once in a process */
  const clock_t begin = clock();
  CHECK(run_failing(im, 0) == MLIM_OK);
  const double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
  const size_t count = allocation_count;
  CHECK(count > 100);
  const size_t affordable = (size_t)(TIME_LIMIT / fmax(seconds, 1e-6)) + 1;
  const size_t step = count / affordable + 1;
  size_t unexpected = 0;
  for (size_t k = 1; k <= count; k += step)
  {
    const mlim_status status = run_failing(im, k);
    if (status != MLIM_OUT_OF_MEMORY)
    {
      fprintf(stderr, "allocation %zu of %zu failed: %s\n", k, count, mlim_status_text(status));
      ++unexpected;
    }
  }
  CHECK_COUNT(unexpected, 0);
  CHECK(run_failing(im, 0) == MLIM_OK);
}

static void check_contacts(const image* im)
{
  const mlim_options options = run_options(0);
  run r;
  CHECK(run_grid(&im->grid, &options, NULL, &r) == MLIM_OK);
  CHECK(r.mesh.contact_count > 0);
  run_free(&r);
}

int main(void)
{
  image* im = image_sample(DIMS, SPACING, 3, 0, indicator);
  test_scene(im);
  image_free(im);
  im = image_sample(LONG_DIMS, SPACING, 3, 0, near_spheres);
  check_contacts(im);
  test_scene(im);
  image_free(im);
  test_map();
  return check_result();
}
