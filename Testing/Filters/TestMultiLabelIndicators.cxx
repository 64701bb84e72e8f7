// Label maps: the arrays that the filter makes of them, and the mesher's way that leaves them out.
#include "MultiLabelTest.h"

#include "vtkDataArraySelection.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkMultiLabelCurveExtractor.h"
#include "vtkMultiLabelIndicators.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkShortArray.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <functional>
#include <set>
#include <sstream>

using namespace test;

namespace
{

// The two balls with ids of their own.
std::vector<double> MapOf(double first, double second, double outside = 0.0)
{
  std::vector<double> values;
  for (int k = 0; k < Size; ++k)
  {
    for (int j = 0; j < Size; ++j)
    {
      for (int i = 0; i < Size; ++i)
      {
        const double x[3] = { double(i), double(j), double(k) };
        const int label = LabelAt(x);
        values.push_back(label == 0 ? outside : label == 1 ? first : second);
      }
    }
  }
  return values;
}

template <typename ArrayT>
vtkSmartPointer<vtkImageData> MapImage(const std::vector<double>& values)
{
  auto image = MakeGrid();
  image->SetSpacing(1.0, 0.8, 1.2);
  image->GetPointData()->AddArray(MakeArray<ArrayT>("parts", values));
  return image;
}

vtkSmartPointer<vtkMultiLabelIndicators> FilterOf(vtkImageData* image)
{
  auto filter = vtkSmartPointer<vtkMultiLabelIndicators>::New();
  filter->SetInputData(image);
  return filter;
}

vtkSmartPointer<vtkImageData> IndicatorsOf(vtkImageData* image)
{
  auto filter = FilterOf(image);
  filter->Update();
  return filter->GetOutput();
}

vtkSmartPointer<vtkPolyData> MeshOf(vtkImageData* image)
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(image);
  mesher->Update();
  return mesher->GetOutput();
}

std::vector<int> IdsOf(vtkDataObject* data)
{
  std::vector<int> ids;
  vtkDataArray* array = data->GetFieldData()->GetArray("LabelIds");
  for (vtkIdType n = 0; array && n < array->GetNumberOfValues(); ++n)
  {
    ids.push_back(array->GetVariantValue(n).ToInt());
  }
  return ids;
}

std::set<int> LabelsOf(vtkPolyData* surface)
{
  vtkDataArray* array = surface->GetCellData()->GetArray("BoundaryLabels");
  std::set<int> labels;
  for (vtkIdType c = surface->GetNumberOfVerts() + surface->GetNumberOfLines();
       c < surface->GetNumberOfCells(); ++c)
  {
    labels.insert(static_cast<int>(array->GetComponent(c, 0)));
    labels.insert(static_cast<int>(array->GetComponent(c, 1)));
  }
  return labels;
}

bool AreSameArrays(vtkDataSetAttributes* a, vtkDataSetAttributes* b)
{
  bool result = a->GetNumberOfArrays() > 0 && a->GetNumberOfArrays() == b->GetNumberOfArrays();
  for (int n = 0; result && n < a->GetNumberOfArrays(); ++n)
  {
    vtkDataArray* x = a->GetArray(n);
    vtkDataArray* y = b->GetArray(x->GetName());
    result = y && x->GetNumberOfTuples() == y->GetNumberOfTuples();
    for (vtkIdType p = 0; result && p < x->GetNumberOfTuples(); ++p)
    {
      result = x->GetComponent(p, 0) == y->GetComponent(p, 0);
    }
  }
  return result;
}

void CheckArrays()
{
  auto image = MapImage<vtkShortArray>(MapOf(-7, 300));
  vtkNew<vtkIntArray> ids;
  ids->SetName("LabelIds");
  vtkNew<vtkStringArray> names;
  names->SetName("LabelNames");
  ids->InsertNextValue(300);
  names->InsertNextValue("kernel");
  image->GetFieldData()->AddArray(ids);
  image->GetFieldData()->AddArray(names);
  auto out = IndicatorsOf(image);
  CHECK((IdsOf(out) == std::vector<int>{ -7, 0, 300 }), "ascending, kept as they are");
  CHECK(out->GetPointData()->GetNumberOfArrays() == 3, "");
  for (const char* name : { "label_-7", "background", "kernel" })
  {
    vtkDataArray* array = out->GetPointData()->GetArray(name);
    CHECK(array && array->GetDataType() == VTK_FLOAT, name);
    double range[2] = { 0.0, 0.0 };
    if (array)
    {
      array->GetRange(range);
    }
    // The band is 3 of the largest spacings; a label's constant at most six tenths of the smallest.
    CHECK(range[0] >= static_cast<double>(-3.6F) && range[0] < -2.0, name);
    CHECK(range[1] > 1.0 && range[1] <= 4.0801, name);
  }
  CHECK(out->GetSpacing()[2] == 1.2, "the geometry is the input's");
  CHECK((LabelsOf(MeshOf(out)) == std::set<int>{ -7, 0, 300 }), "negative ids in a mesh");
}

