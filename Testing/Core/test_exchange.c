/* The shape of single cells, and the steps that better a few. */
#include "check.h"
#include "exchange.h"
#include "predicates.h"
#include "random_field.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

static const mlim_shape_bound BOUND = { .sine = 0.2588, .radius_edge_ratio = 2 };

/* ---- shapes ---- */

static void test_shapes(void)
{
  const double corner[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
  const double regular[4][3] = { { 1, 1, 1 }, { -1, -1, 1 }, { 1, -1, -1 }, { -1, 1, -1 } };
  const double* right[4] = { corner[0], corner[1], corner[2], corner[3] };
  const double* even[4] = { regular[0], regular[2], regular[1], regular[3] };
  const mlim_shape_figures r = mlim_shape_measure(right);
  CHECK_BELOW(fabs(r.volume - 1.0 / 6), 1e-15);
  CHECK_BELOW(fabs(r.min_angle - 54.735610317245346), 1e-12);
  CHECK_BELOW(fabs(r.max_angle - 90), 1e-12);
  CHECK_BELOW(fabs(r.radius_edge_ratio - sqrt(0.75)), 1e-15);
  const mlim_shape_figures e = mlim_shape_measure(even);
  CHECK_BELOW(fabs(fabs(e.volume) - 8.0 / 3), 1e-14);
  CHECK_BELOW(fabs(e.min_angle - 70.52877936550931), 1e-12);
  CHECK_BELOW(fabs(e.max_angle - e.min_angle), 1e-12);
  CHECK_BELOW(fabs(e.radius_edge_ratio - sqrt(0.375)), 1e-15);
  CHECK_BELOW(fabs(mlim_shape_radius_squared(even) - 3), 1e-14);
  double center[3];
  mlim_shape_center(right, center);
  CHECK_BELOW(fabs(center[0] - 0.5) + fabs(center[1] - 0.5) + fabs(center[2] - 0.5), 1e-15);

  CHECK_BELOW(fabs(mlim_shape_of(&BOUND, right) - 1 - sqrt(2.0 / 3)), 1e-14);
  const double* inverted[4] = { corner[1], corner[0], corner[2], corner[3] };
  CHECK(mlim_shape_of(&BOUND, inverted) < 0);
  const double* flat[4] = { corner[0], corner[1], corner[2], corner[2] };
  CHECK(mlim_shape_of(&BOUND, flat) <= 0);
}

/* Just above and just below each bound. */
static void test_bounds(void)
{
  const double side = 1e-3;
  for (int is_below = 0; is_below < 2; ++is_below)
  {
    /* A wedge at the x axis: its smallest dihedral angle is that of the two faces there. */
    const double angle = asin(BOUND.sine) * (is_below ? 1 - side : 1 + side);
    const double wedge[4][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0.5, 1, 0 },
      { 0.5, cos(angle), sin(angle) } };
    const double* points[4] = { wedge[0], wedge[1], wedge[2], wedge[3] };
    const mlim_shape_bound any_ratio = { .sine = BOUND.sine, .radius_edge_ratio = 1e6 };
    CHECK((mlim_shape_of(&any_ratio, points) < 1) == is_below);
    /* The same, held against its own ratio. */
    const double ratio = mlim_shape_measure(points).radius_edge_ratio;
    const mlim_shape_bound own = { .sine = 0.01,
      .radius_edge_ratio = ratio * (is_below ? 1 - side : 1 + side) };
    CHECK((mlim_shape_of(&own, points) < 1) == is_below);
  }
}

/* ---- steps ---- */

enum
{
  LOW,
  HIGH,
  FIRST, /* and two more: a triangle round the axis */
  COUNT = 5
};

