#include "nearest.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>

/* No more bins than this a triangle: a large box with a small mesh must not cost memory. */
static const double BINS_A_TRIANGLE = 4;

/* Nor more along an axis: their numbers have 16 bits while they are filled. */
static const double MAX_BINS = 65535;

/* Above what rounding may take from a distance. */
static const double CERTAINLY = 1 + 1e-9;

enum
{
  AHEAD = 32, /* points */
  FIRST = 4   /* triangles of a bin: nearly always one of them is near enough */
};

static int32_t bin_of(const mlim_nearest* nearest, double value, int axis)
{
  const double b = value / nearest->bin;
  return b < 0 ? 0 : b >= nearest->bins[axis] ? nearest->bins[axis] - 1 : (int32_t)b;
}

static const double* point_of(const mlim_nearest* nearest, int32_t vertex)
{
  return nearest->mesh.points + nearest->mesh.stride * (size_t)vertex;
}

/* ---- sorting ---- */

enum
{
  SLABS = 4,      /* of bins, sorted for themselves: each looks at the layers of all triangles */
  SORT_AHEAD = 16 /* triangles */
};

/* Low and high bins that a triangle may touch. */
typedef struct bin_range
{
  uint16_t low, high;
} bin_range;

typedef struct bin_rows
{
  bin_range x, y;
} bin_rows;

typedef struct sorting
{
  mlim_nearest* nearest;
  bin_range* layers; /* of each triangle, along z */
  bin_rows* ranges;
  int is_placing;
} sorting;

static bin_range range_of(const mlim_nearest* nearest, size_t t, int axis)
{
  const int32_t* v = nearest->mesh.vertices + 3 * t;
  const double a = point_of(nearest, v[0])[axis];
  const double b = point_of(nearest, v[1])[axis];
  const double c = point_of(nearest, v[2])[axis];
  return (bin_range){ .low = (uint16_t)bin_of(nearest, mlim_min(a, mlim_min(b, c)), axis),
    .high = (uint16_t)bin_of(nearest, mlim_max(a, mlim_max(b, c)), axis) };
}

static void ask_for_points(const mlim_nearest* nearest, size_t t)
{
  const int32_t* v = nearest->mesh.vertices + 3 * t;
  mlim_prefetch(point_of(nearest, v[0]));
  mlim_prefetch(point_of(nearest, v[1]));
  mlim_prefetch(point_of(nearest, v[2]));
}

static void range_body(void* data, size_t begin, size_t end)
{
  const sorting* s = (const sorting*)data;
  for (size_t t = begin; t < end; ++t)
  {
    if (t + SORT_AHEAD < end)
    {
      ask_for_points(s->nearest, t + SORT_AHEAD);
    }
    s->ranges[t].x = range_of(s->nearest, t, 0);
    s->ranges[t].y = range_of(s->nearest, t, 1);
    s->layers[t] = range_of(s->nearest, t, 2);
  }
}

/* Counts or places a triangle in the bins of some layers; offsets are two ahead while counting. */
static void sort_triangle(const sorting* s, size_t t, int32_t low, int32_t high)
{
  const mlim_nearest* nearest = s->nearest;
  const bin_rows* r = &s->ranges[t];
  for (int32_t z = low; z <= high; ++z)
  {
    for (int32_t y = r->y.low; y <= r->y.high; ++y)
    {
      const size_t row =
        (size_t)nearest->bins[0] * ((size_t)y + (size_t)nearest->bins[1] * (size_t)z);
      for (int32_t x = r->x.low; x <= r->x.high; ++x)
      {
        const size_t b = row + (size_t)x;
        if (s->is_placing)
        {
          nearest->triangles[nearest->offsets[b + 1]++] = (int32_t)t;
        }
        else
        {
          ++nearest->offsets[b + 2];
        }
      }
    }
  }
}

