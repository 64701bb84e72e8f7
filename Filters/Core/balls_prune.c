#include "balls_prune.h"

#include "ball_grid.h"
#include "ball_list.h"
#include "label_sets.h"
#include "memory.h"
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
  mlim_ball_list list;
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

static mlim_status add_edge(pruning* work, int32_t a, int32_t b, int32_t curve)
{
  return mlim_ball_list_join(&work->list, work->numbers[a], work->numbers[b], curve);
}

static mlim_status keep_balls(pruning* work)
{
  const mlim_balls* old = work->old;
  mlim_status status = MLIM_OK;
  for (size_t b = 0; b < old->ball_count && !status; ++b)
  {
    work->numbers[b] = work->is_marked[b] ? NOBODY : (int32_t)work->list.balls.ball_count;
    if (!work->is_marked[b])
    {
      status = mlim_ball_list_add(
        &work->list, old->centers + 3 * b, old->radii[b], old->ball_curves[b], old->ball_sets[b]);
    }
  }
  return status;
}

static mlim_status keep_edges(pruning* work)
{
  const mlim_balls* old = work->old;
  mlim_status status = MLIM_OK;
  for (size_t e = 0; e < old->edge_count && !status; ++e)
  {
    const int32_t a = old->edges[2 * e];
    const int32_t b = old->edges[2 * e + 1];
    if (work->is_marked[a] == work->is_marked[b])
    {
      status = work->is_marked[a] ? MLIM_OK : add_edge(work, a, b, old->edge_curves[e]);
      continue;
    }
    const int32_t kept = work->is_marked[a] ? b : a;
    const int32_t other = next_kept(work, kept, work->is_marked[a] ? a : b);
    /* Each bridge is found from both its ends. */
    if (other != NOBODY && kept < other)
    {
      status = add_edge(work, kept, other, old->edge_curves[e]);
    }
  }
  return status;
}

mlim_status mlim_balls_prune(
  const mlim_balls* balls, const unsigned char* is_marked, mlim_context* context, mlim_balls* out)
{
  *out = (mlim_balls){ 0 };
  pruning work = { .old = balls,
    .is_marked = is_marked,
    .numbers = mlim_allocate(balls->ball_count, sizeof *work.numbers),
    .links = mlim_allocate(balls->ball_count, 2 * sizeof *work.links) };
  mlim_status status = work.numbers && work.links ? MLIM_OK : MLIM_OUT_OF_MEMORY;
  if (!status)
  {
    memset(work.links, 0xff, balls->ball_count * 2 * sizeof *work.links);
    for (size_t e = 0; e < balls->edge_count; ++e)
    {
      link_ball(&work, balls->edges[2 * e], balls->edges[2 * e + 1]);
      link_ball(&work, balls->edges[2 * e + 1], balls->edges[2 * e]);
    }
    status = keep_balls(&work);
  }
  status = status ? status : keep_edges(&work);
  status = status ? status : mlim_sets_copy(&balls->sets, &work.list.balls.sets);
  if (!status)
  {
    mlim_ball_list_take(&work.list, out);
  }
  mlim_ball_list_free(&work.list);
  mlim_release(work.numbers);
  mlim_release(work.links);
  return status ? mlim_fail_memory(context, "the protecting balls") : MLIM_OK;
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
  mlim_ball_grid grid;
  *count = 0;
  if (mlim_ball_grid_fill(balls, &grid) != MLIM_OK)
  {
    return mlim_fail_memory(context, "the protecting balls");
  }
  memset(is_marked, 0, balls->ball_count);
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    const double* center = balls->centers + 3 * b;
    mlim_point_walk walk;
    for (int32_t q = mlim_point_grid_first(&grid.points, center, grid.largest, &walk); q >= 0;
         q = mlim_point_grid_next(&grid.points, &walk))
    {
      if ((size_t)q != b && !is_marked[b] && is_held(balls, b, (size_t)q))
      {
        is_marked[b] = 1;
        ++*count;
      }
    }
  }
  mlim_ball_grid_free(&grid);
  return MLIM_OK;
}
