/* What was measured of surfaces, and what of it the targets of the product ask for. */
#ifndef mlim_surface_tables_h
#define mlim_surface_tables_h

#include "record.h"
#include "surface.h"

#include <cstdio>
#include <vector>

struct bench_surface_row
{
  const char* Scene; // a case's name
  int Aim;           // vertices, about
  double FacetSize;  // in the smallest spacing
};

struct bench_surface_result
{
  bench_surface_row Row;
  bench_result Ours;
  double OurWall[2]; // seconds of the whole core on one thread and on two; 0: not run
  bench_surface_figures SameBounds; // Parallel_tag on one thread
  double SizeScale;                 // of the bounds that the following had
  bench_surface_figures Sequential;
  bench_surface_figures OneThread;
  bench_surface_figures TwoThreads;
};

/** The tables in Markdown. */
void bench_surface_write(const std::vector<bench_surface_result>& results, FILE* out);

#endif
