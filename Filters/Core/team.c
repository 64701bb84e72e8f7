#include "team.h"

#include "status.h"

#include <stdatomic.h>

#if defined(__unix__) || defined(__APPLE__)
#include <sched.h>
#define HAS_YIELD 1
#endif

enum
{
  OTHERS = 2,   /* as many as can be of use beside one who inserts */
  SPINS = 1024, /* looks before another thread gets the processor; about 40 us */
  LINE = 64     /* bytes; what one thread writes often lies apart from what others read */
};

typedef enum phase
{
  BEFORE,
  LED,
  OVER
} phase;

struct mlim_team
{
  void (*lead)(void* job, mlim_team* team);
  void* job;
  atomic_int phase;
  atomic_int others; /* who stand by */
  mlim_team_work work;
  char apart[LINE];
  atomic_size_t left; /* items that nobody has taken */
  char apart_too[LINE];
  atomic_size_t done; /* items */
};

static void rest(unsigned* rests)
{
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
#ifdef HAS_YIELD
  if (*rests >= SPINS)
  {
    sched_yield();
    return;
  }
#endif
  ++*rests;
}

static void wait_until_done(mlim_team* team, size_t count)
{
  unsigned rests = 0;
  while (atomic_load_explicit(&team->done, memory_order_acquire) < count)
  {
    rest(&rests);
  }
}

/* 0: none is left. Who has an item has the work that it is of: there is no other before it is done. */
static int do_item(mlim_team* team)
{
  size_t left = atomic_load_explicit(&team->left, memory_order_relaxed);
  while (left > 0 && !atomic_compare_exchange_weak_explicit(
                       &team->left, &left, left - 1, memory_order_acquire, memory_order_relaxed))
  {
  }
  if (left == 0)
  {
    return 0;
  }
  const mlim_team_work* work = &team->work;
  const size_t item = work->count - left;
  if (item >= work->second)
  {
    /* Those before it are taken, so that this ends. */
    wait_until_done(team, work->second);
  }
  work->body(work->job, item);
  atomic_fetch_add_explicit(&team->done, 1, memory_order_acq_rel);
  return 1;
}

/* A host with a single thread may come here before anybody leads: then this has to give up. */
static void stand_by(mlim_team* team)
{
  unsigned rests = 0;
  while (atomic_load_explicit(&team->phase, memory_order_acquire) == BEFORE && rests < SPINS)
  {
    rest(&rests);
  }
  if (atomic_load_explicit(&team->phase, memory_order_acquire) != LED)
  {
    return;
  }
  atomic_fetch_add_explicit(&team->others, 1, memory_order_relaxed);
  for (rests = 0; atomic_load_explicit(&team->phase, memory_order_acquire) == LED;)
  {
    if (do_item(team))
    {
      rests = 0;
    }
    else
    {
      rest(&rests);
    }
  }
  atomic_fetch_sub_explicit(&team->others, 1, memory_order_relaxed);
}

/* Item 0 leads. */
static void team_body(void* data, size_t begin, size_t end)
{
  mlim_team* team = (mlim_team*)data;
  for (size_t k = begin; k < end; ++k)
  {
    if (k > 0)
    {
      stand_by(team);
      continue;
    }
    atomic_store_explicit(&team->phase, LED, memory_order_release);
    team->lead(team->job, team);
    atomic_store_explicit(&team->phase, OVER, memory_order_release);
  }
}

void mlim_team_run(mlim_context* context, void (*lead)(void* job, mlim_team* team), void* job)
{
  mlim_team team = { .lead = lead, .job = job };
  atomic_init(&team.phase, BEFORE);
  atomic_init(&team.others, 0);
  atomic_init(&team.left, 0);
  atomic_init(&team.done, 0);
  mlim_parallel_for(context, 1 + OTHERS, team_body, &team);
}

int mlim_team_is_alone(const mlim_team* team)
{
  return atomic_load_explicit(&team->others, memory_order_relaxed) == 0;
}

void mlim_team_offer(mlim_team* team, const mlim_team_work* work)
{
  team->work = *work;
  atomic_store_explicit(&team->done, 0, memory_order_relaxed);
  atomic_store_explicit(&team->left, work->count, memory_order_release);
}

void mlim_team_finish(mlim_team* team)
{
  while (do_item(team))
  {
  }
  wait_until_done(team, team->work.count);
}
