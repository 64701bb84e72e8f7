#include "refine_judge.h"

#include "status.h"
#include "vector.h"

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

typedef struct judgement
{
  int bin; /* -1: the facet is not bad, or cannot be mended */
  unsigned char is_good;
} judgement;

/* The verdict never changes by what is inserted round the facet: once is enough. */
static judgement judge_apart(const mlim_refinement* r, const mlim_facet* facet,
  const mlim_vertex* vertices, const int32_t ids[3])
{
  const mlim_vertex* const corners[3] = { &vertices[ids[0]], &vertices[ids[1]], &vertices[ids[2]] };
  const mlim_badness end = r->goal == MLIM_GOAL_TOPOLOGY ? MLIM_BAD_SIZE : MLIM_BAD_NONE;
  int is_allowed;
  const mlim_verdict verdict =
    mlim_criteria_judge_apart(&r->complex, r->options, facet, corners, end, &is_allowed);
  return (judgement){ .bin = is_allowed ? mlim_queue_bin_of(verdict.badness, verdict.excess) : -1,
    .is_good = verdict.badness == MLIM_BAD_NONE && !verdict.has_ball };
}

static int bin_of(const mlim_refinement* r, mlim_facet* facet)
{
  if (!facet->is_alive || facet->is_judged)
  {
    return -1;
  }
  int32_t ids[3];
  facet->is_judged = 1;
  mlim_complex_facet_vertices(&r->complex, facet->cell, facet->index, ids);
  const judgement found = judge_apart(r, facet, r->complex.vertices, ids);
  facet->is_good = found.is_good & 1;
  return found.bin;
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

void mlim_judge_duals(const mlim_refinement* refinement, size_t part)
{
  const mlim_records* records = &refinement->records;
  const mlim_duals duals = mlim_records_duals(records, part);
  for (size_t k = 0; k < duals.count; ++k)
  {
    mlim_dual* dual = &duals.all[k];
    mlim_facet facet = { .sheet = dual->sheet, .is_multiple = dual->is_multiple };
    mlim_copy(dual->crossing, facet.crossing);
    if (dual->crosses)
    {
      const judgement found = judge_apart(refinement, &facet, records->vertices, dual->vertices);
      dual->bin = (signed char)found.bin;
      dual->is_good = found.is_good;
    }
  }
}

mlim_status mlim_judge_settled(mlim_refinement* refinement, mlim_context* context)
{
  mlim_refinement* r = refinement;
  for (size_t p = 0; p < r->records.part_count; ++p)
  {
    const mlim_duals duals = mlim_records_duals(&r->records, p);
    for (size_t k = 0; k < duals.count; ++k)
    {
      const mlim_dual* dual = &duals.all[k];
      if (dual->record == 0)
      {
        continue;
      }
      mlim_facet* facet = &r->complex.facets[dual->record];
      facet->is_judged = 1;
      facet->is_good = dual->is_good & 1;
      if (dual->bin >= 0 && mlim_queue_push(&r->queue, dual->bin, &r->complex, dual->record))
      {
        return mlim_fail_memory(context, "the queue of facets");
      }
    }
  }
  return MLIM_OK;
}
