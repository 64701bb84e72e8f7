/* VTK's threads as the core's parallel-for, as the filters hand them to it. */
#ifndef mlim_threads_h
#define mlim_threads_h

#include "mlim.h"

#ifdef __cplusplus
extern "C" {
#endif

/* How many threads there are; before the first use. */
void bench_threads_set(int count);

/* As mlim_context has it. */
void bench_threads_for(void* user, size_t count, mlim_body body, void* job);

#ifdef __cplusplus
}
#endif

#endif
