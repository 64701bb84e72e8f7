#include "balls.h"

#include "ball_list.h"
#include "label_sets.h"
#include "memory.h"
#include "radius_map.h"
#include "span.h"
#include "vector.h"

#include <math.h>

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

/* The balls of one round: the junctions', then those of each curve. */
typedef struct round_balls
{
  mlim_ball_list list;
  double* arcs; /* per ball: length along its curve */
  size_t arc_capacity;
  size_t* starts; /* per curve: its first ball; one more at the end */
} round_balls;

/* The cover in the making. */
typedef struct covering
{
  const mlim_curves* curves;
  const mlim_options* options;
  mlim_radius_map map;
  round_balls now;
  round_balls before;      /* of the round before; empty in the first one */
  unsigned char* is_known; /* per ball: it was there in the round before */
  size_t known_capacity;
  mlim_span_cover cover; /* of one curve */
  size_t lowered_count;
} covering;

static void round_free(round_balls* round)
{
  mlim_ball_list_free(&round->list);
  mlim_release(round->arcs);
  mlim_release(round->starts);
}

static void covering_free(covering* work)
{
  mlim_radius_map_free(&work->map);
  round_free(&work->now);
  round_free(&work->before);
  mlim_release(work->is_known);
  mlim_span_cover_free(&work->cover);
}

static mlim_status covering_reserve(covering* work)
{
  const size_t count = work->curves->curve_count + 1;
  work->now.starts = mlim_allocate(count, sizeof *work->now.starts);
  work->before.starts = mlim_allocate(count, sizeof *work->before.starts);
  return work->now.starts != NULL && work->before.starts != NULL ? MLIM_OK : MLIM_OUT_OF_MEMORY;
}

typedef struct curve_ball
{
  double center[3];
  double radius;
  double arc;
  int32_t curve; /* -1: a junction's */
  int32_t set;
  int is_known;
} curve_ball;

static mlim_status add_ball(covering* work, const curve_ball* ball)
{
  round_balls* now = &work->now;
  const size_t count = now->list.balls.ball_count;
  if (mlim_reserve(&now->arcs, &now->arc_capacity, count + 1, sizeof *now->arcs) ||
      mlim_reserve(&work->is_known, &work->known_capacity, count + 1, 1))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  now->arcs[count] = ball->arc;
  work->is_known[count] = (unsigned char)ball->is_known;
  return mlim_ball_list_add(&now->list, ball->center, ball->radius, ball->curve, ball->set);
}

static mlim_status join_balls(covering* work, size_t curve, size_t first)
{
  const int32_t* ends = work->map.ends + 2 * curve;
  mlim_ball_list* list = &work->now.list;
  const int32_t last = (int32_t)list->balls.ball_count - 1;
  mlim_status status = MLIM_OK;
  if (ends[0] >= 0)
  {
    status = mlim_ball_list_join(list, ends[0], (int32_t)first, (int32_t)curve);
  }
  for (int32_t b = (int32_t)first; b < last && !status; ++b)
  {
    status = mlim_ball_list_join(list, b, b + 1, (int32_t)curve);
  }
  return status ? status
                : mlim_ball_list_join(
                    list, last, ends[1] >= 0 ? ends[1] : (int32_t)first, (int32_t)curve);
}

/* A curve of the map, as a span sees it. */
typedef struct map_curve
{
  const mlim_radius_map* map;
  size_t curve;
  size_t near; /* the sample asked for last */
} map_curve;

static double radius_on_curve(void* user, double arc)
{
  map_curve* on = (map_curve*)user;
  return mlim_radius_map_radius(on->map, on->curve, arc, &on->near);
}

/* A curve whose limits and junctions are what they were has the balls that it had. */
static int is_as_before(const covering* work, size_t curve)
{
  const int32_t* ends = work->map.ends + 2 * curve;
  return !work->map.is_changed[curve] &&
         (ends[0] < 0 || (work->is_known[ends[0]] && work->is_known[ends[1]]));
}

static mlim_status take_balls_before(covering* work, size_t curve)
{
  const mlim_balls* balls = &work->before.list.balls;
  mlim_status status = MLIM_OK;
  for (size_t b = work->before.starts[curve]; b < work->before.starts[curve + 1] && !status; ++b)
  {
    curve_ball ball = { .radius = balls->radii[b],
      .arc = work->before.arcs[b],
      .curve = (int32_t)curve,
      .set = work->curves->curve_sets[curve],
      .is_known = 1 };
    mlim_copy(balls->centers + 3 * b, ball.center);
    status = add_ball(work, &ball);
  }
  return status;
}

