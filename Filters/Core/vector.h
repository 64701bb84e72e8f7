/* Points and vectors in space. */
#ifndef mlim_vector_h
#define mlim_vector_h

#include <math.h>

/* fmin and fmax are calls into the library, for the sake of NaN; these are one instruction. */
static inline double mlim_min(double a, double b)
{
  return a < b ? a : b;
}

static inline double mlim_max(double a, double b)
{
  return a > b ? a : b;
}

static inline void mlim_copy(const double a[3], double out[3])
{
  out[0] = a[0];
  out[1] = a[1];
  out[2] = a[2];
}

static inline void mlim_subtract(const double a[3], const double b[3], double out[3])
{
  out[0] = a[0] - b[0];
  out[1] = a[1] - b[1];
  out[2] = a[2] - b[2];
}

static inline double mlim_dot(const double a[3], const double b[3])
{
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void mlim_cross(const double a[3], const double b[3], double out[3])
{
  const double x = a[1] * b[2] - a[2] * b[1];
  const double y = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
  out[0] = x;
  out[1] = y;
}

static inline double mlim_distance_squared(const double a[3], const double b[3])
{
  const double x = a[0] - b[0];
  const double y = a[1] - b[1];
  const double z = a[2] - b[2];
  return x * x + y * y + z * z;
}

static inline double mlim_distance(const double a[3], const double b[3])
{
  return sqrt(mlim_distance_squared(a, b));
}

/* a + t (b - a): exact where a and b have equal coordinates. */
static inline void mlim_interpolate(const double a[3], const double b[3], double t, double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] = a[k] + t * (b[k] - a[k]);
  }
}

#endif
