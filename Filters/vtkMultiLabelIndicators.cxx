#include "vtkMultiLabelIndicators.h"

#include "vtkMultiLabelFrame.h"
#include "vtkMultiLabelMap.h"
#include "vtkMultiLabelRun.h"

#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDataObject.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <set>

using namespace vtkMultiLabel;

vtkStandardNewMacro(vtkMultiLabelIndicators);

namespace
{

// The label map as the core reads it.
struct Source
{
  vtkDataArray* Values = nullptr;
  bool IsCellCentred = false;
  vtkSmartPointer<vtkDoubleArray> Copy; // for a memory layout that the core does not read
};

// The one array with one component of points, or else of cells; nullptr: none or several.
vtkDataArray* FindAlone(vtkFieldData* arrays)
{
  vtkDataArray* found = nullptr;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    vtkDataArray* array = arrays->GetArray(i);
    if (!array || array->GetNumberOfComponents() != 1 ||
        (array->GetName() &&
          array->GetName() == std::string(vtkDataSetAttributes::GhostArrayName())))
    {
      continue;
    }
    if (found)
    {
      return nullptr;
    }
    found = array;
  }
  return found;
}

std::string NameOfArray(vtkDataArray* array)
{
  return array->GetName() ? array->GetName() : "";
}

Source FindSource(vtkImageData* image, vtkDataArray* chosen, int association)
{
  Source source;
  source.Values = chosen;
  source.IsCellCentred = association == vtkDataObject::FIELD_ASSOCIATION_CELLS;
  if (!chosen)
  {
    source.Values = FindAlone(image->GetPointData());
    source.IsCellCentred = !source.Values;
  }
  if (!source.Values)
  {
    source.Values = FindAlone(image->GetCellData());
  }
  if (!source.Values)
  {
    throw Refusal(
      "There is no label map: no array is selected that the image has, it has no active "
      "scalars, and not one array with one component.");
  }
  if (source.Values->GetNumberOfComponents() != 1)
  {
    throw Refusal("The label map '" + NameOfArray(source.Values) + "' has " +
                  std::to_string(source.Values->GetNumberOfComponents()) +
                  " components; one is needed.");
  }
  return source;
}

mlim_array Borrow(Source& source, const std::string& name, const Frame& frame)
{
  vtkDataArray* values = source.Values;
  const int* n = frame.Dimensions;
  const vtkIdType count = static_cast<vtkIdType>(n[0]) * n[1] * n[2];
  if (values->GetNumberOfTuples() != count)
  {
    throw Refusal("The label map '" + name + "' has " +
                  std::to_string(values->GetNumberOfTuples()) + " values for " +
                  std::to_string(count) + (source.IsCellCentred ? " cells." : " points."));
  }
  mlim_array array = {};
  array.name = name.c_str();
  array.type = ScalarType(values->GetDataType());
  array.stride = 1;
  if (array.type != MLIM_SCALAR_END && values->HasStandardMemoryLayout())
  {
    array.values = values->GetVoidPointer(0);
    return array;
  }
  source.Copy = vtkSmartPointer<vtkDoubleArray>::New();
  source.Copy->SetNumberOfTuples(count);
  source.Copy->CopyComponent(0, values, 0);
  array.type = MLIM_FLOAT64;
  array.values = source.Copy->GetPointer(0);
  return array;
}

// The name, or with a number if another array has it.
std::string MakeUnique(const std::string& name, std::set<std::string>& taken)
{
  std::string result = name;
  for (int n = 2; !taken.insert(result).second; ++n)
  {
    result = name + "_" + std::to_string(n);
  }
  return result;
}

// One array a label, and what the next filter reads from the field data.
void WriteIndicators(const LabelMap& map, size_t background, const mlim_indicators* indicators,
  bool isCellCentred, Run& run, vtkImageData* out)
{
  vtkDataSetAttributes* attributes =
    isCellCentred ? static_cast<vtkDataSetAttributes*>(out->GetCellData()) : out->GetPointData();
  vtkNew<vtkIntArray> ids;
  ids->SetName("LabelIds");
  vtkNew<vtkStringArray> names;
  names->SetName("LabelNames");
  std::set<std::string> taken;
  const vtkIdType count = static_cast<vtkIdType>(map.dims[0]) * map.dims[1] * map.dims[2];
  for (size_t label = 0; label < map.LabelCount(); ++label)
  {
    const std::string name = MakeUnique(map.NameOf(label, background), taken);
    vtkNew<vtkFloatArray> array;
    array->SetName(name.c_str());
    array->SetNumberOfTuples(count);
    mlim_indicators_write(indicators, static_cast<int32_t>(label), array->GetPointer(0));
    attributes->AddArray(array);
    ids->InsertNextValue(label == background ? 0 : map.ids[label]);
    names->InsertNextValue(name);
    run.Begin(MLIM_STAGE_INDICATORS);
  }
  out->GetFieldData()->AddArray(ids);
  out->GetFieldData()->AddArray(names);
}

}

vtkMultiLabelIndicators::vtkMultiLabelIndicators() : BackgroundLabel(default_background_label)
{
  this->SetInputArrayToProcess(
    0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS_THEN_CELLS, vtkDataSetAttributes::SCALARS);
}

vtkMultiLabelIndicators::~vtkMultiLabelIndicators() = default;

