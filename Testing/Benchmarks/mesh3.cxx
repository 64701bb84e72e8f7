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

#include <map>
#include <tuple>
#include <unordered_map>
#include <utility>

namespace
{

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using LabeledDomain = CGAL::Labeled_mesh_domain_3<Kernel>;

// Mesh_3 looks for its first points along some lines through the middle and refines only what they
// met: of eight balls it may see one. So this domain's first points are on the border of each label,
// found from inside.
class Domain : public LabeledDomain
{
public:
  Domain(const LabeledDomain& domain, std::vector<std::pair<Point, double>> rays)
    : LabeledDomain(domain), Rays(std::move(rays))
  {
  }

  struct Construct_initial_points
  {
    const Domain& Owner;

    template <typename Output>
    Output operator()(Output out, int = 0) const
    {
      const auto intersect = this->Owner.construct_intersection_object();
      for (const auto& ray : this->Owner.Rays)
      {
        for (int axis = 0; axis < 6; ++axis)
        {
          const double step = axis & 1 ? ray.second : -ray.second;
          const Kernel::Vector_3 along(
            axis / 2 == 0 ? step : 0, axis / 2 == 1 ? step : 0, axis / 2 == 2 ? step : 0);
          const auto hit = intersect(Kernel::Segment_3(ray.first, ray.first + along));
          if (std::get<2>(hit) == 2)
          {
            *out++ = std::make_pair(std::get<0>(hit), std::get<1>(hit));
          }
        }
      }
      return out;
    }
  };

  Construct_initial_points construct_initial_points_object() const { return { *this }; }

private:
  std::vector<std::pair<Point, double>> Rays; // a point inside a label, and the length of its rays
};
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

// Where the search of a crossing stops, as part of the box: our own tolerance is a millionth of the
// spacing, on boxes of some hundred spacings.
const double crossing_tolerance = 1e-8;

// Points of a coarse lattice, two a label, with rays that leave the box.
std::vector<std::pair<Point, double>> FindRays(const mlim_field* field, const double size[3])
{
  const int count = 24;
  const int rays_a_label = 2;
  std::map<int32_t, std::vector<Point>> found;
  for (int k = 0; k < count; ++k)
  {
    for (int j = 0; j < count; ++j)
    {
      for (int i = 0; i < count; ++i)
      {
        const double at[3] = { size[0] * (i + 0.5) / count, size[1] * (j + 0.5) / count,
          size[2] * (k + 0.5) / count };
        found[mlim_field_label(field, at)].emplace_back(at[0], at[1], at[2]);
      }
    }
  }
  found.erase(mlim_field_outside_label(field));
  std::vector<std::pair<Point, double>> rays;
  for (const auto& label : found)
  {
    for (int r = 1; r <= rays_a_label; ++r)
    {
      const size_t place = label.second.size() * static_cast<size_t>(r) / (rays_a_label + 1);
      rays.emplace_back(label.second[place], size[0] + size[1] + size[2]);
    }
  }
  return rays;
}

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
  const auto rays = FindRays(field, size);
  const double begin = bench_clock_user();
  const LabeledDomain labeled(Parameters::function = label, Parameters::bounding_object = box,
    Parameters::relative_error_bound = crossing_tolerance);
  const Domain domain(labeled, rays);
  const Criteria criteria(Parameters::facet_angle = c.FacetAngle,
    Parameters::facet_size = c.FacetSize, Parameters::facet_distance = c.FacetDistance,
    Parameters::cell_radius_edge_ratio = c.CellRadiusEdgeRatio, Parameters::cell_size = c.CellSize);
  const Complex complex =
    CGAL::make_mesh_3<Complex>(domain, criteria, Parameters::perturb(), Parameters::exude());
  *seconds = bench_clock_user() - begin;
  return Read(complex);
}
