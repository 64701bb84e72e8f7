/* A team does each item of each offer once, the first ones before the others, whoever comes to help. */
#include "check.h"
#include "status.h"
#include "team.h"

#include <pthread.h>
#include <stdatomic.h>

enum
{
  OFFERS = 3000,
  MOST = 24, /* items */
  THREADS = 4
};

typedef struct sums
{
  atomic_int times[MOST]; /* an item was done */
  atomic_size_t first;    /* items below `second` that are done */
  atomic_size_t early;    /* others that began before all of those were */
  size_t second;
  size_t leads, wrong;
} sums;

static void item_body(void* job, size_t item)
{
  sums* s = (sums*)job;
  if (item < s->second)
  {
    atomic_fetch_add(&s->first, 1);
  }
  else
  {
    atomic_fetch_add(&s->early, atomic_load(&s->first) < s->second);
  }
  atomic_fetch_add(&s->times[item], 1);
}

static void lead(void* job, mlim_team* team)
{
  sums* s = (sums*)job;
  ++s->leads;
  for (size_t offer = 0; offer < OFFERS; ++offer)
  {
    const size_t count = offer % (MOST + 1);
    atomic_store(&s->first, 0);
    s->second = offer % 3 == 0 ? count : count / 2;
    mlim_team_offer(
      team, &(mlim_team_work){ .body = item_body, .job = s, .count = count, .second = s->second });
    mlim_team_finish(team);
    for (size_t k = 0; k < MOST; ++k)
    {
      s->wrong += atomic_exchange(&s->times[k], 0) != (k < count);
    }
  }
}

/* ---- hosts ---- */

static void backwards(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  for (size_t k = count; k > 0; --k)
  {
    body(job, k - 1, k);
  }
}

typedef struct range
{
  mlim_body body;
  void* job;
  size_t begin, end;
} range;

static void* run_range(void* data)
{
  const range* r = (const range*)data;
  r->body(r->job, r->begin, r->end);
  return NULL;
}

/* Each item has a thread of its own, the last one this. */
static void apart(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  pthread_t threads[THREADS];
  range ranges[THREADS];
  const size_t own = count < THREADS ? count - 1 : THREADS - 1;
  for (size_t k = 0; k <= own; ++k)
  {
    ranges[k] = (range){ .body = body, .job = job, .begin = k, .end = k < own ? k + 1 : count };
  }
  for (size_t k = 0; k < own; ++k)
  {
    CHECK(pthread_create(&threads[k], NULL, run_range, &ranges[k]) == 0);
  }
  run_range(&ranges[own]);
  for (size_t k = 0; k < own; ++k)
  {
    CHECK(pthread_join(threads[k], NULL) == 0);
  }
}

static void test_host(void (*host)(void*, size_t, mlim_body, void*))
{
  sums s = { .leads = 0 };
  mlim_context context = { .parallel_for = host };
  mlim_team_run(&context, lead, &s);
  CHECK_COUNT(s.leads, 1);
  CHECK_COUNT(s.wrong, 0);
  CHECK_COUNT(atomic_load(&s.early), 0);
}

int main(void)
{
  test_host(NULL);
  test_host(backwards);
  for (int round = 0; round < 10; ++round)
  {
    test_host(apart);
  }
  return check_result();
}
