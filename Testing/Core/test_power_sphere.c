/* Every decision of the power sphere against exact arithmetic: on common cells, flat ones, far from the
   origin, with points near the sphere and on it. */
#include "check.h"
#include "power_sphere.h"

#include <stdint.h>

/* Coordinates are whole numbers below 2^21 apart from a common offset, so that the determinant, a sum of
   24 products of at most 22 + 22 + 22 + 46 bits, fits. */
__extension__ typedef __int128 wide;

typedef struct integers
{
  int64_t points[5][3]; /* four vertices and the point asked about */
  int64_t weights[5];
} integers;

static uint64_t state = 1;

static int64_t below(int64_t limit)
{
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (int64_t)((state >> 16) % (uint64_t)limit);
}

static wide determinant3(const wide a[3], const wide b[3], const wide c[3])
{
  return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

static wide orientation(const integers* n)
{
  wide edge[3][3];
  for (int k = 0; k < 3; ++k)
  {
    for (int j = 0; j < 3; ++j)
    {
      edge[k][j] = n->points[k + 1][j] - n->points[0][j];
    }
  }
  return determinant3(edge[0], edge[1], edge[2]);
}

/* -1: in conflict, 1: not, 0: on the sphere; for a positively oriented cell. */
static int exact_side(const integers* n)
{
  wide row[4][3];
  wide lifted[4];
  for (int k = 0; k < 4; ++k)
  {
    lifted[k] = n->weights[4] - n->weights[k];
    for (int j = 0; j < 3; ++j)
    {
      row[k][j] = n->points[k][j] - n->points[4][j];
      lifted[k] += row[k][j] * row[k][j];
    }
  }
  const wide sum = lifted[0] * determinant3(row[1], row[2], row[3]) -
                   lifted[1] * determinant3(row[0], row[2], row[3]) +
                   lifted[2] * determinant3(row[0], row[1], row[3]) -
                   lifted[3] * determinant3(row[0], row[1], row[2]);
  return sum > 0 ? -1 : sum < 0;
}

static void orient(integers* n)
{
  for (int j = 0; j < 3 && orientation(n) < 0; ++j)
  {
    for (int i = 0; i < 3; ++i)
    {
      const int64_t swap = n->points[0][i];
      n->points[0][i] = n->points[1][i];
      n->points[1][i] = swap;
    }
    const int64_t swap = n->weights[0];
    n->weights[0] = n->weights[1];
    n->weights[1] = swap;
  }
}

typedef struct tally
{
  size_t asked, decided, wrong, zeros;
} tally;

/* The sphere of the first four points. Not 0: it decides something. */
static int make(const double points[][3], const double weights[], mlim_power_sphere* sphere,
  mlim_power_bound* bound)
{
  mlim_power_point p[4];
  for (int k = 0; k < 4; ++k)
  {
    p[k] = (mlim_power_point){
      .x = points[k][0], .y = points[k][1], .z = points[k][2], .weight = weights[k]
    };
  }
  const mlim_power_parts parts = mlim_power_sphere_parts(p[0], p[1], p[2], p[3]);
  return mlim_power_sphere_take(&parts, sphere, bound);
}

/* Asks about the last point; scale and offset leave the numbers exact. */
static void ask(const integers* n, double scale, double offset, tally* t)
{
  double points[5][3];
  double weights[5];
  for (int k = 0; k < 5; ++k)
  {
    weights[k] = scale * scale * (double)n->weights[k];
    for (int j = 0; j < 3; ++j)
    {
      points[k][j] = scale * ((double)n->points[k][j] + offset);
    }
  }
  mlim_power_sphere sphere;
  mlim_power_bound bound;
  make((const double(*)[3])points, weights, &sphere, &bound);
  const int exact = exact_side(n);
  const int side = mlim_power_sphere_side(&sphere, &bound, points[4], weights[4]);
  ++t->asked;
  t->decided += side != 0;
  t->wrong += side != 0 && side != exact;
  t->zeros += exact == 0;
}

/* Moves the last point onto the sphere, but for rounding to whole numbers. */
static void approach(integers* n)
{
  double points[4][3];
  double weights[4];
  for (int k = 0; k < 4; ++k)
  {
    weights[k] = (double)n->weights[k];
    for (int j = 0; j < 3; ++j)
    {
      points[k][j] = (double)n->points[k][j];
    }
  }
  mlim_power_sphere sphere;
  mlim_power_bound bound;
  if (!make((const double(*)[3])points, weights, &sphere, &bound) || sphere.level <= 0)
  {
    return;
  }
  double to[3];
  double squared = 0;
  for (int j = 0; j < 3; ++j)
  {
    to[j] = (double)n->points[4][j] - sphere.center[j];
    squared += to[j] * to[j];
  }
  const double part = squared > 0 ? sqrt(sphere.level / squared) : 0;
  for (int j = 0; j < 3; ++j)
  {
    const double x = sphere.center[j] + part * to[j];
    n->points[4][j] = x > 0 && x < 2097151 ? (int64_t)x : n->points[4][j];
  }
  n->weights[4] = 0;
}

/* Four vertices close together on a large sphere and a point on its other side: what is wrong with the
   sphere at the vertices is many times as wrong there. */
static integers random_cap(int64_t width)
{
  const double center = 1 << 20;
  const double radius = 1 << 19;
  integers n = { .weights = { 0 } };
  for (int k = 0; k < 5; ++k)
  {
    double to[3] = { 1, 0, 0 };
    double squared = 0;
    for (int j = 0; j < 3; ++j)
    {
      to[j] +=
        (k < 4 ? (double)below(width) : 2.0 * (double)below(1 << 20) - (1 << 20)) / (1 << 20);
      squared += to[j] * to[j];
    }
    for (int j = 0; j < 3; ++j)
    {
      n.points[k][j] = (int64_t)(center + radius * to[j] / sqrt(squared));
    }
  }
  orient(&n);
  return n;
}

static integers random_cell(const int64_t sides[3], int64_t weight)
{
  integers n;
  for (int k = 0; k < 5; ++k)
  {
    n.weights[k] = weight > 0 ? below(weight) : 0;
    for (int j = 0; j < 3; ++j)
    {
      n.points[k][j] = below(sides[j]);
    }
  }
  orient(&n);
  return n;
}

static tally run(const int64_t sides[3], int64_t weight, int is_near, double scale, double offset)
{
  tally t = { 0 };
  for (int k = 0; k < 20000; ++k)
  {
    integers n = random_cell(sides, weight);
    if (orientation(&n) <= 0)
    {
      continue;
    }
    if (is_near)
    {
      approach(&n);
    }
    ask(&n, scale, offset, &t);
  }
  CHECK_COUNT(t.wrong, 0);
  return t;
}

static void run_caps(int64_t width, double scale, double offset)
{
  tally t = { 0 };
  for (int k = 0; k < 20000; ++k)
  {
    integers n = random_cap(width);
    if (orientation(&n) > 0)
    {
      approach(&n);
      ask(&n, scale, offset, &t);
    }
  }
  CHECK(t.asked > 1000);
  CHECK_COUNT(t.wrong, 0);
}

int main(void)
{
  static const int64_t large[3] = { 1 << 20, 1 << 20, 1 << 20 };
  static const int64_t flat[3] = { 1 << 20, 1 << 20, 3 };
  static const int64_t needle[3] = { 1 << 20, 2, 3 };
  static const int64_t lattice[3] = { 3, 3, 3 };
  static const double offsets[3] = { 0, 1073741824.0, 1099511627776.0 };
  static const double scales[3] = { 1, 0x1p-60, 0x1p+60 };
  for (int o = 0; o < 3; ++o)
  {
    for (int s = 0; s < 3; ++s)
    {
      const tally common = run(large, 0, 0, scales[s], offsets[o]);
      /* The filter has a purpose: with coordinates whose squares a float cannot hold it may give up,
         elsewhere hardly ever. */
      CHECK(s == 2 || common.decided > common.asked - common.asked / 100);
      run_caps(1 << 18, scales[s], offsets[o]);
      run_caps(1 << 15, scales[s], offsets[o]);
      run_caps(1 << 13, scales[s], offsets[o]);
      run(large, (int64_t)1 << 38, 0, scales[s], offsets[o]);
      run(large, 0, 1, scales[s], offsets[o]);
      run(flat, 0, 0, scales[s], offsets[o]);
      run(flat, 1 << 20, 1, scales[s], offsets[o]);
      run(needle, 0, 0, scales[s], offsets[o]);
      const tally tied = run(lattice, 2, 0, scales[s], offsets[o]);
      CHECK(tied.zeros > 100);
    }
  }
  return check_result();
}
