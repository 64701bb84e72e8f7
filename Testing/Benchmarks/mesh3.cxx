#include "mesh3.h"

extern "C" {
#include "clock.h"
}

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <unordered_map>

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Where the search of a crossing stops, as part of the box: our own tolerance is a millionth of the
// spacing, on boxes of some hundred spacings.
const double crossing_tolerance = 1e-8;

bench_cells Read(const Complex& complex)
{
  bench_cells out;
  std::unordered_map<const void*, int32_t> ids;
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell)
  {
    for (int k = 0; k < 4; ++k)
    {
      const auto vertex = cell->vertex(k);
      const auto found = ids.emplace(&*vertex, static_cast<int32_t>(ids.size()));
      if (found.second)
      {
        const Point& p = vertex->point().point();
        out.Points.insert(out.Points.end(), { p.x(), p.y(), p.z() });
      }
      out.Cells.push_back(found.first->second);
    }
  }
  return out;
}

}

bench_cells bench_mesh3(
  const mlim_field* field, const double size[3], const bench_mesh3_criteria& c, double* seconds)
{
  namespace Parameters = CGAL::parameters;
  const int32_t outside = mlim_field_outside_label(field);
  auto label = [field, outside](const Point& p)
  {
    const double at[3] = { p.x(), p.y(), p.z() };
    const int32_t found = mlim_field_label(field, at);
    return found == outside ? 0 : found + 1;
  };
  // A little larger than the box, so that regions that reach it end inside.
  const double rim = 0.01 * (size[0] + size[1] + size[2]);
  const CGAL::Bbox_3 box(-rim, -rim, -rim, size[0] + rim, size[1] + rim, size[2] + rim);
  const double begin = bench_clock_user();
  Domain domain(Parameters::function = label, Parameters::bounding_object = box,
    Parameters::relative_error_bound = crossing_tolerance);
  const Criteria criteria(Parameters::facet_angle = c.FacetAngle,
    Parameters::facet_size = c.FacetSize, Parameters::facet_distance = c.FacetDistance,
    Parameters::cell_radius_edge_ratio = c.CellRadiusEdgeRatio, Parameters::cell_size = c.CellSize);
  const Complex complex =
    CGAL::make_mesh_3<Complex>(domain, criteria, Parameters::perturb(), Parameters::exude());
  *seconds = bench_clock_user() - begin;
  return Read(complex);
}
