#include "span.h"
#include "memory.h"
#include "vector.h"

#include <math.h>

/* Centres of neighbours are this many radii apart. Between 1 (centres held) and 2 (apart). */
static const double CENTER_SPACING = 1.5;
/* Where the number of balls was rounded up they are closer together, and shrink by this more than
   their distance, so that none holds a centre: r / d = 0.8, where radii grow 0.93. */
static const double CROWDED_RADIUS = 1.2;
/* Between two end balls that nearly meet one ball is enough: in units of the spacing. */
static const double SINGLE_BALL = 0.5;
/* A single ball in units of the gap on each side of it: equal margins of overlap and of the end
   balls' centres at 2, still enough overlap at 1.25; and at most this part of the way to an end's centre. */
static const double SINGLE_RADIUS = 2;
static const double LEAST_SINGLE = 1.25;
static const double SINGLE_SHARE = 0.9;
/* Largest radius of any other ball, of the way to a neighbour's centre. */
static const double NEIGHBOUR_SHARE = 0.92;
/* In units of the span: only so that a radius is above 0 where the end balls leave no gap at all,
   which the check will find. */
static const double LEAST_RADIUS = 1e-3;

enum
{
  BISECTIONS = 40 /* to 1e-12 of the length */
};

/* The part from the first ball's centre to the last one's. */
typedef struct span_part
{
  double begin;
  double end;
} span_part;

void mlim_span_cover_free(mlim_span_cover* cover)
{
  mlim_release(cover->arcs);
  mlim_release(cover->radii);
  mlim_release(cover->sums);
  *cover = (mlim_span_cover){ 0 };
}

/* The first ball's centre is half its radius outside the end's ball: both margins, of overlap and of
   the centre held, are the same then, for every ratio of the radii. From the end inwards the left
   side of the comparison grows faster than the right one. */
static double first_arc(const mlim_span* span, int from_end)
{
  double low = span->end_radii[from_end];
  double high = span->length;
  for (int step = 0; step < BISECTIONS; ++step)
  {
    const double arc = 0.5 * (low + high);
    const double radius = span->radius(span->user, from_end ? span->length - arc : arc);
    if (arc < span->end_radii[from_end] + 0.5 * radius)
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

/* Integral of ds / (1.5 radius) over the part, by the midpoint rule. */
static double integrate(const mlim_span* span, const span_part* part, double* sums)
{
  const double step = (part->end - part->begin) / (double)span->step_count;
  sums[0] = 0;
  for (size_t i = 0; i < span->step_count; ++i)
  {
    const double radius = span->radius(span->user, part->begin + ((double)i + 0.5) * step);
    sums[i + 1] = sums[i] + step / (CENTER_SPACING * radius);
  }
  return sums[span->step_count];
}

static mlim_status reserve(mlim_span_cover* cover, size_t count)
{
  return mlim_reserve(&cover->arcs, &cover->arc_capacity, count, sizeof(double)) ||
             mlim_reserve(&cover->radii, &cover->radius_capacity, count, sizeof(double))
           ? MLIM_OUT_OF_MEMORY
           : MLIM_OK;
}

/* Balls at equal parts of the integral; at the end of the part too unless the span is closed. */
static mlim_status place_balls(
  const mlim_span* span, const span_part* part, size_t interval_count, mlim_span_cover* cover)
{
  const mlim_status status = reserve(cover, interval_count + 1);
  const double* sums = cover->sums;
  const double share = sums[span->step_count] / (double)interval_count;
  const double shrink = mlim_min(1, CROWDED_RADIUS * share);
  const double step = (part->end - part->begin) / (double)span->step_count;
  cover->count = status ? 0 : interval_count + (span->is_closed ? 0 : 1);
  size_t at = 0;
  for (size_t i = 0; i < cover->count; ++i)
  {
    const double target = share * (double)i;
    while (at + 1 < span->step_count && sums[at + 1] <= target)
    {
      ++at;
    }
    const double rest = (target - sums[at]) / (sums[at + 1] - sums[at]);
    cover->arcs[i] = i == interval_count
                       ? part->end
                       : part->begin + ((double)at + mlim_min(mlim_max(rest, 0), 1)) * step;
    cover->radii[i] = shrink * span->radius(span->user, cover->arcs[i]);
  }
  return status;
}

/* No ball holds its neighbour's centre, also where radii change fast. */
static void limit_by_neighbours(const mlim_span* span, mlim_span_cover* cover)
{
  for (size_t i = 0; i < cover->count; ++i)
  {
    const double before = i > 0 ? cover->arcs[i - 1] : 0;
    const double after = i + 1 < cover->count ? cover->arcs[i + 1] : span->length;
    const double gap = i > 0 || !span->is_closed
                         ? mlim_min(cover->arcs[i] - before, after - cover->arcs[i])
                         : after - cover->arcs[i];
    cover->radii[i] = mlim_min(cover->radii[i], NEIGHBOUR_SHARE * gap);
  }
}

/* One ball in the middle of what the end balls leave free. */
static mlim_status place_single(const mlim_span* span, mlim_span_cover* cover)
{
  const mlim_status status = reserve(cover, 1);
  const double gap = 0.5 * (span->length - span->end_radii[0] - span->end_radii[1]);
  const double arc = span->end_radii[0] + gap;
  cover->count = status ? 0 : 1;
  if (!status)
  {
    const double wanted = span->radius(span->user, arc);
    const double radius = mlim_max(mlim_min(wanted, SINGLE_RADIUS * gap), LEAST_SINGLE * gap);
    cover->arcs[0] = arc;
    cover->radii[0] = mlim_min(radius, SINGLE_SHARE * mlim_min(arc, span->length - arc));
    cover->radii[0] = mlim_max(cover->radii[0], LEAST_RADIUS * span->length);
  }
  return status;
}

mlim_status mlim_span_cover_make(const mlim_span* span, mlim_span_cover* cover)
{
  span_part part = { .begin = 0, .end = span->length };
  if (!span->is_closed)
  {
    part.begin = first_arc(span, 0);
    part.end = span->length - first_arc(span, 1);
  }
  cover->count = 0;
  if (!(part.end > part.begin))
  {
    return place_single(span, cover);
  }
  if (mlim_reserve(&cover->sums, &cover->sum_capacity, span->step_count + 1, sizeof(double)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  const double length = integrate(span, &part, cover->sums);
  if (length < SINGLE_BALL && span->min_count < 2)
  {
    return place_single(span, cover);
  }
  const size_t least = span->is_closed ? span->min_count : span->min_count - 1;
  const size_t count = (size_t)mlim_max(1, ceil(length));
  const mlim_status status = place_balls(span, &part, count < least ? least : count, cover);
  limit_by_neighbours(span, cover);
  return status;
}