static mlim_status make_balls(covering* work, size_t curve)
{
  const mlim_radius_map* map = &work->map;
  const int32_t* ends = map->ends + 2 * curve;
  const size_t sample_count = map->offsets[curve + 1] - map->offsets[curve];
  map_curve on = { .map = map, .curve = curve };
  mlim_span span = { .length = map->arcs[map->offsets[curve + 1] - 1],
    .is_closed = ends[0] < 0,
    .min_count = 1,
    .step_count = INTEGRAL_STEPS * sample_count,
    .radius = radius_on_curve,
    .user = &on };
  if (span.is_closed)
  {
    span.min_count = MIN_LOOP_BALLS;
  }
  else
  {
    span.end_radii[0] = map->junction_limits[ends[0]];
    span.end_radii[1] = map->junction_limits[ends[1]];
    span.min_count = ends[0] == ends[1] ? MIN_RETURN_BALLS : 1;
  }
  mlim_status status = mlim_span_cover_make(&span, &work->cover);
  for (size_t i = 0; i < work->cover.count && !status; ++i)
  {
    curve_ball ball = { .radius = work->cover.radii[i],
      .arc = work->cover.arcs[i],
      .curve = (int32_t)curve,
      .set = work->curves->curve_sets[curve] };
    mlim_radius_map_point(map, curve, ball.arc, ball.center);
    status = add_ball(work, &ball);
  }
  return status;
}

static mlim_status cover_curve(covering* work, size_t curve)
{
  const size_t first = work->now.list.balls.ball_count;
  work->now.starts[curve] = first;
  const mlim_status status =
    is_as_before(work, curve) ? take_balls_before(work, curve) : make_balls(work, curve);
  work->now.starts[curve + 1] = work->now.list.balls.ball_count;
  work->map.is_changed[curve] = 0;
  return status ? status : join_balls(work, curve, first);
}

static mlim_status cover_junction(covering* work, size_t junction)
{
  const mlim_balls* before = &work->before.list.balls;
  curve_ball ball = { .radius = work->map.junction_limits[junction],
    .curve = MLIM_JUNCTION,
    .set = work->curves->junction_sets[junction] };
  ball.is_known = junction < before->ball_count && before->radii[junction] == ball.radius;
  mlim_copy(
    work->curves->points + 3 * (size_t)work->curves->junction_points[junction], ball.center);
  return add_ball(work, &ball);
}

static mlim_status cover_all(covering* work)
{
  const mlim_curves* curves = work->curves;
  mlim_status status = MLIM_OK;
  const round_balls before = work->before;
  work->before = work->now;
  work->now = before;
  work->now.list.balls.ball_count = 0;
  work->now.list.balls.edge_count = 0;
  for (size_t j = 0; j < curves->junction_count && !status; ++j)
  {
    status = cover_junction(work, j);
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
  const int32_t curve = work->now.list.balls.ball_curves[ball];
  const int has_changed =
    curve < 0
      ? mlim_radius_map_lower_junction(&work->map, (size_t)ball, radius)
      : mlim_radius_map_lower(&work->map, which, (size_t)curve, work->now.arcs[ball], radius);
  work->lowered_count += has_changed ? 1 : 0;
}

/* Balls of two curves that end at one junction keep apart as a wedge. */
static mlim_radius_limit limit_between(const covering* work, int32_t a, int32_t b)
{
  const int32_t c = work->now.list.balls.ball_curves[a];
  const int32_t d = work->now.list.balls.ball_curves[b];
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
  const double* radii = work->now.list.balls.radii;
  const mlim_radius_limit which = limit_between(work, a, b);
  const double factor = mlim_max(APART_BY * distance / (radii[a] + radii[b]), 0.5 * LOWER_BY);
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
  const double* radii = work->now.list.balls.radii;
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
    const double done = (double)round / (MAX_ROUNDS + 1);
    work->lowered_count = 0;
    status = status ? status : mlim_progress(context, MLIM_STAGE_BALLS, done);
    status = status ? status : cover_all(work);
    status = status ? status : mlim_progress(context, MLIM_STAGE_BALLS, done);
    status = status ? status
                    : mlim_balls_examine(work->curves, &work->now.list.balls, work->is_known,
                        work->options, lower_at_fault, work);
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
  status = status ? status : mlim_radius_map_create(curves, options, context, &work.map);
  status = status ? status : covering_reserve(&work);
  status = status ? status : cover_until_good(&work, context);
  status = status ? status : mlim_sets_copy(&curves->sets, &work.now.list.balls.sets);
  status = status ? status : mlim_progress(context, MLIM_STAGE_BALLS, 1);
  if (status == MLIM_OUT_OF_MEMORY)
  {
    mlim_fail_memory(context, "the protecting balls");
  }
  if (!status)
  {
    mlim_ball_list_take(&work.now.list, out);
  }
  covering_free(&work);
  return status;
}
