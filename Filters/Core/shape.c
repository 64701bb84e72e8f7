#include "shape.h"

#include "vector.h"

#include <math.h>

/* Pieces of a cell: all are differences from its first point. */
typedef struct pieces
{
  double normals[4][3];    /* of the face opposite to each vertex: outward, twice its area long */
  double edges_squared[6]; /* of the edges in the order of PAIRS */
  double volume;           /* six times the signed one */
  double radius_squared;
} pieces;

/* Vertices of the six edges; the faces that meet at edge e are opposite to those of edge 5 - e. */
static const int PAIRS[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };

/* Below all others. */
static const double LEAST_SHAPE = -1;

/* The edges from the first point, and their cross products. */
typedef struct corner
{
  double a[3], b[3], c[3];
  double bc[3], ca[3], ab[3];
  double volume; /* six times the signed one */
} corner;

static inline corner take_corner(const double* const p[4])
{
  corner out;
  mlim_subtract(p[1], p[0], out.a);
  mlim_subtract(p[2], p[0], out.b);
  mlim_subtract(p[3], p[0], out.c);
  mlim_cross(out.b, out.c, out.bc);
  mlim_cross(out.c, out.a, out.ca);
  mlim_cross(out.a, out.b, out.ab);
  out.volume = mlim_dot(out.a, out.bc);
  return out;
}

/* The circumcentre from the first point, times 2 volume; from the squared lengths of a, b and c. */
static inline void scaled_center(const corner* at, double aa, double bb, double cc, double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] = aa * at->bc[k] + bb * at->ca[k] + cc * at->ab[k];
  }
}

static pieces take_apart(const double* const p[4])
{
  const corner at = take_corner(p);
  pieces out = { .volume = at.volume,
    .edges_squared = { mlim_dot(at.a, at.a), mlim_dot(at.b, at.b), mlim_dot(at.c, at.c) } };
  /* Inward, in fact; the sign of all four is the same, which is what the angles need. */
  mlim_copy(at.bc, out.normals[1]);
  mlim_copy(at.ca, out.normals[2]);
  mlim_copy(at.ab, out.normals[3]);
  for (int k = 0; k < 3; ++k)
  {
    out.normals[0][k] = -(at.bc[k] + at.ca[k] + at.ab[k]);
  }
  for (int e = 3; e < 6; ++e)
  {
    out.edges_squared[e] = mlim_distance_squared(p[PAIRS[e][0]], p[PAIRS[e][1]]);
  }
  double center[3];
  scaled_center(&at, out.edges_squared[0], out.edges_squared[1], out.edges_squared[2], center);
  out.radius_squared = mlim_dot(center, center) / (4 * at.volume * at.volume);
  return out;
}

static double shortest_squared(const pieces* cell)
{
  double least = cell->edges_squared[0];
  for (int e = 1; e < 6; ++e)
  {
    least = mlim_min(least, cell->edges_squared[e]);
  }
  return least;
}

/* The sine of the angle at an edge is 6 volume length / (normal normal). Most of the time of the
   sliver removal passes here: no loops, no pieces. */
