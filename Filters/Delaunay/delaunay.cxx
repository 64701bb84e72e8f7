// The triangulation behind Core/delaunay.h, over CGAL's Regular_triangulation_3 (exact predicates,
// inexact constructions). The only file that includes CGAL. Points go in one at a time: a range
// insertion would reorder them.

extern "C" {
#include "delaunay.h"
#include "power_sphere.h"
#include "status.h"
}

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Hidden_point_memory_policy.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <memory>
#include <new>
#include <utility>
#include <vector>

namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Exact = CGAL::Exact_predicates_exact_constructions_kernel;
using Point = Kernel::Point_3;
using Weighted = Kernel::Weighted_point_3;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int32_t, Kernel,
  CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
struct CellInfo
{
  int32_t id; // MLIM_NO_CELL: beyond the far vertices
  mlim_power_sphere sphere;
};
using CellBase = CGAL::Triangulation_cell_base_with_info_3<CellInfo, Kernel,
  CGAL::Regular_triangulation_cell_base_3<Kernel, CGAL::Triangulation_cell_base_3<Kernel>,
    CGAL::Discard_hidden_points>>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Regular = CGAL::Regular_triangulation_3<Kernel, Structure>;
using CellHandle = Regular::Cell_handle;
using VertexHandle = Regular::Vertex_handle;
using Facet = Regular::Facet;

// CGAL's own insertion in two halves, without its point location.
class Triangulation : public Regular
{
  // One block at a time: CGAL's reserve leaves several half made when memory runs out.
  template <typename Container>
  static void Grow(Container& container, size_t count)
  {
    while (container.capacity() - container.size() < count)
    {
      container.reserve(container.capacity() + 1);
    }
  }

public:
  // Everything that the point conflicts with, from a cell that does. `test` says whether a cell does.
  template <typename Test>
  void Conflicts(CellHandle start, const Test& test, std::vector<Facet>& boundary,
    std::vector<CellHandle>& cells) const
  {
    Tr_Base::find_conflicts(start, test,
      CGAL::make_triple(
        std::back_inserter(boundary), std::back_inserter(cells), CGAL::Emptyset_iterator()));
  }

  bool IsInConflict(const Weighted& point, CellHandle cell) const
  {
    return this->in_conflict_3(point, cell);
  }

  // Undoes the marks of Conflicts, for a zone that is not filled.
  static void Forget(const std::vector<Facet>& boundary, const std::vector<CellHandle>& cells)
  {
    for (const Facet& f : boundary)
    {
      f.first->neighbor(f.second)->tds_data().clear();
    }
    for (CellHandle c : cells)
    {
      c->tds_data().clear();
    }
  }

  // Room for what an insertion makes. CGAL's insertion keeps a map between calls, one a thread; an
  // exception halfway would leave it half full, and the next insertion anywhere would crash.
  void Reserve(size_t vertices, size_t cells)
  {
    Grow(this->tds().vertices(), vertices);
    Grow(this->tds().cells(), cells);
  }

  VertexHandle Fill(
    const Weighted& point, const std::vector<Facet>& boundary, const std::vector<CellHandle>& cells)
  {
    this->Reserve(1, boundary.size());
    if (this->tds().is_small_hole(boundary.size()))
    {
      return this->_insert_in_small_hole(point, cells, boundary);
    }
    return this->_insert_in_hole(
      point, cells.begin(), cells.end(), boundary.back().first, boundary.back().second);
  }
};

// Weighted circumcentre of a flat cell.
void ExactCenter(CellHandle cell, double out[3])
{
  using ExactPoint = Exact::Weighted_point_3;
  auto exact = [cell](int k)
  {
    const Weighted& p = cell->vertex(k)->point();
    return ExactPoint(Exact::Point_3(p.x(), p.y(), p.z()), p.weight());
  };
  const Exact::Point_3 center =
    Exact().construct_weighted_circumcenter_3_object()(exact(0), exact(1), exact(2), exact(3));
  out[0] = CGAL::to_double(center.x());
  out[1] = CGAL::to_double(center.y());
  out[2] = CGAL::to_double(center.z());
}

// The centre is exact where the plain formula is not good enough; then the sphere decides nothing.
mlim_power_sphere PowerSphere(CellHandle cell)
{
  double points[4][3];
  double weights[4];
  for (int k = 0; k < 4; ++k)
  {
    const Weighted& p = cell->vertex(k)->point();
    points[k][0] = p.x();
    points[k][1] = p.y();
    points[k][2] = p.z();
    weights[k] = p.weight();
  }
  mlim_power_sphere sphere;
  if (!mlim_power_sphere_make(points, weights, &sphere))
  {
    ExactCenter(cell, sphere.center);
  }
  return sphere;
}

// A second point at a vertex's place would be hidden, or hide it; CGAL does not expect to be asked.
bool HasPoint(CellHandle cell, const Weighted& point)
{
  for (int k = 0; k < 4; ++k)
  {
    if (cell->vertex(k)->point().point() == point.point())
    {
      return true;
    }
  }
  return false;
}

