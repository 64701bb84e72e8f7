/* Triangles in space. */
#ifndef mlim_triangle_h
#define mlim_triangle_h

#include "vector.h"

/* Twice the area long; seen from its tip the triangle runs anticlockwise. */
static inline void mlim_triangle_normal(
  const double p[3], const double q[3], const double r[3], double out[3])
{
  double u[3];
  double v[3];
  mlim_subtract(q, p, u);
  mlim_subtract(r, p, v);
  mlim_cross(u, v, out);
}

/* Circumradius / shortest edge, squared: R = a b c / (4 area). Infinite or NaN without an area. */
static inline double mlim_radius_edge_ratio_squared(
  const double p[3], const double q[3], const double r[3])
{
  double n[3];
  mlim_triangle_normal(p, q, r, n);
  const double a = mlim_distance_squared(p, q);
  const double b = mlim_distance_squared(p, r);
  const double c = mlim_distance_squared(q, r);
  return a * b * c / (4 * mlim_dot(n, n) * mlim_min(a, mlim_min(b, c)));
}

#endif
