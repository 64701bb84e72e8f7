#include "grow.h"
#include "memory.h"
#include "vector.h"

#include <math.h>

/* Two sides of a curve whose ends are closer than this times the reach make a sharp corner: an angle
   of 44 degrees. Blunter ones are covered by balls that shrink towards the corner. */
static const double CORNER_CHORD = 0.75;

/* A detour is cut where its two sides are closer than `width` and the way round is longer than this
   many widths; a semicircle's is 1.6. */
static const double DETOUR = 2.5;
/* The longest way round, in widths: longer ones are a part of the curve that can be seen. */
static const double MAX_DETOUR = 10;

enum
{
  SAMPLES_PER_WIDTH = 3 /* more find detours a little earlier, and cost their square */
};

/* A chain in small steps, and which of its own points each step starts at (-1: between two). */
typedef struct samples
{
  size_t count;
  size_t point_capacity;
  size_t arc_capacity;
  size_t number_capacity;
  double* points;
  double* arcs;
  int32_t* numbers;
} samples;

static void samples_free(samples* s)
{
  mlim_release(s->points);
  mlim_release(s->arcs);
  mlim_release(s->numbers);
}

static mlim_status add_sample(samples* s, const double point[3], int32_t number)
{
  if (mlim_reserve(&s->points, &s->point_capacity, s->count + 1, 3 * sizeof(double)) ||
      mlim_reserve(&s->arcs, &s->arc_capacity, s->count + 1, sizeof(double)) ||
      mlim_reserve(&s->numbers, &s->number_capacity, s->count + 1, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  mlim_copy(point, s->points + 3 * s->count);
  s->arcs[s->count] =
    s->count == 0 ? 0
                  : s->arcs[s->count - 1] + mlim_distance(s->points + 3 * (s->count - 1), point);
  s->numbers[s->count] = number;
  ++s->count;
  return MLIM_OK;
}

static mlim_status sample_chain(
  const mlim_network* network, const mlim_chains* chains, size_t chain, double step, samples* s)
{
  mlim_status status = MLIM_OK;
  s->count = 0;
  for (size_t i = chains->offsets[chain]; i < chains->offsets[chain + 1] && !status; ++i)
  {
    const double* a = network->points + 3 * (size_t)chains->points[i];
    status = add_sample(s, a, chains->points[i]);
    if (i + 1 == chains->offsets[chain + 1])
    {
      break;
    }
    const double* b = network->points + 3 * (size_t)chains->points[i + 1];
    const size_t count = (size_t)fmax(1, ceil(mlim_distance(a, b) / step));
    for (size_t k = 1; k < count && !status; ++k)
    {
      double point[3];
      mlim_interpolate(a, b, (double)k / (double)count, point);
      status = add_sample(s, point, -1);
    }
  }
  return status;
}

/* The far side of a detour that starts at a sample; the sample itself if there is none. */
static size_t find_far_side(const samples* s, size_t from, double width)
{
  size_t found = from;
  for (size_t to = from + 1; to < s->count; ++to)
  {
    const double way = s->arcs[to] - s->arcs[from];
    if (way > MAX_DETOUR * width)
    {
      break;
    }
    if (way > DETOUR * width &&
        mlim_distance_squared(s->points + 3 * from, s->points + 3 * to) < width * width)
    {
      found = to;
    }
  }
  return found;
}

/* Adds a chain to the network again, without its detours. */
static mlim_status rebuild(
  mlim_network* network, samples* s, int32_t set, double width, int* has_changed)
{
  mlim_status status = MLIM_OK;
  int32_t previous = s->numbers[0];
  for (size_t i = 0; i < s->count && !status;)
  {
    const size_t far = find_far_side(s, i, width);
    const size_t ends[2] = { i, far };
    for (int e = 0; e < (far > i ? 2 : 1) && !status; ++e)
    {
      int32_t number = s->numbers[ends[e]];
      if (number < 0 && far > i)
      {
        status = mlim_network_add_point(network, s->points + 3 * ends[e], set, &number);
      }
      if (!status && number >= 0 && number != previous)
      {
        status = mlim_network_add_segment(network, previous, number, set);
        previous = number;
      }
    }
    *has_changed = *has_changed || far > i;
    i = far + 1;
  }
  return status;
}

mlim_status mlim_network_cut_detours(
  mlim_network* network, const mlim_chains* chains, double width, int* has_changed)
{
  samples s = { 0 };
  mlim_status status = MLIM_OK;
  *has_changed = 0;
  if (!(width > 0))
  {
    return MLIM_OK;
  }
  network->segment_count = 0;
  for (size_t c = 0; c < chains->count && !status; ++c)
  {
    status = sample_chain(network, chains, c, width / SAMPLES_PER_WIDTH, &s);
    status = status ? status : rebuild(network, &s, chains->sets[c], width, has_changed);
  }
  samples_free(&s);
  return status;
}

/* The point of a chain at a length from one of its points, forwards or backwards. 0: the chain ends
   before. */
static int walk(const mlim_network* network, const mlim_chains* chains, size_t chain, size_t from,
  int step, double reach, double out[3])
{
  const size_t begin = chains->offsets[chain];
  const size_t end = chains->offsets[chain + 1] - 1;
  const int is_closed = chains->points[begin] == chains->points[end];
  double rest = reach;
  size_t at = from;
  for (size_t count = 0; count < end - begin; ++count)
  {
    if (at == (step > 0 ? end : begin))
    {
      if (!is_closed || chains->is_junction[chains->points[at]])
      {
        return 0;
      }
      at = step > 0 ? begin : end;
    }
    const size_t next = step > 0 ? at + 1 : at - 1;
    const double* a = network->points + 3 * (size_t)chains->points[at];
    const double* b = network->points + 3 * (size_t)chains->points[next];
    const double length = mlim_distance(a, b);
    if (length >= rest && length > 0)
    {
      mlim_interpolate(a, b, rest / length, out);
      return 1;
    }
    rest -= length;
    at = next;
  }
  return 0;
}

/* Distance of the points at the reach on both sides, in units of it; 2 where there are none. */
static double corner_chord(
  const mlim_network* network, const mlim_chains* chains, size_t chain, size_t at, double reach)
{
  double before[3];
  double after[3];
  return walk(network, chains, chain, at, -1, reach, before) &&
             walk(network, chains, chain, at, 1, reach, after)
           ? mlim_distance(before, after) / reach
           : 2;
}

/* The corner found last on a chain. */
typedef struct corner
{
  int32_t point;
  double chord;
  double arc;
} corner;

/* Marks a corner, unless a sharper one is near; one that is near and blunter is unmarked. */
static void mark(const corner* found, double reach, corner* last, unsigned char* is_corner)
{
  const int is_near = last->point >= 0 && found->arc - last->arc < reach;
  if (is_near && last->chord <= found->chord)
  {
    return;
  }
  if (is_near)
  {
    is_corner[last->point] = 0;
  }
  is_corner[found->point] = 1;
  *last = *found;
}

void mlim_chains_mark_corners(
  const mlim_network* network, const mlim_chains* chains, double reach, unsigned char* is_corner)
{
  for (size_t c = 0; c < chains->count; ++c)
  {
    corner last = { .point = -1 };
    double arc = 0;
    for (size_t i = chains->offsets[c]; i + 1 < chains->offsets[c + 1]; ++i)
    {
      const corner here = {
        .point = chains->points[i], .chord = corner_chord(network, chains, c, i, reach), .arc = arc
      };
      if (here.chord < CORNER_CHORD)
      {
        mark(&here, reach, &last, is_corner);
      }
      arc += mlim_distance(network->points + 3 * (size_t)chains->points[i],
        network->points + 3 * (size_t)chains->points[i + 1]);
    }
  }
}
