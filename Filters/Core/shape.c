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

/* The sine of the angle at an edge is 6 volume length / (normal normal). */
double mlim_shape_of(const mlim_shape_bound* bound, const double* const points[4])
{
  const pieces cell = take_apart(points);
  double inverse[4];
  for (int k = 0; k < 4; ++k)
  {
    inverse[k] = 1 / mlim_dot(cell.normals[k], cell.normals[k]);
  }
  double least = INFINITY;
  for (int e = 0; e < 6; ++e)
  {
    const int* faces = PAIRS[5 - e];
    least = mlim_min(least, cell.edges_squared[e] * inverse[faces[0]] * inverse[faces[1]]);
  }
  const double sine = cell.volume * sqrt(least);
  if (!(cell.volume > 0) || !(sine > 0))
  {
    return isfinite(sine) ? sine : -1;
  }
  const double allowed = bound->radius_edge_ratio * bound->radius_edge_ratio;
  const double part = allowed * shortest_squared(&cell) / cell.radius_squared;
  const double shape = mlim_min(sine / bound->sine, sqrt(sqrt(part)));
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

mlim_shape_figures mlim_shape_measure(const double* const points[4])
{
  const pieces cell = take_apart(points);
  mlim_shape_figures out = { .volume = cell.volume / 6,
    .min_angle = 180,
    .radius_edge_ratio = sqrt(cell.radius_squared / shortest_squared(&cell)) };
  for (int e = 0; e < 6; ++e)
  {
    const double angle = angle_between(&cell, PAIRS[e][0], PAIRS[e][1]);
    out.min_angle = mlim_min(out.min_angle, angle);
    out.max_angle = mlim_max(out.max_angle, angle);
  }
  return out;
}
