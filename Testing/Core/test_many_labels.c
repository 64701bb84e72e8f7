/* Fields of hundreds of labels, few of which matter at any place: the field has to find those, whatever
   the arrays' types and layout, and in the bricks at the grid's end as well. */
#include "check.h"
#include "field.h"

#include <stdlib.h>
#include <string.h>

enum
{
  LABELS = 200,
  ROOM = LABELS + 2
};

/* A grid with the memory that it borrows. */
typedef struct scene
{
  size_t points;
  mlim_grid grid;
  mlim_array arrays[LABELS];
  void* values; /* of all arrays */
  unsigned char* is_outside;
} scene;

static double random_unit(uint64_t* state)
{
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

static const size_t sizes[MLIM_SCALAR_END] = { 1, 1, 2, 2, 4, 4, 8, 8, 4, 8 };

static void put(const scene* s, int label, size_t point, double value)
{
  const mlim_array* array = &s->arrays[label];
  void* at = (char*)array->values + point * array->stride * sizes[array->type];
  switch (array->type)
  {
    case MLIM_INT8:
      *(int8_t*)at = (int8_t)value;
      break;
    case MLIM_UINT8:
      *(uint8_t*)at = (uint8_t)value;
      break;
    case MLIM_INT16:
      *(int16_t*)at = (int16_t)value;
      break;
    case MLIM_UINT16:
      *(uint16_t*)at = (uint16_t)value;
      break;
    case MLIM_INT32:
      *(int32_t*)at = (int32_t)value;
      break;
    case MLIM_UINT32:
      *(uint32_t*)at = (uint32_t)value;
      break;
    case MLIM_INT64:
      *(int64_t*)at = (int64_t)value;
      break;
    case MLIM_UINT64:
      *(uint64_t*)at = (uint64_t)value;
      break;
    case MLIM_FLOAT32:
      *(float*)at = (float)value;
      break;
    default:
      *(double*)at = value;
      break;
  }
}

static double get(const scene* s, int label, size_t point)
{
  const mlim_array* array = &s->arrays[label];
  const void* at = (const char*)array->values + point * array->stride * sizes[array->type];
  switch (array->type)
  {
    case MLIM_INT8:
      return *(const int8_t*)at;
    case MLIM_UINT8:
      return *(const uint8_t*)at;
    case MLIM_INT16:
      return *(const int16_t*)at;
    case MLIM_UINT16:
      return *(const uint16_t*)at;
    case MLIM_INT32:
      return *(const int32_t*)at;
    case MLIM_UINT32:
      return *(const uint32_t*)at;
    case MLIM_INT64:
      return (double)*(const int64_t*)at;
    case MLIM_UINT64:
      return (double)*(const uint64_t*)at;
    case MLIM_FLOAT32:
      return (double)*(const float*)at;
    default:
      return *(const double*)at;
  }
}

/* is_interleaved: the arrays are the components of one. A second type, of every third array: `other`. */
static scene* make_scene(
  const int32_t dims[3], mlim_scalar type, mlim_scalar other, int is_interleaved)
{
  scene* s = calloc(1, sizeof *s);
  s->points = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
  s->values = calloc(s->points * LABELS, sizeof(double));
  s->is_outside = calloc(s->points, 1);
  for (int l = 0; l < LABELS; ++l)
  {
    const mlim_scalar own = l % 3 == 2 ? other : type;
    const size_t start = is_interleaved ? (size_t)l * sizes[own] : (size_t)l * s->points * 8;
    s->arrays[l] = (mlim_array){ .values = (char*)s->values + start,
      .type = own,
      .stride = is_interleaved ? LABELS : 1,
      .id = l };
  }
  s->grid = (mlim_grid){ .dims = { dims[0], dims[1], dims[2] },
    .spacing = { 1, 1, 1 },
    .array_count = LABELS,
    .arrays = s->arrays,
    .background = MLIM_BACKGROUND_ARRAY,
    .tie_breaking = MLIM_TIE_LOWEST_INDEX };
  return s;
}

static void free_scene(scene* s)
{
  free(s->values);
  free(s->is_outside);
  free(s);
}

/* Cones round random places, whole numbers of 0 to 100, with noise that makes ties and thin films. */
static void fill_cones(const scene* s, uint64_t seed)
{
  const int32_t* dims = s->grid.dims;
  for (int l = 0; l < LABELS; ++l)
  {
    double centre[3];
    for (int k = 0; k < 3; ++k)
    {
      centre[k] = random_unit(&seed) * (dims[k] - 1);
    }
    const double slope = 1 + 4 * random_unit(&seed);
    for (size_t p = 0; p < s->points; ++p)
    {
      const double x = (double)(p % (size_t)dims[0]) - centre[0];
      const double y = (double)(p / (size_t)dims[0] % (size_t)dims[1]) - centre[1];
      const double z = (double)(p / ((size_t)dims[0] * (size_t)dims[1])) - centre[2];
      const double value = 90 - slope * sqrt(x * x + y * y + z * z) + 9 * random_unit(&seed);
      put(s, l, p, fmax(0, floor(value)));
    }
  }
}

/* ---- the naive answer ---- */

/* Values of the arrays' labels and of the one by rule, a point's side by side. */
typedef struct table
{
  int32_t label_count;
  double* values;
  int32_t* best; /* a point: the lowest of the largest */
} table;

static table make_table(const scene* s)
{
  const int has_extra = s->grid.background >= MLIM_BACKGROUND_CONSTANT;
  const int has_blanks = s->grid.is_outside != NULL;
  const int has_outside = s->grid.background == MLIM_BACKGROUND_NONE;
  table out = { .label_count = LABELS + (has_extra || has_outside) };
  out.values = malloc(s->points * ROOM * sizeof *out.values);
  out.best = malloc(s->points * sizeof *out.best);
  double low = INFINITY;
  double high = -INFINITY;
  double most = -INFINITY;
  for (size_t p = 0; p < s->points; ++p)
  {
    double sum = 0;
    for (int l = 0; l < LABELS; ++l)
    {
      const double value = get(s, l, p);
      out.values[p * ROOM + (size_t)(l + has_extra)] = value;
      low = fmin(low, value);
      high = fmax(high, value);
      sum += value;
    }
    most = fmax(most, sum);
    out.values[p * ROOM + (has_extra ? 0 : LABELS)] = has_extra ? sum : -INFINITY;
  }
  const double constant = s->grid.background_value;
  const int is_constant = s->grid.background == MLIM_BACKGROUND_CONSTANT;
  const double range = is_constant ? fmax(high, constant) - fmin(low, constant) : high - low;
  const size_t rule = has_extra ? 0 : has_outside ? LABELS : s->grid.background_array;
  for (size_t p = 0; p < s->points; ++p)
  {
    double* value = &out.values[p * ROOM + rule];
    *value = is_constant ? constant : has_extra ? most - *value : *value;
    if (has_blanks && (s->is_outside[p] || rule == LABELS))
    {
      *value = fmax(*value, s->is_outside[p] ? 2 * range : -2 * range);
    }
    const double* all = &out.values[p * ROOM];
    out.best[p] = 0;
    for (int32_t l = 1; l < out.label_count; ++l)
    {
      out.best[p] = all[l] > all[out.best[p]] ? l : out.best[p];
    }
  }
  return out;
}

/* Whether no winner of a corner beats the label at all corners. */
static int is_candidate(const table* t, const size_t corners[8], int32_t label)
{
  for (int w = 0; w < 8; ++w)
  {
    const int32_t rival = t->best[corners[w]];
    int is_beaten = rival != label;
    for (int c = 0; c < 8 && is_beaten; ++c)
    {
      const double* value = t->values + corners[c] * ROOM;
      is_beaten = value[rival] > value[label] || (value[rival] == value[label] && rival < label);
    }
    if (is_beaten)
    {
      return 0;
    }
  }
  return 1;
}

typedef struct findings
{
  size_t wrong_points, wrong_lists, wrong_values, mixed, most;
} findings;

/* Values are relative to the best and scaled by a power of two, the same everywhere. */
static void compare_cell(const table* t, const size_t corners[8], const mlim_candidates* cell,
  double* scale, findings* out)
{
  int32_t n = 0;
  for (int32_t l = 0; l < t->label_count; ++l)
  {
    if (!is_candidate(t, corners, l))
    {
      continue;
    }
    if (n >= cell->count || cell->labels[n] != l)
    {
      ++out->wrong_lists;
      return;
    }
    for (int c = 0; c < 8; ++c)
    {
      const double* value = t->values + corners[c] * ROOM;
      const double expected = value[l] - value[t->best[corners[c]]];
      const double found = (double)cell->values[8 * n + c];
      *scale = *scale == 0 && expected != 0 ? found / expected : *scale;
      out->wrong_values += !(fabs(found - expected * *scale) <= 1e-6 * fabs(found));
    }
    ++n;
  }
  out->wrong_lists += n != cell->count;
}

/* A search finds the cell itself if it has three labels or more, else what one from the next cell finds. */
static int is_search_right(const mlim_field* field, const int32_t at[3], int32_t count)
{
  const int32_t next[3] = { at[0] + 1, at[1], at[2] };
  return mlim_field_find_many(field, at) == (count > 2 ? at[0] : mlim_field_find_many(field, next));
}

static findings compare(const scene* s, const mlim_field* field)
{
  findings out = { 0 };
  const table t = make_table(s);
  const size_t nx = (size_t)s->grid.dims[0];
  const size_t slice = nx * (size_t)s->grid.dims[1];
  uint16_t labels[ROOM];
  float values[8 * ROOM];
  const mlim_cell_buffer buffer = { labels, values };
  double scale = 0;
  for (size_t p = 0; p < s->points; ++p)
  {
    const int32_t at[3] = { (int32_t)(p % nx), (int32_t)(p % slice / nx), (int32_t)(p / slice) };
    out.wrong_points += mlim_field_point_label(field, at) != t.best[p];
    if (at[0] + 1 == s->grid.dims[0] || at[1] + 1 == s->grid.dims[1] ||
        at[2] + 1 == s->grid.dims[2])
    {
      continue;
    }
    const mlim_candidates cell = mlim_field_cell(field, at, &buffer);
    out.wrong_lists += !is_search_right(field, at, cell.count);
    size_t corners[8];
    int differs = 0;
    for (size_t c = 0; c < 8; ++c)
    {
      corners[c] = p + (c & 1) + nx * (c >> 1 & 1) + slice * (c >> 2);
      differs |= t.best[corners[c]] != t.best[p];
    }
    if (!differs)
    {
      out.wrong_lists += cell.count != 1 || cell.labels[0] != t.best[p];
      continue;
    }
    ++out.mixed;
    out.most = (size_t)cell.count > out.most ? (size_t)cell.count : out.most;
    compare_cell(&t, corners, &cell, &scale, &out);
  }
  free(t.values);
  free(t.best);
  return out;
}

/* Items one at a time, the last one first. */
static void run_backward(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  for (size_t n = count; n > 0; --n)
  {
    body(job, n - 1, n);
  }
}

static void check_scene(const scene* s, size_t min_mixed)
{
  mlim_context context = { .parallel_for = run_backward };
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&s->grid, &context, &field) == MLIM_OK);
  if (field != NULL)
  {
    const findings found = compare(s, field);
    CHECK_COUNT(found.wrong_points, 0);
    CHECK_COUNT(found.wrong_lists, 0);
    CHECK_COUNT(found.wrong_values, 0);
    CHECK(found.mixed >= min_mixed);
    CHECK(found.most >= 3);
    CHECK(found.most < LABELS / 2);
  }
  mlim_field_free(field);
}

