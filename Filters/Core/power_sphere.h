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

/* A point or vector, apart from the weight: by value, so that a compiler can work on several cells at once. */
typedef struct mlim_power_point
{
  double x, y, z;
  double weight;
} mlim_power_point;

/* A sphere and its bound as they come out, before they are rounded. */
typedef struct mlim_power_parts
{
  double x, y, z; /* centre */
  double level;
  double base, slope;
  int is_flat; /* too flat for these formulas: the rest means nothing */
} mlim_power_parts;

static inline mlim_power_point mlim_power_edge(mlim_power_point from, mlim_power_point to)
{
  return (mlim_power_point){ .x = to.x - from.x, .y = to.y - from.y, .z = to.z - from.z };
}

static inline double mlim_power_dot(mlim_power_point a, mlim_power_point b)
{
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline mlim_power_point mlim_power_cross(mlim_power_point a, mlim_power_point b)
{
  return (mlim_power_point){
    .x = a.y * b.z - a.z * b.y, .y = a.z * b.x - a.x * b.z, .z = a.x * b.y - a.y * b.x
  };
}

static inline double mlim_power_sum(mlim_power_point a)
{
  return fabs(a.x) + fabs(a.y) + fabs(a.z);
}

static inline double mlim_power_larger(double a, double b)
{
  return a > b ? a : b;
}

/* What one more vertex adds to the worst residual and to the largest term. */
static inline void mlim_power_residual(
  mlim_power_point vertex, mlim_power_point center, double level, double* worst, double* most)
{
  const mlim_power_point d = mlim_power_edge(center, vertex);
  const double squared = mlim_power_dot(d, d);
  *worst = mlim_power_larger(fabs(squared - vertex.weight - level), *worst);
  *most = mlim_power_larger(squared + fabs(vertex.weight), *most);
}

/* Sets level and bound for a centre. `gradient`: the sum of |n_k|_1 / v. */
static inline void mlim_power_sphere_bound(mlim_power_point a, mlim_power_point b,
  mlim_power_point c, mlim_power_point d, double gradient, mlim_power_parts* out)
{
  const mlim_power_point center = { .x = out->x, .y = out->y, .z = out->z };
  const mlim_power_point radius = mlim_power_edge(center, a);
  const double first = mlim_power_dot(radius, radius);
  double worst = 0;
  double most = first + fabs(a.weight);
  out->level = first - a.weight;
  mlim_power_residual(b, center, out->level, &worst, &most);
  mlim_power_residual(c, center, out->level, &worst, &most);
  mlim_power_residual(d, center, out->level, &worst, &most);
  const double residual = worst + MLIM_SPHERE_ROUNDING * most;
  const double growth = 2.1 * gradient;
  out->base = MLIM_SPHERE_SLACK * residual * (1 + growth * sqrt(first));
  out->slope = MLIM_SPHERE_SLACK * residual * growth;
}

/* Weighted circumcentre and bound of a positively oriented tetrahedron. Without a branch. */
static inline mlim_power_parts mlim_power_sphere_parts(
  mlim_power_point a, mlim_power_point b, mlim_power_point c, mlim_power_point d)
{
  const mlim_power_point e = mlim_power_edge(a, b);
  const mlim_power_point f = mlim_power_edge(a, c);
  const mlim_power_point g = mlim_power_edge(a, d);
  const double ee = mlim_power_dot(e, e);
  const double ff = mlim_power_dot(f, f);
  const double gg = mlim_power_dot(g, g);
  const double r = ee - b.weight + a.weight;
  const double s = ff - c.weight + a.weight;
  const double t = gg - d.weight + a.weight;
  const mlim_power_point l = mlim_power_cross(f, g);
  const mlim_power_point m = mlim_power_cross(g, e);
  const mlim_power_point n = mlim_power_cross(e, f);
  const double product = ee * ff * gg;
  const double volume = mlim_power_dot(e, l);
  mlim_power_parts out;
  out.is_flat =
    !(volume > 0) | (volume * volume < MLIM_SPHERE_FLAT * product) | (product < MLIM_SPHERE_LEAST);
  out.x = a.x + 0.5 * (r * l.x + s * m.x + t * n.x) / volume;
  out.y = a.y + 0.5 * (r * l.y + s * m.y + t * n.y) / volume;
  out.z = a.z + 0.5 * (r * l.z + s * m.z + t * n.z) / volume;
  const double sum = mlim_power_sum(l) + mlim_power_sum(m) + mlim_power_sum(n);
  mlim_power_sphere_bound(a, b, c, d, sum / volume, &out);
  return out;
}

/* Returns 0, and clears the sphere, when the tetrahedron is too flat. */
static inline int mlim_power_sphere_take(
  const mlim_power_parts* parts, mlim_power_sphere* out, mlim_power_bound* bound)
{
  if (parts->is_flat)
  {
    mlim_power_sphere_clear(out, bound);
    return 0;
  }
  *out = (mlim_power_sphere){ .center = { parts->x, parts->y, parts->z }, .level = parts->level };
  bound->base = mlim_power_bound_round(parts->base);
  bound->slope = mlim_power_bound_round(parts->slope);
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
