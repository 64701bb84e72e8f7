#include "mesh3_domain.h"

extern "C" {
#include "field.h"
}

#include <algorithm>
#include <array>

namespace
{

using Place = std::array<int32_t, 3>;

// Of a component: its grid points that lie farthest along -x +x -y +y -z +z.
struct Component
{
  std::array<Place, 6> Ends;
  size_t Count;
};

// 0 stands for the outside.
int32_t LabelOf(const void* owner, const double point[3])
{
  const mlim_field* field = static_cast<const mlim_field*>(owner);
  const int32_t label = mlim_field_label(field, point);
  return label == mlim_field_outside_label(field) ? 0 : label + 1;
}

class Labelling
{
public:
  explicit Labelling(const mlim_field* field)
    : Labels(mlim_field_point_labels(field)), Dims(mlim_field_grid_of(field)->dims),
      IsSeen(this->IndexOf({ 0, 0, Dims[2] }))
  {
  }

  std::vector<Component> Components()
  {
    std::vector<Component> out;
    for (size_t p = 0; p < this->IsSeen.size(); ++p)
    {
      if (!this->IsSeen[p])
      {
        out.push_back(this->Fill(this->PlaceOf(p)));
      }
    }
    return out;
  }

private:
  size_t IndexOf(const Place& at) const
  {
    return static_cast<size_t>(at[0]) +
           static_cast<size_t>(this->Dims[0]) *
             (static_cast<size_t>(at[1]) +
               static_cast<size_t>(this->Dims[1]) * static_cast<size_t>(at[2]));
  }

  Place PlaceOf(size_t index) const
  {
    const size_t x = static_cast<size_t>(this->Dims[0]);
    const size_t y = static_cast<size_t>(this->Dims[1]);
    return { static_cast<int32_t>(index % x), static_cast<int32_t>(index / x % y),
      static_cast<int32_t>(index / x / y) };
  }

  // All that is 26-connected to a grid point and has its label.
  Component Fill(const Place& first)
  {
    Component out = { {}, 0 };
    out.Ends.fill(first);
    std::vector<Place> open = { first };
    this->IsSeen[this->IndexOf(first)] = true;
    while (!open.empty())
    {
      const Place at = open.back();
      open.pop_back();
      ++out.Count;
      for (size_t e = 0; e < 6; ++e)
      {
        const int32_t side = e & 1 ? 1 : -1;
        if (side * at[e / 2] > side * out.Ends[e][e / 2])
        {
          out.Ends[e] = at;
        }
      }
      this->Spread(at, &open);
    }
    return out;
  }

  void Spread(const Place& at, std::vector<Place>* open)
  {
    const uint16_t label = this->Labels[this->IndexOf(at)];
    Place low;
    Place high;
    for (size_t k = 0; k < 3; ++k)
    {
      low[k] = std::max(at[k] - 1, 0);
      high[k] = std::min(at[k] + 1, this->Dims[k] - 1);
    }
    for (int32_t k = low[2]; k <= high[2]; ++k)
    {
      for (int32_t j = low[1]; j <= high[1]; ++j)
      {
        for (int32_t i = low[0]; i <= high[0]; ++i)
        {
          const size_t next = this->IndexOf({ i, j, k });
          if (!this->IsSeen[next] && this->Labels[next] == label)
          {
            this->IsSeen[next] = true;
            open->push_back({ i, j, k });
          }
        }
      }
    }
  }

  const uint16_t* Labels;
  const int32_t* Dims;
  std::vector<bool> IsSeen;
};

// Where the label changes between two points; false: their labels are the same.
bool FindBorder(
  const mlim_field* field, const double from[3], const double to[3], bench_border* out)
{
  double ends[2][3];
  std::copy(from, from + 3, ends[0]);
  std::copy(to, to + 3, ends[1]);
  out->Labels[0] = LabelOf(field, from);
  out->Labels[1] = LabelOf(field, to);
  // Halving one spacing so often comes below our own crossing tolerance.
  for (int step = 0; step < 24; ++step)
  {
    for (int k = 0; k < 3; ++k)
    {
      out->Point[k] = 0.5 * (ends[0][k] + ends[1][k]);
    }
    const int32_t label = LabelOf(field, out->Point);
    const int side = label == out->Labels[0] ? 0 : 1;
    out->Labels[1] = side == 1 ? label : out->Labels[1];
    std::copy(out->Point, out->Point + 3, ends[side]);
  }
  return out->Labels[0] != out->Labels[1];
}

std::vector<bench_border> FindBorders(const mlim_field* field, size_t minVoxels)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  std::vector<bench_border> borders;
  for (const Component& component : Labelling(field).Components())
  {
    for (int e = 0; e < 6 && component.Count >= minVoxels; ++e)
    {
      double from[3];
      double to[3];
      for (int k = 0; k < 3; ++k)
      {
        from[k] = component.Ends[static_cast<size_t>(e)][static_cast<size_t>(k)] * grid->spacing[k];
        to[k] = from[k] + (k == e / 2 ? (e & 1 ? 1 : -1) * grid->spacing[k] : 0);
      }
      bench_border border;
      if (FindBorder(field, from, to, &border))
      {
        borders.push_back(border);
      }
    }
  }
  return borders;
}

}

bench_mesh3_domain bench_mesh3_domain_of(
  const mlim_field* field, const mlim_curves* curves, size_t minVoxels)
{
  const double* size = mlim_field_grid_of(field)->size;
  bench_mesh3_domain out = { &LabelOf, field, { size[0], size[1], size[2] },
    FindBorders(field, minVoxels), {} };
  for (size_t c = 0; curves != nullptr && c < curves->curve_count; ++c)
  {
    std::vector<double> polyline;
    for (size_t p = curves->curve_offsets[c]; p < curves->curve_offsets[c + 1]; ++p)
    {
      const double* point = curves->points + 3 * curves->curve_points[p];
      polyline.insert(polyline.end(), point, point + 3);
    }
    out.Curves.push_back(polyline);
  }
  return out;
}