/* Three cells round the axis, of two labels if `is_split`; or the two cells beside the triangle. */
static mlim_solid make(double height, int is_ring, int is_split)
{
  static const int32_t ring[3][4] = { { LOW, HIGH, FIRST, FIRST + 1 },
    { LOW, HIGH, FIRST + 1, FIRST + 2 }, { LOW, HIGH, FIRST + 2, FIRST } };
  static const int32_t ring_neighbors[3][4] = { { -1, -1, 1, 2 }, { -1, -1, 2, 0 },
    { -1, -1, 0, 1 } };
  static const int32_t pair[2][4] = { { LOW, FIRST, FIRST + 1, FIRST + 2 },
    { HIGH, FIRST + 1, FIRST, FIRST + 2 } };
  static const int32_t pair_neighbors[2][4] = { { 1, -1, -1, -1 }, { 0, -1, -1, -1 } };
  static const unsigned char is_ball[COUNT] = { 0 };
  mlim_solid solid;
  CHECK(mlim_solid_create(COUNT + 1, 3, NULL, &solid) == MLIM_OK);
  solid.bound = BOUND;
  solid.is_ball = is_ball;
  solid.vertex_count = COUNT;
  solid.fixed_count = COUNT;
  for (int v = 0; v < COUNT; ++v)
  {
    const double turn = 2 * 3.141592653589793 / 3 * (v - FIRST);
    double* p = solid.points + 3 * v;
    p[0] = v < FIRST ? 0 : cos(turn);
    p[1] = v < FIRST ? 0 : sin(turn);
    p[2] = v == LOW ? -height : v == HIGH ? height : 0;
  }
  solid.cell_count = is_ring ? 3 : 2;
  for (size_t c = 0; c < solid.cell_count; ++c)
  {
    mlim_solid_cell* cell = &solid.cells[c];
    *cell = (mlim_solid_cell){ .label = is_split && c == 0 };
    memcpy(cell->vertices, is_ring ? ring[c] : pair[c], sizeof cell->vertices);
    memcpy(
      cell->neighbors, is_ring ? ring_neighbors[c] : pair_neighbors[c], sizeof cell->neighbors);
    cell->shape = mlim_solid_shape(&solid, cell->vertices);
  }
  return solid;
}

static double worst(const mlim_solid* solid, double* volume)
{
  double least = INFINITY;
  *volume = 0;
  for (size_t c = 0; c < solid->cell_count; ++c)
  {
    const mlim_solid_cell* cell = &solid->cells[c];
    if (cell->vertices[0] >= 0)
    {
      const double* points[4];
      for (int k = 0; k < 4; ++k)
      {
        points[k] = solid->points + 3 * (size_t)cell->vertices[k];
        const int32_t other = cell->neighbors[k];
        if (other >= 0)
        {
          const int32_t* back = solid->cells[other].neighbors;
          CHECK(back[0] == (int32_t)c || back[1] == (int32_t)c || back[2] == (int32_t)c ||
                back[3] == (int32_t)c);
        }
      }
      *volume += mlim_shape_measure(points).volume;
      least = mlim_min(least, mlim_solid_shape(solid, cell->vertices));
    }
  }
  return least;
}

/* The edge gives way on a short axis only, the face on a long one only, and none between labels. */
static void test_flips(void)
{
  mlim_solid_change* change = malloc(sizeof *change);
  size_t edges = 0;
  size_t faces = 0;
  for (double height = 0.02; height < 8; height *= 1.7)
  {
    double volume;
    double same;
    mlim_solid ring = make(height, 1, 0);
    mlim_solid pair = make(height, 0, 0);
    const double of_ring = worst(&ring, &volume);
    const double of_pair = worst(&pair, &same);
    CHECK_BELOW(fabs(volume - same), 1e-12);
    const int edge = mlim_exchange_edge(&ring, change, 0, 0);
    const int face = mlim_exchange_face(&pair, change, 0, 0);
    CHECK(edge == (of_pair > of_ring));
    CHECK(face == (of_ring > of_pair));
    CHECK_BELOW(fabs(worst(&ring, &same) - mlim_max(of_ring, of_pair)), 1e-12);
    CHECK_BELOW(fabs(volume - same), 1e-12);
    CHECK_BELOW(fabs(worst(&pair, &same) - mlim_max(of_ring, of_pair)), 1e-12);
    CHECK_BELOW(fabs(volume - same), 1e-12);
    edges += edge > 0;
    faces += face > 0;
    mlim_solid_free(&ring);
    mlim_solid_free(&pair);
    mlim_solid split = make(height, 1, 1);
    CHECK(mlim_exchange_edge(&split, change, 0, 0) == 0);
    for (int k = 0; k < 4; ++k)
    {
      CHECK(mlim_exchange_face(&split, change, 0, k) == 0);
      CHECK(mlim_exchange_move(&split, change, 0, k) == 0);
      CHECK(mlim_exchange_vertex(&split, change, 0, k) == 0);
      CHECK(mlim_exchange_star(&split, change, 0, k) == 0);
    }
    mlim_solid_free(&split);
  }
  CHECK(edges > 0 && faces > 0);
  free(change);
}

