/* Reading label maps: any scalar type, ids with gaps, what is refused and in which words. */
#include "check.h"
#include "label_scenes.h"

static const int32_t DIMS[3] = { 3, 2, 2 };
static const double SPACING[3] = { 1, 1, 1 };

static mlim_status read(
  const void* values, mlim_scalar type, size_t stride, mlim_context* context, mlim_label_map* out)
{
  const mlim_array array = { .values = values, .type = type, .stride = stride, .name = "parts" };
  return mlim_label_map_read(DIMS, SPACING, &array, context, out);
}

static void check_map(const mlim_label_map* map)
{
  static const int32_t ids[4] = { -5, 0, 7, 100 };
  static const uint16_t labels[12] = { 1, 1, 2, 0, 3, 3, 1, 2, 2, 2, 0, 1 };
  CHECK_COUNT((size_t)map->label_count, 4);
  CHECK(map->ids != NULL && memcmp(map->ids, ids, sizeof ids) == 0);
  CHECK(map->labels != NULL && memcmp(map->labels, labels, sizeof labels) == 0);
}

static void test_types(void)
{
  static const int8_t narrow[12] = { 0, 0, 7, -5, 100, 100, 0, 7, 7, 7, -5, 0 };
  int64_t wide[12];
  float single[12];
  double strided[24];
  for (int i = 0; i < 12; ++i)
  {
    wide[i] = narrow[i];
    single[i] = narrow[i];
    strided[2 * i] = narrow[i];
    strided[2 * i + 1] = 0.5;
  }
  const void* const values[4] = { narrow, wide, single, strided };
  static const mlim_scalar types[4] = { MLIM_INT8, MLIM_INT64, MLIM_FLOAT32, MLIM_FLOAT64 };
  for (int n = 0; n < 4; ++n)
  {
    mlim_label_map map;
    CHECK(read(values[n], types[n], n == 3 ? 2 : 1, NULL, &map) == MLIM_OK);
    check_map(&map);
    mlim_label_map_free(&map);
    CHECK(map.labels == NULL);
  }
}

static void test_select(void)
{
  static const int32_t values[12] = { 0, 0, 7, -5, 100, 100, 0, 7, 7, 7, -5, 0 };
  static const int32_t kept[1] = { 100 };
  static const int32_t ids[2] = { 0, 100 };
  static const uint16_t labels[12] = { 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0 };
  mlim_label_map map;
  CHECK(read(values, MLIM_INT32, 1, NULL, &map) == MLIM_OK);
  CHECK(mlim_label_map_select(&map, kept, 1, 0, NULL) == MLIM_OK);
  CHECK_COUNT((size_t)map.label_count, 2);
  CHECK(memcmp(map.ids, ids, sizeof ids) == 0);
  CHECK(memcmp(map.labels, labels, sizeof labels) == 0);
  mlim_label_map_free(&map);
}

static void check_refused(const void* values, mlim_scalar type, const char* part)
{
  mlim_context context = { 0 };
  mlim_label_map map;
  CHECK(read(values, type, 1, &context, &map) == MLIM_INVALID_ARGUMENT);
  CHECK(map.labels == NULL && map.ids == NULL);
  CHECK(strstr(context.message, part) != NULL);
  if (strstr(context.message, part) == NULL)
  {
    fprintf(stderr, "  message: %s\n", context.message);
  }
}

static void test_refusals(void)
{
  double values[12] = { 0 };
  values[4] = 1.5;
  values[9] = NAN;
  check_refused(values, MLIM_FLOAT64, "\"parts\" has 2 values");
  check_refused(values, MLIM_FLOAT64, "1.5, at point (1, 1, 0)");
  int64_t wide[12] = { 0 };
  wide[11] = 2147483648;
  check_refused(wide, MLIM_INT64, "2147483648, at point (2, 1, 1)");
  wide[11] = -2147483648;
  mlim_label_map map;
  CHECK(read(wide, MLIM_INT64, 1, NULL, &map) == MLIM_OK);
  CHECK(map.label_count == 2 && map.ids[0] == INT32_MIN);
  mlim_label_map_free(&map);
  static const int32_t flat[3] = { 3, 4, 1 };
  const mlim_array array = { .values = wide, .type = MLIM_INT64, .stride = 1 };
  CHECK(mlim_label_map_read(flat, SPACING, &array, NULL, &map) == MLIM_INVALID_ARGUMENT);
  static const double bad[3] = { 1, 0, 1 };
  CHECK(mlim_label_map_read(DIMS, bad, &array, NULL, &map) == MLIM_INVALID_ARGUMENT);
  CHECK(read(NULL, MLIM_INT64, 1, NULL, &map) == MLIM_INVALID_ARGUMENT);
}

static int32_t every_point(const int32_t at[3])
{
  return at[0] + 40 * (at[1] + 40 * at[2]);
}

/* A grey-value image that was taken for a label map. */
static void test_too_many(void)
{
  static const int32_t dims[3] = { 40, 40, 40 };
  mlim_context context = { 0 };
  label_scene scene = label_scene_make(dims, SPACING, every_point);
  mlim_label_map map = label_scene_read(&scene, &context);
  CHECK(map.labels == NULL);
  CHECK(strstr(context.message, "more than 32000 different values") != NULL);
  free(scene.values);
}

int main(void)
{
  test_types();
  test_select();
  test_refusals();
  test_too_many();
  return check_result();
}
