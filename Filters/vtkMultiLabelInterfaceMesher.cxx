#include "vtkMultiLabelInterfaceMesher.h"

#include "vtkMultiLabelInput.h"
#include "vtkMultiLabelProducts.h"
#include "vtkMultiLabelRun.h"
#include "vtkMultiLabelStages.h"
#include "vtkMultiLabelSurface.h"
#include "vtkMultiLabelVolume.h"

#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <vector>

using namespace vtkMultiLabel;

vtkStandardNewMacro(vtkMultiLabelInterfaceMesher);

namespace
{

struct MeshOwner : mlim_mesh
{
  MeshOwner() : mlim_mesh() {}
  MeshOwner(const MeshOwner&) = delete;
  MeshOwner& operator=(const MeshOwner&) = delete;
  ~MeshOwner() { mlim_mesh_free(this); }
};

struct VolumeOwner : mlim_volume
{
  VolumeOwner() : mlim_volume() {}
  VolumeOwner(const VolumeOwner&) = delete;
  VolumeOwner& operator=(const VolumeOwner&) = delete;
  ~VolumeOwner() { mlim_volume_free(this); }
};

// The setting of balls that came from outside, which must be of this image and these labels.
Setting CheckBalls(vtkPolyData* balls, const Setting& ours)
{
  const Setting theirs = ReadSetting(balls->GetFieldData(), "balls");
  const std::string difference = theirs.GridFrame.DifferenceFrom(ours.GridFrame);
  if (!difference.empty())
  {
    throw Refusal("The balls were made for another image: it has " + difference + ".");
  }
  if (theirs.Ids != ours.Ids)
  {
    throw Refusal("The balls were made for " + std::to_string(theirs.Ids.size()) +
                  " labels with other ids or in another order than the image's " +
                  std::to_string(ours.Ids.size()) + ".");
  }
  return theirs;
}

std::string LossOf(const mlim_certificate& certificate)
{
  std::string text;
  if (certificate.lost_label_count > 0)
  {
    text += std::to_string(certificate.lost_label_count) + " of " +
            std::to_string(certificate.label_count) + " labels";
  }
  if (certificate.lost_component_count > 0)
  {
    text += (text.empty() ? "" : " and ") + std::to_string(certificate.lost_component_count) +
            " of " + std::to_string(certificate.component_count) + " connected components";
  }
  return text;
}

}

vtkMultiLabelInterfaceMesher::vtkMultiLabelInterfaceMesher()
  : BallRadiusScale(default_ball_radius_scale)
{
  this->SetNumberOfInputPorts(2);
  this->SetNumberOfOutputPorts(2);
}

vtkMultiLabelInterfaceMesher::~vtkMultiLabelInterfaceMesher() = default;

void vtkMultiLabelInterfaceMesher::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FacetSize: " << this->FacetSize << "\n";
  os << indent << "FacetRadiusEdgeRatio: " << this->FacetRadiusEdgeRatio << "\n";
  os << indent << "FacetDistance: " << this->FacetDistance << "\n";
  os << indent << "VolumeTolerance: " << this->VolumeTolerance << "\n";
  os << indent << "EdgeSize: " << this->EdgeSize << "\n";
  os << indent << "BallRadiusScale: " << this->BallRadiusScale << "\n";
  os << indent << "CrossingTolerance: " << this->CrossingTolerance << "\n";
  os << indent << "OracleMode: " << (this->OracleMode == Exact ? "Exact" : "Bisection") << "\n";
  os << indent << "CapBoundary: " << (this->CapBoundary ? "On" : "Off") << "\n";
  os << indent << "VolumeMesh: " << (this->VolumeMesh ? "On" : "Off") << "\n";
  os << indent << "CellSize: " << this->CellSize << "\n";
  for (const auto& label : this->LabelCellSizes)
  {
    os << indent << "LabelCellSize " << label.first << ": " << label.second << "\n";
  }
  os << indent << "CellRadiusEdgeRatio: " << this->CellRadiusEdgeRatio << "\n";
  os << indent << "RemoveSlivers: " << (this->RemoveSlivers ? "On" : "Off") << "\n";
  os << indent << "KeepBackground: " << (this->KeepBackground ? "On" : "Off") << "\n";
  os << indent << "OutputCurves: " << (this->OutputCurves ? "On" : "Off") << "\n";
  os << indent << "MinimumComponentVoxels: " << this->MinimumComponentVoxels << "\n";
  os << indent << "VertexLimit: " << this->VertexLimit << "\n";
  os << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
  os << indent << "ActiveScalars: " << (this->ActiveScalars == Label ? "Label" : "BoundaryLabels")
     << "\n";
}