// Runs a function; no exception leaves it.
template <typename Function>
mlim_status Guard(mlim_context* context, Function&& function)
{
  try
  {
    return function();
  }
  catch (const std::bad_alloc&)
  {
    return mlim_fail(
      context, MLIM_OUT_OF_MEMORY, "There is not enough memory for the triangulation.");
  }
  catch (const std::exception& error)
  {
    return mlim_fail(context, MLIM_INTERNAL, "The triangulation failed: %s", error.what());
  }
  catch (...)
  {
    return mlim_fail(context, MLIM_INTERNAL, "The triangulation failed.");
  }
}
}

struct mlim_delaunay
{
  Triangulation triangulation;
  std::vector<CellHandle> cells; // by id; stale where the id is free
  std::vector<int32_t> free;     // ids, last in first out
  int32_t vertex_count = 0;
  VertexHandle last; // inserted: what is asked for next is often near
  double far[MLIM_FAR_VERTICES][3];

  // The zone of the last find.
  Weighted point;
  std::vector<Facet> boundary;
  std::vector<CellHandle> zone;
  bool has_zone = false;
  std::vector<uint32_t> kept; // a vertex: the last stamp with which it was seen on a boundary
  uint32_t stamp = 0;

  // What the C side borrows.
  std::vector<int32_t> dead;
  std::vector<mlim_delaunay_cell> made;
  std::vector<std::pair<CellHandle, int>> outer;

  void TakeId(CellHandle cell)
  {
    if (this->free.empty())
    {
      cell->info().id = static_cast<int32_t>(this->cells.size());
      this->cells.push_back(cell);
    }
    else
    {
      cell->info().id = this->free.back();
      this->free.pop_back();
      this->cells[static_cast<size_t>(cell->info().id)] = cell;
    }
    mlim_power_sphere_clear(&cell->info().sphere);
  }

  // The sphere decides if it can, else exact arithmetic.
  bool IsInConflict(CellHandle cell) const
  {
    const double at[3] = { this->point.x(), this->point.y(), this->point.z() };
    const int side = mlim_power_sphere_side(&cell->info().sphere, at, this->point.weight());
    return side == 0 ? this->triangulation.IsInConflict(this->point, cell) : side < 0;
  }

  mlim_delaunay_cell Describe(CellHandle cell)
  {
    mlim_delaunay_cell out;
    out.id = cell->info().id;
    cell->info().sphere = PowerSphere(cell);
    std::copy_n(cell->info().sphere.center, 3, out.center);
    for (int k = 0; k < 4; ++k)
    {
      out.vertices[k] = cell->vertex(k)->info();
      CellHandle n = cell->neighbor(k);
      out.neighbors[k] = this->triangulation.is_infinite(n) ? MLIM_NO_CELL : n->info().id;
    }
    return out;
  }

  // A vertex of dead cells that is on no boundary facet would vanish.
  bool HidesVertex()
  {
    this->kept.resize(static_cast<size_t>(this->vertex_count), 0);
    ++this->stamp;
    for (const Facet& f : this->boundary)
    {
      for (int k = 1; k < 4; ++k)
      {
        this->kept[static_cast<size_t>(f.first->vertex((f.second + k) & 3)->info())] = this->stamp;
      }
    }
    for (CellHandle c : this->zone)
    {
      for (int k = 0; k < 4; ++k)
      {
        if (this->kept[static_cast<size_t>(c->vertex(k)->info())] != this->stamp)
        {
          return true;
        }
      }
    }
    return false;
  }

  void Drop()
  {
    if (this->has_zone)
    {
      Triangulation::Forget(this->boundary, this->zone);
    }
    this->has_zone = false;
    this->boundary.clear();
    this->zone.clear();
    this->dead.clear();
  }

  void Start(const double size[3])
  {
    // Far enough that no facet of the mesh can see them after the first insertions, near enough not
    // to cost digits; off the cube's corners, since eight points on a sphere are a degenerate start.
    const double largest = std::max(size[0], std::max(size[1], size[2]));
    this->triangulation.Reserve(MLIM_FAR_VERTICES, 64);
    for (int k = 0; k < MLIM_FAR_VERTICES; ++k)
    {
      const double off = 0.0078125 * k;
      const double sign[3] = { k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0 };
      const double shift[3] = { off, -0.75 * off, off * off * 3 };
      for (int a = 0; a < 3; ++a)
      {
        this->far[k][a] = 0.5 * size[a] + largest * (3 * sign[a] + shift[a]);
      }
      VertexHandle v = this->triangulation.insert(
        Weighted(Point(this->far[k][0], this->far[k][1], this->far[k][2]), 0));
      v->info() = this->vertex_count++;
      this->last = v;
    }
    for (CellHandle c : this->triangulation.all_cell_handles())
    {
      c->info().id = MLIM_NO_CELL;
      mlim_power_sphere_clear(&c->info().sphere);
    }
    for (CellHandle c : this->triangulation.finite_cell_handles())
    {
      this->TakeId(c);
    }
  }
};

