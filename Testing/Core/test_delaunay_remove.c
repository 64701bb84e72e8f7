/* The triangulation after removals: that of the vertices that are left, as if the others had never been, ties
   included. All coordinates and weights are whole numbers: every lattice is full of ties. */
#include "check.h"
#include "delaunay.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum
{
  MAX_POINTS = 2000,
  SIDE = 1 << 20 /* of the box */
};

static const double SIZE[3] = { SIDE, SIDE, SIDE };

typedef struct cloud
{
  double points[MAX_POINTS + MLIM_FAR_VERTICES][4]; /* with their weights */
  unsigned char is_marked[MAX_POINTS + MLIM_FAR_VERTICES];
  size_t count; /* with the far vertices */
} cloud;

static uint64_t state;

static int64_t below(int64_t limit)
{
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (int64_t)((state >> 16) % (uint64_t)limit);
}

static mlim_delaunay* start(cloud* c)
{
  mlim_delaunay* delaunay = NULL;
  CHECK(mlim_delaunay_create(SIZE, NULL, &delaunay) == MLIM_OK);
  *c = (cloud){ .count = MLIM_FAR_VERTICES };
  return delaunay;
}

/* Notes the point if it goes in. */
static void insert(mlim_delaunay* delaunay, cloud* c, const double point[4])
{
  mlim_delaunay_zone zone;
  CHECK(mlim_delaunay_find(delaunay, point, point[3], MLIM_NO_CELL, MLIM_START_NEAR, NULL, &zone) ==
        MLIM_OK);
  if (zone.count > 0 && c->count < MAX_POINTS + MLIM_FAR_VERTICES)
  {
    CHECK(mlim_delaunay_fill(delaunay, NULL, NULL) == MLIM_OK);
    memcpy(c->points[c->count++], point, sizeof c->points[0]);
  }
}

static void insert_random(mlim_delaunay* delaunay, cloud* c, int count, int64_t max_weight)
{
  for (int k = 0; k < count; ++k)
  {
    const double point[4] = { (double)below(SIDE), (double)below(SIDE), (double)below(SIDE),
      (double)below(max_weight + 1) };
    insert(delaunay, c, point);
  }
}

/* Points of a lattice in some order: `stride` has no divisor in common with 343. Every `heavy`-th one has weight
   (0: none). */
static void insert_lattice(mlim_delaunay* delaunay, cloud* c, int stride, int heavy)
{
  const double step = SIDE / 8;
  for (int n = 0; n < 343; ++n)
  {
    const int at = n * stride % 343;
    const double point[4] = { step * (1 + at % 7), step * (1 + at / 7 % 7),
      step * (double)(1 + at / 49), heavy > 0 && at % heavy == 0 ? step * step / 4 : 0 };
    insert(delaunay, c, point);
  }
}

/* ---- comparison ---- */

typedef struct corners
{
  int32_t v[4]; /* ascending */
} corners;

static int compare_corners(const void* a, const void* b)
{
  const corners* x = a;
  const corners* y = b;
  for (int k = 0; k < 4; ++k)
  {
    if (x->v[k] != y->v[k])
    {
      return x->v[k] < y->v[k] ? -1 : 1;
    }
  }
  return 0;
}

/* The living cells, sorted. The caller frees them. */
static corners* list_cells(mlim_delaunay* delaunay, size_t* count)
{
  const mlim_delaunay_cells all = mlim_delaunay_all(delaunay);
  corners* list = malloc((all.count + 1) * sizeof *list);
  *count = 0;
  for (size_t c = 0; c < all.count; ++c)
  {
    const int32_t* v = all.cells[c].vertices;
    if (v[0] < 0)
    {
      continue;
    }
    corners* one = &list[(*count)++];
    memcpy(one->v, v, sizeof one->v);
    for (int k = 1; k < 4; ++k)
    {
      for (int j = k; j > 0 && one->v[j] < one->v[j - 1]; --j)
      {
        const int32_t higher = one->v[j - 1];
        one->v[j - 1] = one->v[j];
        one->v[j] = higher;
      }
    }
  }
  qsort(list, *count, sizeof *list, compare_corners);
  return list;
}

