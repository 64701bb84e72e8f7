#include "faces.h"
#include "grow.h"
#include "memory.h"
#include "point_grid.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>

/* In units of the merge tolerance. A chain between merged junctions or a closed one goes when it is
   shorter than TINY_CHAIN: it runs round less than a merged junction's own extent. An end that
   leads nowhere goes when it is shorter than TINY_END. Larger values drop real curves. */
static const double TINY_CHAIN = 4;
static const double TINY_END = 2;
/* Extent of a cluster: chains of near junctions must not run away. */
static const double MAX_CLUSTER = 2;

/* Squared distances that differ by less, in squared tolerances, count as equal: rounding only. */
static const double NEARER = 1e-6;

/* A set of junctions that become one; kept with its first member. */
typedef struct cluster
{
  double low[3];
  double high[3];
  double sum[3];
  double count;
  unsigned faces;   /* of the box on which a member lies, a bit each */
  int32_t position; /* the member that gives the position */
} cluster;

typedef struct junction_pair
{
  double distance;
  int32_t junctions[2];
} junction_pair;

typedef struct cleaning
{
  mlim_network* network;
  const mlim_chains* chains;
  double tolerance;
  const double* size;
  int32_t* parents;          /* per point: towards the first of its cluster */
  int32_t* degrees;          /* per point: ends of chains */
  cluster* clusters;         /* per point */
  double* lengths;           /* per chain */
  unsigned char* is_dropped; /* per chain */
  junction_pair* pairs;
  size_t pair_count;
  size_t pair_capacity;
} cleaning;

static void cleaning_free(cleaning* work)
{
  mlim_release(work->parents);
  mlim_release(work->degrees);
  mlim_release(work->clusters);
  mlim_release(work->lengths);
  mlim_release(work->is_dropped);
  mlim_release(work->pairs);
}

static mlim_status cleaning_create(cleaning* work)
{
  const mlim_network* network = work->network;
  const mlim_chains* chains = work->chains;
  work->parents = mlim_allocate(network->point_count, sizeof(int32_t));
  work->degrees = mlim_allocate_zeroed(network->point_count, sizeof(int32_t));
  work->clusters = mlim_allocate(network->point_count, sizeof(cluster));
  work->lengths = mlim_allocate_zeroed(chains->count, sizeof(double));
  work->is_dropped = mlim_allocate_zeroed(chains->count, 1);
  if (!work->parents || !work->degrees || !work->clusters || !work->lengths || !work->is_dropped)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  for (size_t p = 0; p < network->point_count; ++p)
  {
    const double* point = network->points + 3 * p;
    work->parents[p] = (int32_t)p;
    cluster* c = work->clusters + p;
    *c = (cluster){ .count = 1, .faces = mlim_faces_at(work->size, point), .position = (int32_t)p };
    mlim_copy(point, c->low);
    mlim_copy(point, c->high);
    mlim_copy(point, c->sum);
  }
  for (size_t c = 0; c < chains->count; ++c)
  {
    const size_t end = chains->offsets[c + 1] - 1;
    ++work->degrees[chains->points[chains->offsets[c]]];
    ++work->degrees[chains->points[end]];
    for (size_t i = chains->offsets[c]; i < end; ++i)
    {
      work->lengths[c] += mlim_distance(network->points + 3 * (size_t)chains->points[i],
        network->points + 3 * (size_t)chains->points[i + 1]);
    }
  }
  return MLIM_OK;
}

static int32_t find_root(const cleaning* work, int32_t point)
{
  while (work->parents[point] != point)
  {
    point = work->parents[point];
  }
  return point;
}

static int compare_pairs(const void* a, const void* b)
{
  const junction_pair* p = a;
  const junction_pair* q = b;
  if (p->distance < q->distance || p->distance > q->distance)
  {
    return p->distance < q->distance ? -1 : 1;
  }
  const int k = p->junctions[0] == q->junctions[0];
  return p->junctions[k] < q->junctions[k] ? -1 : p->junctions[k] > q->junctions[k];
}

