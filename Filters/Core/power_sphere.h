/* The power sphere of a tetrahedron in floating point, with a bound that says on which side of it a
   point is for certain. Most questions of a triangulation are answered by it, without a determinant.

   Let c and R be any point and number, and S(x) = |x - c|^2 - R. The exact power sphere has
   S'(x) = |x - c'|^2 - R' with S'(p_k) = w_k at the four vertices. S - S' is affine in x, since the
   squares cancel. At vertex k it is e_k = |p_k - c|^2 - R - w_k, the residual there, so at x it is the
   sum of l_k(x) e_k with the barycentric coordinates l_k, and

     |S(x) - S'(x)| <= max |e_k| * sum |l_k(x)|.

   The l_k sum up to 1, and l_k(x) = l_k(p_0) + grad l_k . (x - p_0). The gradients of l_1, l_2, l_3 are
   the normals n_k = e_i x e_j of the edges from p_0, divided by the volume v = e_1 . n_1; that of l_0 is
   minus their sum. Hence

     sum |l_k(x)| <= 1 + G |x - p_0|,   G = 2 sum |n_k|_1 / v,   |x - p_0| <= |x - c|_1 + |p_0 - c|.

   Rounding, with u = 2^-53: a squared distance is right to 5 u of itself and S, in which three terms are
   added, to 8 u (|x - c|^2 + |R| + w); ROUNDING is four times that. The components of n_k are right to
   6 u |e_i| |e_j|, and v to 24 u |e_1| |e_2| |e_3|, which is below 1e-4 of it where the cell is not
   called flat; the same holds for the length of n_k then, which is at least v / |e_k|. 2.1 for 2 in G and
   SLACK cover this and the rounding of the bound itself, TINY and FLT_MIN the loss of digits near zero.

   Nothing is assumed of c and R: the residuals, measured, tell how good they are. Not a number and
   infinite values compare as undecided. */
#ifndef mlim_power_sphere_h
#define mlim_power_sphere_h

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

typedef struct mlim_power_sphere
{
  double center[3];
  double level; /* R: squared radius, that is, power of the vertices */
} mlim_power_sphere;

/* The bound is 2^base + 2^slope |x - c|_1, apart from the rounding of S itself. As powers of two, with the
   exponents as a float has them, it takes 2 bytes, and may be twice as large as it has to be: next to
   the distances that it is compared with, both are nearly nothing. 255 is infinite. */
typedef struct mlim_power_bound
{
  unsigned char base, slope;
} mlim_power_bound;

/* Below this squared ratio of volume to edge lengths the plain formulas lose more than five of their
   sixteen digits. Below the least product of squared lengths they lose them to underflow. */
#define MLIM_SPHERE_FLAT 1e-22
#define MLIM_SPHERE_LEAST 1e-280

#define MLIM_SPHERE_ROUNDING 4e-15
#define MLIM_SPHERE_SLACK 1.001
#define MLIM_SPHERE_TINY 1e-300

/* The next power of two, as an exponent; for values above 0. */
static inline unsigned char mlim_power_bound_round(double value)
{
  const float narrow = (float)value;
  uint32_t bits;
  memcpy(&bits, &narrow, sizeof bits);
  const uint32_t exponent = (bits >> 23) + 1;
  return (unsigned char)(exponent < 255 ? exponent : 255);
}

static inline double mlim_power_bound_value(unsigned char exponent)
{
  const uint32_t bits = (uint32_t)exponent << 23;
  float value;
  memcpy(&value, &bits, sizeof value);
  return (double)value;
}

/* A sphere that decides nothing. */
static inline void mlim_power_sphere_clear(mlim_power_sphere* sphere, mlim_power_bound* bound)
{
  sphere->level = 0;
  *bound = (mlim_power_bound){ .base = 255, .slope = 255 };
}

static inline double mlim_power_sphere_squared(const double a[3], const double b[3])
{
  const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
  return d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
}

