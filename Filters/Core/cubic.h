/* Cubics in Bernstein form on [0, 1]: what a trilinear function is along a segment. */
#ifndef mlim_cubic_h
#define mlim_cubic_h

/* A cubic whose values at 0 and 1 are c[0] and c[3]. No coefficient of the other sign: no root. */
typedef struct mlim_cubic
{
  double c[4];
} mlim_cubic;

static inline double mlim_cubic_at(const mlim_cubic* f, double t)
{
  const double s = 1 - t;
  return s * s * (s * f->c[0] + 3 * t * f->c[1]) + t * t * (3 * s * f->c[2] + t * f->c[3]);
}

/* Restricts f to its first half and its second half (de Casteljau). */
static inline void mlim_cubic_halve(const mlim_cubic* f, mlim_cubic* first, mlim_cubic* second)
{
  const double a = 0.5 * (f->c[0] + f->c[1]);
  const double b = 0.5 * (f->c[1] + f->c[2]);
  const double d = 0.5 * (f->c[2] + f->c[3]);
  const double ab = 0.5 * (a + b);
  const double bd = 0.5 * (b + d);
  const double middle = 0.5 * (ab + bd);
  const double start = f->c[0];
  const double end = f->c[3];
  *first = (mlim_cubic){ { start, a, ab, middle } };
  *second = (mlim_cubic){ { middle, bd, d, end } };
}

/* Number of sign changes among the coefficients, 0 counting as positive: at least the number of
   times the sign of f changes. */
static inline int mlim_cubic_sign_changes(const mlim_cubic* f)
{
  int changes = 0;
  for (int k = 0; k < 3; ++k)
  {
    changes += (f->c[k] >= 0) != (f->c[k + 1] >= 0);
  }
  return changes;
}

/* The root of a cubic with exactly one sign change: safeguarded Newton, to `precision` in t. */
static inline double mlim_cubic_root(const mlim_cubic* f, double precision)
{
  enum
  {
    MAX_STEPS = 60 /* bisection alone would reach the last bit */
  };
  const int is_positive = f->c[0] >= 0;
  double low = 0;
  double high = 1;
  double t = f->c[0] / (f->c[0] - f->c[3]);
  for (int step = 0; step < MAX_STEPS; ++step)
  {
    if ((mlim_cubic_at(f, t) >= 0) == is_positive)
    {
      low = t;
    }
    else
    {
      high = t;
    }
    const double s = 1 - t;
    const double slope = 3 * (s * s * (f->c[1] - f->c[0]) + 2 * s * t * (f->c[2] - f->c[1]) +
                               t * t * (f->c[3] - f->c[2]));
    double next = t - mlim_cubic_at(f, t) / slope;
    if (!(next > low && next < high))
    {
      /* At the root Newton stands still, or steps back by a rounding. Not so at another end of [0, 1] that is a
         root as well. */
      const double off = next > t ? next - t : t - next;
      const int is_there = off <= precision && (is_positive ? slope < 0 : slope > 0);
      next = is_there ? t : 0.5 * (low + high);
    }
    const double moved = next > t ? next - t : t - next;
    t = next;
    if (moved <= precision || high - low <= precision)
    {
      break;
    }
  }
  return t;
}

#endif
