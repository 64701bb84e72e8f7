/* The triangulation after random and degenerate insertions: valid, Delaunay in power, repeatable. */
#include "check.h"
#include "delaunay.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum
{
  MAX_POINTS = 600,
  SIDE = 6
};

static const double SIZE[3] = { SIDE, SIDE, SIDE };

typedef struct cloud
{
  double points[MAX_POINTS + MLIM_FAR_VERTICES][3];
  double weights[MAX_POINTS + MLIM_FAR_VERTICES];
  int32_t count; /* far vertices too */
  int is_integer;
} cloud;

static double unit(uint64_t* state)
{
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) / 9007199254740992.0;
}

/* Returns whether the point went in. */
static int insert(mlim_delaunay* delaunay, cloud* c, const double point[3], double weight)
{
  mlim_delaunay_zone zone;
  mlim_delaunay_cells made;
  CHECK(mlim_delaunay_find(delaunay, point, weight, MLIM_NO_CELL, MLIM_START_NEAR, NULL, &zone) ==
        MLIM_OK);
  if (zone.count == 0)
  {
    return 0;
  }
  CHECK(mlim_delaunay_fill(delaunay, NULL, &made) == MLIM_OK);
  int all_new = made.count > 0;
  for (size_t k = 0; k < made.count; ++k)
  {
    const int32_t* v = made.cells[k].vertices;
    all_new &= v[0] == c->count || v[1] == c->count || v[2] == c->count || v[3] == c->count;
  }
  CHECK(all_new);
  memcpy(c->points[c->count], point, 3 * sizeof(double));
  c->weights[c->count++] = weight;
  return 1;
}

static mlim_delaunay* start(cloud* c)
{
  mlim_delaunay* delaunay = NULL;
  CHECK(mlim_delaunay_create(SIZE, NULL, &delaunay) == MLIM_OK);
  *c = (cloud){ .count = MLIM_FAR_VERTICES };
  for (int32_t v = 0; v < MLIM_FAR_VERTICES; ++v)
  {
    mlim_delaunay_far_vertex(delaunay, v, c->points[v]);
  }
  return delaunay;
}

/* ---- checks ---- */

/* Rows p_k - q with their lifted coordinate, in long double: exact on the integer lattice. */
static void lift(const cloud* c, int32_t vertex, int32_t from, long double out[4])
{
  out[3] = -(long double)c->weights[vertex] + (long double)c->weights[from];
  for (int k = 0; k < 3; ++k)
  {
    out[k] = (long double)c->points[vertex][k] - (long double)c->points[from][k];
    out[3] += out[k] * out[k];
  }
}

static long double determinant(
  const long double a[4], const long double b[4], const long double c[4], int i, int j, int k)
{
  return a[i] * (b[j] * c[k] - b[k] * c[j]) - a[j] * (b[i] * c[k] - b[k] * c[i]) +
         a[k] * (b[i] * c[j] - b[j] * c[i]);
}

static long double orientation(const cloud* c, const int32_t v[4])
{
  long double row[3][4];
  for (int k = 0; k < 3; ++k)
  {
    lift(c, v[k + 1], v[0], row[k]);
  }
  return determinant(row[0], row[1], row[2], 0, 1, 2);
}

/* Above 0: the vertex is inside the power sphere of the cell. *scale: what rounding is measured by. */
static long double inside(const cloud* c, const int32_t v[4], int32_t vertex, long double* scale)
{
  long double row[4][4];
  long double sum = 0;
  *scale = 0;
  for (int k = 0; k < 4; ++k)
  {
    lift(c, v[k], vertex, row[k]);
  }
  for (int k = 0; k < 4; ++k)
  {
    const long double minor =
      determinant(row[k == 0], row[k < 2 ? 2 : 1], row[k < 3 ? 3 : 2], 0, 1, 2);
    const long double term = (k % 2 ? 1 : -1) * row[k][3] * minor;
    sum += term;
    *scale += fabsl(term);
  }
  /* With positive orientation, expansion along the last column: positive means inside. */
  return -sum;
}

static void check_centers(const cloud* c, const mlim_delaunay_cell* cell)
{
  const int is_flat = orientation(c, cell->vertices) < 1e-3L;
  double power[4];
  double most = 0;
  for (int k = 0; k < 4; ++k)
  {
    const double* p = c->points[cell->vertices[k]];
    power[k] = -c->weights[cell->vertices[k]];
    for (int j = 0; j < 3; ++j)
    {
      power[k] += (p[j] - cell->center[j]) * (p[j] - cell->center[j]);
    }
    most = fmax(most, fabs(power[k]));
  }
  for (int k = 1; k < 4 && !is_flat; ++k)
  {
    CHECK_BELOW(fabs(power[k] - power[0]), 1e-6 * (1 + most));
  }
}

