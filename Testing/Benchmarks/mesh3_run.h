/* Mesh_3 with either tag. Each tag is compiled in a file of its own: CGAL's classes differ where TBB
   is linked. */
#ifndef mlim_mesh3_run_h
#define mlim_mesh3_run_h

#include "mesh3.h"

#include "clock.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <set>
#include <unordered_map>
#include <utility>

namespace
{

namespace Parameters = CGAL::parameters;

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Labeled = CGAL::Labeled_mesh_domain_3<Kernel>;
using Domain = CGAL::Mesh_domain_with_polyline_features_3<Labeled>;

// Where the search of a crossing stops, as part of the box: our own tolerance is a millionth of the
// spacing, on boxes of some hundred spacings.
const double crossing_tolerance = 1e-8;

Domain MakeDomain(const bench_mesh3_domain& given)
{
  auto label = [&given](const Point& p)
  {
    const double at[3] = { p.x(), p.y(), p.z() };
    return given.Label(given.Field, at);
  };
  // A little larger than the box, so that regions that reach it end inside.
  const double* size = given.Size;
  const double rim = 0.01 * (size[0] + size[1] + size[2]);
  const CGAL::Bbox_3 box(-rim, -rim, -rim, size[0] + rim, size[1] + rim, size[2] + rim);
  const Labeled labeled(Parameters::function = label, Parameters::bounding_object = box,
    Parameters::relative_error_bound = crossing_tolerance);
  Domain domain(labeled);
  std::vector<std::vector<Point>> curves;
  for (const std::vector<double>& curve : given.Curves)
  {
    curves.emplace_back();
    for (size_t p = 0; p + 2 < curve.size(); p += 3)
    {
      curves.back().emplace_back(curve[p], curve[p + 1], curve[p + 2]);
    }
  }
  domain.add_features(curves.begin(), curves.end());
  return domain;
}

// The size of the edges is the same everywhere.
struct EdgeSize
{
  double Size;
  template <typename Index>
  double operator()(const Point&, int, const Index&) const
  {
    return this->Size;
  }
};

// As make_mesh_3 does, which stops at balls of size 0 only, and takes first points off the curves only
// where there is no curve.
template <typename Complex>
void Protect(const Domain& domain, const bench_mesh3_criteria& c, Complex* complex)
{
  CGAL::Mesh_3::Protect_edges_sizing_field<Complex, Domain, EdgeSize> protect(
    *complex, domain, EdgeSize{ c.EdgeSize }, c.MinEdgeSize);
  protect(true);
}

// Mesh_3 looks for its first points along some lines through the middle and refines only what they
// met: of eight balls it may see one.
template <typename Complex>
void InsertBorders(const Domain& domain, const std::vector<bench_border>& borders, Complex* complex)
{
  const auto weighted = complex->triangulation().geom_traits().construct_weighted_point_3_object();
  for (const bench_border& border : borders)
  {
    const double* p = border.Point;
    const auto vertex = complex->triangulation().insert(weighted(Point(p[0], p[1], p[2])));
    // None: the point is inside a ball.
    if (vertex != typename Complex::Vertex_handle())
    {
      complex->set_dimension(vertex, 2);
      complex->set_index(vertex,
        domain.index_from_surface_patch_index(std::minmax(border.Labels[0], border.Labels[1])));
    }
  }
}

template <typename Complex>
void CountSurface(const Complex& complex, bench_mesh3_mesh* out)
{
  std::set<const void*> vertices;
  for (auto facet = complex.facets_in_complex_begin(); facet != complex.facets_in_complex_end();
       ++facet)
  {
    for (int k = 1; k < 4; ++k)
    {
      vertices.insert(&*facet->first->vertex((facet->second + k) % 4));
    }
  }
  out->Vertices = vertices.size();
  out->Triangles = complex.number_of_facets_in_complex();
  out->Balls = 0;
  const auto& triangulation = complex.triangulation();
  for (auto vertex = triangulation.finite_vertices_begin();
       vertex != triangulation.finite_vertices_end(); ++vertex)
  {
    // Points far outside, which Parallel_tag adds, have the dimension -1.
    out->Balls += vertex->in_dimension() == 0 || vertex->in_dimension() == 1;
  }
}

template <typename Complex>
void ReadCells(const Complex& complex, bench_mesh3_mesh* out)
{
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
        out->Points.insert(out->Points.end(), { p.x(), p.y(), p.z() });
      }
      out->Cells.push_back(found.first->second);
    }
  }
}

template <typename Tag>
using TriangulationOf = typename CGAL::Mesh_triangulation_3<Domain, CGAL::Default, Tag>::type;
template <typename Tag>
using ComplexOf = CGAL::Mesh_complex_3_in_triangulation_3<TriangulationOf<Tag>,
  Domain::Corner_index, Domain::Curve_index>;

template <typename Tag>
bench_mesh3_mesh Run(const bench_mesh3_domain& given, const bench_mesh3_criteria& c)
{
  using Criteria = CGAL::Mesh_criteria_3<TriangulationOf<Tag>>;

  const bool isVolume = c.CellSize > 0;
  const double user = bench_clock_user();
  const double wall = bench_clock_wall();
  const Domain domain = MakeDomain(given);
  const Criteria criteria(Parameters::facet_angle = c.FacetAngle,
    Parameters::facet_size = c.FacetSize, Parameters::facet_distance = c.FacetDistance,
    Parameters::cell_radius_edge_ratio = isVolume ? c.CellRadiusEdgeRatio : 0,
    Parameters::cell_size = c.CellSize);
  ComplexOf<Tag> complex;
  if (!given.Curves.empty())
  {
    Protect(domain, c, &complex);
  }
  InsertBorders(domain, given.Borders, &complex);
  CGAL::refine_mesh_3(complex, domain, criteria,
    isVolume ? Parameters::perturb() : Parameters::no_perturb(),
    isVolume ? Parameters::exude() : Parameters::no_exude());
  bench_mesh3_mesh out = {};
  out.UserSeconds = bench_clock_user() - user;
  out.WallSeconds = bench_clock_wall() - wall;
  CountSurface(complex, &out);
  if (isVolume)
  {
    ReadCells(complex, &out);
  }
  return out;
}

}

#endif
