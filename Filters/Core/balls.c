#include "balls.h"
#include "label_sets.h"
#include "memory.h"
#include "radius_map.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* Centres of neighbours are this many radii apart: radii are two thirds of the distance, as in the
   paper. Between 1 (centres held) and 2 (balls apart). */
static const double CENTER_SPACING = 1.5;
/* Where the number of balls was rounded up they are closer together, and shrink by this more than
   their distance, so that none holds a centre: r / d = 0.87 at worst. */
static const double CROWDED_RADIUS = 1.3;
/* Between two junctions' balls that nearly meet one ball is enough: its two neighbours' distances
   would be this part of CENTER_SPACING. */
static const double SINGLE_BALL = 0.45;
/* How far a limit falls where a condition does not hold, per round. Nearer to 1: more rounds. */
static const double LOWER_BY = 0.8;
/* Radii of balls that touch are lowered to this part of what would just be disjoint. */
static const double APART_BY = 0.93;
/* A ball this many times larger than the one it touches is lowered alone. */
static const double MUCH_LARGER = 2;

enum
{
  MAX_ROUNDS = 60, /* of covering and lowering; 0.8^60 is below any ratio of lengths in use */
  MIN_LOOP_BALLS = 6,
  MIN_RETURN_BALLS = 3, /* of a curve from a junction back to itself */
  INTEGRAL_STEPS = 4    /* per sample, for the length in units of the radius */
};

void mlim_balls_free(mlim_balls* balls)
{
  mlim_release(balls->centers);
  mlim_release(balls->radii);
  mlim_release(balls->ball_curves);
  mlim_release(balls->ball_sets);
  mlim_release(balls->edges);
  mlim_release(balls->edge_curves);
  mlim_sets_free(&balls->sets);
  *balls = (mlim_balls){ 0 };
}

/* The cover in the making. */
typedef struct covering
{
  const mlim_curves* curves;
  const mlim_options* options;
  mlim_radius_map map;
  mlim_balls balls;
  double* arcs; /* per ball: length along its curve */
  size_t capacities[7];
  double* sums; /* integral along one curve */
  size_t sum_capacity;
  size_t fault_count;
  size_t lowered_count;
} covering;

static void covering_free(covering* work)
{
  mlim_radius_map_free(&work->map);
  mlim_balls_free(&work->balls);
  mlim_release(work->arcs);
  mlim_release(work->sums);
}