mlim_status mlim_delaunay_create(const double size[3], mlim_context* context, mlim_delaunay** out)
{
  *out = nullptr;
  return Guard(context,
    [&]
    {
      auto made = std::make_unique<mlim_delaunay>();
      made->Start(size);
      *out = made.release();
      return MLIM_OK;
    });
}

void mlim_delaunay_free(mlim_delaunay* delaunay)
{
  delete delaunay;
}

void mlim_delaunay_far_vertex(const mlim_delaunay* delaunay, int32_t vertex, double out[3])
{
  std::copy_n(delaunay->far[vertex], 3, out);
}

mlim_status mlim_delaunay_all(
  mlim_delaunay* delaunay, mlim_context* context, mlim_delaunay_cells* out)
{
  *out = {};
  return Guard(context,
    [&]
    {
      std::vector<bool> is_free(delaunay->cells.size());
      for (int32_t id : delaunay->free)
      {
        is_free[static_cast<size_t>(id)] = true;
      }
      delaunay->made.clear();
      for (size_t id = 0; id < delaunay->cells.size(); ++id)
      {
        if (!is_free[id])
        {
          delaunay->made.push_back(delaunay->Describe(delaunay->cells[id]));
        }
      }
      *out = { delaunay->made.size(), delaunay->made.data() };
      return MLIM_OK;
    });
}

mlim_status mlim_delaunay_find(mlim_delaunay* delaunay, const double point[3], double weight,
  int32_t start, mlim_delaunay_start kind, mlim_context* context, mlim_delaunay_zone* out)
{
  *out = {};
  return Guard(context,
    [&]
    {
      delaunay->Drop();
      Triangulation& t = delaunay->triangulation;
      delaunay->point = Weighted(Point(point[0], point[1], point[2]), weight);
      CellHandle from = start == MLIM_NO_CELL ? delaunay->last->cell()
                                              : delaunay->cells[static_cast<size_t>(start)];
      if (kind == MLIM_START_NEAR)
      {
        Regular::Locate_type type;
        int i;
        int j;
        from = t.locate(delaunay->point, type, i, j, from);
      }
      if (from == CellHandle() || t.is_infinite(from) || HasPoint(from, delaunay->point) ||
          !delaunay->IsInConflict(from))
      {
        return MLIM_OK;
      }
      delaunay->has_zone = true;
      t.Conflicts(
        from, [delaunay](CellHandle c) { return delaunay->IsInConflict(c); }, delaunay->boundary,
        delaunay->zone);
      const bool is_out = std::any_of(delaunay->zone.begin(), delaunay->zone.end(),
        [&t](CellHandle c) { return t.is_infinite(c); });
      if (is_out || (weight > 0 && delaunay->HidesVertex()))
      {
        delaunay->Drop();
        return MLIM_OK;
      }
      for (CellHandle c : delaunay->zone)
      {
        delaunay->dead.push_back(c->info().id);
      }
      *out = { delaunay->dead.size(), delaunay->dead.data() };
      return MLIM_OK;
    });
}

mlim_status mlim_delaunay_fill(
  mlim_delaunay* delaunay, mlim_context* context, mlim_delaunay_cells* out)
{
  if (out != nullptr)
  {
    *out = {};
  }
  if (!delaunay->has_zone)
  {
    return mlim_fail(context, MLIM_INTERNAL, "A point was inserted without its zone.");
  }
  return Guard(context,
    [&]
    {
      delaunay->outer.clear();
      for (const Facet& f : delaunay->boundary)
      {
        CellHandle o = f.first->neighbor(f.second);
        delaunay->outer.emplace_back(o, o->index(f.first));
      }
      delaunay->made.clear();
      delaunay->made.reserve(delaunay->outer.size());
      delaunay->free.insert(delaunay->free.end(), delaunay->dead.rbegin(), delaunay->dead.rend());
      delaunay->has_zone = false;
      VertexHandle v =
        delaunay->triangulation.Fill(delaunay->point, delaunay->boundary, delaunay->zone);
      v->info() = delaunay->vertex_count++;
      delaunay->last = v;
      for (const auto& o : delaunay->outer)
      {
        delaunay->TakeId(o.first->neighbor(o.second));
      }
      for (const auto& o : delaunay->outer)
      {
        if (out != nullptr)
        {
          delaunay->made.push_back(delaunay->Describe(o.first->neighbor(o.second)));
        }
      }
      delaunay->boundary.clear();
      delaunay->zone.clear();
      delaunay->dead.clear();
      if (out != nullptr)
      {
        *out = { delaunay->made.size(), delaunay->made.data() };
      }
      return MLIM_OK;
    });
}
