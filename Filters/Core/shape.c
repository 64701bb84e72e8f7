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

static pieces take_apart(const double* const p[4])
{
  pieces out;
  double a[3];
  double b[3];
  double c[3];
  mlim_subtract(p[1], p[0], a);
  mlim_subtract(p[2], p[0], b);
  mlim_subtract(p[3], p[0], c);
  /* Inward, in fact; the sign of all four is the same, which is what the angles need. */
  mlim_cross(b, c, out.normals[1]);
  mlim_cross(c, a, out.normals[2]);
  mlim_cross(a, b, out.normals[3]);
  const double squared[3] = { mlim_dot(a, a), mlim_dot(b, b), mlim_dot(c, c) };
  double sum[3];
  for (int k = 0; k < 3; ++k)
  {
    out.normals[0][k] = -(out.normals[1][k] + out.normals[2][k] + out.normals[3][k]);
    sum[k] = squared[0] * out.normals[1][k] + squared[1] * out.normals[2][k] +
             squared[2] * out.normals[3][k];
  }
  for (int e = 0; e < 3; ++e)
  {
    out.edges_squared[e] = squared[e];
    out.edges_squared[e + 3] = mlim_distance_squared(p[PAIRS[e + 3][0]], p[PAIRS[e + 3][1]]);
  }
  out.volume = mlim_dot(a, out.normals[1]);
  out.radius_squared = mlim_dot(sum, sum) / (4 * out.volume * out.volume);
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
  double a[3];
  double b[3];
  double c[3];
  mlim_subtract(p[1], p[0], a);
  mlim_subtract(p[2], p[0], b);
  mlim_subtract(p[3], p[0], c);
  double bc[3];
  double ca[3];
  double ab[3];
  mlim_cross(b, c, bc);
  mlim_cross(c, a, ca);
  mlim_cross(a, b, ab);
  const double volume = mlim_dot(a, bc);
  const double aa = mlim_dot(a, a);
  const double bb = mlim_dot(b, b);
  const double cc = mlim_dot(c, c);
  const double dot_ab = mlim_dot(a, b);
  const double dot_ac = mlim_dot(a, c);
  const double dot_bc = mlim_dot(b, c);
  const double ab_ab = aa + bb - 2 * dot_ab; /* squared edges between the other three vertices */
  const double ac_ac = aa + cc - 2 * dot_ac;
  const double bc_bc = bb + cc - 2 * dot_bc;
  const double sum[3] = { bc[0] + ca[0] + ab[0], bc[1] + ca[1] + ab[1], bc[2] + ca[2] + ab[2] };
  const double n0 = 1 / mlim_dot(sum, sum);
  const double n1 = 1 / mlim_dot(bc, bc);
  const double n2 = 1 / mlim_dot(ca, ca);
  const double n3 = 1 / mlim_dot(ab, ab);
  const double least = mlim_min(mlim_min(mlim_min(aa * n2 * n3, bb * n1 * n3), cc * n1 * n2),
    mlim_min(mlim_min(ab_ab * n0 * n3, ac_ac * n0 * n2), bc_bc * n0 * n1));
  const double sine = volume * sqrt(least);
  if (!(volume > 0) || !(sine > 0))
  {
    return isfinite(sine) ? mlim_max(sine / bound->sine, LEAST_SHAPE) : LEAST_SHAPE;
  }
  const double shortest =
    mlim_min(mlim_min(mlim_min(aa, bb), cc), mlim_min(mlim_min(ab_ab, ac_ac), bc_bc));
  double center[3];
  for (int k = 0; k < 3; ++k)
  {
    center[k] = aa * bc[k] + bb * ca[k] + cc * ab[k];
  }
  const double allowed = bound->radius_edge_ratio * bound->radius_edge_ratio;
  const double part = allowed * shortest * 4 * volume * volume / mlim_dot(center, center);
  const double shape = mlim_min(sine / bound->sine, part < 1 ? sqrt(sqrt(part)) : INFINITY);
  return shape < 1 ? shape : 1 + sine;
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
  const pieces cell = take_apart(points);
  for (int k = 0; k < 3; ++k)
  {
    double sum = 0;
    for (int e = 0; e < 3; ++e)
    {
      sum += cell.edges_squared[e] * cell.normals[e + 1][k];
    }
    out[k] = points[0][k] + sum / (2 * cell.volume);
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
