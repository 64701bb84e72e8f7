#include "balls.h"
#include "label_sets.h"
#include "memory.h"
#include "span.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* A marked ball's radius becomes this part of itself, or of what its neighbours leave free if that
   is less: a new ball needs a place for its centre outside both. */
static const double SPLIT_BY = 0.5;
/* New balls keep inside the union of the balls that were there, and so clear of all others. */
static const double INSIDE = 0.94;
/* Balls on two edges that leave one ball, in units of the distance of their centres. */
static const double WEDGE_SHARE = 0.45;
/* Cosine of the angle up to which two edges make a wedge: 70 degrees. Balls along blunter ones do not
   meet. */
static const double WEDGE_COSINE = 0.34;
/* Growth of radii per length, as in the cover. */
static const double GRADE = 0.25;
/* A centre may be moved onto the tie by this much of its ball's radius. */
static const double MAX_MOVE = 0.3;
/* Neighbours whose overlap is below this part of the smaller radius get balls between them; above
   the least overlap that the check accepts. */
static const double ENOUGH_OVERLAP = 0.12;
/* Margins after a move, a little above those of the check. */
static const double CENTER_MARGIN = 0.06;

/* Smallest radius of a split ball, of smallest_distance: as of the cover. */
static const double FLOOR_SHARE = 0.1;

enum
{
  INTEGRAL_STEPS = 32,
  RETREAT_ROUNDS = 8 /* a neighbour may have to give way to a ball that gives way */
};

typedef struct splitting
{
  const mlim_balls* old;
  const mlim_ball_split* split;
  double floor_radius;
  double* radii;  /* new radii of the old balls */
  double* slopes; /* 2 per edge: largest radius per distance from that end, by other edges there */
  int32_t* numbers; /* of the old balls among the new ones */
  mlim_span_cover cover;
  mlim_balls balls;
  size_t capacities[6];
} splitting;

static void splitting_free(splitting* work)
{
  mlim_release(work->radii);
  mlim_release(work->slopes);
  mlim_release(work->numbers);
  mlim_span_cover_free(&work->cover);
  mlim_balls_free(&work->balls);
}

