// The output contract: arrays, order of labels, direction of normals in world space, closed regions,
// and what the options leave out.
#include "MultiLabelTest.h"

#include "vtkCellArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkMatrix3x3.h"
#include "vtkPoints.h"
#include "vtkTriangle.h"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

using namespace test;

namespace
{

// Distance from a triangle's centre at which both sides are sampled, in voxels: far above the
// triangle's distance from the interface, far below the balls' radii.
const double sample_distance = 0.4;

vtkSmartPointer<vtkPolyData> MeshOf(vtkImageData* image)
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(image);
  mesher->Update();
  return mesher->GetOutput();
}

struct Triangle
{
  vtkIdType Ids[3];
  int Labels[2];
};

std::vector<Triangle> TrianglesOf(vtkPolyData* surface)
{
  std::vector<Triangle> triangles;
  vtkDataArray* labels = surface->GetCellData()->GetArray("BoundaryLabels");
  const vtkIdType first = surface->GetNumberOfVerts() + surface->GetNumberOfLines();
  vtkNew<vtkIdList> ids;
  for (vtkIdType c = first; c < surface->GetNumberOfCells(); ++c)
  {
    surface->GetCellPoints(c, ids);
    Triangle triangle;
    std::copy_n(ids->GetPointer(0), 3, triangle.Ids);
    triangle.Labels[0] = static_cast<int>(labels->GetComponent(c, 0));
    triangle.Labels[1] = static_cast<int>(labels->GetComponent(c, 1));
    triangles.push_back(triangle);
  }
  return triangles;
}

// Share of the triangles whose labels are found on the sides that the normal says.
double NormalShare(vtkPolyData* surface, vtkImageData* image, double spacing)
{
  int extent[6];
  image->GetExtent(extent);
  auto labelAt = [&](const double center[3], const double normal[3], double distance)
  {
    double world[3];
    double index[3];
    for (int c = 0; c < 3; ++c)
    {
      world[c] = center[c] + distance * normal[c];
    }
    image->TransformPhysicalPointToContinuousIndex(world, index);
    for (int c = 0; c < 3; ++c)
    {
      index[c] -= extent[2 * c];
    }
    return LabelAt(index);
  };
  const std::vector<Triangle> triangles = TrianglesOf(surface);
  size_t right = 0;
  for (const Triangle& triangle : triangles)
  {
    double p[3][3];
    double center[3];
    double normal[3];
    for (int c = 0; c < 3; ++c)
    {
      surface->GetPoint(triangle.Ids[c], p[c]);
    }
    vtkTriangle::TriangleCenter(p[0], p[1], p[2], center);
    vtkTriangle::ComputeNormal(p[0], p[1], p[2], normal);
    const double distance = sample_distance * spacing;
    right += labelAt(center, normal, -distance) == triangle.Labels[0] &&
                 labelAt(center, normal, distance) == triangle.Labels[1]
               ? 1
               : 0;
  }
  return triangles.empty() ? 0.0 : static_cast<double>(right) / triangles.size();
}

// Edges that do not have two triangles of the label, in opposite directions.
int OpenEdges(const std::vector<Triangle>& triangles, int label)
{
  std::map<std::pair<vtkIdType, vtkIdType>, int> balance;
  for (const Triangle& triangle : triangles)
  {
    for (int side = 0; side < 2; ++side)
    {
      for (int c = 0; c < 3 && triangle.Labels[side] == label; ++c)
      {
        const vtkIdType a = triangle.Ids[c];
        const vtkIdType b = triangle.Ids[(c + 1) % 3];
        balance[{ std::min(a, b), std::max(a, b) }] += (a < b) == (side == 0) ? 1 : -1;
      }
    }
  }
  return static_cast<int>(std::count_if(
    balance.begin(), balance.end(), [](const auto& entry) { return entry.second != 0; }));
}

