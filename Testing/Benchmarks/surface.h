/* The surface of one case by Mesh_3, in a process of its own. */
#ifndef mlim_surface_h
#define mlim_surface_h

#include "measure.h"

/** Who makes the surface. */
enum class bench_mesher
{
  Sequential,
  OneThread, // Parallel_tag
  TwoThreads
};

struct bench_surface_demand
{
  bench_demand Ours;   // what our own run of the case gets
  double SizeScale;    // of facet size, distance and edge size; 1: the same bounds
  unsigned MaxSeconds; // a run that takes longer is given up
};

struct bench_surface_figures
{
  bool HasFailed;
  char Message[BENCH_MESSAGE_SIZE]; // why
  size_t Vertices;
  size_t Triangles;
  size_t Balls;
  double UserSeconds;
  double WallSeconds;
};

/** Field, curves and first points are made before the clock starts. */
bench_surface_figures bench_surface_run(
  const bench_surface_demand& demand, bench_mesher mesher, const char* folder);

#endif
