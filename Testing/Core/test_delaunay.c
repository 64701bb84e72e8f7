/* The triangulation after random and degenerate insertions: valid, Delaunay in power, repeatable. All
   coordinates and weights are whole numbers, so that every check is exact. */
#include "check.h"
#include "delaunay.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum
{
  MAX_POINTS = 1500,
  SIDE = 1 << 20, /* of the box: the far vertices are whole numbers too, below 2^22 */
  LATTICE = 7
};

static const double SIZE[3] = { SIDE, SIDE, SIDE };

/* A determinant is a sum of 24 products of at most 23 + 23 + 23 + 48 bits. */
__extension__ typedef __int128 wide;

typedef struct cloud
{
  int64_t points[MAX_POINTS + MLIM_FAR_VERTICES][4]; /* with their weights */
  int32_t count;                                     /* far vertices too */
  wide volume;                                       /* of the hull */
} cloud;

static uint64_t state;

static int64_t below(int64_t limit)
{
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (int64_t)((state >> 16) % (uint64_t)limit);
}

/* ---- exact geometry ---- */

/* Rows p_k - q with their lifted coordinate. */
static void lift(const cloud* c, int32_t vertex, int32_t from, wide out[4])
{
  out[3] = c->points[from][3] - c->points[vertex][3];
  for (int k = 0; k < 3; ++k)
  {
    out[k] = c->points[vertex][k] - c->points[from][k];
    out[3] += out[k] * out[k];
  }
}

static wide determinant(const wide a[4], const wide b[4], const wide c[4])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static wide orientation(const cloud* c, const int32_t v[4])
{
  wide row[3][4];
  for (int k = 0; k < 3; ++k)
  {
    lift(c, v[k + 1], v[0], row[k]);
  }
  return determinant(row[0], row[1], row[2]);
}

/* Above 0: the vertex is inside the power sphere of the cell. */
static wide inside(const cloud* c, const int32_t v[4], int32_t vertex)
{
  wide row[4][4];
  for (int k = 0; k < 4; ++k)
  {
    lift(c, v[k], vertex, row[k]);
  }
  return row[0][3] * determinant(row[1], row[2], row[3]) -
         row[1][3] * determinant(row[0], row[2], row[3]) +
         row[2][3] * determinant(row[0], row[1], row[3]) -
         row[3][3] * determinant(row[0], row[1], row[2]);
}

/* ---- checks ---- */

/* A power centre is as far in power from all vertices, but for the digits that a flat cell costs. */
static void check_center(const cloud* c, const mlim_delaunay_cells* all, size_t id)
{
  const int32_t* v = all->cells[id].vertices;
  const double* center = all->spheres[id].center;
  double power[4];
  double most = 0;
  double longest = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int64_t* p = c->points[v[k]];
    power[k] = (double)-p[3];
    double squared = 0;
    for (int j = 0; j < 3; ++j)
    {
      const double d = (double)p[j] - center[j];
      const double e = (double)(p[j] - c->points[v[0]][j]);
      power[k] += d * d;
      squared += e * e;
    }
    longest = fmax(longest, sqrt(squared));
    most = fmax(most, fabs(power[k]));
  }
  const int is_flat = (double)orientation(c, v) < 1e-4 * longest * longest * longest;
  for (int k = 1; k < 4 && !is_flat; ++k)
  {
    CHECK_BELOW(fabs(power[k] - power[0]), 1e-9 * (1 + most));
  }
}

/* Neighbour i of a cell, and the cell as its neighbour, share the other three vertices. */
static int is_linked(const mlim_delaunay_cells* all, size_t id, int i)
{
  const mlim_cell* cell = &all->cells[id];
  const int32_t n = cell->neighbors[i];
  if (n < 0 || (size_t)n >= all->count || all->cells[n].vertices[0] < 0)
  {
    return 0;
  }
  const mlim_cell* other = &all->cells[n];
  int shared = 0;
  int back = -1;
  for (int j = 0; j < 4; ++j)
  {
    int is_shared = 0;
    for (int m = 0; m < 4; ++m)
    {
      is_shared |= m != i && cell->vertices[m] == other->vertices[j];
    }
    shared += is_shared;
    back = is_shared ? back : j;
  }
  return shared == 3 && other->neighbors[back] == (int32_t)id;
}

