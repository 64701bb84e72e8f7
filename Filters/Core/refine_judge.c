#include "refine_judge.h"

#include "status.h"

enum
{
  BATCH = 8192, /* facets judged between two looks at the host, about 3 ms */
  FEW = 512     /* facets that are not worth waking a thread for */
};

typedef struct judging
{
  mlim_refinement* refinement;
  const int32_t* records; /* NULL: all from record 1 on */
  signed char bins[BATCH];
} judging;

static int32_t record_of(const judging* j, size_t k)
{
  return j->records == NULL ? (int32_t)k + 1 : j->records[k];
}

static int is_wanted(const mlim_refinement* r, mlim_badness badness)
{
  return badness < (r->goal == MLIM_GOAL_TOPOLOGY ? MLIM_BAD_SIZE : MLIM_BAD_NONE);
}

/* Bin of a record; -1: it is not bad, or cannot be mended. Its verdict never changes by what is inserted
   round it: once is enough. */
static int bin_of(const mlim_refinement* r, mlim_facet* facet)
{
  if (!facet->is_alive || facet->is_judged)
  {
    return -1;
  }
  facet->is_judged = 1;
  const mlim_verdict verdict = mlim_criteria_judge(&r->complex, r->options, facet);
  facet->is_good = verdict.badness == MLIM_BAD_NONE && !verdict.has_ball;
  return is_wanted(r, verdict.badness) &&
             mlim_criteria_may_insert(&r->complex, r->options, facet, verdict.badness)
           ? mlim_queue_bin_of(verdict.badness, verdict.excess)
           : -1;
}

static void judge_body(void* data, size_t begin, size_t end)
{
  judging* j = (judging*)data;
  for (size_t k = begin; k < end; ++k)
  {
    mlim_facet* facet = &j->refinement->complex.facets[record_of(j, k)];
    j->bins[k % BATCH] = (signed char)bin_of(j->refinement, facet);
  }
}

static mlim_status push(void* data, size_t begin, size_t end, mlim_context* context)
{
  const judging* j = (const judging*)data;
  mlim_refinement* r = j->refinement;
  for (size_t k = begin; k < end; ++k)
  {
    const int bin = j->bins[k % BATCH];
    if (bin >= 0 && mlim_queue_push(&r->queue, bin, &r->complex, record_of(j, k)))
    {
      return mlim_fail_memory(context, "the queue of facets");
    }
  }
  return mlim_refine_report(r, context);
}

static mlim_status judge(
  mlim_refinement* r, const int32_t* records, size_t count, mlim_context* context)
{
  judging j = { .refinement = r, .records = records };
  return mlim_parallel_batches(context,
    &(mlim_batches){
      .count = count, .size = BATCH, .few = FEW, .body = judge_body, .finish = push, .job = &j });
}

mlim_status mlim_judge_fresh(mlim_refinement* refinement, mlim_context* context)
{
  mlim_complex* complex = &refinement->complex;
  const mlim_status status = judge(refinement, complex->fresh, complex->fresh_count, context);
  complex->fresh_count = 0;
  return status;
}

mlim_status mlim_judge_all(mlim_refinement* refinement, mlim_context* context)
{
  refinement->complex.fresh_count = 0;
  return judge(refinement, NULL, refinement->complex.facet_count - 1, context);
}