void CheckArrays()
{
  auto image = MakeImage();
  auto surface = MeshOf(image);
  CHECK(IsTyped(surface), "plain image");
  std::set<std::pair<int, int>> pairs;
  for (const Triangle& triangle : TrianglesOf(surface))
  {
    pairs.insert({ triangle.Labels[0], triangle.Labels[1] });
  }
  const std::set<std::pair<int, int>> expected = { { 1, 0 }, { 1, 2 }, { 2, 0 } };
  CHECK(pairs == expected, "background second, else ascending");
  for (int label : { 1, 2 })
  {
    CHECK(OpenEdges(TrianglesOf(surface), label) == 0, "region is closed");
  }
  CHECK(surface->GetNumberOfLines() > 0, "the circle where the balls meet");
  if (surface->GetNumberOfLines() == 0)
  {
    return;
  }
  vtkDataArray* curves = surface->GetCellData()->GetArray("CurveId");
  vtkDataArray* patches = surface->GetCellData()->GetArray("PatchId");
  vtkDataArray* types = surface->GetPointData()->GetArray("NodeType");
  vtkDataArray* counts = surface->GetPointData()->GetArray("NumberOfLabels");
  const vtkIdType lineBegin = surface->GetNumberOfVerts();
  const vtkIdType lineEnd = lineBegin + surface->GetNumberOfLines();
  vtkNew<vtkIdList> ids;
  for (vtkIdType c = 0; c < surface->GetNumberOfCells(); ++c)
  {
    const bool isLine = c >= lineBegin && c < lineEnd;
    CHECK((curves->GetComponent(c, 0) >= 0) == isLine, "CurveId is of lines");
    CHECK((patches->GetComponent(c, 0) >= 0) == (c >= lineEnd), "PatchId is of triangles");
    surface->GetCellPoints(c, ids);
    for (vtkIdType p : { ids->GetId(0), ids->GetId(isLine ? 1 : 0) })
    {
      const double type = types->GetComponent(p, 0);
      CHECK(type == 2 || type == 3 || type == 4, "nothing is on the box");
      CHECK(!isLine || (type >= 3 && counts->GetComponent(p, 0) == 3), "three labels on a curve");
    }
  }
  vtkFieldData* field = surface->GetFieldData();
  CHECK(field->GetArray("TriangleCount")->GetComponent(0, 0) == surface->GetNumberOfPolys(), "");
  CHECK(field->GetArray("FacetSize")->GetComponent(0, 0) == 2.0, "filled in from the spacing");
  CHECK(field->GetArray("LabelIds")->GetNumberOfTuples() == 3, "one id a label");
  CHECK(field->GetAbstractArray("LabelNames")->GetVariantValue(2).ToString() == "second", "");
  for (const char* name :
    { "TimeField", "TimeCurves", "TimeBalls", "TimeSurface", "TimeCertificate", "LostLabelCount",
      "MaxRadiusEdgeRatio", "HiddenBallCount", "RelabeledCellCount", "MaxVolumeDifference" })
  {
    CHECK(field->GetArray(name) && field->GetArray(name)->GetNumberOfTuples() == 1, name);
  }
  CHECK(field->GetArray("LostLabelCount")->GetComponent(0, 0) == 0, "");
}

void CheckPlacements()
{
  struct Placement
  {
    const char* Name;
    double Spacing;
    double Direction[9];
  };
  const double c = 0.8;
  const double s = 0.6;
  const Placement placements[] = {
    { "identity", 1.0, { 1, 0, 0, 0, 1, 0, 0, 0, 1 } },
    { "rotation", 0.5, { c, -s, 0, s, c, 0, 0, 0, 1 } },
    { "mirror", 2.0, { -1, 0, 0, 0, 1, 0, 0, 0, 1 } },
    { "rotation and mirror", 1.0, { c, s, 0, s, -c, 0, 0, 0, 1 } },
    { "two mirrors", 1.0, { -1, 0, 0, 0, -1, 0, 0, 0, 1 } },
    { "negative spacing", -1.0, { 1, 0, 0, 0, 1, 0, 0, 0, 1 } },
  };
  for (const Placement& placement : placements)
  {
    auto image = MakeImage();
    const double spacing = std::abs(placement.Spacing);
    image->SetSpacing(placement.Spacing, spacing, spacing);
    image->SetOrigin(10.0, -20.0, 0.3);
    image->SetDirectionMatrix(placement.Direction);
    image->SetExtent(3, 3 + Size - 1, -7, -7 + Size - 1, 0, Size - 1);
    auto surface = MeshOf(image);
    CHECK(surface->GetNumberOfPolys() > 100, placement.Name);
    CHECK(NormalShare(surface, image, spacing) > 0.95, placement.Name);
    for (int label : { 1, 2 })
    {
      CHECK(OpenEdges(TrianglesOf(surface), label) == 0, placement.Name);
    }
  }
}