/* Vertices beyond a facet of the hull. */
static size_t count_beyond(const cloud* c, const mlim_cell* cell, int i)
{
  int32_t v[4];
  memcpy(v, cell->vertices, sizeof v);
  size_t count = 0;
  for (v[i] = 0; v[i] < c->count; ++v[i])
  {
    count += orientation(c, v) < 0;
  }
  return count;
}

/* Positive cells that fill the hull, each linked to its neighbours, each facet locally Delaunay: then all
   spheres are empty. `is_slow`: looks at every pair of sphere and vertex, too. */
static void check_all(mlim_delaunay* delaunay, const cloud* c, int is_slow)
{
  const mlim_delaunay_cells all = mlim_delaunay_all(delaunay);
  size_t flipped = 0;
  size_t unlinked = 0;
  size_t not_empty = 0;
  size_t beyond = 0;
  static int used[MAX_POINTS + MLIM_FAR_VERTICES];
  memset(used, 0, sizeof used);
  wide volume = 0;
  for (size_t id = 0; id < all.count; ++id)
  {
    const mlim_cell* cell = &all.cells[id];
    if (cell->vertices[0] < 0)
    {
      continue;
    }
    const wide part = orientation(c, cell->vertices);
    flipped += !(part > 0);
    volume += part;
    check_center(c, &all, id);
    for (int i = 0; i < 4; ++i)
    {
      used[cell->vertices[i]] = 1;
      if (cell->neighbors[i] == MLIM_NO_CELL)
      {
        beyond += count_beyond(c, cell, i);
        continue;
      }
      unlinked += !is_linked(&all, id, i);
      const mlim_cell* other = &all.cells[cell->neighbors[i]];
      for (int j = 0; j < 4; ++j)
      {
        not_empty += inside(c, cell->vertices, other->vertices[j]) > 0;
      }
    }
    for (int32_t v = 0; v < c->count && is_slow; ++v)
    {
      not_empty += inside(c, cell->vertices, v) > 0;
    }
  }
  CHECK_COUNT(flipped, 0);
  CHECK_COUNT(unlinked, 0);
  CHECK_COUNT(not_empty, 0);
  CHECK_COUNT(beyond, 0);
  CHECK(c->volume == 0 || volume == c->volume);
  size_t unused = 0;
  for (int32_t v = 0; v < c->count; ++v)
  {
    unused += !used[v];
  }
  CHECK_COUNT(unused, 0);
}

/* ---- insertion ---- */

static mlim_delaunay_zone find(mlim_delaunay* delaunay, const int64_t point[4])
{
  const double at[3] = { (double)point[0], (double)point[1], (double)point[2] };
  mlim_delaunay_zone zone = { 0 };
  CHECK(mlim_delaunay_find(
          delaunay, at, (double)point[3], MLIM_NO_CELL, MLIM_START_NEAR, NULL, &zone) == MLIM_OK);
  return zone;
}

/* Returns whether the point went in. */
static int insert(
  mlim_delaunay* delaunay, cloud* c, int64_t x, int64_t y, int64_t z, int64_t weight)
{
  const int64_t point[4] = { x, y, z, weight };
  if (c->count >= MAX_POINTS + MLIM_FAR_VERTICES || find(delaunay, point).count == 0)
  {
    return 0;
  }
  mlim_delaunay_zone made;
  CHECK(mlim_delaunay_fill(delaunay, NULL, &made) == MLIM_OK);
  const mlim_cell* cells = mlim_delaunay_all(delaunay).cells;
  size_t wrong = made.count == 0;
  for (size_t k = 0; k < made.count; ++k)
  {
    const mlim_cell* cell = &cells[made.cells[k]];
    wrong += cell->vertices[0] != c->count || cell->mark != 0 || cell->label != 0 ||
             cell->facets[0] != 0 || cell->facets[3] != 0;
  }
  CHECK_COUNT(wrong, 0);
  memcpy(c->points[c->count++], point, sizeof point);
  return 1;
}

