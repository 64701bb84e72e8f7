#include "vtkMultiLabelSurface.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace vtkMultiLabel
{

namespace
{

// Which elements of the mesh are shown. Without the caps, what only they use goes as well: curve
// edges along the box, and vertices.
class Shown
{
public:
  Shown(const mlim_mesh& mesh, const SurfaceChoice& choice)
  {
    for (size_t t = 0; t < mesh.triangle_count; ++t)
    {
      if (choice.CapBoundary || mesh.triangle_faces[t] < 0)
      {
        this->Triangles.push_back(t);
      }
    }
    std::vector<char> isUsed(mesh.vertex_count, choice.CapBoundary ? 1 : 0);
    for (size_t t : this->Triangles)
    {
      for (int c = 0; c < 3; ++c)
      {
        isUsed[static_cast<size_t>(mesh.triangles[3 * t + c])] = 1;
      }
    }
    this->NewIds.assign(mesh.vertex_count, -1);
    for (size_t v = 0; v < mesh.vertex_count; ++v)
    {
      if (isUsed[v])
      {
        this->NewIds[v] = static_cast<vtkIdType>(this->Vertices.size());
        this->Vertices.push_back(v);
      }
    }
    if (choice.OutputCurves)
    {
      this->ReadEdges(mesh, choice.CapBoundary);
    }
  }

  vtkIdType NewId(int32_t vertex) const { return this->NewIds[static_cast<size_t>(vertex)]; }

  std::vector<size_t> Vertices;
  std::vector<size_t> Triangles;
  std::vector<size_t> Edges;
  std::vector<size_t> Junctions;

private:
  using Pair = std::pair<int32_t, int32_t>;
  static Pair Ordered(int32_t a, int32_t b) { return { std::min(a, b), std::max(a, b) }; }

  void ReadEdges(const mlim_mesh& mesh, bool all)
  {
    std::vector<Pair> sides;
    for (size_t n = 0; !all && n < this->Triangles.size(); ++n)
    {
      const int32_t* t = mesh.triangles + 3 * this->Triangles[n];
      sides.insert(sides.end(), { Ordered(t[0], t[1]), Ordered(t[1], t[2]), Ordered(t[2], t[0]) });
    }
    std::sort(sides.begin(), sides.end());
    for (size_t e = 0; e < mesh.edge_count; ++e)
    {
      const Pair pair = Ordered(mesh.edges[2 * e], mesh.edges[2 * e + 1]);
      if (all || std::binary_search(sides.begin(), sides.end(), pair))
      {
        this->Edges.push_back(e);
      }
    }
    for (size_t j = 0; j < mesh.junction_count; ++j)
    {
      if (this->NewId(mesh.junctions[j]) >= 0)
      {
        this->Junctions.push_back(j);
      }
    }
  }

  std::vector<vtkIdType> NewIds;
};

void WritePoints(const mlim_mesh& mesh, const Shown& shown, const Setting& setting,
  const SurfaceChoice& choice, vtkPolyData* out)
{
  vtkNew<vtkPoints> points;
  points->SetDataType(choice.IsSinglePrecision ? VTK_FLOAT : VTK_DOUBLE);
  const vtkIdType count = static_cast<vtkIdType>(shown.Vertices.size());
  points->SetNumberOfPoints(count);
  vtkNew<vtkIntArray> types;
  types->SetName("NodeType");
  types->SetNumberOfValues(count);
  vtkNew<vtkIntArray> counts;
  counts->SetName("NumberOfLabels");
  counts->SetNumberOfValues(count);
  for (vtkIdType p = 0; p < count; ++p)
  {
    const size_t v = shown.Vertices[static_cast<size_t>(p)];
    double world[3];
    setting.GridFrame.ToWorld(mesh.vertices + 3 * v, world);
    points->SetPoint(p, world);
    types->SetValue(p, mesh.node_types[v]);
    counts->SetValue(p, mesh.label_counts[v]);
  }
  out->SetPoints(points);
  out->GetPointData()->AddArray(types);
  out->GetPointData()->AddArray(counts);
}

/** Where vertices fail the disk condition, and what they are. */
void WriteDiskFailures(const mlim_mesh& mesh, const Setting& setting, vtkFieldData* field)
{
  const vtkIdType count = static_cast<vtkIdType>(mesh.certificate.disk_failure_count);
  vtkNew<vtkDoubleArray> places;
  places->SetName("DiskFailurePoints");
  places->SetNumberOfComponents(3);
  places->SetNumberOfTuples(count);
  vtkNew<vtkIntArray> types;
  types->SetName("DiskFailureTypes");
  types->SetNumberOfValues(count);
  for (vtkIdType f = 0; f < count; ++f)
  {
    double world[3];
    setting.GridFrame.ToWorld(mesh.disk_failures + 3 * f, world);
    places->SetTuple(f, world);
    types->SetValue(f, mesh.disk_failure_types[f]);
  }
  field->AddArray(places);
  field->AddArray(types);
}

}

void WriteSurface(
  const mlim_mesh& mesh, const Setting& setting, const SurfaceChoice& choice, vtkPolyData* out)
{
  const Shown shown(mesh, choice);
  WritePoints(mesh, shown, setting, choice, out);

  vtkNew<vtkCellArray> verts;
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkCellArray> polys;
  vtkNew<vtkIntArray> labels;
  labels->SetName("BoundaryLabels");
  labels->SetNumberOfComponents(2);
  vtkNew<vtkIntArray> firsts;
  firsts->SetName("Label");
  vtkNew<vtkIntArray> patches;
  patches->SetName("PatchId");
  vtkNew<vtkIntArray> curves;
  curves->SetName("CurveId");
  auto addCell = [&](int label0, int label1, int patch, int curve)
  {
    labels->InsertNextTuple2(label0, label1);
    firsts->InsertNextValue(std::max(label0, 0));
    patches->InsertNextValue(patch);
    curves->InsertNextValue(curve);
  };
  const size_t firstContact = mesh.junction_count - mesh.contact_count;
  for (size_t j : shown.Junctions)
  {
    verts->InsertNextCell({ shown.NewId(mesh.junctions[j]) });
    addCell(-1, -1, -1, j < firstContact ? MLIM_JUNCTION : MLIM_CONTACT);
  }
  for (size_t e : shown.Edges)
  {
    lines->InsertNextCell({ shown.NewId(mesh.edges[2 * e]), shown.NewId(mesh.edges[2 * e + 1]) });
    addCell(-1, -1, -1, mesh.edge_curves[e]);
  }
  const vtkIdType triangleCount = static_cast<vtkIdType>(shown.Triangles.size());
  polys->AllocateExact(triangleCount, 3 * triangleCount);
  // In local coordinates the normal points from the first label to the second; a mirror turns
  // every normal round, and the other order of the vertices turns it back.
  const int second = setting.GridFrame.IsMirrored ? 2 : 1;
  const int third = setting.GridFrame.IsMirrored ? 1 : 2;
  for (size_t t : shown.Triangles)
  {
    const int32_t* corners = mesh.triangles + 3 * t;
    const vtkIdType ids[3] = { shown.NewId(corners[0]), shown.NewId(corners[second]),
      shown.NewId(corners[third]) };
    polys->InsertNextCell(3, ids);
    addCell(setting.IdOf(mesh.triangle_labels[2 * t]),
      setting.IdOf(mesh.triangle_labels[2 * t + 1]), mesh.triangle_patches[t], -1);
  }
  out->SetVerts(verts);
  out->SetLines(lines);
  out->SetPolys(polys);
  out->GetCellData()->SetScalars(labels);
  out->GetCellData()->AddArray(firsts);
  if (choice.IsLabelActive)
  {
    out->GetCellData()->SetActiveScalars("Label");
  }
  out->GetCellData()->AddArray(patches);
  out->GetCellData()->AddArray(curves);
}

void WriteFigures(const mlim_mesh& mesh, const Setting& setting, vtkPolyData* out)
{
  vtkFieldData* field = out->GetFieldData();
  WriteCount("VertexCount", mesh.vertex_count, field);
  WriteCount("TriangleCount", mesh.triangle_count, field);
  WriteCount("PatchCount", mesh.patch_count, field);
  WriteCount("CurveEdgeCount", mesh.edge_count, field);
  WriteCount("JunctionCount", mesh.junction_count, field);
  const std::vector<int32_t> ids(mesh.edge_curves, mesh.edge_curves + mesh.edge_count);
  const int32_t lastCurve = ids.empty() ? -1 : *std::max_element(ids.begin(), ids.end());
  WriteCount("CurveCount", std::max(lastCurve, -1) + 1, field);
  WriteLabelVolumes(mesh.volumes, mesh.label_count, field);

  const mlim_report& report = mesh.report;
  WriteCount("InsertionCount", report.insertion_count, field);
  WriteCount("UnresolvedCrossingCount", report.unresolved_crossing_count, field);
  WriteCount("UnresolvedPatchCount", report.unresolved_patch_count, field);
  WriteCount("UnresolvedSizeCount", report.unresolved_size_count, field);
  WriteCount("UnresolvedDistanceCount", report.unresolved_distance_count, field);
  WriteCount("RelabeledRatioCount", report.relabeled_ratio_count, field);
  WriteCount("UnresolvedRatioCount", report.unresolved_ratio_count, field);
  WriteCount("UnresolvedBallRatioCount", report.unresolved_ball_ratio_count, field);
  WriteCount("HiddenBallCount", report.hidden_ball_count, field);
  WriteCount("ContactCount", mesh.contact_count, field);
  WriteCount("ContactEdgeCount", report.contact_edge_count, field);
  WriteCount("OffCurveEdgeCount", report.off_curve_edge_count, field);
  WriteCount("LostCurveEdgeCount", report.lost_curve_edge_count, field);
  WriteCount("RelabeledCellCount", report.relabeled_cell_count, field);
  WriteValue("MaxRadiusEdgeRatio", report.max_radius_edge_ratio, field);
  WriteValue("MeanRadiusEdgeRatio", report.mean_radius_edge_ratio, field);
  WriteValue("MaxBallRadiusEdgeRatio", report.max_ball_radius_edge_ratio, field);
  WriteValue("MinDihedralAngle", report.min_dihedral_angle, field);
  WriteValue("MinAngle", report.min_angle, field);

  const mlim_certificate& certificate = mesh.certificate;
  WriteCount("CertifiedLabelCount", certificate.label_count, field);
  WriteCount("LostLabelCount", certificate.lost_label_count, field);
  WriteCount("CertifiedComponentCount", certificate.component_count, field);
  WriteCount("LostComponentCount", certificate.lost_component_count, field);
  WriteCount("DiskFailureCount", certificate.disk_failure_count, field);
  WriteDiskFailures(mesh, setting, field);
  WriteCount("OpenEdgeCount", certificate.open_edge_count, field);
  WriteCount("GridCrossingCount", certificate.grid_crossing_count, field);
  WriteCount("FarCrossingCount", certificate.far_crossing_count, field);
  WriteValue("MaxCrossingDistance", certificate.max_crossing_distance, field);
  WriteValue("MaxVolumeDifference", certificate.max_volume_difference, field);
}

}