static mlim_status add_ball(
  splitting* work, const double center[3], double radius, int32_t curve, int32_t set)
{
  mlim_balls* balls = &work->balls;
  const size_t count = balls->ball_count;
  if (count >= INT32_MAX ||
      mlim_reserve(&balls->centers, &work->capacities[0], count + 1, 3 * sizeof(double)) ||
      mlim_reserve(&balls->radii, &work->capacities[1], count + 1, sizeof(double)) ||
      mlim_reserve(&balls->ball_curves, &work->capacities[2], count + 1, sizeof(int32_t)) ||
      mlim_reserve(&balls->ball_sets, &work->capacities[3], count + 1, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  mlim_copy(center, balls->centers + 3 * count);
  balls->radii[count] = radius;
  balls->ball_curves[count] = curve;
  balls->ball_sets[count] = set;
  ++balls->ball_count;
  return MLIM_OK;
}

static mlim_status add_edge(splitting* work, int32_t a, int32_t b, int32_t curve)
{
  mlim_balls* balls = &work->balls;
  const size_t count = balls->edge_count;
  if (mlim_reserve(&balls->edges, &work->capacities[4], count + 1, 2 * sizeof(int32_t)) ||
      mlim_reserve(&balls->edge_curves, &work->capacities[5], count + 1, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  balls->edges[2 * count] = a;
  balls->edges[2 * count + 1] = b;
  balls->edge_curves[count] = curve;
  ++balls->edge_count;
  return MLIM_OK;
}

static double edge_length(const mlim_balls* balls, size_t edge)
{
  return mlim_distance(balls->centers + 3 * (size_t)balls->edges[2 * edge],
    balls->centers + 3 * (size_t)balls->edges[2 * edge + 1]);
}

static int is_covered(double a, double b, double distance)
{
  return a + b >= distance + ENOUGH_OVERLAP * fmin(a, b);
}

/* Halves the marked radii. Where two neighbours do not overlap any more but leave too little for a
   ball between them, the marked one gives way; without a marked one there is nothing to do. */
static void shrink(splitting* work)
{
  const mlim_balls* old = work->old;
  for (size_t b = 0; b < old->ball_count; ++b)
  {
    const double radius = old->radii[b];
    work->radii[b] = work->split->is_marked[b]
                       ? fmin(radius, fmax(SPLIT_BY * radius, work->floor_radius))
                       : radius;
  }
  int has_changed = 1;
  for (int round = 0; round < RETREAT_ROUNDS && has_changed; ++round)
  {
    has_changed = 0;
    for (size_t e = 0; e < old->edge_count; ++e)
    {
      const double d = edge_length(old, e);
      double* a = work->radii + old->edges[2 * e];
      double* b = work->radii + old->edges[2 * e + 1];
      double* give = *a < old->radii[old->edges[2 * e]] ? a : b;
      double* keep = give == a ? b : a;
      const int is_either = *b < old->radii[old->edges[2 * e + 1]] && give == a;
      if (is_either && *b > *a)
      {
        give = b;
        keep = a;
      }
      if (!is_covered(*a, *b, d) && *give > (d - *keep) * SPLIT_BY + 1e-12 * d &&
          d - *a - *b < SPLIT_BY * fmin(*a, *b))
      {
        *give = fmin(*give, SPLIT_BY * (d - *keep));
        has_changed = 1;
      }
    }
  }
}

/* Two edges that leave a ball at a small angle limit the radii along both. */
static void find_slopes_at(splitting* work, const size_t* starts, const int32_t* ends, size_t ball)
{
  const mlim_balls* old = work->old;
  for (size_t i = starts[ball]; i < starts[ball + 1]; ++i)
  {
    double direction[3];
    mlim_subtract(
      old->centers + 3 * (size_t)old->edges[ends[i] ^ 1], old->centers + 3 * ball, direction);
    const double length = sqrt(mlim_dot(direction, direction));
    for (size_t j = starts[ball]; j < starts[ball + 1]; ++j)
    {
      double other[3];
      mlim_subtract(
        old->centers + 3 * (size_t)old->edges[ends[j] ^ 1], old->centers + 3 * ball, other);
      const double cosine = mlim_dot(direction, other) / (length * sqrt(mlim_dot(other, other)));
      if (i != j && cosine > WEDGE_COSINE)
      {
        /* The chord of the angle on the unit circle. */
        const double slope = WEDGE_SHARE * sqrt(fmax(2 - 2 * cosine, 0));
        work->slopes[ends[i]] = fmin(work->slopes[ends[i]], fmin(slope, GRADE));
      }
    }
  }
}

static mlim_status find_slopes(splitting* work)
{
  const mlim_balls* old = work->old;
  size_t* starts = mlim_allocate_zeroed(old->ball_count + 2, sizeof(size_t));
  int32_t* ends = mlim_allocate(2 * old->edge_count, sizeof(int32_t));
  const int is_made = starts && ends;
  for (size_t i = 0; i < 2 * old->edge_count && is_made; ++i)
  {
    ++starts[old->edges[i] + 2];
    work->slopes[i] = HUGE_VAL;
  }
  for (size_t i = 2; i < old->ball_count + 2 && is_made; ++i)
  {
    starts[i] += starts[i - 1];
  }
  for (size_t i = 0; i < 2 * old->edge_count && is_made; ++i)
  {
    size_t* at = starts + old->edges[i] + 1;
    ends[*at] = (int32_t)i;
    ++*at;
  }
  for (size_t b = 0; b < old->ball_count && is_made; ++b)
  {
    find_slopes_at(work, starts, ends, b);
  }
  mlim_release(starts);
  mlim_release(ends);
  return is_made ? MLIM_OK : MLIM_OUT_OF_MEMORY;
}

/* An edge between two old balls. */
typedef struct split_edge
{
  double length;
  double old_radii[2];
  double radii[2];
  double slopes[2];
  double floor_radius;
} split_edge;

/* From one end's radius to the other's, inside the spheres through the two old balls' common circle
   (these lie in the union), and inside the wedges at both ends. A sphere of that pencil at a
   distance x from the circle's plane has the radius sqrt(w^2 + x^2), w being the circle's; a slope
   of GRADE instead keeps neighbours of like size. */
static double radius_on_edge(const void* user, double arc)
{
  const split_edge* edge = user;
  const double d = edge->length;
  const double t = arc / d;
  const double a_squared = edge->old_radii[0] * edge->old_radii[0];
  const double plane = 0.5 * (d + (a_squared - edge->old_radii[1] * edge->old_radii[1]) / d);
  const double circle = sqrt(fmax(a_squared - plane * plane, 0));
  double radius = (1 - t) * edge->radii[0] + t * edge->radii[1];
  radius = fmin(radius, INSIDE * circle + GRADE * fabs(arc - plane));
  radius = fmin(radius, fmin(edge->slopes[0] * arc, edge->slopes[1] * (d - arc)));
  return fmax(radius, edge->floor_radius);
}

/* Are the new balls [first, end of all) good neighbours, from the edge's one end to the other? */
static int are_neighbours_good(const splitting* work, size_t first, const int32_t ends[2])
{
  const mlim_balls* balls = &work->balls;
  int32_t previous = ends[0];
  for (size_t i = first; i <= balls->ball_count; ++i)
  {
    const int32_t b = i < balls->ball_count ? (int32_t)i : ends[1];
    const double d =
      mlim_distance(balls->centers + 3 * (size_t)previous, balls->centers + 3 * (size_t)b);
    const double small = fmin(balls->radii[previous], balls->radii[b]);
    const double large = fmax(balls->radii[previous], balls->radii[b]);
    if (!is_covered(small, large, d) || d < large + CENTER_MARGIN * small)
    {
      return 0;
    }
    previous = b;
  }
  return 1;
}

/* Moves the new centres of one edge onto the tie, all or none. */
static mlim_status project_centers(
  splitting* work, size_t first, const int32_t ends[2], int32_t set)
{
  mlim_balls* balls = &work->balls;
  const size_t count = balls->ball_count - first;
  size_t label_count;
  const int32_t* labels = mlim_set_labels(&work->old->sets, set, &label_count);
  double* chord = mlim_allocate(count, 3 * sizeof(double));
  if (!chord)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  memcpy(chord, balls->centers + 3 * first, 3 * count * sizeof(double));
  int is_near = 1;
  for (size_t i = 0; i < count; ++i)
  {
    double* center = balls->centers + 3 * (first + i);
    work->split->project(work->split->user, labels, label_count, center);
    is_near = is_near && mlim_distance(center, chord + 3 * i) <= MAX_MOVE * balls->radii[first + i];
  }
  if (!is_near || !are_neighbours_good(work, first, ends))
  {
    memcpy(balls->centers + 3 * first, chord, 3 * count * sizeof(double));
  }
  mlim_release(chord);
  return MLIM_OK;
}

/* Covers one old edge: as it is if its balls still overlap, else with new balls between them. */
static mlim_status split_one_edge(splitting* work, size_t e)
{
  const mlim_balls* old = work->old;
  const int32_t* old_ends = old->edges + 2 * e;
  const int32_t ends[2] = { work->numbers[old_ends[0]], work->numbers[old_ends[1]] };
  const int32_t curve = old->edge_curves[e];
  const int32_t set =
    old->ball_sets[old->ball_curves[old_ends[0]] >= 0 ? old_ends[0] : old_ends[1]];
  split_edge edge = { .length = edge_length(old, e), .floor_radius = 0.5 * work->floor_radius };
  for (int k = 0; k < 2; ++k)
  {
    edge.old_radii[k] = old->radii[old_ends[k]];
    edge.radii[k] = work->radii[old_ends[k]];
    edge.slopes[k] = work->slopes[2 * e + (size_t)k];
  }
  if (is_covered(edge.radii[0], edge.radii[1], edge.length))
  {
    return add_edge(work, ends[0], ends[1], curve);
  }
  const mlim_span span = { .length = edge.length,
    .end_radii = { edge.radii[0], edge.radii[1] },
    .min_count = 1,
    .step_count = INTEGRAL_STEPS,
    .radius = radius_on_edge,
    .user = &edge };
  const size_t first = work->balls.ball_count;
  mlim_status status = mlim_span_cover_make(&span, &work->cover);
  for (size_t i = 0; i < work->cover.count && !status; ++i)
  {
    double center[3];
    mlim_interpolate(old->centers + 3 * (size_t)old_ends[0], old->centers + 3 * (size_t)old_ends[1],
      work->cover.arcs[i] / edge.length, center);
    status = add_ball(work, center, work->cover.radii[i], curve, set);
  }
  if (!status && work->split->project)
  {
    status = project_centers(work, first, ends, set);
  }
  int32_t previous = ends[0];
  for (size_t b = first; b < work->balls.ball_count && !status; ++b)
  {
    status = add_edge(work, previous, (int32_t)b, curve);
    previous = (int32_t)b;
  }
  return status ? status : add_edge(work, previous, ends[1], curve);
}

/* Junctions keep their numbers; the old balls of curves come next, new ones behind them. */
static mlim_status split_all(splitting* work)
{
  const mlim_balls* old = work->old;
  mlim_status status = MLIM_OK;
  for (size_t b = 0; b < old->ball_count && !status; ++b)
  {
    work->numbers[b] = (int32_t)b;
    status =
      add_ball(work, old->centers + 3 * b, work->radii[b], old->ball_curves[b], old->ball_sets[b]);
  }
  for (size_t e = 0; e < old->edge_count && !status; ++e)
  {
    status = split_one_edge(work, e);
  }
  return status;
}

mlim_status mlim_balls_split(const mlim_balls* balls, const mlim_options* options,
  const mlim_ball_split* split, mlim_context* context, mlim_balls* out)
{
  *out = (mlim_balls){ 0 };
  if (!balls || !options || !split || !split->is_marked)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT, "splitting needs balls, options and marks");
  }
  splitting work = { .old = balls,
    .split = split,
    .floor_radius = FLOOR_SHARE * options->smallest_distance,
    .radii = mlim_allocate(balls->ball_count, sizeof(double)),
    .slopes = mlim_allocate(balls->edge_count, 2 * sizeof(double)),
    .numbers = mlim_allocate(balls->ball_count, sizeof(int32_t)) };
  mlim_status status = work.radii && work.slopes && work.numbers ? MLIM_OK : MLIM_OUT_OF_MEMORY;
  if (!status)
  {
    shrink(&work);
    status = find_slopes(&work);
  }
  status = status ? status : split_all(&work);
  status = status ? status : mlim_sets_copy(&balls->sets, &work.balls.sets);
  if (status)
  {
    mlim_fail_memory(context, "the split balls");
  }
  else
  {
    *out = work.balls;
    work.balls = (mlim_balls){ 0 };
  }
  splitting_free(&work);
  return status;
}