static mlim_delaunay* start(cloud* c)
{
  mlim_delaunay* delaunay = NULL;
  CHECK(mlim_delaunay_create(SIZE, NULL, &delaunay) == MLIM_OK);
  c->count = MLIM_FAR_VERTICES;
  c->volume = 0;
  for (int32_t v = 0; v < MLIM_FAR_VERTICES; ++v)
  {
    const double* at = mlim_delaunay_vertices(delaunay)[v].point;
    for (int k = 0; k < 3; ++k)
    {
      c->points[v][k] = (int64_t)at[k];
      CHECK((double)c->points[v][k] - at[k] == 0);
    }
    c->points[v][3] = 0;
  }
  const mlim_delaunay_cells all = mlim_delaunay_all(delaunay);
  for (size_t id = 0; id < all.count; ++id)
  {
    c->volume += orientation(c, all.cells[id].vertices);
  }
  return delaunay;
}

/* ---- clouds ---- */

static void add_random(mlim_delaunay* delaunay, cloud* c, int count, int64_t max_weight)
{
  for (int n = 0; n < count; ++n)
  {
    insert(delaunay, c, below(SIDE), below(SIDE), below(SIDE), below(max_weight + 1));
  }
}

static void test_random(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  check_all(delaunay, &c, 1);
  state = 1;
  add_random(delaunay, &c, 300, 0);
  CHECK_COUNT(c.count, MLIM_FAR_VERTICES + 300);
  check_all(delaunay, &c, 1);
  mlim_delaunay_free(delaunay);
  /* Balls with radii up to this part of the side: of the larger ones most are hidden. */
  static const double parts[] = { 0.1, 0.2, 0.4 };
  for (int k = 0; k < 3; ++k)
  {
    delaunay = start(&c);
    const double radius = parts[k] * SIDE;
    add_random(delaunay, &c, 300, (int64_t)(radius * radius));
    CHECK(c.count < MLIM_FAR_VERTICES + 300 && c.count > MLIM_FAR_VERTICES + 10);
    add_random(delaunay, &c, 100, 0); /* points without weight among them */
    check_all(delaunay, &c, 1);
    mlim_delaunay_free(delaunay);
  }
}

/* All points of a lattice in a scrambled order: each cube is cospherical, each plane full. */
static void test_lattices(void)
{
  static cloud c;
  const int64_t step = SIDE / 8;
  for (int k = 0; k < 3; ++k)
  {
    mlim_delaunay* delaunay = start(&c);
    for (int n = 0; n < LATTICE * LATTICE * LATTICE; ++n)
    {
      const int at = k == 2 ? n : n * 100 % (LATTICE * LATTICE * LATTICE);
      const int64_t weight = k == 1 ? step * step / 4 * (at % 2) : 0;
      CHECK(insert(
        delaunay, &c, step * (1 + at % 7), step * (1 + at / 7 % 7), step * (1 + at / 49), weight));
    }
    check_all(delaunay, &c, k == 1);
    /* Their midpoints lie on facets, edges and in the middle of cells. */
    for (int n = 0; n < 216; ++n)
    {
      const int64_t x = step * (1 + n % 6);
      const int64_t y = step * (1 + n / 6 % 6);
      const int64_t z = step * (1 + n / 36);
      insert(delaunay, &c, x + step / 2, y + step / 2, z + step / 2, 0);
      insert(delaunay, &c, x + step / 2, y + step / 2, z, 0);
      insert(delaunay, &c, x + step / 2, y, z, 0);
    }
    CHECK(c.count > MLIM_FAR_VERTICES + 343 + (k == 1 ? 216 : 647));
    check_all(delaunay, &c, 0);
    mlim_delaunay_free(delaunay);
  }
}

/* Points on a line, then in a plane through it, then out of it. */
static void test_flat(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  const int64_t step = SIDE / 64;
  for (int n = 1; n < 64; ++n)
  {
    CHECK(insert(delaunay, &c, step * (n * 29 % 64), SIDE / 2, SIDE / 2, 0));
  }
  check_all(delaunay, &c, 1);
  for (int n = 1; n < 256; ++n)
  {
    const int at = n * 101 % 256;
    insert(delaunay, &c, 4 * step * (at % 16), 4 * step * (at / 16), SIDE / 2, 0);
  }
  CHECK(c.count > MLIM_FAR_VERTICES + 63 + 200);
  check_all(delaunay, &c, 1);
  add_random(delaunay, &c, 50, 0);
  check_all(delaunay, &c, 1);
  mlim_delaunay_free(delaunay);
}

