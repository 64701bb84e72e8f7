/* Distances through the bins against a look at every triangle. */
#include "check.h"
#include "nearest.h"
#include "random_field.h"
#include "vector.h"

#include <string.h>

enum
{
  MAX_TRIANGLES = 200
};

static double vertices[9 * MAX_TRIANGLES];
static int32_t triangles[3 * MAX_TRIANGLES];
static const double SIZE[3] = { 8, 5, 3 };

/* Triangles of about `extent`, now and then one as large as the box, a needle or a point. */
static mlim_mesh make_mesh(size_t count, double extent, uint64_t seed)
{
  for (size_t t = 0; t < count; ++t)
  {
    const double reach = t % 17 == 5 ? 8 : extent;
    for (size_t k = 0; k < 9; ++k)
    {
      const double middle = k < 3 ? SIZE[k] * random_unit(&seed) : vertices[9 * t + k % 3];
      const double x = middle + (k < 3 ? 0 : reach * (random_unit(&seed) - 0.5));
      vertices[9 * t + k] = fmin(fmax(x, 0), SIZE[k % 3]);
      triangles[3 * t + k / 3] = (int32_t)(3 * t + k / 3);
    }
    if (t % 13 == 3)
    {
      memcpy(vertices + 9 * t + 3, vertices + 9 * t, 3 * sizeof(double));
    }
    if (t % 26 == 3)
    {
      memcpy(vertices + 9 * t + 6, vertices + 9 * t, 3 * sizeof(double));
    }
  }
  return (mlim_mesh){
    .vertex_count = 3 * count, .vertices = vertices, .triangle_count = count, .triangles = triangles
  };
}

/* Squared distance to a + s (b - a) + t (c - a), least over t for a given s. */
static double row_distance(const double p[3], const double* v, double s)
{
  double a[3];
  double along[3];
  for (int k = 0; k < 3; ++k)
  {
    a[k] = v[k] + s * (v[3 + k] - v[k]);
    along[k] = v[6 + k] - v[k];
  }
  double to[3];
  mlim_subtract(p, a, to);
  const double length = mlim_dot(along, along);
  const double t = length > 0 ? mlim_dot(to, along) / length : 0;
  const double clamped = fmin(fmax(t, 0), 1 - s);
  double q[3];
  for (int k = 0; k < 3; ++k)
  {
    q[k] = a[k] + clamped * along[k];
  }
  return mlim_distance_squared(p, q);
}

/* The distance is convex in s, so halving thirds finds its least value. */
static double triangle_distance(const double p[3], const double* v)
{
  double low = 0;
  double high = 1;
  for (int n = 0; n < 100; ++n)
  {
    const double s = low + (high - low) / 3;
    const double t = high - (high - low) / 3;
    if (row_distance(p, v, s) < row_distance(p, v, t))
    {
      high = t;
    }
    else
    {
      low = s;
    }
  }
  return sqrt(row_distance(p, v, 0.5 * (low + high)));
}

static double brute_distance(const mlim_mesh* mesh, const double p[3])
{
  double least = INFINITY;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    least = fmin(least, triangle_distance(p, mesh->vertices + 9 * t));
  }
  return least;
}

static void test_points(const mlim_mesh* mesh, double side, uint64_t seed)
{
  const mlim_triangles triangles = mlim_triangles_of(mesh);
  mlim_nearest nearest;
  CHECK(mlim_nearest_create(&triangles, SIZE, side, NULL, &nearest) == MLIM_OK);
  int32_t hint = -1; /* of the point before, anywhere */
  for (int n = 0; n < 150; ++n)
  {
    double p[3];
    for (int k = 0; k < 3; ++k)
    {
      /* Also on the box and a little outside it. */
      p[k] = n % 10 == 0 ? SIZE[k] * (random_unit(&seed) < 0.5) : SIZE[k] * random_unit(&seed);
      p[k] += n % 10 == 1 ? 0.5 : 0;
    }
    const double expected = fmin(brute_distance(mesh, p), 100);
    const double limit = n % 3 == 0 ? 0.3 : 100;
    const double found = mlim_nearest_distance(&nearest, p, 0, limit, &hint);
    CHECK_BELOW(fabs(found - fmin(expected, limit)), 1e-6);
    const double enough = 0.4;
    const double quick = mlim_nearest_distance(&nearest, p, enough, 100, &hint);
    CHECK(quick > expected - 1e-6);
    CHECK(expected < enough ? quick < enough + 1e-6 : quick < expected + 1e-6);
    CHECK(mlim_nearest_is_within(&nearest, p, expected + 1e-5, &hint) == (expected < 100));
    CHECK(expected < 2e-5 || !mlim_nearest_is_within(&nearest, p, expected - 1e-5, &hint));
  }
  mlim_nearest_free(&nearest);
}

int main(void)
{
  const struct
  {
    size_t count;
    double extent;
    double side;
  } rows[] = {
    { 0, 1, 1 },      /* no mesh: everything is at the limit */
    { 1, 1, 0.5 },    /* most bins are empty */
    { 200, 0.7, 1 },  /* as the certificate uses it */
    { 200, 0.7, 20 }, /* one bin */
    { 50, 3, 0.01 },  /* more bins than there may be */
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    const mlim_mesh mesh = make_mesh(rows[k].count, rows[k].extent, k + 1);
    test_points(&mesh, rows[k].side, k + 7);
  }
  return check_result();
}