/* ---- tests ---- */

/* Every type, alone and mixed with another, plain and interleaved; rows of several tiles. */
static void test_types(void)
{
  static const int32_t dims[2][3] = { { 14, 11, 10 }, { 263, 6, 5 } };
  for (int type = 0; type < MLIM_SCALAR_END; ++type)
  {
    for (int variant = 0; variant < 3; ++variant)
    {
      const mlim_scalar other = variant == 2 ? MLIM_SCALAR_END - 1 - type : (mlim_scalar)type;
      scene* s = make_scene(dims[type % 2], (mlim_scalar)type, other, variant == 1);
      fill_cones(s, 5 + (uint64_t)type);
      check_scene(s, 300);
      free_scene(s);
    }
  }
}

/* Values that touch the ends of their types. */
static void test_ends(void)
{
  static const int32_t dims[3] = { 13, 9, 9 };
  static const mlim_scalar types[4] = { MLIM_INT8, MLIM_UINT8, MLIM_INT16, MLIM_UINT16 };
  static const double low[4] = { -128, 0, -32768, 0 };
  for (int n = 0; n < 4; ++n)
  {
    scene* s = make_scene(dims, types[n], types[n], 0);
    const double high = low[n] + (sizes[types[n]] == 1 ? 255 : 65535);
    uint64_t seed = 3;
    for (int l = 0; l < LABELS; ++l)
    {
      for (size_t p = 0; p < s->points; ++p)
      {
        put(
          s, l, p, (p * 37 + (size_t)l) % 61 == 0 ? high - floor(2 * random_unit(&seed)) : low[n]);
      }
    }
    /* Nothing but ends: one label has the largest value at each point, or several tie there. */
    mlim_field* field = NULL;
    CHECK(mlim_field_create(&s->grid, NULL, &field) == MLIM_OK);
    if (field != NULL)
    {
      const findings found = compare(s, field);
      CHECK_COUNT(found.wrong_points + found.wrong_lists + found.wrong_values, 0);
    }
    mlim_field_free(field);
    free_scene(s);
  }
}

