#include "bulk.h"

#include "clock.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Hidden_point_memory_policy.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>
#include <CGAL/version.h>

#include <cstdint>
#include <new>
#include <vector>

namespace
{

// The types of Filters/Delaunay/delaunay.cxx: both sides pay for the same vertices and cells.
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Weighted = Kernel::Weighted_point_3;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int32_t, Kernel,
  CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using CellBase = CGAL::Triangulation_cell_base_with_info_3<int32_t, Kernel,
  CGAL::Regular_triangulation_cell_base_3<Kernel, CGAL::Triangulation_cell_base_3<Kernel>,
    CGAL::Discard_hidden_points>>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Regular = CGAL::Regular_triangulation_3<Kernel, Structure>;

}

double bench_bulk_seconds(const double* xyzw, size_t count, int repeats)
{
  try
  {
    std::vector<Weighted> points;
    points.reserve(count);
    for (size_t p = 0; p < count; ++p)
    {
      const double* q = xyzw + 4 * p;
      points.emplace_back(Kernel::Point_3(q[0], q[1], q[2]), q[3]);
    }
    double least = -1.0;
    for (int r = 0; r < repeats; ++r)
    {
      Regular triangulation;
      const double begin = bench_clock_user();
      triangulation.insert(points.begin(), points.end());
      const double seconds = bench_clock_user() - begin;
      least = r == 0 || seconds < least ? seconds : least;
    }
    return least;
  }
  catch (const std::bad_alloc&)
  {
    return -1.0;
  }
}

const char* bench_bulk_version(void)
{
  return CGAL_VERSION_STR;
}