/* Bins of one layer come before those of the next: slabs of layers do not meet. */
static void slab_body(void* data, size_t begin, size_t end)
{
  const sorting* s = (const sorting*)data;
  const size_t layers = (size_t)s->nearest->bins[2];
  const int32_t first = (int32_t)(layers * begin / SLABS);
  const int32_t last = (int32_t)(layers * end / SLABS) - 1;
  for (size_t t = 0; t < s->nearest->mesh.count; ++t)
  {
    const bin_range z = s->layers[t];
    if (z.low <= last && z.high >= first)
    {
      sort_triangle(s, t, z.low > first ? z.low : first, z.high < last ? z.high : last);
    }
  }
}

/* Each bin lists its triangles in ascending order. Not 0: out of memory. */
static int sort_triangles(mlim_nearest* nearest, size_t bin_count, mlim_context* context)
{
  const size_t count = nearest->mesh.count;
  sorting s = { .nearest = nearest,
    .layers = mlim_allocate(count, sizeof *s.layers),
    .ranges = mlim_allocate(count, sizeof *s.ranges) };
  if (s.layers != NULL && s.ranges != NULL)
  {
    mlim_parallel_for(context, count, range_body, &s);
    mlim_parallel_for(context, SLABS, slab_body, &s);
    size_t uses = 0;
    for (size_t b = 0; b < bin_count; ++b)
    {
      uses += nearest->offsets[b + 2];
      nearest->offsets[b + 2] = (uint32_t)uses;
    }
    nearest->triangles =
      uses <= UINT32_MAX ? mlim_allocate(uses, sizeof *nearest->triangles) : NULL;
  }
  if (nearest->triangles != NULL)
  {
    s.is_placing = 1;
    mlim_parallel_for(context, SLABS, slab_body, &s);
  }
  mlim_release(s.layers);
  mlim_release(s.ranges);
  return nearest->triangles == NULL;
}

mlim_status mlim_nearest_create(const mlim_triangles* triangles, const double size[3], double side,
  mlim_context* context, mlim_nearest* out)
{
  *out = (mlim_nearest){ .mesh = *triangles, .bin = side };
  const double most = BINS_A_TRIANGLE * (double)triangles->count + 1000;
  const double wanted = (size[0] / side + 1) * (size[1] / side + 1) * (size[2] / side + 1);
  if (wanted > most)
  {
    out->bin = side * cbrt(wanted / most);
  }
  size_t count = 1;
  const double longest = mlim_max(size[0], mlim_max(size[1], size[2]));
  out->bin = mlim_max(out->bin, longest / (MAX_BINS - 1));
  for (int k = 0; k < 3; ++k)
  {
    out->bins[k] = (int32_t)(size[k] / out->bin) + 1;
    count *= (size_t)out->bins[k];
  }
  out->offsets = mlim_allocate_zeroed(count + 2, sizeof *out->offsets);
  if (out->offsets == NULL || sort_triangles(out, count, context))
  {
    mlim_nearest_free(out);
    return mlim_fail_memory(context, "the search for nearest triangles");
  }
  return MLIM_OK;
}

void mlim_nearest_free(mlim_nearest* nearest)
{
  mlim_release(nearest->offsets);
  mlim_release(nearest->triangles);
  *nearest = (mlim_nearest){ 0 };
}

/* ---- distances ---- */

static double segment_distance_squared(const double p[3], const double a[3], const double b[3])
{
  double along[3];
  double to[3];
  mlim_subtract(b, a, along);
  mlim_subtract(p, a, to);
  const double length = mlim_dot(along, along);
  const double t = length > 0 ? mlim_min(mlim_max(mlim_dot(to, along) / length, 0), 1) : 0;
  double q[3];
  mlim_interpolate(a, b, t, q);
  return mlim_distance_squared(p, q);
}

/* Whether a triangle lies all beyond the line through one of its edges, and that is no nearer than `best`:
   the line is `outside` / (|edge| |n|) from the foot of the point, which is `height` / |n| above the plane. */
static int is_cut_off(double outside, double height, double best_nn, const double edge[3])
{
  const double length = mlim_dot(edge, edge);
  return outside < 0 && outside * outside >= (best_nn * CERTAINLY - height * height) * length;
}

/* Inside the prism over the triangle the plane is nearest, else an edge. At most `best`; a triangle
   whose plane is farther is not looked at closely, nor one whose edges' lines are. */