/* Backgrounds and blanked points, by which a label's values are not those of an array. */
static void test_rules(void)
{
  static const int32_t dims[3] = { 14, 11, 10 };
  for (int background = MLIM_BACKGROUND_NONE; background <= MLIM_BACKGROUND_COMPLEMENT;
       ++background)
  {
    for (int has_blanks = 0; has_blanks < 2; ++has_blanks)
    {
      scene* s = make_scene(dims, MLIM_UINT8, MLIM_UINT8, 0);
      fill_cones(s, 11);
      for (int l = 0; l < LABELS; ++l)
      {
        s->arrays[l].id = l + (background != MLIM_BACKGROUND_ARRAY);
      }
      s->grid.background = (mlim_background)background;
      s->grid.background_value = has_blanks ? 95.5 : 95; /* the latter ties */
      for (size_t p = 0; p < s->points; ++p)
      {
        s->is_outside[p] = p % 14 > 10 || p % 101 == 0;
      }
      s->grid.is_outside = has_blanks ? s->is_outside : NULL;
      check_scene(s, 20);
      free_scene(s);
    }
  }
}

/* The last label wins in the middle of one cell, and at no grid point. */
static void test_inner_label(void)
{
  static const int32_t dims[3] = { 19, 14, 11 };
  static const int32_t cells[6][3] = { { 0, 0, 0 }, { 7, 3, 3 }, { 3, 7, 7 }, { 17, 12, 9 },
    { 16, 5, 8 }, { 11, 11, 4 } };
  for (int n = 0; n < 6; ++n)
  {
    const int32_t* cell = cells[n];
    scene* s = make_scene(dims, MLIM_INT16, MLIM_INT16, 0);
    for (size_t p = 0; p < s->points; ++p)
    {
      const int32_t at[3] = { (int32_t)(p % 19), (int32_t)(p / 19 % 14), (int32_t)(p / (19 * 14)) };
      /* Left and right of the cell's middle, 1000 ahead at its corners. */
      put(s, 40, p, at[0] <= cell[0] ? 1000 : -1000);
      put(s, 90, p, at[0] <= cell[0] ? -1000 : 1000);
      for (int l = 0; l < LABELS; ++l)
      {
        if (l != 40 && l != 90)
        {
          put(s, l, p, -1500 - l);
        }
      }
      const int is_corner = (at[0] == cell[0] || at[0] == cell[0] + 1) &&
                            (at[1] == cell[1] || at[1] == cell[1] + 1) &&
                            (at[2] == cell[2] || at[2] == cell[2] + 1);
      if (is_corner)
      {
        put(s, LABELS - 1, p, 10);
      }
    }
    mlim_field* field = NULL;
    CHECK(mlim_field_create(&s->grid, NULL, &field) == MLIM_OK);
    if (field != NULL)
    {
      const double middle[3] = { cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5 };
      const double aside[3] = { cell[0] + 0.3, cell[1] + 0.5, cell[2] + 0.5 };
      CHECK(mlim_field_label(field, middle) == LABELS - 1);
      CHECK(mlim_field_label(field, aside) == 40);
      const findings found = compare(s, field);
      CHECK_COUNT(found.wrong_points + found.wrong_lists + found.wrong_values, 0);
    }
    mlim_field_free(field);
    free_scene(s);
  }
}