static int has(const int32_t v[4], int32_t vertex)
{
  return v[0] == vertex || v[1] == vertex || v[2] == vertex || v[3] == vertex;
}

/* Neighbours that do not know each other, or share something else than the facet. */
static size_t count_unlinked(mlim_delaunay* delaunay)
{
  const mlim_delaunay_cells all = mlim_delaunay_all(delaunay);
  size_t count = 0;
  for (size_t c = 0; c < all.count; ++c)
  {
    const mlim_cell* cell = &all.cells[c];
    for (int k = 0; k < 4 && cell->vertices[0] >= 0; ++k)
    {
      const int32_t n = cell->neighbors[k];
      const int is_known = n == MLIM_NO_CELL || (all.cells[n].vertices[0] >= 0 &&
                                                  has(all.cells[n].neighbors, (int32_t)c) &&
                                                  !has(all.cells[n].vertices, cell->vertices[k]));
      count += !is_known;
      for (int j = 1; j < 4 && n != MLIM_NO_CELL; ++j)
      {
        count += !has(all.cells[n].vertices, cell->vertices[(k + j) & 3]);
      }
    }
  }
  return count;
}

static void compare(mlim_delaunay* a, mlim_delaunay* b)
{
  size_t a_count;
  size_t b_count;
  corners* x = list_cells(a, &a_count);
  corners* y = list_cells(b, &b_count);
  CHECK_COUNT(a_count, b_count);
  CHECK(a_count == b_count && memcmp(x, y, a_count * sizeof *x) == 0);
  CHECK_COUNT(count_unlinked(a), 0);
  free(x);
  free(y);
}

/* The spheres of the new cells belong to them: the power of the centre is the same to all their vertices. */
static void check_spheres(mlim_delaunay* delaunay, const mlim_delaunay_zone* made)
{
  const mlim_delaunay_cells all = mlim_delaunay_all(delaunay);
  const mlim_vertex* vertices = mlim_delaunay_vertices(delaunay);
  for (size_t c = 0; c < made->count; ++c)
  {
    const double* center = all.spheres[made->cells[c]].center;
    double power[4];
    double most = 0;
    for (int k = 0; k < 4; ++k)
    {
      const mlim_vertex* v = &vertices[all.cells[made->cells[c]].vertices[k]];
      double squared = 0;
      for (int j = 0; j < 3; ++j)
      {
        squared += (v->point[j] - center[j]) * (v->point[j] - center[j]);
      }
      power[k] = squared - v->weight;
      most = squared > most ? squared : most;
    }
    for (int k = 1; k < 4; ++k)
    {
      CHECK(power[k] - power[0] < 1e-6 * most && power[0] - power[k] < 1e-6 * most);
    }
  }
}

/* ---- removal ---- */

/* Takes the marked points out of the triangulation and the cloud; compares with one that has never seen them. */
static void remove_marked(mlim_delaunay* delaunay, cloud* c, int has_good_cells)
{
  static cloud left;
  mlim_delaunay_zone made;
  CHECK(mlim_delaunay_remove(delaunay, c->is_marked, 0, NULL, &made) == MLIM_OK);
  if (has_good_cells)
  {
    check_spheres(delaunay, &made);
  }
  mlim_delaunay* fresh = start(&left);
  for (size_t v = MLIM_FAR_VERTICES; v < c->count; ++v)
  {
    if (!c->is_marked[v])
    {
      insert(fresh, &left, c->points[v]);
    }
  }
  compare(delaunay, fresh);
  const mlim_vertex* vertices = mlim_delaunay_vertices(delaunay);
  size_t moved = 0;
  for (size_t v = MLIM_FAR_VERTICES; v < left.count; ++v)
  {
    moved += memcmp(vertices[v].at, left.points[v], sizeof left.points[v]) != 0;
  }
  CHECK_COUNT(moved, 0);
  *c = left;
  mlim_delaunay_free(fresh);
}

/* Every one in `parts`, by chance. */
static void mark_some(cloud* c, int64_t parts)
{
  for (size_t v = MLIM_FAR_VERTICES; v < c->count; ++v)
  {
    c->is_marked[v] = below(parts) == 0;
  }
}