void CheckCaps()
{
  auto image = MakeGrid();
  std::vector<double> values;
  for (double value : ValuesOf(1))
  {
    values.push_back(value + 3.4); // a ball of 7.5 voxels, which leaves the box
  }
  image->GetPointData()->AddArray(MakeArray<vtkFloatArray>("ball", values));
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(image);
  mesher->SetBackgroundModeToConstant();
  auto hasCaps = [&mesher]()
  {
    vtkPolyData* surface = mesher->GetOutput();
    for (const Triangle& triangle : TrianglesOf(surface))
    {
      double bounds[6];
      vtkNew<vtkPoints> points;
      for (vtkIdType p : triangle.Ids)
      {
        points->InsertNextPoint(surface->GetPoint(p));
      }
      points->GetBounds(bounds);
      for (int a = 0; a < 3; ++a)
      {
        const bool isFlat = bounds[2 * a] == bounds[2 * a + 1];
        if (isFlat && (bounds[2 * a] == 0.0 || bounds[2 * a] == Size - 1.0))
        {
          return true;
        }
      }
    }
    return false;
  };
  auto usesAllPoints = [&mesher]()
  {
    std::set<vtkIdType> used;
    for (const Triangle& triangle : TrianglesOf(mesher->GetOutput()))
    {
      used.insert(triangle.Ids, triangle.Ids + 3);
    }
    return static_cast<vtkIdType>(used.size()) == mesher->GetOutput()->GetNumberOfPoints();
  };
  mesher->Update();
  CHECK(hasCaps(), "a region that reaches the box is closed there");
  CHECK(OpenEdges(TrianglesOf(mesher->GetOutput()), 1) == 0, "");
  CHECK(usesAllPoints(), "");
  const vtkIdType whole = mesher->GetOutput()->GetNumberOfPolys();
  mesher->CapBoundaryOff();
  mesher->Update();
  CHECK(!hasCaps(), "CapBoundary is off");
  CHECK(mesher->GetOutput()->GetNumberOfPolys() < whole, "");
  CHECK(OpenEdges(TrianglesOf(mesher->GetOutput()), 1) > 0, "");
  CHECK(usesAllPoints(), "vertices of the caps are gone");
  CHECK(IsTyped(mesher->GetOutput()), "");
}

void CheckOptions()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(MakeImage());
  mesher->Update();
  vtkNew<vtkPolyData> whole;
  whole->DeepCopy(mesher->GetOutput());
  CHECK(whole->GetPoints()->GetDataType() == VTK_DOUBLE, "");
  mesher->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION);
  mesher->Update();
  const double none[3] = { 0.0, 0.0, 0.0 };
  CHECK(mesher->GetOutput()->GetPoints()->GetDataType() == VTK_FLOAT, "");
  CHECK(AreSame(whole, mesher->GetOutput(), 1e-5, none), "only rounded");
  mesher->OutputCurvesOff();
  mesher->Update();
  vtkPolyData* surface = mesher->GetOutput();
  CHECK(IsTyped(surface), "");
  CHECK(surface->GetNumberOfCells() == surface->GetNumberOfPolys(), "no lines and verts");
  CHECK(surface->GetNumberOfPolys() == whole->GetNumberOfPolys(), "");
  mesher->SetFacetSize(1.0);
  mesher->Update();
  CHECK(mesher->GetOutput()->GetNumberOfPolys() > 2 * whole->GetNumberOfPolys(), "finer");
  Messages messages(mesher);
  mesher->SetVertexLimit(60);
  mesher->Update();
  CHECK(Contains(messages.Warnings, "vertex limit of 60"), messages.Warnings);
  CHECK(messages.Errors.empty(), messages.Errors);
  CHECK(mesher->GetOutput()->GetNumberOfPolys() > 0, "the unfinished mesh is returned");
  CHECK(
    mesher->GetOutput()->GetFieldData()->GetArray("VertexLimitReached")->GetComponent(0, 0) == 1,
    "");
  std::ostringstream text;
  mesher->Print(text);
  for (const char* name : { "PointArraySelection", "BackgroundMode", "BackgroundValue",
         "BackgroundArrayName", "TieBreaking", "UnseenLabels: Keep", "JunctionMergeTolerance",
         "FacetSize: 1", "FacetRadiusEdgeRatio", "FacetDistance", "VolumeTolerance: 0.02",
         "EdgeSize", "BallRadiusScale", "CrossingTolerance", "OracleMode", "CapBoundary",
         "OutputCurves", "MinimumComponentVoxels", "VertexLimit: 60", "OutputPointsPrecision",
         "ActiveScalars: BoundaryLabels" })
  {
    CHECK(Contains(text.str(), name), name);
  }
}

// What a user interface asks for: a range of sizes before the run, one scalar to colour by.
void CheckUserInterface()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  CHECK(mesher->GetFacetSizeRange()[0] == 0.0 && mesher->GetFacetSizeRange()[1] == 0.0, "");
  auto image = MakeImage();
  image->SetSpacing(0.5, 2.0, 1.0);
  mesher->SetInputData(image);
  mesher->UpdateInformation();
  CHECK(mesher->GetFacetSizeRange()[0] == 1.0 && mesher->GetFacetSizeRange()[1] == 3.0, "");
  mesher->SetActiveScalarsToLabel();
  mesher->Update();
  vtkCellData* arrays = mesher->GetOutput()->GetCellData();
  CHECK(arrays->GetScalars() == arrays->GetArray("Label"), "");
  for (vtkIdType c = 0; c < mesher->GetOutput()->GetNumberOfCells(); ++c)
  {
    const double first = arrays->GetArray("BoundaryLabels")->GetComponent(c, 0);
    CHECK(
      arrays->GetScalars()->GetComponent(c, 0) == std::max(first, 0.0), "0 is a line or a vert");
  }
}

}

int TestMultiLabelSurface(int, char*[])
{
  CheckArrays();
  CheckPlacements();
  CheckCaps();
  CheckOptions();
  CheckUserInterface();
  return Result();
}
