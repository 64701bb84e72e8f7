#include "vtkMultiLabelCurveProtector.h"

#include "vtkMultiLabelProducts.h"
#include "vtkMultiLabelRun.h"
#include "vtkMultiLabelStages.h"

#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkStandardNewMacro(vtkMultiLabelCurveProtector);

vtkMultiLabelCurveProtector::vtkMultiLabelCurveProtector()
  : BallRadiusScale(vtkMultiLabel::default_ball_radius_scale)
{
}

vtkMultiLabelCurveProtector::~vtkMultiLabelCurveProtector() = default;

void vtkMultiLabelCurveProtector::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "EdgeSize: " << this->EdgeSize << "\n";
  os << indent << "FacetDistance: " << this->FacetDistance << "\n";
  os << indent << "BallRadiusScale: " << this->BallRadiusScale << "\n";
}

int vtkMultiLabelCurveProtector::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = inputs[0]->GetInformationObject(0);
  info->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
  info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
  info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
  return 1;
}

int vtkMultiLabelCurveProtector::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  using namespace vtkMultiLabel;
  vtkPolyData* curves = vtkPolyData::GetData(inputs[0]);
  vtkPolyData* out = vtkPolyData::GetData(outputs);
  auto clear = [out]()
  {
    out->Initialize();
    WriteBalls({}, {}, out);
  };
  if (IsLaterPiece(outputs))
  {
    return Guard(this, clear, clear);
  }
  auto protect = [&]()
  {
    Run run(this, { MLIM_STAGE_BALLS });
    const CoverChoice choice = { this->EdgeSize, this->FacetDistance, this->BallRadiusScale };
    CoverCurves(curves, choice, run, out);
    run.WriteTimes(out->GetFieldData());
  };
  return Guard(this, protect, clear);
}