static mlim_status add_ball(
  covering* work, const double center[3], double radius, int32_t curve, int32_t set, double arc)
{
  mlim_balls* balls = &work->balls;
  const size_t count = balls->ball_count;
  if (count >= INT32_MAX ||
      mlim_reserve(&balls->centers, &work->capacities[0], count + 1, 3 * sizeof(double)) ||
      mlim_reserve(&balls->radii, &work->capacities[1], count + 1, sizeof(double)) ||
      mlim_reserve(&balls->ball_curves, &work->capacities[2], count + 1, sizeof(int32_t)) ||
      mlim_reserve(&balls->ball_sets, &work->capacities[3], count + 1, sizeof(int32_t)) ||
      mlim_reserve(&work->arcs, &work->capacities[4], count + 1, sizeof(double)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  mlim_copy(center, balls->centers + 3 * count);
  balls->radii[count] = radius;
  balls->ball_curves[count] = curve;
  balls->ball_sets[count] = set;
  work->arcs[count] = arc;
  ++balls->ball_count;
  return MLIM_OK;
}

static mlim_status add_edge(covering* work, int32_t a, int32_t b, int32_t curve)
{
  mlim_balls* balls = &work->balls;
  const size_t count = balls->edge_count;
  if (mlim_reserve(&balls->edges, &work->capacities[5], count + 1, 2 * sizeof(int32_t)) ||
      mlim_reserve(&balls->edge_curves, &work->capacities[6], count + 1, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  balls->edges[2 * count] = a;
  balls->edges[2 * count + 1] = b;
  balls->edge_curves[count] = curve;
  ++balls->edge_count;
  return MLIM_OK;
}

/* The part of a curve that its own balls cover, from the first one's centre to the last one's. */
typedef struct span
{
  double begin;
  double end;
  double length; /* in units of the spacing of centres */
} span;

/* The first ball's centre is half its radius outside the junction's ball: both margins, of overlap
   and of the centre held, are the same then, for every ratio of the radii. From the junction
   outwards the left side grows faster than the right one. */
static double first_arc(
  const covering* work, size_t curve, int from_end, double junction_radius, double length)
{
  double low = junction_radius;
  double high = length;
  for (int step = 0; step < 50; ++step)
  {
    const double arc = 0.5 * (low + high);
    const double radius = mlim_radius_map_radius(&work->map, curve, from_end ? length - arc : arc);
    if (arc < junction_radius + 0.5 * radius)
    {
      low = arc;
    }
    else
    {
      high = arc;
    }
  }
  return 0.5 * (low + high);
}

/* Integral of ds / (1.5 radius) over the span, by the midpoint rule, into work->sums. */
static mlim_status integrate(covering* work, size_t curve, span* part, size_t* step_count)
{
  const size_t samples = work->map.offsets[curve + 1] - work->map.offsets[curve];
  const size_t count = INTEGRAL_STEPS * samples;
  if (mlim_reserve(&work->sums, &work->sum_capacity, count + 1, sizeof(double)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  const double step = (part->end - part->begin) / (double)count;
  work->sums[0] = 0;
  for (size_t i = 0; i < count; ++i)
  {
    const double arc = part->begin + ((double)i + 0.5) * step;
    const double radius = mlim_radius_map_radius(&work->map, curve, arc);
    work->sums[i + 1] = work->sums[i] + step / (CENTER_SPACING * radius);
  }
  part->length = work->sums[count];
  *step_count = count;
  return MLIM_OK;
}

/* Places `count` + 1 balls at equal parts of the integral, the last one only if the span is open. */
static mlim_status place_balls(
  covering* work, size_t curve, const span* part, size_t steps, size_t count, int is_closed)
{
  const double share = part->length / (double)count;
  const double shrink = fmin(1, CROWDED_RADIUS * share);
  const double step = (part->end - part->begin) / (double)steps;
  mlim_status status = MLIM_OK;
  size_t at = 0;
  for (size_t i = 0; i < count + (is_closed ? 0 : 1) && !status; ++i)
  {
    const double target = share * (double)i;
    while (at + 1 < steps && work->sums[at + 1] <= target)
    {
      ++at;
    }
    const double rest = (target - work->sums[at]) / (work->sums[at + 1] - work->sums[at]);
    const double arc =
      i == count ? part->end : part->begin + ((double)at + fmin(fmax(rest, 0), 1)) * step;
    double center[3];
    mlim_radius_map_point(&work->map, curve, arc, center);
    const double radius = shrink * mlim_radius_map_radius(&work->map, curve, arc);
    status = add_ball(work, center, radius, (int32_t)curve, work->curves->curve_sets[curve], arc);
  }
  return status;
}

/* One ball in the middle of what two junctions' balls leave free, with equal margins. */
static mlim_status place_single(covering* work, size_t curve, const double radii[2], double length)
{
  const double gap = 0.5 * (length - radii[0] - radii[1]);
  const double arc = radii[0] + gap;
  double center[3];
  mlim_radius_map_point(&work->map, curve, arc, center);
  const double radius = fmax(fmin(2 * gap, 0.9 * fmin(arc, length - arc)), 0.1 * length);
  return add_ball(work, center, radius, (int32_t)curve, work->curves->curve_sets[curve], arc);
}

static mlim_status join_balls(covering* work, size_t curve, size_t first)
{
  const int32_t* ends = work->map.ends + 2 * curve;
  const int32_t last = (int32_t)work->balls.ball_count - 1;
  mlim_status status = MLIM_OK;
  if (ends[0] >= 0)
  {
    status = add_edge(work, ends[0], (int32_t)first, (int32_t)curve);
  }
  for (int32_t b = (int32_t)first; b < last && !status; ++b)
  {
    status = add_edge(work, b, b + 1, (int32_t)curve);
  }
  return status ? status
                : add_edge(work, last, ends[1] >= 0 ? ends[1] : (int32_t)first, (int32_t)curve);
}

static mlim_status cover_curve(covering* work, size_t curve)
{
  const mlim_radius_map* map = &work->map;
  const int32_t* ends = map->ends + 2 * curve;
  const size_t first = work->balls.ball_count;
  const double length = map->arcs[map->offsets[curve + 1] - 1];
  const int is_closed = ends[0] < 0;
  const int is_return = !is_closed && ends[0] == ends[1];
  double radii[2] = { 0, 0 };
  span part = { .begin = 0, .end = length };
  if (!is_closed)
  {
    radii[0] = map->junction_limits[ends[0]];
    radii[1] = map->junction_limits[ends[1]];
    part.begin = first_arc(work, curve, 0, radii[0], length);
    part.end = length - first_arc(work, curve, 1, radii[1], length);
  }
  mlim_status status = MLIM_OK;
  size_t steps = 0;
  if (part.end > part.begin)
  {
    status = integrate(work, curve, &part, &steps);
  }
  size_t count = (size_t)fmax(1, ceil(part.length));
  count = is_closed && count < MIN_LOOP_BALLS ? MIN_LOOP_BALLS : count;
  count = is_return && count + 1 < MIN_RETURN_BALLS ? MIN_RETURN_BALLS - 1 : count;
  if (!status && (part.end > part.begin) && (part.length >= SINGLE_BALL || is_closed || is_return))
  {
    status = place_balls(work, curve, &part, steps, count, is_closed);
  }
  else if (!status)
  {
    status = place_single(work, curve, radii, length);
  }
  return status ? status : join_balls(work, curve, first);
}

static mlim_status cover_all(covering* work)
{
  const mlim_curves* curves = work->curves;
  mlim_status status = MLIM_OK;
  work->balls.ball_count = 0;
  work->balls.edge_count = 0;
  for (size_t j = 0; j < curves->junction_count && !status; ++j)
  {
    status = add_ball(work, curves->points + 3 * (size_t)curves->junction_points[j],
      work->map.junction_limits[j], -1, curves->junction_sets[j], 0);
  }
  for (size_t c = 0; c < curves->curve_count && !status; ++c)
  {
    status = cover_curve(work, c);
  }
  return status;
}

/* Lowers the limit where a ball stands. */
static void lower(covering* work, mlim_radius_limit which, int32_t ball, double radius)
{
  const int32_t curve = work->balls.ball_curves[ball];
  const int has_changed =
    curve < 0 ? mlim_radius_map_lower_junction(&work->map, (size_t)ball, radius)
              : mlim_radius_map_lower(&work->map, which, (size_t)curve, work->arcs[ball], radius);
  work->lowered_count += has_changed ? 1 : 0;
}

/* Balls of two curves that end at one junction keep apart as a wedge. */
static mlim_radius_limit limit_between(const covering* work, int32_t a, int32_t b)
{
  const int32_t c = work->balls.ball_curves[a];
  const int32_t d = work->balls.ball_curves[b];
  if (c >= 0 && d >= 0 && c != d)
  {
    const int32_t* ends = work->map.ends + 2 * (size_t)c;
    const int32_t* other = work->map.ends + 2 * (size_t)d;
    for (int e = 0; e < 2; ++e)
    {
      if (ends[e] >= 0 && (ends[e] == other[0] || ends[e] == other[1]))
      {
        return MLIM_LIMIT_WEDGE;
      }
    }
  }
  return MLIM_LIMIT_NETWORK;
}

static void separate(covering* work, int32_t a, int32_t b, double distance)
{
  const double* radii = work->balls.radii;
  const mlim_radius_limit which = limit_between(work, a, b);
  const double factor = fmax(APART_BY * distance / (radii[a] + radii[b]), 0.5 * LOWER_BY);
  if (radii[a] <= MUCH_LARGER * radii[b])
  {
    lower(work, which, b, factor * radii[b]);
  }
  if (radii[b] <= MUCH_LARGER * radii[a])
  {
    lower(work, which, a, factor * radii[a]);
  }
}

static void lower_at_fault(void* user, mlim_ball_fault fault, int32_t a, int32_t b, double distance)
{
  covering* work = user;
  const double* radii = work->balls.radii;
  ++work->fault_count;
  switch (fault)
  {
    case MLIM_BALLS_TOUCH:
      separate(work, a, b, distance);
      break;
    case MLIM_BALL_HOLDS_CENTER:
      lower(work, MLIM_LIMIT_NETWORK, a, LOWER_BY * radii[a]);
      break;
    case MLIM_BALLS_APART:
    case MLIM_BALLS_LONG:
    case MLIM_BALLS_STRAY:
      lower(work, MLIM_LIMIT_NETWORK, a, LOWER_BY * radii[a]);
      lower(work, MLIM_LIMIT_NETWORK, b, LOWER_BY * radii[b]);
      break;
    case MLIM_BALLS_SHORT:
      break;
  }
}

/* Covers with the largest radii allowed, and lowers the limits where a condition does not hold,
   until all hold or no limit can fall. */
static mlim_status cover_until_good(covering* work, mlim_context* context)
{
  mlim_status status = MLIM_OK;
  for (int round = 0; round < MAX_ROUNDS; ++round)
  {
    work->fault_count = 0;
    work->lowered_count = 0;
    status = status ? status : cover_all(work);
    status =
      status ? status
             : mlim_balls_examine(work->curves, &work->balls, work->options, lower_at_fault, work);
    status =
      status ? status : mlim_progress(context, MLIM_STAGE_BALLS, (round + 1.0) / (MAX_ROUNDS + 1));
    if (status || work->lowered_count == 0)
    {
      break;
    }
    mlim_radius_map_grade(&work->map);
  }
  return status;
}

/* The balls' sets are those of the curves. */
static mlim_status copy_sets(const mlim_sets* sets, mlim_sets* out)
{
  int32_t* use = mlim_allocate(sets->count, sizeof(int32_t));
  mlim_status status = MLIM_OUT_OF_MEMORY;
  if (use)
  {
    memset(use, 1, sets->count * sizeof(int32_t));
    status = mlim_sets_compact(sets, use, out);
  }
  mlim_release(use);
  return status;
}

mlim_status mlim_balls_cover(
  const mlim_curves* curves, const mlim_options* options, mlim_context* context, mlim_balls* out)
{
  *out = (mlim_balls){ 0 };
  if (!curves || !options || !(options->edge_size > 0) || !(options->ball_radius_scale > 0) ||
      !(options->ball_radius_scale <= 1) || !(options->smallest_distance > 0))
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "balls need curves, and options with edge_size and smallest_distance above 0 and "
      "ball_radius_scale in (0, 1]");
  }
  covering work = { .curves = curves, .options = options };
  mlim_status status = mlim_progress(context, MLIM_STAGE_BALLS, 0);
  status = status ? status : mlim_radius_map_create(curves, options, &work.map);
  status = status ? status : cover_until_good(&work, context);
  status = status ? status : copy_sets(&curves->sets, &work.balls.sets);
  status = status ? status : mlim_progress(context, MLIM_STAGE_BALLS, 1);
  if (status == MLIM_OUT_OF_MEMORY)
  {
    mlim_fail_memory(context, "the protecting balls");
  }
  if (!status)
  {
    *out = work.balls;
    work.balls = (mlim_balls){ 0 };
  }
  covering_free(&work);
  return status;
}
