// The same weighted points in CGAL's own Regular_triangulation_3: the same cells. Weighted Delaunay
// triangulations of points in general position are unique.

extern "C" {
#include "check.h"
#include "delaunay.h"
}

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Regular_triangulation_cell_base_3.h>
#include <CGAL/Regular_triangulation_vertex_base_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Weighted = Kernel::Weighted_point_3;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<int32_t, Kernel,
  CGAL::Regular_triangulation_vertex_base_3<Kernel>>;
using CellBase = CGAL::Regular_triangulation_cell_base_3<Kernel>;
using Structure = CGAL::Triangulation_data_structure_3<VertexBase, CellBase>;
using Regular = CGAL::Regular_triangulation_3<Kernel, Structure>;
using Cells = std::vector<std::array<int32_t, 4>>; // sorted, of sorted vertices

const double Size[3] = { 10, 7, 4 };

struct Pair
{
  mlim_delaunay* Ours = nullptr;
  Regular Peer;
  int32_t Count = 0;

  void AddToPeer(const double at[3], double weight)
  {
    const auto vertex = this->Peer.insert(Weighted(Point(at[0], at[1], at[2]), weight));
    CHECK(vertex != Regular::Vertex_handle());
    vertex->info() = this->Count++;
  }

  Pair()
  {
    CHECK(mlim_delaunay_create(Size, nullptr, &this->Ours) == MLIM_OK);
    for (int32_t v = 0; v < MLIM_FAR_VERTICES; ++v)
    {
      const double* at = mlim_delaunay_vertices(this->Ours)[v].point;
      this->AddToPeer(at, 0);
    }
  }

  ~Pair() { mlim_delaunay_free(this->Ours); }

  // The peer gets what ours takes.
  void Add(const double at[3], double weight)
  {
    mlim_delaunay_zone zone;
    CHECK(mlim_delaunay_find(
            this->Ours, at, weight, MLIM_NO_CELL, MLIM_START_NEAR, nullptr, &zone) == MLIM_OK);
    if (zone.count > 0)
    {
      CHECK(mlim_delaunay_fill(this->Ours, nullptr, nullptr) == MLIM_OK);
      this->AddToPeer(at, weight);
    }
  }

  void Check() const
  {
    Cells ours;
    Cells peers;
    const mlim_delaunay_cells all = mlim_delaunay_all(this->Ours);
    for (size_t c = 0; c < all.count; ++c)
    {
      const int32_t* v = all.cells[c].vertices;
      if (v[0] >= 0)
      {
        ours.push_back({ v[0], v[1], v[2], v[3] });
      }
    }
    for (const auto& c : this->Peer.finite_cell_handles())
    {
      peers.push_back(
        { c->vertex(0)->info(), c->vertex(1)->info(), c->vertex(2)->info(), c->vertex(3)->info() });
    }
    for (Cells* cells : { &ours, &peers })
    {
      for (auto& c : *cells)
      {
        std::sort(c.begin(), c.end());
      }
      std::sort(cells->begin(), cells->end());
    }
    CHECK_COUNT(ours.size(), peers.size());
    CHECK(ours == peers);
    CHECK_COUNT(
      static_cast<size_t>(this->Count), static_cast<size_t>(this->Peer.number_of_vertices()));
  }
};

// Random points, spread through the box or near a sphere in it, with weights up to that of a ball of
// the radius.
void Compare(int count, double radius, bool onSphere, unsigned seed)
{
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Pair pair;
  pair.Check();
  for (int n = 0; n < count; ++n)
  {
    double at[3];
    double length = 0;
    for (int k = 0; k < 3; ++k)
    {
      at[k] = onSphere ? unit(random) - 0.5 : Size[k] * unit(random);
      length += at[k] * at[k];
    }
    for (int k = 0; k < 3 && onSphere; ++k)
    {
      at[k] = 0.5 * Size[k] + 1.7 * at[k] / std::sqrt(length);
    }
    pair.Add(at, radius * radius * unit(random));
  }
  CHECK(pair.Count > MLIM_FAR_VERTICES + count / 3);
  pair.Check();
}
}

int main()
{
  Compare(3000, 0, false, 1);
  Compare(3000, 0.3, false, 2);
  Compare(1000, 1, false, 3);
  Compare(3000, 0, true, 4); // nearly cospherical
  Compare(1000, 0.05, true, 5);
  return check_result();
}
