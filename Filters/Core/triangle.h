/* Triangles in space. */
#ifndef mlim_triangle_h
#define mlim_triangle_h

#include "vector.h"

/* Circumradius / shortest edge, squared: R = a b c / (4 area). Infinite or NaN without an area. */
static inline double mlim_radius_edge_ratio_squared(
  const double p[3], const double q[3], const double r[3])
{
  double u[3];
  double v[3];
  double n[3];
  mlim_subtract(q, p, u);
  mlim_subtract(r, p, v);
  mlim_cross(u, v, n);
  const double a = mlim_dot(u, u);
  const double b = mlim_dot(v, v);
  const double c = mlim_distance_squared(q, r);
  return a * b * c / (4 * mlim_dot(n, n) * mlim_min(a, mlim_min(b, c)));
}

#endif
