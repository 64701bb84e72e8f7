#include "balls_prune.h"

#include "label_sets.h"
#include "memory.h"
#include "point_grid.h"
#include "status.h"
#include "vector.h"

#include <string.h>

enum
{
  NOBODY = -1
};

typedef struct pruning
{
  const mlim_balls* old;
  const unsigned char* is_marked;
  int32_t* numbers; /* new number of each old ball, NOBODY */
  int32_t* links;   /* two neighbours of each old ball on its curve, NOBODY */
  mlim_balls balls;
} pruning;

static void link_ball(pruning* work, int32_t ball, int32_t neighbor)
{
  int32_t* links = work->links + 2 * (size_t)ball;
  links[links[0] == NOBODY ? 0 : 1] = neighbor;
}

/* The first ball that stays, going on from `ball`, which is marked, away from `from`. NOBODY where
   the curve ends, at a marked junction, or comes back to its start. */
static int32_t next_kept(const pruning* work, int32_t from, int32_t ball)
{
  for (size_t step = 0; step < work->old->ball_count; ++step)
  {
    if (!work->is_marked[ball])
    {
      return ball;
    }
    if (work->old->ball_curves[ball] < 0)
    {
      return NOBODY;
    }
    const int32_t* links = work->links + 2 * (size_t)ball;
    const int32_t next = links[0] == from ? links[1] : links[0];
    if (next == NOBODY)
    {
      return NOBODY;
    }
    from = ball;
    ball = next;
  }
  return NOBODY;
}

static void add_edge(pruning* work, int32_t a, int32_t b, int32_t curve)
{
  mlim_balls* balls = &work->balls;
  balls->edges[2 * balls->edge_count] = work->numbers[a];
  balls->edges[2 * balls->edge_count + 1] = work->numbers[b];
  balls->edge_curves[balls->edge_count++] = curve;
}

static void keep_balls(pruning* work)
{
  const mlim_balls* old = work->old;
  mlim_balls* balls = &work->balls;
  for (size_t b = 0; b < old->ball_count; ++b)
  {
    work->numbers[b] = NOBODY;
    if (work->is_marked[b])
    {
      continue;
    }
    const size_t n = balls->ball_count++;
    work->numbers[b] = (int32_t)n;
    memcpy(balls->centers + 3 * n, old->centers + 3 * b, 3 * sizeof *balls->centers);
    balls->radii[n] = old->radii[b];
    balls->ball_curves[n] = old->ball_curves[b];
    balls->ball_sets[n] = old->ball_sets[b];
  }
}

static void keep_edges(pruning* work)
{
  const mlim_balls* old = work->old;
  for (size_t e = 0; e < old->edge_count; ++e)
  {
    const int32_t a = old->edges[2 * e];
    const int32_t b = old->edges[2 * e + 1];
    if (work->is_marked[a] == work->is_marked[b])
    {
      if (!work->is_marked[a])
      {
        add_edge(work, a, b, old->edge_curves[e]);
      }
      continue;
    }
    const int32_t kept = work->is_marked[a] ? b : a;
    const int32_t other = next_kept(work, kept, work->is_marked[a] ? a : b);
    /* Each bridge is found from both its ends. */
    if (other != NOBODY && kept < other)
    {
      add_edge(work, kept, other, old->edge_curves[e]);
    }
  }
}

static mlim_status allocate(pruning* work)
{
  const mlim_balls* old = work->old;
  mlim_balls* balls = &work->balls;
  work->numbers = mlim_allocate(old->ball_count, sizeof *work->numbers);
  work->links = mlim_allocate(old->ball_count, 2 * sizeof *work->links);
  balls->centers = mlim_allocate(old->ball_count, 3 * sizeof *balls->centers);
  balls->radii = mlim_allocate(old->ball_count, sizeof *balls->radii);
  balls->ball_curves = mlim_allocate(old->ball_count, sizeof *balls->ball_curves);
  balls->ball_sets = mlim_allocate(old->ball_count, sizeof *balls->ball_sets);
  balls->edges = mlim_allocate(old->edge_count, 2 * sizeof *balls->edges);
  balls->edge_curves = mlim_allocate(old->edge_count, sizeof *balls->edge_curves);
  const int is_complete = work->numbers != NULL && work->links != NULL && balls->centers != NULL &&
                          balls->radii != NULL && balls->ball_curves != NULL &&
                          balls->ball_sets != NULL && balls->edges != NULL &&
                          balls->edge_curves != NULL;
  return is_complete ? mlim_sets_copy(&old->sets, &balls->sets) : MLIM_OUT_OF_MEMORY;
}

mlim_status mlim_balls_prune(
  const mlim_balls* balls, const unsigned char* is_marked, mlim_context* context, mlim_balls* out)
{
  *out = (mlim_balls){ 0 };
  pruning work = { .old = balls, .is_marked = is_marked };
  const mlim_status status = allocate(&work);
  if (status == MLIM_OK)
  {
    memset(work.links, 0xff, balls->ball_count * 2 * sizeof *work.links);
    for (size_t e = 0; e < balls->edge_count; ++e)
    {
      link_ball(&work, balls->edges[2 * e], balls->edges[2 * e + 1]);
      link_ball(&work, balls->edges[2 * e + 1], balls->edges[2 * e]);
    }
    keep_balls(&work);
    keep_edges(&work);
    *out = work.balls;
  }
  else
  {
    mlim_balls_free(&work.balls);
    (void)mlim_fail_memory(context, "the protecting balls");
  }
  mlim_release(work.numbers);
  mlim_release(work.links);
  return status;
}

/* Of two that hold each other's centre, which equal ones at one place do, the first one stays. */
static int is_held(const mlim_balls* balls, size_t ball, size_t by)
{
  const double d = mlim_distance_squared(balls->centers + 3 * ball, balls->centers + 3 * by);
  const double difference =
    balls->radii[by] * balls->radii[by] - balls->radii[ball] * balls->radii[ball];
  return d < difference || (!(d > difference) && by < ball);
}

mlim_status mlim_balls_find_held(
  const mlim_balls* balls, mlim_context* context, unsigned char* is_marked, size_t* count)
{
  mlim_point_grid grid = { 0 };
  double largest = 0;
  *count = 0;
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    is_marked[b] = 0;
    largest = mlim_max(largest, balls->radii[b]);
  }
  if (balls->ball_count == 0)
  {
    return MLIM_OK;
  }
  if (mlim_point_grid_create(2 * largest, balls->ball_count, &grid) != MLIM_OK)
  {
    return mlim_fail_memory(context, "the protecting balls");
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    mlim_point_grid_add(&grid, balls->centers + 3 * b, (int32_t)b);
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    mlim_point_walk walk;
    for (int32_t q = mlim_point_grid_first(&grid, balls->centers + 3 * b, largest, &walk); q >= 0;
         q = mlim_point_grid_next(&grid, &walk))
    {
      if ((size_t)q != b && !is_marked[b] && is_held(balls, b, (size_t)q))
      {
        is_marked[b] = 1;
        ++*count;
      }
    }
  }
  mlim_point_grid_free(&grid);
  return MLIM_OK;
}