static mlim_status find_pairs(cleaning* work)
{
  const mlim_network* network = work->network;
  mlim_point_grid grid = { 0 };
  mlim_status status = mlim_point_grid_create(work->tolerance, network->point_count, &grid);
  for (size_t p = 0; p < network->point_count && !status; ++p)
  {
    if (!work->chains->is_junction[p])
    {
      continue;
    }
    const double* point = network->points + 3 * p;
    mlim_point_walk walk;
    for (int32_t q = mlim_point_grid_first(&grid, point, work->tolerance, &walk); q >= 0 && !status;
         q = mlim_point_grid_next(&grid, &walk))
    {
      const double distance = mlim_distance(point, network->points + 3 * (size_t)q);
      if (distance >= work->tolerance)
      {
        continue;
      }
      if (mlim_reserve(
            &work->pairs, &work->pair_capacity, work->pair_count + 1, sizeof(junction_pair)))
      {
        status = MLIM_OUT_OF_MEMORY;
        break;
      }
      work->pairs[work->pair_count] =
        (junction_pair){ .distance = distance, .junctions = { q, (int32_t)p } };
      ++work->pair_count;
    }
    mlim_point_grid_add(&grid, point, (int32_t)p);
  }
  mlim_point_grid_free(&grid);
  if (work->pair_count > 0)
  {
    qsort(work->pairs, work->pair_count, sizeof(junction_pair), compare_pairs);
  }
  return status;
}

/* Unites two clusters unless the union is too large or would lie on opposite faces of the box (two
   corners of it always would). */
static mlim_status unite(cleaning* work, const int32_t junctions[2])
{
  const int32_t a = find_root(work, junctions[0]);
  const int32_t b = find_root(work, junctions[1]);
  const int32_t root = a < b ? a : b;
  const int32_t other = a < b ? b : a;
  cluster* c = work->clusters + root;
  const cluster* d = work->clusters + other;
  const unsigned faces = c->faces | d->faces;
  cluster both = *c;
  double extent = 0;
  int is_opposite = 0;
  for (int k = 0; k < 3; ++k)
  {
    both.low[k] = fmin(c->low[k], d->low[k]);
    both.high[k] = fmax(c->high[k], d->high[k]);
    both.sum[k] = c->sum[k] + d->sum[k];
    extent += (both.high[k] - both.low[k]) * (both.high[k] - both.low[k]);
    is_opposite = is_opposite || (faces >> (2 * k) & 3u) == 3u;
  }
  if (a == b || is_opposite ||
      extent > MAX_CLUSTER * MAX_CLUSTER * work->tolerance * work->tolerance)
  {
    return MLIM_OK;
  }
  both.count = c->count + d->count;
  both.faces = faces;
  *c = both;
  work->parents[other] = root;
  int32_t* sets = work->network->point_sets;
  return mlim_set_table_join(&work->network->table, sets[root], sets[other], sets + root);
}

/* Is a a better position for the cluster than b? On more of its faces, then nearer to its mean; of
   two members, which always are equally near, the one with smaller coordinates, since numbers of
   points depend on the order of the labels. */
static int is_better(const cleaning* work, const cluster* c, int32_t a, int32_t b)
{
  const int32_t points[2] = { a, b };
  int face_counts[2] = { 0, 0 };
  double distances[2];
  const double margin = NEARER * work->tolerance * work->tolerance;
  for (int i = 0; i < 2; ++i)
  {
    const double* point = work->network->points + 3 * (size_t)points[i];
    face_counts[i] = mlim_faces_count(mlim_faces_at(work->size, point));
    const double mean[3] = { c->sum[0] / c->count, c->sum[1] / c->count, c->sum[2] / c->count };
    distances[i] = mlim_distance_squared(point, mean);
  }
  if (face_counts[0] != face_counts[1])
  {
    return face_counts[0] > face_counts[1];
  }
  if (fabs(distances[0] - distances[1]) > margin)
  {
    return distances[0] < distances[1];
  }
  const double* p = work->network->points + 3 * (size_t)a;
  const double* q = work->network->points + 3 * (size_t)b;
  for (int k = 0; k < 3; ++k)
  {
    if (p[k] < q[k] || p[k] > q[k])
    {
      return p[k] < q[k];
    }
  }
  return 0;
}

