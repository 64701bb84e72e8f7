#include "mesh3_run.h"

#include <tbb/global_control.h>

bench_mesh3_mesh bench_mesh3_parallel(
  const bench_mesh3_domain& domain, const bench_mesh3_criteria& criteria, int threads)
{
  const tbb::global_control limit(
    tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
  return Run<CGAL::Parallel_tag>(domain, criteria);
}
