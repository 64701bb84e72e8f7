#include "mesh3_run.h"

size_t bench_mesh3_balls(const bench_mesh3_domain& given, const bench_mesh3_criteria& criteria)
{
  ComplexOf<CGAL::Sequential_tag> complex;
  Protect(MakeDomain(given), criteria, &complex);
  return complex.triangulation().number_of_vertices();
}

bench_mesh3_mesh bench_mesh3(const bench_mesh3_domain& domain, const bench_mesh3_criteria& criteria)
{
  return Run<CGAL::Sequential_tag>(domain, criteria);
}