/* The cluster takes the place of one of its members, so that it stays on a tie. */
static void place_clusters(cleaning* work)
{
  const size_t count = work->network->point_count;
  double* points = work->network->points;
  for (size_t p = 0; p < count; ++p)
  {
    cluster* c = work->clusters + find_root(work, (int32_t)p);
    if (c->count > 1 && is_better(work, c, (int32_t)p, c->position))
    {
      c->position = (int32_t)p;
    }
  }
  for (size_t p = 0; p < count; ++p)
  {
    const cluster* c = work->clusters + p;
    if (work->parents[p] != (int32_t)p || !(c->count > 1))
    {
      continue;
    }
    double* point = points + 3 * p;
    mlim_copy(points + 3 * (size_t)c->position, point);
    for (int k = 0; k < 3; ++k)
    {
      point[k] = c->faces >> (2 * k) & 1u ? 0 : point[k];
      point[k] = c->faces >> (2 * k) & 2u ? work->size[k] : point[k];
    }
  }
}

/* Marks the chains that go. Returns how many. */
static size_t drop_chains(cleaning* work)
{
  const mlim_chains* chains = work->chains;
  size_t count = 0;
  for (size_t c = 0; c < chains->count; ++c)
  {
    const int32_t a = chains->points[chains->offsets[c]];
    const int32_t b = chains->points[chains->offsets[c + 1] - 1];
    const int is_end = a != b && (work->degrees[a] == 1 || work->degrees[b] == 1);
    const int is_closed = find_root(work, a) == find_root(work, b);
    const double length = work->lengths[c] / work->tolerance;
    /* A chain with two free ends is a closed one that fell together. */
    const int is_free = is_end && work->degrees[a] == 1 && work->degrees[b] == 1;
    work->is_dropped[c] =
      ((is_closed || is_free) && length < TINY_CHAIN) || (is_end && length < TINY_END);
    count += work->is_dropped[c];
  }
  return count;
}

/* First point of a chain, in steps from one end, that is clear of the merged junction there: what
   is nearer would make the chain turn back. */
static size_t trim(const cleaning* work, size_t begin, size_t end, int step)
{
  const int32_t* points = work->chains->points;
  size_t at = step > 0 ? begin : end;
  const size_t stop = step > 0 ? end : begin;
  const int32_t root = find_root(work, points[at]);
  if (!(work->clusters[root].count > 1))
  {
    return step > 0 ? at + 1 : at - 1;
  }
  const double* junction = work->network->points + 3 * (size_t)root;
  do
  {
    at = step > 0 ? at + 1 : at - 1;
  } while (at != stop && mlim_distance(work->network->points + 3 * (size_t)points[at], junction) <
                           work->tolerance);
  return at;
}

static mlim_status rebuild_chain(cleaning* work, size_t chain)
{
  const mlim_chains* chains = work->chains;
  const size_t begin = chains->offsets[chain];
  const size_t end = chains->offsets[chain + 1] - 1;
  const int32_t set = chains->sets[chain];
  const size_t first = trim(work, begin, end, 1);
  const size_t last = trim(work, begin, end, -1);
  int32_t previous = find_root(work, chains->points[begin]);
  mlim_status status = MLIM_OK;
  for (size_t i = first; i <= last && i < end && !status; ++i)
  {
    status = mlim_network_add_segment(work->network, previous, chains->points[i], set);
    previous = chains->points[i];
  }
  return status ? status
                : mlim_network_add_segment(
                    work->network, previous, find_root(work, chains->points[end]), set);
}

mlim_status mlim_network_clean(mlim_network* network, const mlim_chains* chains, double tolerance,
  const double size[3], int* has_changed)
{
  cleaning work = { .network = network, .chains = chains, .tolerance = tolerance, .size = size };
  *has_changed = 0;
  if (!(tolerance > 0) || network->point_count == 0)
  {
    return MLIM_OK;
  }
  mlim_status status = cleaning_create(&work);
  if (!status)
  {
    status = find_pairs(&work);
  }
  for (size_t p = 0; p < work.pair_count && !status; ++p)
  {
    status = unite(&work, work.pairs[p].junctions);
  }
  if (status)
  {
    goto done;
  }
  const size_t dropped_count = drop_chains(&work);
  *has_changed = dropped_count > 0;
  for (size_t p = 0; p < network->point_count; ++p)
  {
    *has_changed = *has_changed || work.parents[p] != (int32_t)p;
  }
  if (*has_changed)
  {
    place_clusters(&work);
    network->segment_count = 0;
    for (size_t c = 0; c < chains->count && !status; ++c)
    {
      status = work.is_dropped[c] ? MLIM_OK : rebuild_chain(&work, c);
    }
  }

done:
  cleaning_free(&work);
  return status;
}