// All that holds the same numbers gives the same arrays.
void CheckTypes()
{
  const std::vector<double> values = MapOf(5, 9);
  auto expected = IndicatorsOf(MapImage<vtkUnsignedCharArray>(values));
  for (auto image : { MapImage<vtkFloatArray>(values), MapImage<vtkDoubleArray>(values),
         MapImage<vtkIdTypeArray>(values), MapImage<vtkSOADataArrayTemplate<short>>(values) })
  {
    CHECK(AreSameArrays(expected->GetPointData(), IndicatorsOf(image)->GetPointData()),
      image->GetPointData()->GetArray(0)->GetClassName());
  }
  auto cells = vtkSmartPointer<vtkImageData>::New();
  cells->SetDimensions(Size + 1, Size + 1, Size + 1);
  cells->SetSpacing(1.0, 0.8, 1.2);
  cells->GetCellData()->AddArray(MakeArray<vtkIntArray>("parts", values));
  CHECK(AreSameArrays(expected->GetPointData(), IndicatorsOf(cells)->GetCellData()), "cell data");
  // Beside another array it has to be chosen.
  auto two = MapImage<vtkUnsignedCharArray>(values);
  two->GetPointData()->AddArray(MakeArray<vtkFloatArray>("other", ValuesOf(1)));
  auto filter = FilterOf(two);
  filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, "parts");
  filter->Update();
  CHECK(AreSameArrays(expected->GetPointData(), filter->GetOutput()->GetPointData()), "chosen");
  two->GetPointData()->SetActiveScalars("parts");
  CHECK(AreSameArrays(expected->GetPointData(), IndicatorsOf(two)->GetPointData()), "active");
}

// The mesher and the extractor make the same of the map as of its indicators.
void CheckDirect()
{
  auto image = MapImage<vtkShortArray>(MapOf(12, 30000));
  auto direct = MeshOf(image);
  CHECK(AreSame(direct, MeshOf(IndicatorsOf(image))), "the same mesh");
  CHECK((LabelsOf(direct) == std::set<int>{ 0, 12, 30000 }), "");
  CHECK(direct->GetFieldData()->GetArray("TimeIndicators")->GetComponent(0, 0) > 0.0, "");
  vtkNew<vtkMultiLabelCurveExtractor> extractor;
  extractor->SetInputData(image);
  extractor->Update();
  vtkSmartPointer<vtkPolyData> curves = vtkSmartPointer<vtkPolyData>::New();
  curves->ShallowCopy(extractor->GetOutput());
  extractor->SetInputData(IndicatorsOf(image));
  extractor->Update();
  CHECK(AreSame(curves, extractor->GetOutput()), "the same curves");

  // A selected array counts as alone, and integers with a background of another kind are no map.
  image->GetPointData()->AddArray(MakeArray<vtkFloatArray>("other", ValuesOf(1)));
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(image);
  mesher->GetPointArraySelection()->EnableArray("parts");
  mesher->Update();
  CHECK(AreSame(direct, mesher->GetOutput()), "the selected array");
  mesher->SetBackgroundModeToConstant();
  mesher->SetBackgroundValue(15.0);
  mesher->Update();
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1 }), "an indicator of whole numbers");

  // Whole numbers in floating point are an indicator as well.
  vtkNew<vtkMultiLabelInterfaceMesher> other;
  other->SetInputData(MapImage<vtkFloatArray>(MapOf(12, 13)));
  Messages messages(other);
  other->Update();
  CHECK(Contains(messages.Warnings, "vtkMultiLabelIndicators"), messages.Warnings);
}