static double triangle_distance_squared(
  const double p[3], const double a[3], const double b[3], const double c[3], double best)
{
  double u[3];
  double v[3];
  double w[3];
  double n[3];
  mlim_subtract(b, a, u);
  mlim_subtract(c, a, v);
  mlim_subtract(p, a, w);
  mlim_cross(u, v, n);
  const double nn = mlim_dot(n, n);
  const double height = mlim_dot(w, n);
  if (height * height >= best * nn && nn > 0)
  {
    return best;
  }
  if (nn > 0)
  {
    double wv[3];
    double uw[3];
    mlim_cross(w, v, wv);
    mlim_cross(u, w, uw);
    const double s = mlim_dot(wv, n);
    const double t = mlim_dot(uw, n);
    if (s >= 0 && t >= 0 && s + t <= nn)
    {
      return height * height / nn;
    }
    double opposite[3];
    mlim_subtract(c, b, opposite);
    if (is_cut_off(s, height, best * nn, v) || is_cut_off(t, height, best * nn, u) ||
        is_cut_off(nn - s - t, height, best * nn, opposite))
    {
      return best;
    }
  }
  return mlim_min(mlim_min(best, segment_distance_squared(p, a, b)),
    mlim_min(segment_distance_squared(p, b, c), segment_distance_squared(p, c, a)));
}

static size_t bin_at(const mlim_nearest* nearest, int32_t x, int32_t y, int32_t z)
{
  return (size_t)x + (size_t)nearest->bins[0] * ((size_t)y + (size_t)nearest->bins[1] * (size_t)z);
}

/* Each thing leads to the next, which has to wait for it: all points get as far before any goes on. */
void mlim_nearest_ahead(const mlim_nearest* nearest, const mlim_nearest_points* from)
{
  const uint32_t* offsets[AHEAD];
  for (size_t begin = 0; begin < from->count; begin += AHEAD)
  {
    const size_t count = from->count - begin < AHEAD ? from->count - begin : AHEAD;
    for (size_t k = 0; k < count; ++k)
    {
      const double* p = from->points + from->stride * (begin + k);
      offsets[k] = nearest->offsets + bin_at(nearest, bin_of(nearest, p[0], 0),
                                        bin_of(nearest, p[1], 1), bin_of(nearest, p[2], 2));
      mlim_prefetch(offsets[k]);
    }
    for (size_t k = 0; k < count; ++k)
    {
      mlim_prefetch(nearest->triangles + *offsets[k]);
    }
    for (size_t k = 0; k < count; ++k)
    {
      for (uint32_t t = *offsets[k]; t < offsets[k][1] && t < *offsets[k] + FIRST; ++t)
      {
        mlim_prefetch(nearest->mesh.vertices + 3 * (size_t)nearest->triangles[t]);
      }
    }
    for (size_t k = 0; k < count; ++k)
    {
      for (uint32_t t = *offsets[k]; t < offsets[k][1] && t < *offsets[k] + FIRST; ++t)
      {
        ask_for_points(nearest, (size_t)nearest->triangles[t]);
      }
    }
  }
}

/* The triangle that is nearest so far. */
typedef struct search
{
  const mlim_nearest* nearest;
  const double* point;
  double best; /* squared */
  double enough;
  int32_t triangle; /* -1: none */
} search;

static void look_at_triangle(search* s, int32_t triangle)
{
  const int32_t* t = s->nearest->mesh.vertices + 3 * (size_t)triangle;
  const double d = triangle_distance_squared(s->point, point_of(s->nearest, t[0]),
    point_of(s->nearest, t[1]), point_of(s->nearest, t[2]), s->best);
  s->triangle = d < s->best ? triangle : s->triangle;
  s->best = mlim_min(d, s->best);
}

/* Whether that is enough. */
static int look_at_bin(search* s, int32_t x, int32_t y, int32_t z)
{
  const mlim_nearest* nearest = s->nearest;
  const size_t bin = bin_at(nearest, x, y, z);
  for (size_t k = nearest->offsets[bin]; k < nearest->offsets[bin + 1]; ++k)
  {
    look_at_triangle(s, nearest->triangles[k]);
    if (s->best <= s->enough)
    {
      return 1;
    }
  }
  return 0;
}

