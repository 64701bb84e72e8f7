/* The best figures of all runs as text. */
#ifndef mlim_record_h
#define mlim_record_h

#include "measure.h"

#include <stdio.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bench_result
{
  const bench_case* one;
  bench_figures best; /* of each time the least, of the memory the most */
  int run_count;      /* 0: not run */
  int has_varied;     /* the runs did not give the same counts: they should */
} bench_result;

/* Takes the figures of one more run. */
void bench_result_add(bench_result* result, const bench_figures* figures);

/* Machine, versions, date and command, then the tables in Markdown. */
void bench_record_write(
  const bench_result* results, size_t count, const char* command, int thread_count, FILE* out);

#ifdef __cplusplus
}
#endif

#endif