/* Points exactly on a sphere; then its centre, in conflict with everything inside it. */
static void test_sphere(void)
{
  static cloud c;
  const int64_t radius = 2 * 3 * 5 * 7 * 11;
  for (int k = 0; k < 2; ++k)
  {
    mlim_delaunay* delaunay = start(&c);
    /* (2mn, m^2 - n^2, m^2 + n^2) twice: whole points of the sphere from those of the circle. */
    for (int64_t x = -radius; x <= radius; x += 2)
    {
      for (int64_t y = -radius; y <= radius && c.count < 600; y += 35)
      {
        const int64_t left = radius * radius - x * x - y * y;
        const int64_t z = left >= 0 ? (int64_t)(sqrt((double)left) + 0.5) : 0;
        if (left >= 0 && z * z == left)
        {
          insert(delaunay, &c, SIDE / 2 + x, SIDE / 2 + y, SIDE / 2 + z, 0);
          insert(delaunay, &c, SIDE / 2 + y, SIDE / 2 - z, SIDE / 2 + x, 0);
        }
      }
    }
    CHECK(c.count > MLIM_FAR_VERTICES + 100);
    check_all(delaunay, &c, 1);
    const int64_t center[4] = { SIDE / 2 + k, SIDE / 2, SIDE / 2, k * 100 };
    CHECK(find(delaunay, center).count > 100);
    CHECK(insert(delaunay, &c, center[0], center[1], center[2], center[3]));
    check_all(delaunay, &c, 1);
    add_random(delaunay, &c, 50, 0);
    check_all(delaunay, &c, 1);
    mlim_delaunay_free(delaunay);
  }
}

/* What would be hidden, or would hide another, or is not inside the hull, finds no cells. */
static void test_refused(void)
{
  static cloud c;
  const int64_t u = SIDE / 6;
  const int64_t m = 3 * u;
  mlim_delaunay* delaunay = start(&c);
  CHECK(insert(delaunay, &c, m, m, m, u * u));
  CHECK(insert(delaunay, &c, m + 2 * u, m, m, 0));
  CHECK(insert(delaunay, &c, m - 2 * u, m, m, 0));
  CHECK(insert(delaunay, &c, m, m - 2 * u, m, 0));
  CHECK(insert(delaunay, &c, m, m + 2 * u, m, 0));
  CHECK(insert(delaunay, &c, m, m, m - 2 * u, 0));
  CHECK(insert(delaunay, &c, m, m, m + 2 * u, 0));
  const int64_t refused[][4] = {
    { m + u / 10, m, m, 0 },                               /* hidden by (m, m, m) */
    { m, m, m, 0 },                                        /* there already, heavier */
    { m, m, m, u * u },                                    /* there already, as heavy */
    { m, m, m, u * u + 1 },                                /* there already, lighter */
    { m + 2 * u, m, m, 0 },                                /* there already */
    { m + 2 * u, m, m, 1 },                                /* there already, lighter */
    { m + u / 10, m, m, 4 * u * u },                       /* would hide (m, m, m) */
    { 5 * SIDE, m, m, 0 },                                 /* outside the hull */
    { 5 * SIDE, m, m, 9 * u * u },                         /* and with weight */
    { c.points[3][0], c.points[3][1], c.points[3][2], 0 }, /* a far vertex */
    { c.points[3][0], c.points[3][1], c.points[3][2], 9 },
  };
  for (size_t k = 0; k < sizeof refused / sizeof *refused; ++k)
  {
    CHECK_COUNT(find(delaunay, refused[k]).count, 0);
    mlim_delaunay_zone made;
    CHECK(mlim_delaunay_fill(delaunay, NULL, &made) == MLIM_INTERNAL && made.count == 0);
  }
  const int64_t fine[4] = { m + 2 * u - u / 10, m + u / 5, m, 0 };
  CHECK(find(delaunay, fine).count > 0);
  check_all(delaunay, &c, 1);
  CHECK(insert(delaunay, &c, fine[0], fine[1], fine[2], 0));
  check_all(delaunay, &c, 1);
  mlim_delaunay_free(delaunay);
}