double mlim_shape_of(const mlim_shape_bound* bound, const double* const p[4])
{
  const corner at = take_corner(p);
  const double aa = mlim_dot(at.a, at.a);
  const double bb = mlim_dot(at.b, at.b);
  const double cc = mlim_dot(at.c, at.c);
  /* Squared edges between the other three vertices. */
  const double ab_ab = aa + bb - 2 * mlim_dot(at.a, at.b);
  const double ac_ac = aa + cc - 2 * mlim_dot(at.a, at.c);
  const double bc_bc = bb + cc - 2 * mlim_dot(at.b, at.c);
  const double sum[3] = { at.bc[0] + at.ca[0] + at.ab[0], at.bc[1] + at.ca[1] + at.ab[1],
    at.bc[2] + at.ca[2] + at.ab[2] };
  const double n0 = 1 / mlim_dot(sum, sum);
  const double n1 = 1 / mlim_dot(at.bc, at.bc);
  const double n2 = 1 / mlim_dot(at.ca, at.ca);
  const double n3 = 1 / mlim_dot(at.ab, at.ab);
  const double least = mlim_min(mlim_min(mlim_min(aa * n2 * n3, bb * n1 * n3), cc * n1 * n2),
    mlim_min(mlim_min(ab_ab * n0 * n3, ac_ac * n0 * n2), bc_bc * n0 * n1));
  const double sine = at.volume * sqrt(least);
  if (!(sine > 0))
  {
    return isfinite(sine) ? mlim_max(sine / bound->sine, LEAST_SHAPE) : LEAST_SHAPE;
  }
  const double shortest =
    mlim_min(mlim_min(mlim_min(aa, bb), cc), mlim_min(mlim_min(ab_ab, ac_ac), bc_bc));
  double center[3];
  scaled_center(&at, aa, bb, cc, center);
  const double allowed = bound->radius_edge_ratio * bound->radius_edge_ratio;
  const double part = allowed * shortest * 4 * at.volume * at.volume / mlim_dot(center, center);
  const double shape = mlim_min(sine / bound->sine, part < 1 ? sqrt(sqrt(part)) : INFINITY);
  return shape < 1 ? shape : 1 + sine;
}

/* Rounding errors of the volume are below (7 + 56 u) u times the sum of its products' magnitudes, u = 2^-53
   (Shewchuk, Adaptive precision floating-point arithmetic, 1997), and that sum is at most sqrt(2) times
   the product of the three edges. This is a little above the square of the two factors. */
static const double LOST_SQUARED = 1.44e-30;

int mlim_shape_is_positive(const double* const points[4])
{
  const corner at = take_corner(points);
  const double edges = mlim_dot(at.a, at.a) * mlim_dot(at.b, at.b) * mlim_dot(at.c, at.c);
  return at.volume > 0 && at.volume * at.volume > LOST_SQUARED * edges;
}

static double angle_between(const pieces* cell, int i, int j)
{
  static const double degrees = 57.29577951308232;
  const double* a = cell->normals[i];
  const double* b = cell->normals[j];
  double cross[3];
  mlim_cross(a, b, cross);
  return degrees * atan2(sqrt(mlim_dot(cross, cross)), -mlim_dot(a, b));
}

double mlim_shape_radius_squared(const double* const points[4])
{
  return take_apart(points).radius_squared;
}

void mlim_shape_center(const double* const points[4], double out[3])
{
  const corner at = take_corner(points);
  double center[3];
  scaled_center(&at, mlim_dot(at.a, at.a), mlim_dot(at.b, at.b), mlim_dot(at.c, at.c), center);
  for (int k = 0; k < 3; ++k)
  {
    out[k] = points[0][k] + center[k] / (2 * at.volume);
  }
}

/* The angles grow as the cosines fall: only the first and the last are needed as angles. */
mlim_shape_figures mlim_shape_measure(const double* const points[4])
{
  const pieces cell = take_apart(points);
  double lengths[4];
  for (int k = 0; k < 4; ++k)
  {
    lengths[k] = sqrt(mlim_dot(cell.normals[k], cell.normals[k]));
  }
  int first = 0;
  int last = 0;
  double cosines[6];
  for (int e = 0; e < 6; ++e)
  {
    const int* faces = PAIRS[e];
    cosines[e] = -mlim_dot(cell.normals[faces[0]], cell.normals[faces[1]]) /
                 (lengths[faces[0]] * lengths[faces[1]]);
    first = cosines[e] > cosines[first] ? e : first;
    last = cosines[e] < cosines[last] ? e : last;
  }
  return (mlim_shape_figures){ .volume = cell.volume / 6,
    .min_angle = angle_between(&cell, PAIRS[first][0], PAIRS[first][1]),
    .max_angle = angle_between(&cell, PAIRS[last][0], PAIRS[last][1]),
    .radius_edge_ratio = sqrt(cell.radius_squared / shortest_squared(&cell)) };
}
