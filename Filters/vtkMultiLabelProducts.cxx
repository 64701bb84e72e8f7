#include "vtkMultiLabelProducts.h"

#include "vtkMultiLabelRun.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkIdList.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <cmath>

namespace vtkMultiLabel
{

namespace
{

// The sets with the given indices, as one tuple each.
class SetWriter
{
public:
  SetWriter(const mlim_sets& sets, const Setting& setting) : Sets(sets), Labels(setting)
  {
    size_t width = 1;
    for (size_t s = 0; s < sets.count; ++s)
    {
      width = std::max(width, sets.offsets[s + 1] - sets.offsets[s]);
    }
    this->Width = width;
    this->Ids->SetName("LabelSet");
    this->Ids->SetNumberOfComponents(static_cast<int>(width));
    this->Sizes->SetName("LabelSetSize");
    this->Codes->SetName("LabelCodes");
    this->Codes->SetNumberOfComponents(static_cast<int>(width));
  }

  void Add(int32_t set)
  {
    const size_t begin = this->Sets.offsets[set];
    const size_t end = this->Sets.offsets[set + 1];
    std::vector<int> codes(this->Sets.labels + begin, this->Sets.labels + end);
    std::vector<int> ids;
    for (int code : codes)
    {
      ids.push_back(this->Labels.IdOf(code));
    }
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    this->Sizes->InsertNextValue(static_cast<int>(ids.size()));
    ids.resize(this->Width, -1);
    codes.resize(this->Width, -1);
    this->Ids->InsertNextTypedTuple(ids.data());
    this->Codes->InsertNextTypedTuple(codes.data());
  }