void CheckProperties()
{
  auto image = MapImage<vtkIntArray>(MapOf(5, 9));
  auto filter = FilterOf(image);
  filter->AddLabel(9);
  filter->AddLabel(9);
  CHECK(filter->GetNumberOfLabels() == 1 && filter->GetLabel(0) == 9, "");
  filter->Update();
  CHECK((IdsOf(filter->GetOutput()) == std::vector<int>{ 0, 9 }), "all others are background");
  filter->RemoveAllLabels();
  filter->SetBackgroundLabel(-1);
  Messages messages(filter);
  filter->Update();
  CHECK(Contains(messages.Errors, "has the label 0"), messages.Errors);
  messages.Errors.clear();
  auto grains = FilterOf(MapImage<vtkIntArray>(MapOf(5, 9, 2)));
  grains->Update();
  CHECK((IdsOf(grains->GetOutput()) == std::vector<int>{ 2, 5, 9 }), "no background");
  CHECK(MeshOf(grains->GetOutput())->GetBounds()[0] == 0.0, "so the box is full");
  grains->SetBackgroundLabel(2);
  grains->Update();
  CHECK((IdsOf(grains->GetOutput()) == std::vector<int>{ 0, 5, 9 }), "the background's id is 0");
  grains->SetMethodToGaussianMask();
  grains->SetGaussianSigma(1.0);
  grains->SetKeepThinLabels(false);
  grains->Update();
  vtkPointData* masks = grains->GetOutput()->GetPointData();
  for (vtkIdType p = 0; p < grains->GetOutput()->GetNumberOfPoints(); ++p)
  {
    double sum = 0.0;
    for (int n = 0; n < 3; ++n)
    {
      sum += masks->GetArray(n)->GetComponent(p, 0);
    }
    CHECK(std::abs(sum - 1.0) < 1e-4, "masks share out each point");
  }
  const vtkMTimeType time = grains->GetMTime();
  grains->SetMedianRadius(2);
  grains->SetDilateRadius(1);
  grains->SetDistanceBand(4.0);
  grains->SetGaussianSmoothing(false);
  grains->SetPreserveVolume(false);
  grains->SetCurvatureDiffusionIterations(3);
  grains->SetCurvatureDiffusionTimeStep(0.1);
  CHECK(grains->GetMTime() > time, "");
  std::ostringstream text;
  grains->Print(text);
  for (const char* part : { "BackgroundLabel: 2", "MedianRadius: 2", "DilateRadius: 1",
         "Method: GaussianMask", "DistanceBand: 4", "GaussianSmoothing: Off", "GaussianSigma: 1",
         "PreserveVolume: Off", "KeepThinLabels: Off", "CurvatureDiffusionIterations: 3",
         "CurvatureDiffusionTimeStep: 0.1", "Labels: all" })
  {
    CHECK(Contains(text.str(), part), part);
  }
}

void CheckLoss()
{
  std::vector<double> values = MapOf(5, 5);
  values[2 + Size * (2 + Size * 3)] = 77;
  auto filter = FilterOf(MapImage<vtkIntArray>(values));
  Messages messages(filter);
  filter->Update();
  CHECK(messages.Warnings.empty(), messages.Warnings);
  filter->SetKeepThinLabels(false);
  filter->Update();
  CHECK(Contains(messages.Warnings, "1 of 3 labels are lost"), messages.Warnings);
  CHECK(Contains(messages.Warnings, "77 (label_77)"), messages.Warnings);
  CHECK(Contains(messages.Warnings, "KeepThinLabels"), messages.Warnings);
}

void CheckBlanking()
{
  auto image = MapImage<vtkIntArray>(MapOf(5, 9));
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  for (int i = 0; i < Size * Size * Size; ++i)
  {
    ghosts->InsertNextValue(i % Size >= 9 ? vtkDataSetAttributes::HIDDENPOINT : 0);
  }
  image->GetPointData()->AddArray(ghosts);
  auto direct = MeshOf(image);
  CHECK(direct->GetBounds()[1] <= 9.0, "blanked points are background");
  CHECK(AreSame(direct, MeshOf(IndicatorsOf(image))), "and the filter passes them on");
}

void CheckRefused(const std::string& part, vtkImageData* image)
{
  auto filter = FilterOf(image);
  Messages messages(filter);
  filter->Update();
  CHECK(Contains(messages.Errors, part), messages.Errors);
  CHECK(filter->GetOutput()->GetPointData()->GetNumberOfArrays() == 0, part);
}

