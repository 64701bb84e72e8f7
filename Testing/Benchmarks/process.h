/* Work in a process of its own: neither the heap nor the peak of one run shows in another's, and one
   that does not end is ended. */
#ifndef mlim_process_h
#define mlim_process_h

#include "image.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Fills `out`, a plain struct without pointers. */
typedef void (*bench_work)(const void* job, void* out);

/* Runs the work in a child, and copies `size` bytes of its `out` here. After so many seconds (0: never)
   the child is ended. Not 0: there is no result, and `message` says why. */
int bench_process_run(bench_work work, const void* job, unsigned seconds, size_t size, void* out,
  char message[BENCH_MESSAGE_SIZE]);

#ifdef __cplusplus
}
#endif

#endif