/* Whether that is enough. Points near to each other have a triangle near in common. */
static int start_at_hint(search* s, const int32_t* hint)
{
  if (*hint >= 0)
  {
    look_at_triangle(s, *hint);
  }
  return s->best <= s->enough;
}

/* How far a bin is from the point along one axis, at least: what is outside the box is in its outermost
   bins. */
static double gap(const search* s, int32_t bin, int32_t own, int axis)
{
  const double side = s->nearest->bin;
  return bin == own  ? 0
         : bin > own ? bin * side - s->point[axis]
                     : s->point[axis] - (bin + 1) * side;
}

static int is_beyond(const search* s, double gap_squared)
{
  return gap_squared >= s->best * CERTAINLY;
}

/* Shells of bins: beyond shell s everything is at least s bins away. */
static void search_shells(search* s)
{
  const int32_t* bins = s->nearest->bins;
  int32_t at[3];
  int32_t widest = 0;
  for (int k = 0; k < 3; ++k)
  {
    at[k] = bin_of(s->nearest, s->point[k], k);
    widest = bins[k] > widest ? bins[k] : widest;
  }
  for (int32_t d = 0; d <= widest; ++d)
  {
    const double reach = (d - 1) * s->nearest->bin;
    if (d > 0 && reach > 0 && reach * reach >= s->best)
    {
      break;
    }
    for (int32_t z = at[2] - d; z <= at[2] + d; ++z)
    {
      const double gap_z = gap(s, z, at[2], 2);
      for (int32_t y = at[1] - d; y <= at[1] + d && !is_beyond(s, gap_z * gap_z); ++y)
      {
        const int is_side = z == at[2] - d || z == at[2] + d || y == at[1] - d || y == at[1] + d;
        const double gap_y = gap(s, y, at[1], 1);
        const double gap_yz = gap_y * gap_y + gap_z * gap_z;
        for (int32_t x = at[0] - d; x <= at[0] + d; x += is_side || d == 0 ? 1 : 2 * d)
        {
          const double gap_x = gap(s, x, at[0], 0);
          if (x >= 0 && y >= 0 && z >= 0 && x < bins[0] && y < bins[1] && z < bins[2] &&
              !is_beyond(s, gap_x * gap_x + gap_yz) && look_at_bin(s, x, y, z))
          {
            return;
          }
        }
      }
    }
  }
}

double mlim_nearest_distance(
  const mlim_nearest* nearest, const double point[3], double enough, double limit, int32_t* hint)
{
  search s = { .nearest = nearest,
    .point = point,
    .best = limit * limit,
    .enough = enough * enough,
    .triangle = -1 };
  if (!start_at_hint(&s, hint))
  {
    search_shells(&s);
  }
  *hint = s.triangle >= 0 ? s.triangle : *hint;
  return sqrt(s.best);
}

int mlim_nearest_is_within(
  const mlim_nearest* nearest, const double point[3], double bound, int32_t* hint)
{
  /* A triangle just beyond the bound is measured, not cut off at it. */
  search s = { .nearest = nearest,
    .point = point,
    .best = bound * bound * (1 + 1e-9),
    .enough = bound * bound,
    .triangle = -1 };
  if (start_at_hint(&s, hint))
  {
    return 1;
  }
  int32_t own[3];
  int32_t low[3];
  int32_t high[3];
  for (int k = 0; k < 3; ++k)
  {
    own[k] = bin_of(nearest, point[k], k);
    low[k] = bin_of(nearest, point[k] - bound, k);
    high[k] = bin_of(nearest, point[k] + bound, k);
  }
  int is_found = look_at_bin(&s, own[0], own[1], own[2]);
  for (int32_t z = low[2]; z <= high[2] && !is_found; ++z)
  {
    for (int32_t y = low[1]; y <= high[1] && !is_found; ++y)
    {
      for (int32_t x = low[0]; x <= high[0] && !is_found; ++x)
      {
        const int is_own = x == own[0] && y == own[1] && z == own[2];
        is_found = !is_own && look_at_bin(&s, x, y, z);
      }
    }
  }
  *hint = is_found ? s.triangle : *hint;
  return is_found;
}