void CheckErrors()
{
  CheckRefused("0.5, at point (0, 0, 0)", MapImage<vtkFloatArray>(MapOf(1, 2, 0.5)));
  CheckRefused("5000000000", MapImage<vtkIdTypeArray>(MapOf(1, 5e9)));
  auto image = MapImage<vtkIntArray>(MapOf(1, 2));
  image->GetPointData()->AddArray(MakeArray<vtkIntArray>("again", MapOf(1, 2)));
  CheckRefused("There is no label map", image);
  auto flat = vtkSmartPointer<vtkImageData>::New();
  flat->SetDimensions(4, 4, 1);
  flat->GetPointData()->AddArray(MakeArray<vtkIntArray>("parts", std::vector<double>(16, 1.0)));
  CheckRefused("4 x 4 x 1", flat);
  auto pairs = MakeGrid();
  vtkNew<vtkIntArray> wide;
  wide->SetName("pairs");
  wide->SetNumberOfComponents(2);
  wide->SetNumberOfTuples(Size * Size * Size);
  wide->Fill(0);
  pairs->GetPointData()->SetScalars(wide);
  CheckRefused("'pairs' has 2 components", pairs);
  auto filter = FilterOf(MapImage<vtkIntArray>(MapOf(1, 2)));
  Messages messages(filter);
  filter->SetDistanceBand(1.0);
  filter->Update();
  CHECK(Contains(messages.Errors, "at least a voxel's diagonal"), messages.Errors);
  messages.Errors.clear();
  filter->SetDistanceBand(0.0);
  filter->AddLabel(3);
  filter->Update();
  CHECK(Contains(messages.Errors, "no label 3"), messages.Errors);
}

// The direct path's errors are the mesher's.
void CheckDirectErrors()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(MapImage<vtkIdTypeArray>(MapOf(1, 5e9)));
  Messages messages(mesher);
  mesher->Update();
  CHECK(Contains(messages.Errors, "\"parts\""), messages.Errors);
  CHECK(Contains(messages.Errors, "5000000000"), messages.Errors);
  CHECK(IsTypedEmpty(mesher->GetOutput()), "");
}

// An abort at any progress event of the filter leaves the geometry and no arrays.
void CheckAbort()
{
  int count = 1;
  for (int stop = 0; stop < count; ++stop)
  {
    auto filter = FilterOf(MapImage<vtkIntArray>(MapOf(1, 2)));
    Messages messages(filter);
    std::vector<double> fractions;
    vtkNew<vtkCallbackCommand> command;
    std::function<void(vtkAlgorithm*)> look = [&](vtkAlgorithm* source)
    {
      fractions.push_back(source->GetProgress());
      if (static_cast<int>(fractions.size()) == stop)
      {
        source->SetAbortExecute(1);
      }
    };
    command->SetClientData(&look);
    command->SetCallback(
      [](vtkObject* caller, unsigned long, void* data, void*) {
        (*static_cast<std::function<void(vtkAlgorithm*)>*>(data))(
          static_cast<vtkAlgorithm*>(caller));
      });
    filter->AddObserver(vtkCommand::ProgressEvent, command);
    filter->Update();
    CHECK(messages.Errors.empty(), messages.Errors);
    CHECK(std::is_sorted(fractions.begin(), fractions.end()), "monotone");
    // Events depend on the time that passes, so a run may have fewer than the first one.
    const bool isReached = stop > 0 && static_cast<int>(fractions.size()) >= stop;
    const double fraction = isReached ? fractions[static_cast<size_t>(stop - 1)] : 1.0;
    const int arrays = filter->GetOutput()->GetPointData()->GetNumberOfArrays();
    CHECK(arrays == 0 || arrays == 3, "all or nothing");
    CHECK(!isReached || fraction >= 1.0 || arrays == 0, std::to_string(stop));
    CHECK(isReached || arrays == 3, std::to_string(stop));
    // From VTK 9.2 on the pipeline takes the geometry of a stopped filter back.
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 0)
    const bool keepsGeometry = !isReached;
#else
    const bool keepsGeometry = true;
#endif
    CHECK(!keepsGeometry || filter->GetOutput()->GetDimensions()[0] == Size, "");
    count = stop == 0 ? static_cast<int>(fractions.size()) : count;
  }
  CHECK(count > 5, "");
}

}

int TestMultiLabelIndicators(int, char*[])
{
  CheckArrays();
  CheckTypes();
  CheckDirect();
  CheckProperties();
  CheckLoss();
  CheckBlanking();
  CheckErrors();
  CheckDirectErrors();
  CheckAbort();
  return Result();
}
