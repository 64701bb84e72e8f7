/* Statuses, the sentence that goes with them, and the host's two services. */
#ifndef mlim_status_h
#define mlim_status_h

#include "mlim.h"

/* Writes the sentence into the context (which may be NULL) and returns the status. */
#if defined(__GNUC__)
__attribute__((format(printf, 3, 4)))
#endif
mlim_status
mlim_fail(mlim_context* context, mlim_status status, const char* format, ...);

/* mlim_fail for a failed allocation of `what`. */
mlim_status mlim_fail_memory(mlim_context* context, const char* what);

/* Reports progress. MLIM_CANCELLED when the host asks to stop. */
mlim_status mlim_progress(mlim_context* context, mlim_stage stage, double fraction);

/* Runs body on [0, count), through the host's parallel-for if there is one. */
void mlim_parallel_for(mlim_context* context, size_t count, mlim_body body, void* job);

/* The same in pieces, with progress from `from` to `to` between them, so that the host can cancel.
   `begin` and `end` of the body count from 0 over all pieces: the job needs no knowledge of them. */
typedef struct mlim_stage_work
{
  size_t count;
  mlim_body body;
  void* job;
  mlim_stage stage;
  double from, to;
  size_t
    step; /* items of a piece, which have to take less than a tenth of a second; 0: a 32nd of all */
} mlim_stage_work;

mlim_status mlim_parallel_stage(mlim_context* context, const mlim_stage_work* work);

/* Sum of count(job, begin, end) over blocks of `block` of the `item_count` items. `done` is reported as the
   share of the stage. */
typedef struct mlim_counting
{
  size_t item_count, block;
  size_t (*count)(const void* job, size_t begin, size_t end);
  const void* job;
  mlim_stage stage;
  double done;
} mlim_counting;

mlim_status mlim_parallel_count(mlim_context* context, const mlim_counting* counting, size_t* out);

/* What has to be done in order is prepared in parallel: body runs on a batch of at most `size` of the
   `count` items, `finish` then on the same, on this thread, before the next batch. Both count from 0 over
   all. A batch of no more than `few` items is not shared among threads. A finish that fails ends it. */
typedef struct mlim_batches
{
  size_t count, size, few;
  mlim_body body;
  mlim_status (*finish)(void* job, size_t begin, size_t end, mlim_context* context);
  void* job;
} mlim_batches;

mlim_status mlim_parallel_batches(mlim_context* context, const mlim_batches* batches);

#endif