/* Arrays that are the largest nowhere change nothing, also where ties are smoothed. */
static void test_idle_labels(void)
{
  static const int32_t dims[3] = { 17, 13, 12 };
  enum
  {
    FEW = 4
  };
  scene* s = make_scene(dims, MLIM_UINT8, MLIM_UINT8, 0);
  for (size_t p = 0; p < s->points; ++p)
  {
    const int32_t at[3] = { (int32_t)(p % 17), (int32_t)(p / 17 % 13), (int32_t)(p / (17 * 13)) };
    for (int l = 0; l < LABELS; ++l)
    {
      const int off = abs(at[0] - 5 * l) + abs(at[1] - 3 * l) / 2 + abs(at[2] - 7 * (l % 2)) / 2;
      put(s, l, p, l < FEW ? 100 - off : 0);
    }
  }
  mlim_field* fields[2] = { NULL, NULL };
  s->grid.tie_breaking = MLIM_TIE_SMOOTH;
  /* So that both have one range of values, by which bonuses are scaled. */
  put(s, 3, 0, 0);
  CHECK(mlim_field_create(&s->grid, NULL, &fields[0]) == MLIM_OK);
  s->grid.array_count = FEW;
  CHECK(mlim_field_create(&s->grid, NULL, &fields[1]) == MLIM_OK);
  size_t differing = 0;
  size_t many = 0;
  uint16_t labels[2][ROOM];
  float values[2][8 * ROOM];
  for (int32_t n = 0; n < 16 * 12 * 11 && fields[0] != NULL && fields[1] != NULL; ++n)
  {
    const int32_t cell[3] = { n % 16, n / 16 % 12, n / (16 * 12) };
    mlim_candidates found[2];
    for (int k = 0; k < 2; ++k)
    {
      const mlim_cell_buffer buffer = { labels[k], values[k] };
      found[k] = mlim_field_cell(fields[k], cell, &buffer);
    }
    const size_t count = (size_t)found[0].count;
    many += count > 1;
    differing +=
      found[0].count != found[1].count ||
      memcmp(found[0].labels, found[1].labels, count * sizeof(uint16_t)) != 0 ||
      (count > 1 && memcmp(found[0].values, found[1].values, 8 * count * sizeof(float)) != 0);
  }
  CHECK_COUNT(differing, 0);
  CHECK(many > 100);
  mlim_field_free(fields[0]);
  mlim_field_free(fields[1]);
  free_scene(s);
}