void vtkMultiLabelInterfaceMesher::SetBallsData(vtkPolyData* balls)
{
  this->SetInputData(1, balls);
}

int vtkMultiLabelInterfaceMesher::FillInputPortInformation(int port, vtkInformation* info)
{
  if (port == 0)
  {
    return this->Superclass::FillInputPortInformation(port, info);
  }
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkPolyData");
  info->Set(vtkAlgorithm::INPUT_IS_OPTIONAL(), 1);
  return 1;
}

int vtkMultiLabelInterfaceMesher::RequestInformation(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  vtkInformation* info = inputs[0]->GetInformationObject(0);
  double spacing[3] = { 0.0, 0.0, 0.0 };
  if (info && info->Has(vtkDataObject::SPACING()))
  {
    info->Get(vtkDataObject::SPACING(), spacing);
  }
  std::transform(spacing, spacing + 3, spacing, [](double s) { return std::abs(s); });
  const double unit = mlim_spacing_unit(spacing);
  this->FacetSizeRange[0] = unit;
  this->FacetSizeRange[1] = 3.0 * unit;
  return 1;
}

int vtkMultiLabelInterfaceMesher::FillOutputPortInformation(int port, vtkInformation* info)
{
  if (port == 0)
  {
    return this->Superclass::FillOutputPortInformation(port, info);
  }
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkUnstructuredGrid");
  return 1;
}

vtkUnstructuredGrid* vtkMultiLabelInterfaceMesher::GetVolumeOutput()
{
  return vtkUnstructuredGrid::SafeDownCast(this->GetOutputDataObject(1));
}

void vtkMultiLabelInterfaceMesher::SetLabelCellSize(int id, double size)
{
  if (!(size >= 0.0) || size == this->GetLabelCellSize(id))
  {
    return;
  }
  if (size > 0.0)
  {
    this->LabelCellSizes[id] = size;
  }
  else
  {
    this->LabelCellSizes.erase(id);
  }
  this->Modified();
}

void vtkMultiLabelInterfaceMesher::SetLabelCellSize(const double idAndSize[2])
{
  const double id = idAndSize[0];
  // No label has another id; and its conversion would not be defined.
  if (id >= VTK_INT_MIN && id <= VTK_INT_MAX && id == std::floor(id))
  {
    this->SetLabelCellSize(static_cast<int>(id), idAndSize[1]);
  }
}

double vtkMultiLabelInterfaceMesher::GetLabelCellSize(int id)
{
  const auto found = this->LabelCellSizes.find(id);
  return found == this->LabelCellSizes.end() ? 0.0 : found->second;
}

void vtkMultiLabelInterfaceMesher::RemoveAllLabelCellSizes()
{
  if (!this->LabelCellSizes.empty())
  {
    this->LabelCellSizes.clear();
    this->Modified();
  }
}

int vtkMultiLabelInterfaceMesher::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* image = vtkImageData::GetData(inputs[0]);
  vtkPolyData* balls = vtkPolyData::GetData(inputs[1]);
  vtkPolyData* out = vtkPolyData::GetData(outputs);
  vtkUnstructuredGrid* volume = vtkUnstructuredGrid::GetData(outputs, 1);
  auto clear = [out, volume]()
  {
    out->Initialize();
    WriteSurface({}, {}, {}, out);
    volume->Initialize();
    WriteVolume({}, {}, false, volume);
  };
  if (IsLaterPiece(outputs))
  {
    return Guard(this, clear, clear);
  }
  return Guard(
    this, [&]() { this->Mesh(image, balls, out, volume); }, clear);
}