/* Sets level and bound for a centre. `gradient`: the sum of |n_k|_1 / v. */
static inline void mlim_power_sphere_bound(const double points[4][3], const double weights[4],
  double gradient, mlim_power_sphere* sphere, mlim_power_bound* bound)
{
  const double first = mlim_power_sphere_squared(points[0], sphere->center);
  double worst = 0;
  double most = first + fabs(weights[0]);
  sphere->level = first - weights[0];
  for (int k = 1; k < 4; ++k)
  {
    const double squared = mlim_power_sphere_squared(points[k], sphere->center);
    const double residual = fabs(squared - weights[k] - sphere->level);
    worst = residual > worst ? residual : worst;
    most = squared + fabs(weights[k]) > most ? squared + fabs(weights[k]) : most;
  }
  const double residual = worst + MLIM_SPHERE_ROUNDING * most;
  const double growth = 2.1 * gradient;
  bound->base = mlim_power_bound_round(MLIM_SPHERE_SLACK * residual * (1 + growth * sqrt(first)));
  bound->slope = mlim_power_bound_round(MLIM_SPHERE_SLACK * residual * growth);
}

/* Weighted circumcentre and bound of a positively oriented tetrahedron. Returns 0, and clears the
   sphere, when it is too flat for that. */
static inline int mlim_power_sphere_make(const double points[4][3], const double weights[4],
  mlim_power_sphere* out, mlim_power_bound* bound)
{
  double edge[3][3];
  double right[3];
  double product = 1;
  for (int k = 0; k < 3; ++k)
  {
    for (int j = 0; j < 3; ++j)
    {
      edge[k][j] = points[k + 1][j] - points[0][j];
    }
    const double squared = mlim_power_sphere_squared(points[k + 1], points[0]);
    right[k] = squared - weights[k + 1] + weights[0];
    product *= squared;
  }
  double normal[3][3];
  double sum = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double* a = edge[(k + 1) % 3];
    const double* b = edge[(k + 2) % 3];
    normal[k][0] = a[1] * b[2] - a[2] * b[1];
    normal[k][1] = a[2] * b[0] - a[0] * b[2];
    normal[k][2] = a[0] * b[1] - a[1] * b[0];
    sum += fabs(normal[k][0]) + fabs(normal[k][1]) + fabs(normal[k][2]);
  }
  const double volume =
    edge[0][0] * normal[0][0] + edge[0][1] * normal[0][1] + edge[0][2] * normal[0][2];
  if (!(volume > 0) || volume * volume < MLIM_SPHERE_FLAT * product || product < MLIM_SPHERE_LEAST)
  {
    mlim_power_sphere_clear(out, bound);
    return 0;
  }
  for (int j = 0; j < 3; ++j)
  {
    out->center[j] =
      points[0][j] +
      0.5 * (right[0] * normal[0][j] + right[1] * normal[1][j] + right[2] * normal[2][j]) / volume;
  }
  mlim_power_sphere_bound(points, weights, sum / volume, out, bound);
  return 1;
}

/* -1: the weighted point is in conflict with the cell, that is, nearer in power than its vertices are to
   the centre; 1: it is not; 0: undecided. */
static inline int mlim_power_sphere_side(const mlim_power_sphere* sphere,
  const mlim_power_bound* bound, const double point[3], double weight)
{
  const double d[3] = { point[0] - sphere->center[0], point[1] - sphere->center[1],
    point[2] - sphere->center[2] };
  const double squared = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const double value = squared - sphere->level - weight;
  const double most =
    mlim_power_bound_value(bound->base) +
    mlim_power_bound_value(bound->slope) * (fabs(d[0]) + fabs(d[1]) + fabs(d[2])) +
    MLIM_SPHERE_ROUNDING * (squared + fabs(sphere->level) + weight) + MLIM_SPHERE_TINY;
  return value > most ? 1 : value < -most ? -1 : 0;
}

#endif
