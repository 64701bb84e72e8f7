/* One run of a case through the whole core, in a process of its own. */
#ifndef mlim_measure_h
#define mlim_measure_h

#include "cases.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bench_demand
{
  const bench_case* one;
  double facet_size;   /* in the smallest spacing; 0: the default */
  int has_bounds_only; /* not 0: without volume_tolerance, which other meshers do not have */
  int thread_count;    /* 0: the core runs without a host's parallel-for */
} bench_demand;

typedef struct bench_figures
{
  int has_failed;
  char message[BENCH_MESSAGE_SIZE]; /* why; or, without a failure, a remark; else empty */
  double facet_size;                /* in the smallest spacing */
  size_t vertex_count;
  size_t triangle_count;
  size_t insertion_count;
  size_t curve_count;
  size_t ball_count;
  size_t unweighted_count;     /* vertices on curves that are no ball's centre */
  double user[MLIM_STAGE_END]; /* seconds of user CPU time of each stage */
  double total_user;
  double total_wall;
  double bulk;              /* seconds of user CPU time */
  size_t input_memory;      /* bytes of the process with the image read */
  size_t peak_memory;       /* the most at any time from there on */
  size_t refinement_memory; /* what the surface's stage adds at most */
} bench_figures;

/* The default options but for what is demanded. */
mlim_status bench_options(const mlim_grid* grid, const mlim_field* field,
  const bench_demand* demand, mlim_context* context, mlim_options* out);

/* Runs the case once, and the bulk insertion of the points that came out. */
void bench_measure(const bench_demand* demand, const char* folder, bench_figures* out);

#ifdef __cplusplus
}
#endif

#endif
