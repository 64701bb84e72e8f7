/* CGAL Mesh_3 on a field of ours, for comparison: the same oracle and the same criteria. */
#ifndef mlim_mesh3_h
#define mlim_mesh3_h

extern "C" {
#include "mlim.h"
}

#include <cstddef>
#include <cstdint>
#include <vector>

/** Tetrahedra of the regions. */
struct bench_cells
{
  std::vector<double> Points;
  std::vector<int32_t> Cells; // 4 each
};

struct bench_mesh3_criteria
{
  double FacetAngle; // degrees
  double FacetSize;
  double FacetDistance;
  double CellSize;
  double CellRadiusEdgeRatio;
};

/** make_mesh_3 with its own perturbation and exudation, sequential. `seconds` of user time. */
bench_cells bench_mesh3(const mlim_field* field, const double size[3],
  const bench_mesh3_criteria& criteria, double* seconds);

#endif