static void check_all(mlim_delaunay* delaunay, const cloud* c)
{
  mlim_delaunay_cells all;
  CHECK(mlim_delaunay_all(delaunay, NULL, &all) == MLIM_OK);
  int32_t max_id = 0;
  for (size_t k = 0; k < all.count; ++k)
  {
    max_id = all.cells[k].id > max_id ? all.cells[k].id : max_id;
  }
  const mlim_delaunay_cell** by_id = calloc((size_t)max_id + 1, sizeof *by_id);
  size_t unsorted = 0;
  for (size_t k = 0; k < all.count; ++k)
  {
    unsorted += k > 0 && all.cells[k].id <= all.cells[k - 1].id;
    by_id[all.cells[k].id] = &all.cells[k];
  }
  CHECK_COUNT(unsorted, 0);
  size_t flipped = 0;
  size_t unlinked = 0;
  size_t not_empty = 0;
  int used[MAX_POINTS + MLIM_FAR_VERTICES] = { 0 };
  for (size_t k = 0; k < all.count; ++k)
  {
    const mlim_delaunay_cell* cell = &all.cells[k];
    flipped += !(orientation(c, cell->vertices) > 0);
    check_centers(c, cell);
    for (int i = 0; i < 4; ++i)
    {
      used[cell->vertices[i]] = 1;
      const int32_t id = cell->neighbors[i];
      if (id == MLIM_NO_CELL)
      {
        continue;
      }
      const mlim_delaunay_cell* other = id >= 0 && id <= max_id ? by_id[id] : NULL;
      int back = 0;
      int shared = 0;
      for (int j = 0; j < 4 && other != NULL; ++j)
      {
        back += other->neighbors[j] == cell->id;
        for (int m = 0; m < 4; ++m)
        {
          shared += m != i && cell->vertices[m] == other->vertices[j];
        }
      }
      unlinked += back != 1 || shared != 3;
    }
    for (int32_t v = 0; v < c->count; ++v)
    {
      long double scale;
      const long double value = inside(c, cell->vertices, v, &scale);
      not_empty += value > (c->is_integer && v >= MLIM_FAR_VERTICES ? 1e-12L : 1e-15L) * scale;
    }
  }
  CHECK_COUNT(flipped, 0);
  CHECK_COUNT(unlinked, 0);
  CHECK_COUNT(not_empty, 0);
  size_t unused = 0;
  for (int32_t v = 0; v < c->count; ++v)
  {
    unused += !used[v];
  }
  CHECK_COUNT(unused, 0);
  free(by_id);
}

/* ---- clouds ---- */

static int random_cloud(mlim_delaunay* delaunay, cloud* c, double max_weight, uint64_t seed)
{
  for (int n = 0; n < 300; ++n)
  {
    const double p[3] = { SIDE * unit(&seed), SIDE * unit(&seed), SIDE * unit(&seed) };
    insert(delaunay, c, p, max_weight * unit(&seed));
  }
  return c->count;
}

/* All points of a lattice in a scrambled order: each cube is cospherical. */
static int lattice_cloud(mlim_delaunay* delaunay, cloud* c, double weight)
{
  c->is_integer = 1;
  for (int n = 0; n < 343; ++n)
  {
    const int at = n * 100 % 343;
    const double p[3] = { at % 7, at / 7 % 7, at / 49 };
    CHECK(insert(delaunay, c, p, weight * (at % 2)));
  }
  return c->count;
}

static void test_clouds(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  check_all(delaunay, &c);
  CHECK(random_cloud(delaunay, &c, 0, 1) == MLIM_FAR_VERTICES + 300);
  check_all(delaunay, &c);
  mlim_delaunay_free(delaunay);
  delaunay = start(&c);
  /* Weights up to 0.6^2: some points are hidden and refused. */
  CHECK(random_cloud(delaunay, &c, 0.36, 2) < MLIM_FAR_VERTICES + 300);
  check_all(delaunay, &c);
  mlim_delaunay_free(delaunay);
  for (int k = 0; k < 2; ++k)
  {
    delaunay = start(&c);
    lattice_cloud(delaunay, &c, 0.25 * k);
    check_all(delaunay, &c);
    mlim_delaunay_free(delaunay);
  }
}