void vtkMultiLabelIndicators::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "Labels:";
  for (int id : this->Labels)
  {
    os << " " << id;
  }
  os << (this->Labels.empty() ? " all\n" : "\n");
  os << indent << "BackgroundLabel: " << this->BackgroundLabel << "\n";
  os << indent << "MedianRadius: " << this->MedianRadius << "\n";
  os << indent << "DilateRadius: " << this->DilateRadius << "\n";
  os << indent << "Method: " << (this->Method == SignedDistance ? "SignedDistance" : "GaussianMask")
     << "\n";
  os << indent << "DistanceBand: " << this->DistanceBand << "\n";
  os << indent << "GaussianSmoothing: " << (this->GaussianSmoothing ? "On" : "Off") << "\n";
  os << indent << "GaussianSigma: " << this->GaussianSigma << "\n";
  os << indent << "PreserveVolume: " << (this->PreserveVolume ? "On" : "Off") << "\n";
  os << indent << "KeepThinLabels: " << (this->KeepThinLabels ? "On" : "Off") << "\n";
  os << indent << "CurvatureDiffusionIterations: " << this->CurvatureDiffusionIterations << "\n";
  os << indent << "CurvatureDiffusionTimeStep: " << this->CurvatureDiffusionTimeStep << "\n";
}

void vtkMultiLabelIndicators::AddLabel(int id)
{
  if (std::find(this->Labels.begin(), this->Labels.end(), id) == this->Labels.end())
  {
    this->Labels.push_back(id);
    this->Modified();
  }
}

void vtkMultiLabelIndicators::RemoveAllLabels()
{
  if (!this->Labels.empty())
  {
    this->Labels.clear();
    this->Modified();
  }
}

int vtkMultiLabelIndicators::GetLabel(int index) const
{
  return index >= 0 && index < this->GetNumberOfLabels() ? this->Labels[static_cast<size_t>(index)]
                                                         : 0;
}

int vtkMultiLabelIndicators::RequestInformation(
  vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs)
{
  vtkDataObject::SetPointDataActiveScalarInfo(outputs->GetInformationObject(0), VTK_FLOAT, 1);
  return 1;
}

int vtkMultiLabelIndicators::RequestUpdateExtent(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  vtkInformation* info = inputs[0]->GetInformationObject(0);
  if (info->Has(Pipeline::WHOLE_EXTENT()))
  {
    int extent[6];
    info->Get(Pipeline::WHOLE_EXTENT(), extent);
    info->Set(Pipeline::UPDATE_EXTENT(), extent, 6);
  }
  return 1;
}

int vtkMultiLabelIndicators::RequestData(
  vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs)
{
  vtkImageData* image = vtkImageData::GetData(inputs[0]);
  vtkImageData* out = vtkImageData::GetData(outputs);
  auto clear = [image, out]()
  {
    out->Initialize();
    if (image)
    {
      out->CopyStructure(image);
    }
  };
  return Guard(
    this,
    [&]()
    {
      clear();
      this->Make(image, out);
    },
    clear);
}

void vtkMultiLabelIndicators::Make(vtkImageData* image, vtkImageData* out)
{
  if (!image || image->GetNumberOfPoints() == 0)
  {
    throw Refusal("The input image is empty.");
  }
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* chosen = this->GetInputArrayToProcess(0, image, association);
  Source source = FindSource(image, chosen, association);
  const std::string name = NameOfArray(source.Values);
  const Frame frame = FrameOfImage(image, source.IsCellCentred);
  const mlim_array values = Borrow(source, name, frame);

  Run run(this, { MLIM_STAGE_INDICATORS });
  LabelMap map;
  map.Read(values, frame.Dimensions, frame.Spacing, run);
  map.Select(this->Labels, this->BackgroundLabel, run);
  const size_t background = map.FindBackground(this->BackgroundLabel);
  map.ReadNames(image->GetFieldData());

  mlim_indicator_options options = mlim_indicator_options_default();
  options.method = this->Method == SignedDistance ? MLIM_INDICATOR_DISTANCE : MLIM_INDICATOR_MASK;
  options.median_radius = this->MedianRadius;
  options.dilate_radius = this->DilateRadius;
  options.distance_band = this->DistanceBand;
  options.gaussian_sigma = this->GaussianSmoothing ? this->GaussianSigma : -1.0;
  options.keeps_volume = this->PreserveVolume ? 1 : 0;
  options.keeps_thin = this->KeepThinLabels ? 1 : 0;
  options.diffusion_iterations = this->CurvatureDiffusionIterations;
  options.diffusion_time_step = this->CurvatureDiffusionTimeStep;
  const IndicatorsPointer indicators = map.MakeIndicators(options, run);

  WriteIndicators(map, background, indicators.get(), source.IsCellCentred, run, out);
  vtkDataSetAttributes* from = source.IsCellCentred
                                 ? static_cast<vtkDataSetAttributes*>(image->GetCellData())
                                 : image->GetPointData();
  vtkDataSetAttributes* to = source.IsCellCentred
                               ? static_cast<vtkDataSetAttributes*>(out->GetCellData())
                               : out->GetPointData();
  if (vtkAbstractArray* blanked = from->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()))
  {
    to->AddArray(blanked);
  }
  const std::string loss = map.LossOf(indicators.get(), background);
  if (!loss.empty())
  {
    vtkWarningMacro(<< loss << (this->KeepThinLabels ? "" : " KeepThinLabels keeps them."));
  }
}
