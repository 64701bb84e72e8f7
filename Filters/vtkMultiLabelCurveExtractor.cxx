#include "vtkMultiLabelCurveExtractor.h"

#include "vtkMultiLabelInput.h"
#include "vtkMultiLabelProducts.h"
#include "vtkMultiLabelRun.h"
#include "vtkMultiLabelStages.h"

#include "vtkImageData.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"

vtkStandardNewMacro(vtkMultiLabelCurveExtractor);

vtkMultiLabelCurveExtractor::vtkMultiLabelCurveExtractor() = default;

vtkMultiLabelCurveExtractor::~vtkMultiLabelCurveExtractor() = default;

void vtkMultiLabelCurveExtractor::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
}

int vtkMultiLabelCurveExtractor::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  using namespace vtkMultiLabel;
  vtkImageData* image = vtkImageData::GetData(inputs[0]);
  vtkPolyData* out = vtkPolyData::GetData(outputs);
  auto clear = [out]()
  {
    out->Initialize();
    WriteCurves({}, {}, out);
  };
  if (IsLaterPiece(outputs))
  {
    return Guard(this, clear, clear);
  }
  auto extract = [&]()
  {
    Input input(image, this->GetChoice());
    Run run(this, StagesFrom(input, { MLIM_STAGE_FIELD, MLIM_STAGE_CURVES }));
    const FieldPointer field = IndexField(input, run);
    this->WarnOf(input);
    Setting setting = MakeSetting(field.get(), input);
    setting.Options = CurveOptions(field.get(), this->GetJunctionMergeTolerance(), run);
    ExtractCurves(field.get(), setting, run, out);
    run.WriteTimes(out->GetFieldData());
  };
  return Guard(this, extract, clear);
}