static size_t zone_of(mlim_delaunay* delaunay, double x, double y, double z, double weight)
{
  const double p[3] = { x, y, z };
  mlim_delaunay_zone zone = { 0 };
  CHECK(
    mlim_delaunay_find(delaunay, p, weight, MLIM_NO_CELL, MLIM_START_NEAR, NULL, &zone) == MLIM_OK);
  return zone.count;
}

/* What would be hidden, or would hide another, finds no cells, and a find alone changes nothing. */
static void test_hidden(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  CHECK(insert(delaunay, &c, (const double[3]){ 3, 3, 3 }, 1));
  CHECK(insert(delaunay, &c, (const double[3]){ 5, 3, 3 }, 0));
  CHECK(insert(delaunay, &c, (const double[3]){ 1, 3, 3 }, 0));
  CHECK(insert(delaunay, &c, (const double[3]){ 3, 1, 3 }, 0));
  CHECK(insert(delaunay, &c, (const double[3]){ 3, 5, 3 }, 0));
  CHECK(insert(delaunay, &c, (const double[3]){ 3, 3, 1 }, 0));
  CHECK(insert(delaunay, &c, (const double[3]){ 3, 3, 5 }, 0));
  CHECK_COUNT(zone_of(delaunay, 3.1, 3, 3, 0), 0);
  CHECK_COUNT(zone_of(delaunay, 3, 3, 3, 0), 0);
  CHECK_COUNT(zone_of(delaunay, 5, 3, 3, 0), 0);
  CHECK_COUNT(zone_of(delaunay, 3.1, 3, 3, 4), 0); /* would hide (3, 3, 3) */
  CHECK(zone_of(delaunay, 4.9, 3.2, 3, 0) > 0);
  check_all(delaunay, &c);
  CHECK(insert(delaunay, &c, (const double[3]){ 4.9, 3.2, 3 }, 0));
  check_all(delaunay, &c);
  mlim_delaunay_free(delaunay);
}

/* Starting from the cells in conflict, or near them, gives the zone that a search gives. */
static void test_starts(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  random_cloud(delaunay, &c, 0, 5);
  uint64_t seed = 6;
  for (int n = 0; n < 50; ++n)
  {
    const double p[3] = { SIDE * unit(&seed), SIDE * unit(&seed), SIDE * unit(&seed) };
    mlim_delaunay_zone zone;
    CHECK(
      mlim_delaunay_find(delaunay, p, 0, MLIM_NO_CELL, MLIM_START_NEAR, NULL, &zone) == MLIM_OK);
    const size_t expected = zone.count;
    const int32_t start_cell = expected > 0 ? zone.cells[expected - 1] : 0;
    CHECK(expected > 0);
    CHECK(mlim_delaunay_find(delaunay, p, 0, start_cell, MLIM_START_IN_CONFLICT, NULL, &zone) ==
          MLIM_OK);
    CHECK_COUNT(zone.count, expected);
    CHECK(mlim_delaunay_find(delaunay, p, 0, start_cell, MLIM_START_NEAR, NULL, &zone) == MLIM_OK);
    CHECK_COUNT(zone.count, expected);
  }
  mlim_delaunay_free(delaunay);
}

static void test_repeat(void)
{
  static cloud c;
  static cloud d;
  mlim_delaunay* first = start(&c);
  random_cloud(first, &c, 0.3, 9);
  void* between = malloc(12345); /* other addresses for the second one */
  mlim_delaunay* second = start(&d);
  random_cloud(second, &d, 0.3, 9);
  mlim_delaunay_cells a;
  mlim_delaunay_cells b;
  CHECK(mlim_delaunay_all(first, NULL, &a) == MLIM_OK);
  CHECK(mlim_delaunay_all(second, NULL, &b) == MLIM_OK);
  CHECK_COUNT(a.count, b.count);
  size_t different = 0;
  for (size_t k = 0; k < a.count && k < b.count; ++k)
  {
    different += a.cells[k].id != b.cells[k].id ||
                 memcmp(a.cells[k].vertices, b.cells[k].vertices, sizeof a.cells[k].vertices) ||
                 memcmp(a.cells[k].neighbors, b.cells[k].neighbors, sizeof a.cells[k].neighbors) ||
                 memcmp(a.cells[k].center, b.cells[k].center, sizeof a.cells[k].center);
  }
  CHECK_COUNT(different, 0);
  mlim_delaunay_free(first);
  mlim_delaunay_free(second);
  free(between);
}

int main(void)
{
  test_clouds();
  test_hidden();
  test_starts();
  test_repeat();
  return check_result();
}
