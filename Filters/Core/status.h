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
    pieces; /* 0: 32, which is enough where each is well below the tenth of a second in which a host
                    wants to cancel */
} mlim_stage_work;

mlim_status mlim_parallel_stage(mlim_context* context, const mlim_stage_work* work);

#endif