  void Attach(vtkFieldData* out)
  {
    out->AddArray(this->Ids);
    out->AddArray(this->Sizes);
    out->AddArray(this->Codes);
  }

private:
  const mlim_sets& Sets;
  const Setting& Labels;
  size_t Width;
  vtkNew<vtkIntArray> Ids;
  vtkNew<vtkIntArray> Sizes;
  vtkNew<vtkIntArray> Codes;
};

vtkDataArray* Find(vtkFieldData* arrays, const char* name, const char* what)
{
  vtkDataArray* array = arrays->GetArray(name);
  if (!array)
  {
    throw Refusal("The " + std::string(what) + " carry no array '" + name + "'.");
  }
  return array;
}

// The set of each tuple of the array LabelCodes.
std::vector<std::vector<int32_t>> ReadCodes(
  vtkFieldData* arrays, vtkIdType count, const Setting& setting, const char* what)
{
  vtkDataArray* array = Find(arrays, "LabelCodes", what);
  std::vector<std::vector<int32_t>> sets(static_cast<size_t>(count));
  std::vector<double> tuple(static_cast<size_t>(array->GetNumberOfComponents()));
  for (vtkIdType i = 0; i < count; ++i)
  {
    std::vector<int32_t>& codes = sets[static_cast<size_t>(i)];
    array->GetTuple(i, tuple.data());
    for (double value : tuple)
    {
      if (value == -1.0)
      {
        break;
      }
      const bool isCode = value >= 0.0 && value < setting.LabelCount() + 6.0;
      if (!isCode || (!codes.empty() && value <= codes.back()))
      {
        throw Refusal("The array 'LabelCodes' of the " + std::string(what) + " holds " +
                      std::to_string(value) + ", where an ascending set of codes from 0 to " +
                      std::to_string(setting.LabelCount() + 5) + " is needed.");
      }
      codes.push_back(static_cast<int32_t>(value));
    }
  }
  return sets;
}

void Snap(const std::vector<int32_t>& codes, const Setting& setting, double* local)
{
  for (int32_t code : codes)
  {
    if (setting.IsFace(code))
    {
      setting.GridFrame.Snap(code - setting.LabelCount(), local);
    }
  }
}

std::vector<double> ReadPoints(vtkPolyData* data, const Setting& setting, const char* what)
{
  const vtkIdType count = data->GetNumberOfPoints();
  std::vector<double> local(3 * static_cast<size_t>(count));
  for (vtkIdType p = 0; p < count; ++p)
  {
    double world[3];
    data->GetPoint(p, world);
    if (!std::isfinite(world[0]) || !std::isfinite(world[1]) || !std::isfinite(world[2]))
    {
      throw Refusal("Point " + std::to_string(p) + " of the " + what + " is not finite.");
    }
    setting.GridFrame.ToLocal(world, local.data() + 3 * static_cast<size_t>(p));
  }
  return local;
}

vtkNew<vtkPoints> WritePoints(const double* points, size_t count, const Setting& setting)
{
  vtkNew<vtkPoints> out;
  out->SetDataType(VTK_DOUBLE);
  out->SetNumberOfPoints(static_cast<vtkIdType>(count));
  for (size_t p = 0; p < count; ++p)
  {
    double world[3];
    setting.GridFrame.ToWorld(points + 3 * p, world);
    out->SetPoint(static_cast<vtkIdType>(p), world);
  }
  return out;
}

}

int32_t SetTable::IndexOf(const std::vector<int32_t>& codes)
{
  const auto inserted =
    this->Indices.emplace(codes, static_cast<int32_t>(this->Offsets.size() - 1));
  if (inserted.second)
  {
    this->Codes.insert(this->Codes.end(), codes.begin(), codes.end());
    this->Offsets.push_back(this->Codes.size());
  }
  return inserted.first->second;
}

mlim_sets SetTable::View()
{
  mlim_sets sets = {};
  sets.count = this->Offsets.size() - 1;
  sets.offsets = this->Offsets.data();
  sets.labels = this->Codes.data();
  return sets;
}

mlim_curves CurveNetwork::View()
{
  mlim_curves curves = {};
  curves.point_count = this->Points.size() / 3;
  curves.points = this->Points.data();
  curves.curve_count = this->CurveSets.size();
  curves.curve_offsets = this->CurveOffsets.data();
  curves.curve_points = this->CurvePoints.data();
  curves.curve_sets = this->CurveSets.data();
  curves.junction_count = this->JunctionPoints.size();
  curves.junction_points = this->JunctionPoints.data();
  curves.junction_sets = this->JunctionSets.data();
  curves.sets = this->Sets.View();
  return curves;
}

mlim_balls BallCover::View()
{
  mlim_balls balls = {};
  balls.ball_count = this->Radii.size();
  balls.centers = this->Centers.data();
  balls.radii = this->Radii.data();
  balls.ball_curves = this->BallCurves.data();
  balls.ball_sets = this->BallSets.data();
  balls.edge_count = this->EdgeCurves.size();
  balls.edges = this->Edges.data();
  balls.edge_curves = this->EdgeCurves.data();
  balls.sets = this->Sets.View();
  return balls;
}

void WriteCurves(const mlim_curves& curves, const Setting& setting, vtkPolyData* out)
{
  out->SetPoints(WritePoints(curves.points, curves.point_count, setting));
  SetWriter sets(curves.sets, setting);
  vtkNew<vtkIntArray> curveIds;
  curveIds->SetName("CurveId");
  vtkNew<vtkCellArray> verts;
  for (size_t j = 0; j < curves.junction_count; ++j)
  {
    verts->InsertNextCell({ static_cast<vtkIdType>(curves.junction_points[j]) });
    curveIds->InsertNextValue(-1);
    sets.Add(curves.junction_sets[j]);
  }
  vtkNew<vtkCellArray> lines;
  for (size_t c = 0; c < curves.curve_count; ++c)
  {
    const size_t begin = curves.curve_offsets[c];
    const size_t end = curves.curve_offsets[c + 1];
    lines->InsertNextCell(static_cast<int>(end - begin));
    for (size_t p = begin; p < end; ++p)
    {
      lines->InsertCellPoint(curves.curve_points[p]);
    }
    curveIds->InsertNextValue(static_cast<int>(c));
    sets.Add(curves.curve_sets[c]);
  }
  out->SetVerts(verts);
  out->SetLines(lines);
  out->GetCellData()->SetScalars(curveIds);
  sets.Attach(out->GetCellData());
}

CurveNetwork ReadCurves(vtkPolyData* data, const Setting& setting)
{
  const char* const what = "curves";
  CurveNetwork network;
  network.Points = ReadPoints(data, setting, what);
  const vtkIdType vertCount = data->GetNumberOfVerts();
  const vtkIdType lineCount = data->GetNumberOfLines();
  const std::vector<std::vector<int32_t>> sets =
    ReadCodes(data->GetCellData(), vertCount + lineCount, setting, what);
  vtkNew<vtkIdList> ids;
  for (vtkIdType c = 0; c < vertCount + lineCount; ++c)
  {
    const bool isJunction = c < vertCount;
    const std::vector<int32_t>& codes = sets[static_cast<size_t>(c)];
    if (isJunction)
    {
      data->GetVerts()->GetCellAtId(c, ids);
    }
    else
    {
      data->GetLines()->GetCellAtId(c - vertCount, ids);
    }
    if (isJunction ? ids->GetNumberOfIds() != 1 : ids->GetNumberOfIds() < 2)
    {
      throw Refusal("Cell " + std::to_string(c) + " of the curves has " +
                    std::to_string(ids->GetNumberOfIds()) + " points.");
    }
    for (vtkIdType p : *ids)
    {
      Snap(codes, setting, network.Points.data() + 3 * p);
      (isJunction ? network.JunctionPoints : network.CurvePoints)
        .push_back(static_cast<int32_t>(p));
    }
    (isJunction ? network.JunctionSets : network.CurveSets).push_back(network.Sets.IndexOf(codes));
    if (!isJunction)
    {
      network.CurveOffsets.push_back(network.CurvePoints.size());
    }
  }
  return network;
}

void WriteBalls(const mlim_balls& balls, const Setting& setting, vtkPolyData* out)
{
  out->SetPoints(WritePoints(balls.centers, balls.ball_count, setting));
  SetWriter sets(balls.sets, setting);
  vtkNew<vtkDoubleArray> radii;
  radii->SetName("Radius");
  vtkNew<vtkIntArray> pointCurves;
  pointCurves->SetName("CurveId");
  vtkNew<vtkIntArray> cellCurves;
  cellCurves->SetName("CurveId");
  vtkNew<vtkCellArray> verts;
  for (size_t b = 0; b < balls.ball_count; ++b)
  {
    verts->InsertNextCell({ static_cast<vtkIdType>(b) });
    radii->InsertNextValue(balls.radii[b]);
    pointCurves->InsertNextValue(balls.ball_curves[b]);
    cellCurves->InsertNextValue(balls.ball_curves[b]);
    sets.Add(balls.ball_sets[b]);
  }
  vtkNew<vtkCellArray> lines;
  for (size_t e = 0; e < balls.edge_count; ++e)
  {
    lines->InsertNextCell({ static_cast<vtkIdType>(balls.edges[2 * e]),
      static_cast<vtkIdType>(balls.edges[2 * e + 1]) });
    cellCurves->InsertNextValue(balls.edge_curves[e]);
  }
  out->SetVerts(verts);
  out->SetLines(lines);
  out->GetPointData()->SetScalars(radii);
  out->GetPointData()->AddArray(pointCurves);
  sets.Attach(out->GetPointData());
  out->GetCellData()->AddArray(cellCurves);
}

BallCover ReadBalls(vtkPolyData* data, const Setting& setting)
{
  const char* const what = "balls";
  BallCover cover;
  cover.Centers = ReadPoints(data, setting, what);
  const vtkIdType count = data->GetNumberOfPoints();
  const std::vector<std::vector<int32_t>> sets =
    ReadCodes(data->GetPointData(), count, setting, what);
  vtkDataArray* radii = Find(data->GetPointData(), "Radius", what);
  vtkDataArray* ballCurves = Find(data->GetPointData(), "CurveId", what);
  for (vtkIdType b = 0; b < count; ++b)
  {
    const double radius = radii->GetComponent(b, 0);
    if (!(radius > 0.0) || !std::isfinite(radius))
    {
      throw Refusal(
        "Ball " + std::to_string(b) + " has the radius " + std::to_string(radius) + ".");
    }
    const std::vector<int32_t>& codes = sets[static_cast<size_t>(b)];
    Snap(codes, setting, cover.Centers.data() + 3 * b);
    cover.Radii.push_back(radius);
    cover.BallCurves.push_back(static_cast<int32_t>(ballCurves->GetComponent(b, 0)));
    cover.BallSets.push_back(cover.Sets.IndexOf(codes));
  }
  vtkDataArray* cellCurves = Find(data->GetCellData(), "CurveId", what);
  const vtkIdType vertCount = data->GetNumberOfVerts();
  vtkNew<vtkIdList> ids;
  for (vtkIdType e = 0; e < data->GetNumberOfLines(); ++e)
  {
    data->GetLines()->GetCellAtId(e, ids);
    if (ids->GetNumberOfIds() != 2)
    {
      throw Refusal("Line " + std::to_string(e) + " of the balls has " +
                    std::to_string(ids->GetNumberOfIds()) +
                    " points; it must join two neighbours.");
    }
    cover.Edges.push_back(static_cast<int32_t>(ids->GetId(0)));
    cover.Edges.push_back(static_cast<int32_t>(ids->GetId(1)));
    cover.EdgeCurves.push_back(static_cast<int32_t>(cellCurves->GetComponent(vertCount + e, 0)));
  }
  return cover;
}

}