/* ---- cells as thin as rounding errors ---- */

/* Exactly: not positively oriented, or on the four vertices of another one. */
static size_t count_wrong(const mlim_solid* solid)
{
  size_t count = 0;
  for (size_t c = 0; c < solid->cell_count; ++c)
  {
    const int32_t* v = solid->cells[c].vertices;
    if (v[0] < 0)
    {
      continue;
    }
    const double* p = solid->points;
    int side;
    CHECK(mlim_predicates_orientation(p + 3 * (size_t)v[0], p + 3 * (size_t)v[1],
            p + 3 * (size_t)v[2], p + 3 * (size_t)v[3], NULL, &side) == MLIM_OK);
    count += side <= 0;
    for (size_t d = 0; d < c; ++d)
    {
      const int32_t* w = solid->cells[d].vertices;
      int same = 0;
      for (int k = 0; k < 16 && w[0] >= 0; ++k)
      {
        same += v[k / 4] == w[k % 4];
      }
      count += same == 4;
    }
  }
  return count;
}

/* Vertices at random places, off a plane askew to the axes by up to `height`; two of the triangle's are about
   as close together, and if `is_narrow` LOW and HIGH are, too. */
static void place(mlim_solid* solid, double height, int is_narrow, uint64_t* seed)
{
  for (int v = 0; v < COUNT; ++v)
  {
    double* p = solid->points + 3 * v;
    const double a = random_unit(seed);
    const double b = random_unit(seed);
    p[0] = a + b / 3;
    p[1] = b - a / 7;
    p[2] = 0.7 * a + 0.3 * b + height * random_unit(seed);
    if (v == FIRST + 1 || (v == HIGH && is_narrow))
    {
      for (int k = 0; k < 3; ++k)
      {
        p[k] = p[k - 3] + height * (random_unit(seed) - 0.5);
      }
    }
  }
  for (size_t c = 0; c < solid->cell_count; ++c)
  {
    solid->cells[c].shape = mlim_solid_shape(solid, solid->cells[c].vertices);
  }
}

/* A positively oriented cell may get a shape that is not above 0, and one that is not may get a larger one.
   Whatever takes the place of cells that are in order is so, too. */
static void test_thin(void)
{
  mlim_solid_change* change = malloc(sizeof *change);
  uint64_t seed = 1;
  size_t thin = 0;
  size_t steps = 0;
  for (int k = 0; k < 1000000; ++k)
  {
    const int is_ring = k & 1;
    mlim_solid solid = make(1, is_ring, 0);
    place(&solid, pow(10, -16 * random_unit(&seed)), k & 2, &seed);
    if (count_wrong(&solid) == 0)
    {
      double volume;
      thin += worst(&solid, &volume) <= 0;
      const int done = is_ring ? mlim_exchange_edge(&solid, change, 0, 0)
                               : mlim_exchange_face(&solid, change, 0, 0);
      steps += done > 0;
      CHECK_COUNT(count_wrong(&solid), 0);
    }
    mlim_solid_free(&solid);
  }
  CHECK(thin > 0 && steps > 0);
  free(change);
}

int main(void)
{
  test_shapes();
  test_bounds();
  test_flips();
  test_thin();
  return check_result();
}
