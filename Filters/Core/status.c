#include "status.h"

#include "memory.h"

#include <stdarg.h>
#include <stdio.h>

const char* mlim_status_text(mlim_status status)
{
  switch (status)
  {
    case MLIM_OK:
      return "success";
    case MLIM_INVALID_ARGUMENT:
      return "an input or an option is out of range";
    case MLIM_OUT_OF_MEMORY:
      return "out of memory";
    case MLIM_CANCELLED:
      return "cancelled";
    case MLIM_VERTEX_LIMIT:
      return "the vertex limit is reached";
    case MLIM_INTERNAL:
      return "internal error";
    case MLIM_STATUS_END:
      break;
  }
  return "unknown status";
}

const char* mlim_stage_text(mlim_stage stage)
{
  switch (stage)
  {
    case MLIM_STAGE_INDICATORS:
      return "Making indicators of the labels";
    case MLIM_STAGE_FIELD:
      return "Indexing the indicator field";
    case MLIM_STAGE_CURVES:
      return "Extracting curves";
    case MLIM_STAGE_BALLS:
      return "Protecting curves";
    case MLIM_STAGE_SURFACE:
      return "Refining the interface";
    case MLIM_STAGE_CERTIFICATE:
      return "Checking the mesh";
    case MLIM_STAGE_VOLUME:
      return "Filling the regions";
    case MLIM_STAGE_END:
      break;
  }
  return "unknown stage";
}

mlim_status mlim_fail(mlim_context* context, mlim_status status, const char* format, ...)
{
  if (context != NULL)
  {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(context->message, sizeof context->message, format, arguments);
    va_end(arguments);
  }
  return status;
}

mlim_status mlim_fail_memory(mlim_context* context, const char* what)
{
  return mlim_fail(context, MLIM_OUT_OF_MEMORY, "There is not enough memory for %s.", what);
}

mlim_status mlim_progress(mlim_context* context, mlim_stage stage, double fraction)
{
  if (context == NULL || context->progress == NULL ||
      context->progress(context->user, stage, fraction) == 0)
  {
    return MLIM_OK;
  }
  return mlim_fail(context, MLIM_CANCELLED, "Cancelled by the host.");
}

void mlim_parallel_for(mlim_context* context, size_t count, mlim_body body, void* job)
{
  if (count == 0)
  {
    return;
  }
  if (context != NULL && context->parallel_for != NULL)
  {
    context->parallel_for(context->user, count, body, job);
    return;
  }
  body(job, 0, count);
}

typedef struct piece
{
  mlim_body body;
  void* job;
  size_t first;
} piece;

static void piece_body(void* data, size_t begin, size_t end)
{
  const piece* p = (const piece*)data;
  p->body(p->job, p->first + begin, p->first + end);
}

mlim_status mlim_parallel_stage(mlim_context* context, const mlim_stage_work* work)
{
  enum
  {
    PIECES = 32
  };
  const size_t step = work->step > 0 ? work->step : work->count / PIECES + 1;
  mlim_status status = mlim_progress(context, work->stage, work->from);
  for (size_t first = 0; first < work->count && status == MLIM_OK; first += step)
  {
    const size_t count = work->count - first < step ? work->count - first : step;
    mlim_parallel_for(
      context, count, piece_body, &(piece){ .body = work->body, .job = work->job, .first = first });
    const double share = (double)(first + count) / (double)work->count;
    status = mlim_progress(context, work->stage, work->from + share * (work->to - work->from));
  }
  return status;
}

mlim_status mlim_parallel_batches(mlim_context* context, const mlim_batches* batches)
{
  const mlim_batches* b = batches;
  mlim_status status = MLIM_OK;
  for (size_t first = 0; first < b->count && status == MLIM_OK; first += b->size)
  {
    const size_t count = b->count - first < b->size ? b->count - first : b->size;
    mlim_parallel_for(count > b->few ? context : NULL, count, piece_body,
      &(piece){ .body = b->body, .job = b->job, .first = first });
    status = b->finish(b->job, first, first + count, context);
  }
  return status;
}

typedef struct count_job
{
  const mlim_counting* counting;
  size_t* counts; /* of each block */
} count_job;

static void count_body(void* data, size_t begin, size_t end)
{
  const count_job* job = (const count_job*)data;
  const mlim_counting* c = job->counting;
  for (size_t b = begin; b < end; ++b)
  {
    const size_t first = b * c->block;
    const size_t last = c->item_count - first < c->block ? c->item_count : first + c->block;
    job->counts[b] = c->count(c->job, first, last);
  }
}

mlim_status mlim_parallel_count(mlim_context* context, const mlim_counting* counting, size_t* out)
{
  enum
  {
    BLOCKS_A_PIECE = 16
  };
  *out = 0;
  const size_t blocks = (counting->item_count + counting->block - 1) / counting->block;
  count_job job = { .counting = counting, .counts = mlim_allocate(blocks, sizeof *job.counts) };
  if (job.counts == NULL)
  {
    return mlim_fail_memory(context, "counting");
  }
  const mlim_status status = mlim_parallel_stage(context, &(mlim_stage_work){ .count = blocks,
                                                            .body = count_body,
                                                            .job = &job,
                                                            .stage = counting->stage,
                                                            .from = counting->done,
                                                            .to = counting->done,
                                                            .step = BLOCKS_A_PIECE });
  for (size_t b = 0; b < blocks && status == MLIM_OK; ++b)
  {
    *out += job.counts[b];
  }
  mlim_release(job.counts);
  return status;
}