void vtkMultiLabelInterfaceMesher::Mesh(
  vtkImageData* image, vtkPolyData* balls, vtkPolyData* out, vtkUnstructuredGrid* volumeOut)
{
  Input input(image, this->GetChoice());
  std::vector<mlim_stage> stages = { MLIM_STAGE_FIELD, MLIM_STAGE_SURFACE, MLIM_STAGE_CERTIFICATE };
  if (!balls)
  {
    stages.insert(stages.begin() + 1, { MLIM_STAGE_CURVES, MLIM_STAGE_BALLS });
  }
  Run run(this, StagesFrom(input, stages));
  if (this->VolumeMesh)
  {
    run.Use(MLIM_STAGE_VOLUME);
  }
  const FieldPointer field = IndexField(input, run);
  this->WarnOf(input);
  Setting setting = MakeSetting(field.get(), input);
  mlim_options options = mlim_options_default(field.get());
  options.facet_size = this->FacetSize;
  options.facet_radius_edge_ratio = this->FacetRadiusEdgeRatio;
  options.facet_distance = this->FacetDistance;
  options.smallest_distance = 0; /* follows from the size */
  options.volume_tolerance = this->VolumeTolerance;
  options.edge_size = this->EdgeSize;
  options.ball_radius_scale = this->BallRadiusScale;
  options.crossing_tolerance = this->CrossingTolerance;
  options.oracle_mode = this->OracleMode == Exact ? MLIM_ORACLE_EXACT : MLIM_ORACLE_BISECTION;
  options.vertex_limit = static_cast<size_t>(this->VertexLimit);
  options.min_component_voxels = static_cast<size_t>(this->MinimumComponentVoxels);
  options.cell_size = this->CellSize;
  options.cell_radius_edge_ratio = this->CellRadiusEdgeRatio;
  options.remove_slivers = this->RemoveSlivers ? 1 : 0;
  options.keep_background = this->KeepBackground ? 1 : 0;
  std::vector<mlim_label_size> labelSizes;
  for (const auto& label : this->LabelCellSizes)
  {
    labelSizes.push_back({ label.first, label.second });
  }
  options.label_sizes = labelSizes.data();
  options.label_size_count = labelSizes.size();
  run.End(mlim_options_complete(field.get(), run.GetContext(), &options));

  vtkNew<vtkPolyData> ownBalls;
  if (!balls)
  {
    vtkNew<vtkPolyData> curves;
    setting.Options = CurveOptions(field.get(), this->GetJunctionMergeTolerance(), run);
    ExtractCurves(field.get(), setting, run, curves);
    const CoverChoice choice = { options.edge_size, options.facet_distance,
      options.ball_radius_scale };
    CoverCurves(curves, choice, run, ownBalls);
    balls = ownBalls;
  }
  const mlim_options used = CheckBalls(balls, setting).Options;
  options.edge_size = used.edge_size;
  options.ball_radius_scale = used.ball_radius_scale;
  options.junction_merge_tolerance = used.junction_merge_tolerance;
  setting.Options = options;
  BallCover cover = ReadBalls(balls, setting);
  const mlim_balls view = cover.View();

  MeshOwner mesh;
  VolumeOwner volume;
  run.Begin(MLIM_STAGE_SURFACE);
  const mlim_status status =
    this->VolumeMesh
      ? mlim_volume_refine(field.get(), &view, &options, run.GetContext(), &mesh, &volume)
      : mlim_mesh_refine(field.get(), &view, &options, run.GetContext(), &mesh);
  run.End(status);
  if (status == MLIM_VERTEX_LIMIT)
  {
    vtkWarningMacro("Refinement stopped at the vertex limit of "
                    << this->VertexLimit
                    << "; the mesh is consistent but does not meet all bounds.");
  }
  const std::string loss = LossOf(mesh.certificate);
  if (!loss.empty())
  {
    vtkWarningMacro(<< loss << " of at least " << this->MinimumComponentVoxels
                    << " voxels are not in the mesh. A smaller FacetSize may bring them back.");
  }

  SurfaceChoice shown;
  shown.CapBoundary = this->CapBoundary;
  shown.OutputCurves = this->OutputCurves;
  shown.IsLabelActive = this->ActiveScalars == Label;
  shown.IsSinglePrecision = this->OutputPointsPrecision == SINGLE_PRECISION;
  WriteSurface(mesh, setting, shown, out);
  WriteSetting(setting, out->GetFieldData());
  WriteFigures(mesh, setting, out);
  WriteCount("BallCount", view.ball_count, out->GetFieldData());
  WriteCount("VertexLimitReached", status == MLIM_VERTEX_LIMIT ? 1 : 0, out->GetFieldData());
  run.WriteTimes(out->GetFieldData());

  WriteVolume(volume, setting, shown.IsSinglePrecision, volumeOut);
  if (this->VolumeMesh)
  {
    WriteSetting(setting, volumeOut->GetFieldData());
    WriteVolumeFigures(volume, options, volumeOut);
    WriteCount(
      "VertexLimitReached", status == MLIM_VERTEX_LIMIT ? 1 : 0, volumeOut->GetFieldData());
    run.WriteTimes(volumeOut->GetFieldData());
  }
}
