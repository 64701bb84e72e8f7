#include "grow.h"
#include "memory.h"

void mlim_chains_free(mlim_chains* chains)
{
  mlim_release(chains->offsets);
  mlim_release(chains->points);
  mlim_release(chains->sets);
  mlim_release(chains->is_junction);
  *chains = (mlim_chains){ 0 };
}

/* The segments round each point, and what is grown so far. */
typedef struct growth
{
  const mlim_network* network;
  size_t* starts;         /* per point, into incident; one more at the end */
  int32_t* incident;      /* segments, ascending round a point */
  unsigned char* is_used; /* per segment */
  mlim_chains chains;
  size_t point_count; /* of all chains */
} growth;

static void growth_free(growth* g)
{
  mlim_release(g->starts);
  mlim_release(g->incident);
  mlim_release(g->is_used);
  mlim_chains_free(&g->chains);
}

static mlim_status growth_create(const mlim_network* network, growth* out)
{
  const size_t points = network->point_count;
  const size_t segments = network->segment_count;
  /* A chain has one point more than segments, so two points a segment are always enough. */
  growth made = { .network = network,
    .starts = mlim_allocate_zeroed(points + 2, sizeof(size_t)),
    .incident = mlim_allocate(2 * segments, sizeof(int32_t)),
    .is_used = mlim_allocate_zeroed(segments, 1),
    .chains = { .offsets = mlim_allocate(segments + 1, sizeof(size_t)),
      .points = mlim_allocate(2 * segments, sizeof(int32_t)),
      .sets = mlim_allocate(segments, sizeof(int32_t)),
      .is_junction = mlim_allocate_zeroed(points, 1) } };
  *out = made;
  if (!made.starts || !made.incident || !made.is_used || !made.chains.offsets ||
      !made.chains.points || !made.chains.sets || !made.chains.is_junction)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  made.chains.offsets[0] = 0;
  size_t* starts = made.starts + 1;
  for (size_t s = 0; s < segments; ++s)
  {
    ++starts[network->segments[s].ends[0] + 1];
    ++starts[network->segments[s].ends[1] + 1];
  }
  for (size_t p = 0; p < points; ++p)
  {
    starts[p + 1] += starts[p];
  }
  /* Filling moves each start to its end, which is the next one's start: hence the shift by one. */
  for (size_t s = 0; s < segments; ++s)
  {
    for (int e = 0; e < 2; ++e)
    {
      size_t* at = made.starts + network->segments[s].ends[e] + 1;
      made.incident[*at] = (int32_t)s;
      ++*at;
    }
  }
  return MLIM_OK;
}

static int is_junction(const growth* g, size_t point)
{
  const size_t begin = g->starts[point];
  const size_t degree = g->starts[point + 1] - begin;
  const mlim_segment* segments = g->network->segments;
  return degree > 0 &&
         (degree != 2 || segments[g->incident[begin]].set != segments[g->incident[begin + 1]].set);
}

/* Follows a chain from one of its points until it meets a junction or itself. */
static void grow_chain(growth* g, int32_t start, int32_t segment)
{
  mlim_chains* chains = &g->chains;
  const mlim_segment* segments = g->network->segments;
  chains->sets[chains->count] = segments[segment].set;
  chains->points[g->point_count] = start;
  ++g->point_count;
  int32_t point = start;
  while (segment >= 0)
  {
    g->is_used[segment] = 1;
    const mlim_segment* here = segments + segment;
    point = here->ends[0] == point ? here->ends[1] : here->ends[0];
    chains->points[g->point_count] = point;
    ++g->point_count;
    segment = -1;
    const size_t end = g->starts[point + 1];
    for (size_t i = g->starts[point]; i < end && !chains->is_junction[point]; ++i)
    {
      segment = g->is_used[g->incident[i]] ? segment : g->incident[i];
    }
  }
  ++chains->count;
  chains->offsets[chains->count] = g->point_count;
}

mlim_status mlim_chains_grow(
  const mlim_network* network, const unsigned char* is_corner, mlim_chains* out)
{
  growth g;
  const mlim_status status = growth_create(network, &g);
  if (status)
  {
    growth_free(&g);
    return status;
  }
  for (size_t p = 0; p < network->point_count; ++p)
  {
    g.chains.is_junction[p] = (unsigned char)(is_junction(&g, p) || (is_corner && is_corner[p]));
  }
  for (size_t p = 0; p < network->point_count; ++p)
  {
    for (size_t i = g.starts[p]; i < g.starts[p + 1]; ++i)
    {
      if (g.chains.is_junction[p] && !g.is_used[g.incident[i]])
      {
        grow_chain(&g, (int32_t)p, g.incident[i]);
      }
    }
  }
  for (size_t s = 0; s < network->segment_count; ++s)
  {
    if (!g.is_used[s])
    {
      grow_chain(&g, network->segments[s].ends[0], (int32_t)s);
    }
  }
  *out = g.chains;
  g.chains = (mlim_chains){ 0 };
  growth_free(&g);
  return MLIM_OK;
}