/* Points in the facets of the hull would make flat cells. */
static void test_hull(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  const mlim_delaunay_cells all = mlim_delaunay_all(delaunay);
  size_t facets = 0;
  for (size_t id = 0; id < all.count; ++id)
  {
    for (int i = 0; i < 4; ++i)
    {
      if (all.cells[id].neighbors[i] != MLIM_NO_CELL)
      {
        continue;
      }
      /* The middle of an edge: its ends are even numbers. */
      const int64_t* a = c.points[all.cells[id].vertices[(i + 1) & 3]];
      const int64_t* b = c.points[all.cells[id].vertices[(i + 2) & 3]];
      const int64_t middle[4] = { (a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2, 0 };
      const double at[3] = { (double)middle[0], (double)middle[1], (double)middle[2] };
      CHECK_COUNT(find(delaunay, middle).count, 0);
      mlim_delaunay_zone zone;
      CHECK(mlim_delaunay_find(delaunay, at, 0, (int32_t)id, MLIM_START_IN_CONFLICT, NULL, &zone) ==
            MLIM_OK);
      CHECK_COUNT(zone.count, 0);
      ++facets;
    }
  }
  CHECK_COUNT(facets, 12);
  mlim_delaunay_free(delaunay);
}

/* ---- starts, repetition ---- */

/* Starting from the cells in conflict, or near them, gives the zone that a search gives. */
static void test_starts(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  state = 5;
  add_random(delaunay, &c, 300, 0);
  for (int n = 0; n < 50; ++n)
  {
    const int64_t point[4] = { below(SIDE), below(SIDE), below(SIDE), 0 };
    const double p[3] = { (double)point[0], (double)point[1], (double)point[2] };
    mlim_delaunay_zone zone = find(delaunay, point);
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

/* The cell of its centroid is found from anywhere, that of a point on a facet, edge or vertex from nowhere. */
static void test_locate(void)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  state = 6;
  add_random(delaunay, &c, 300, 0);
  const mlim_delaunay_cells all = mlim_delaunay_all(delaunay);
  int32_t from = 0;
  for (size_t id = 0; id < all.count; ++id)
  {
    if (all.cells[id].vertices[0] < 0)
    {
      continue;
    }
    from = id % 16 == 0 ? (int32_t)id : from;
    for (int k = 0; k < 4; ++k)
    {
      /* Exact: the points are whole numbers. */
      static const double parts[4][4] = { { 1 }, { 0.5, 0.5 }, { 0.25, 0.25, 0.5 },
        { 0.25, 0.25, 0.25, 0.25 } };
      double at[3] = { 0, 0, 0 };
      for (int n = 0; n < 4; ++n)
      {
        for (int j = 0; j < 3; ++j)
        {
          at[j] += parts[k][n] * (double)c.points[all.cells[id].vertices[n]][j];
        }
      }
      int32_t cell;
      CHECK(mlim_delaunay_locate(delaunay, at, from, NULL, &cell) == MLIM_OK);
      CHECK(cell == (k == 3 ? (int32_t)id : MLIM_NO_CELL));
    }
  }
  mlim_delaunay_free(delaunay);
}

/* The same insertions give the same bytes, whatever goes on beside them. */
static void test_repeat(void)
{
  static cloud c;
  static cloud d;
  static cloud e;
  const int64_t weight = (int64_t)SIDE * SIDE / 100;
  mlim_delaunay* first = start(&c);
  state = 9;
  add_random(first, &c, 300, weight);
  void* between = malloc(12345); /* other addresses for the second one */
  mlim_delaunay* second = start(&d);
  mlim_delaunay* other = start(&e);
  state = 9;
  for (int n = 0; n < 300; ++n)
  {
    add_random(second, &d, 1, weight);
    insert(other, &e, n * 100, n * n, (n * 37) % 100, n);
  }
  const mlim_delaunay_cells a = mlim_delaunay_all(first);
  const mlim_delaunay_cells b = mlim_delaunay_all(second);
  CHECK_COUNT(a.count, b.count);
  size_t different = a.count != b.count;
  for (size_t k = 0; k < a.count && k < b.count; ++k)
  {
    different += memcmp(a.cells[k].vertices, b.cells[k].vertices, sizeof a.cells[k].vertices) ||
                 memcmp(a.cells[k].neighbors, b.cells[k].neighbors, sizeof a.cells[k].neighbors) ||
                 memcmp(a.spheres[k].center, b.spheres[k].center, sizeof a.spheres[k].center);
  }
  CHECK_COUNT(different, 0);
  mlim_delaunay_free(first);
  mlim_delaunay_free(second);
  mlim_delaunay_free(other);
  free(between);
}

int main(void)
{
  test_random();
  test_lattices();
  test_flat();
  test_sphere();
  test_refused();
  test_hull();
  test_starts();
  test_locate();
  test_repeat();
  return check_result();
}
