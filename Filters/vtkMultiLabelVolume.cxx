#include "vtkMultiLabelVolume.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

namespace vtkMultiLabel
{

namespace
{

void WriteVolumePoints(const mlim_volume& volume, const Setting& setting, bool isSinglePrecision,
  vtkUnstructuredGrid* out)
{
  vtkNew<vtkPoints> points;
  points->SetDataType(isSinglePrecision ? VTK_FLOAT : VTK_DOUBLE);
  points->SetNumberOfPoints(static_cast<vtkIdType>(volume.vertex_count));
  for (size_t v = 0; v < volume.vertex_count; ++v)
  {
    double world[3];
    setting.GridFrame.ToWorld(volume.vertices + 3 * v, world);
    points->SetPoint(static_cast<vtkIdType>(v), world);
  }
  out->SetPoints(points);
}

}

void WriteVolume(const mlim_volume& volume, const Setting& setting, bool isSinglePrecision,
  vtkUnstructuredGrid* out)
{
  WriteVolumePoints(volume, setting, isSinglePrecision, out);
  const vtkIdType count = static_cast<vtkIdType>(volume.cell_count);
  vtkNew<vtkCellArray> cells;
  cells->AllocateExact(count, 4 * count);
  vtkNew<vtkIntArray> labels;
  labels->SetName("Label");
  labels->SetNumberOfValues(count);
  // Positively oriented in world space too: a mirror turns every cell round.
  const int third = setting.GridFrame.IsMirrored ? 3 : 2;
  const int fourth = setting.GridFrame.IsMirrored ? 2 : 3;
  for (vtkIdType c = 0; c < count; ++c)
  {
    const int32_t* v = volume.cells + 4 * c;
    cells->InsertNextCell({ v[0], v[1], v[third], v[fourth] });
    labels->SetValue(c, setting.IdOf(volume.cell_labels[c]));
  }
  out->SetCells(VTK_TETRA, cells);
  out->GetCellData()->SetScalars(labels);
}

void WriteVolumeFigures(
  const mlim_volume& volume, const mlim_options& options, vtkUnstructuredGrid* out)
{
  vtkFieldData* field = out->GetFieldData();
  WriteValue("CellSize", options.cell_size, field);
  WriteValue("CellRadiusEdgeRatio", options.cell_radius_edge_ratio, field);
  WriteCount("RemoveSlivers", options.remove_slivers ? 1 : 0, field);
  WriteCount("KeepBackground", options.keep_background ? 1 : 0, field);
  if (options.label_size_count > 0)
  {
    vtkNew<vtkDoubleArray> sizes;
    sizes->SetName("LabelCellSizes");
    sizes->SetNumberOfComponents(2);
    for (size_t k = 0; k < options.label_size_count; ++k)
    {
      sizes->InsertNextTuple2(options.label_sizes[k].id, options.label_sizes[k].size);
    }
    field->AddArray(sizes);
  }
  WriteLabelVolumes(volume.label_volumes, volume.label_count, field);

  const mlim_volume_report& report = volume.report;
  WriteCount("VertexCount", volume.vertex_count, field);
  WriteCount("SurfaceVertexCount", volume.surface_vertex_count, field);
  WriteCount("CellCount", volume.cell_count, field);
  WriteCount("InsertionCount", report.insertion_count, field);
  WriteCount("UnresolvedSizeCount", report.unresolved_size_count, field);
  WriteCount("UnresolvedRatioCount", report.unresolved_ratio_count, field);
  WriteCount("UnresolvedBoxCount", report.unresolved_box_count, field);
  WriteCount("SliverCount", report.sliver_count, field);
  WriteCount("UnresolvedSliverCount", report.unresolved_sliver_count, field);
  WriteCount("ExchangeCount", report.exchange_count, field);
  WriteCount("AddedVertexCount", report.added_vertex_count, field);
  WriteValue("MinDihedralAngle", report.min_dihedral_angle, field);
  WriteValue("MaxDihedralAngle", report.max_dihedral_angle, field);
  WriteValue("MaxRadiusEdgeRatio", report.max_radius_edge_ratio, field);
  WriteValue("MinCellVolume", report.min_cell_volume, field);
}

}
