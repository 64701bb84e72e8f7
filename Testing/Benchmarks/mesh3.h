/* CGAL Mesh_3 on a field of ours, for comparison: the same oracle, the same criteria and, where there
   are any, the same curves. */
#ifndef mlim_mesh3_h
#define mlim_mesh3_h

#include <cstddef>
#include <cstdint>
#include <vector>

/** A point on the border between two labels. */
struct bench_border
{
  double Point[3];
  int32_t Labels[2]; // as the domain's function names them
};

/** What is meshed. */
struct bench_mesh3_domain
{
  int32_t (*Label)(const void* field, const double point[3]); // 0: outside
  const void* Field;                                          // borrowed
  double Size[3];
  std::vector<bench_border> Borders;       // first points
  std::vector<std::vector<double>> Curves; // polylines of 3 numbers a point; loops repeat the first
};

struct bench_mesh3_criteria
{
  double FacetAngle; // degrees
  double FacetSize;
  double FacetDistance;
  double EdgeSize;    // of the curves
  double MinEdgeSize; // of the curves: no ball is made smaller
  double CellSize;    // 0: the surface alone
  double CellRadiusEdgeRatio;
};

struct bench_mesh3_mesh
{
  std::vector<double> Points; // of the cells
  std::vector<int32_t> Cells; // 4 each; none of a surface alone
  size_t Vertices;            // of the surface
  size_t Triangles;
  size_t Balls;
  double UserSeconds;
  double WallSeconds;
};

/** How many balls protect the curves; the facets are not looked at. */
size_t bench_mesh3_balls(const bench_mesh3_domain& domain, const bench_mesh3_criteria& criteria);

/** Sequential_tag; a volume is perturbed and exuded. */
bench_mesh3_mesh bench_mesh3(
  const bench_mesh3_domain& domain, const bench_mesh3_criteria& criteria);

/** Parallel_tag on so many threads. */
__attribute__((visibility("default"))) bench_mesh3_mesh bench_mesh3_parallel(
  const bench_mesh3_domain& domain, const bench_mesh3_criteria& criteria, int threads);

#endif