/* Rows of grid points along which the last two labels are equal everywhere: a plateau across z, of which each
   gets one half. */
static void test_tied_rows(void)
{
  static const int32_t dims[3] = { 9, 9, 10 };
  static const double falling[10] = { 9, 8, 7, 5, 5, 5, 5, 3, 2, 1 };
  scene* s = make_scene(dims, MLIM_FLOAT32, MLIM_FLOAT32, 0);
  for (size_t p = 0; p < s->points; ++p)
  {
    put(s, LABELS - 2, p, falling[p / 81]);
    put(s, LABELS - 1, p, 10 - falling[p / 81]);
  }
  s->grid.tie_breaking = MLIM_TIE_SMOOTH;
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&s->grid, NULL, &field) == MLIM_OK);
  for (double x = 0.5; x < 8 && field != NULL; x += 1)
  {
    const double below[3] = { x, 3.5, 4.4 };
    const double above[3] = { x, 3.5, 4.6 };
    CHECK(mlim_field_label(field, below) == LABELS - 2);
    CHECK(mlim_field_label(field, above) == LABELS - 1);
  }
  mlim_field_free(field);
  free_scene(s);
}

/* The message names the array and the first of the points, wherever they are. */
static void test_not_finite(void)
{
  static const int32_t dims[3] = { 263, 6, 5 };
  for (int type = MLIM_FLOAT32; type <= MLIM_FLOAT64; ++type)
  {
    for (int variant = 0; variant < 2; ++variant)
    {
      scene* s = make_scene(dims, (mlim_scalar)type, (mlim_scalar)type, variant);
      fill_cones(s, 2);
      put(s, 150, s->points - 1, NAN);
      put(s, 150, s->points - 2, variant ? INFINITY : -INFINITY);
      mlim_context context = { 0 };
      mlim_field* field = NULL;
      CHECK(mlim_field_create(&s->grid, &context, &field) == MLIM_INVALID_ARGUMENT);
      CHECK(field == NULL);
      CHECK(strstr(context.message, "Array 150") != NULL);
      CHECK(strstr(context.message, "2 values") != NULL);
      CHECK(strstr(context.message, "(261, 5, 4)") != NULL);
      free_scene(s);
    }
  }
}

int main(void)
{
  test_types();
  test_ends();
  test_rules();
  test_inner_label();
  test_idle_labels();
  test_tied_rows();
  test_not_finite();
  return check_result();
}