static void mark_ball(cloud* c, const double center[3], double radius)
{
  for (size_t v = MLIM_FAR_VERTICES; v < c->count; ++v)
  {
    double squared = 0;
    for (int k = 0; k < 3; ++k)
    {
      squared += (c->points[v][k] - center[k]) * (c->points[v][k] - center[k]);
    }
    c->is_marked[v] = squared < radius * radius;
  }
}

static void mark_one(cloud* c)
{
  memset(c->is_marked, 0, sizeof c->is_marked);
  c->is_marked[MLIM_FAR_VERTICES + below((int64_t)c->count - MLIM_FAR_VERTICES)] = 1;
}

/* Single ones, scattered ones and neighbourhoods, with insertions between; in the end all that there are. */
static void test_random(int64_t max_weight)
{
  static cloud c;
  mlim_delaunay* delaunay = start(&c);
  insert_random(delaunay, &c, 600, max_weight);
  for (int k = 0; k < 5; ++k)
  {
    mark_one(&c);
    remove_marked(delaunay, &c, 1);
    mark_some(&c, 30);
    remove_marked(delaunay, &c, 1);
    const double center[3] = { (double)below(SIDE), (double)below(SIDE), (double)below(SIDE) };
    mark_ball(&c, center, SIDE / 6);
    remove_marked(delaunay, &c, 1);
    insert_random(delaunay, &c, 100, max_weight);
  }
  mark_some(&c, 2);
  remove_marked(delaunay, &c, 1);
  mark_some(&c, 1);
  remove_marked(delaunay, &c, 1);
  CHECK_COUNT(c.count, MLIM_FAR_VERTICES);
  insert_random(delaunay, &c, 100, max_weight);
  memset(c.is_marked, 0, sizeof c.is_marked);
  remove_marked(delaunay, &c, 1);
  mlim_delaunay_free(delaunay);
}

/* Every sphere has more than four points on it: which four make a cell is told by the order alone. */
static void test_lattices(void)
{
  static const int strides[] = { 1, 100, 150 };
  static cloud c;
  for (int k = 0; k < 3; ++k)
  {
    for (int heavy = 0; heavy <= 2; heavy += 2)
    {
      mlim_delaunay* delaunay = start(&c);
      insert_lattice(delaunay, &c, strides[k], heavy);
      for (int n = 0; n < 12; ++n)
      {
        mark_one(&c);
        remove_marked(delaunay, &c, 0);
      }
      mark_some(&c, 8);
      remove_marked(delaunay, &c, 0);
      const double center[3] = { SIDE / 2, SIDE / 2, SIDE / 2 };
      mark_ball(&c, center, SIDE / 3.5);
      remove_marked(delaunay, &c, 0);
      insert_lattice(delaunay, &c, 5, 0);
      insert_random(delaunay, &c, 20, 0);
      mark_some(&c, 3);
      remove_marked(delaunay, &c, 0);
      mlim_delaunay_free(delaunay);
    }
  }
}

/* All points in one plane, or on one line: their cells reach the far vertices. */
static void test_flat(void)
{
  static cloud c;
  for (int k = 0; k < 2; ++k)
  {
    mlim_delaunay* delaunay = start(&c);
    const double step = SIDE / 64;
    for (int n = 0; n < 256; ++n)
    {
      const int at = n * 101 % 256;
      const double in_plane[4] = { 4 * step * (at % 16), 4 * step * (at / 16), SIDE / 2, 0 };
      const double on_line[4] = { step * (at % 64), SIDE / 2, SIDE / 2, 0 };
      insert(delaunay, &c, k == 0 ? in_plane : on_line);
    }
    mark_some(&c, 20);
    remove_marked(delaunay, &c, 0);
    mark_some(&c, 2);
    remove_marked(delaunay, &c, 0);
    mlim_delaunay_free(delaunay);
  }
}

int main(void)
{
  state = 17;
  test_random(0);
  test_random((int64_t)SIDE * SIDE / 400);
  test_lattices();
  test_flat();
  return check_result();
}
