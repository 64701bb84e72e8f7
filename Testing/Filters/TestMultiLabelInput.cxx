// The ways in which an image may hold its labels; most give the same mesh.
#include "MultiLabelTest.h"

#include "vtkDataArraySelection.h"
#include "vtkDataSetAttributes.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkSOADataArrayTemplate.h"
#include "vtkShortArray.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <set>

using namespace test;

namespace
{

const double none[3] = { 0.0, 0.0, 0.0 };

vtkSmartPointer<vtkMultiLabelInterfaceMesher> MesherOf(vtkImageData* image)
{
  auto mesher = vtkSmartPointer<vtkMultiLabelInterfaceMesher>::New();
  mesher->SetInputData(image);
  return mesher;
}

vtkSmartPointer<vtkPolyData> MeshOf(vtkImageData* image)
{
  auto mesher = MesherOf(image);
  mesher->Update();
  return mesher->GetOutput();
}

std::set<int> LabelsOf(vtkPolyData* surface)
{
  vtkDataArray* array = surface->GetCellData()->GetArray("BoundaryLabels");
  std::set<int> labels;
  for (vtkIdType c = 0; c < surface->GetNumberOfCells(); ++c)
  {
    labels.insert(static_cast<int>(array->GetComponent(c, 0)));
    labels.insert(static_cast<int>(array->GetComponent(c, 1)));
  }
  labels.erase(-1);
  return labels;
}

template <typename ArrayT>
vtkSmartPointer<vtkImageData> ImageOf(double factor)
{
  auto image = MakeGrid();
  const char* const names[] = { "background", "first", "second" };
  for (int label = 0; label < 3; ++label)
  {
    std::vector<double> values = ValuesOf(label);
    for (double& value : values)
    {
      value = factor == 1.0 ? value : std::round(factor * value);
    }
    image->GetPointData()->AddArray(MakeArray<ArrayT>(names[label], values));
  }
  return image;
}

void CheckTypes(vtkPolyData* expected)
{
  CHECK(AreSame(expected, MeshOf(ImageOf<vtkDoubleArray>(1.0))), "double");
  CHECK(AreSame(expected, MeshOf(ImageOf<vtkSOADataArrayTemplate<float>>(1.0))), "another layout");
  // Integers round, so only among themselves.
  auto ints = MeshOf(ImageOf<vtkIntArray>(1000.0));
  CHECK(AreSame(ints, MeshOf(ImageOf<vtkShortArray>(1000.0))), "short");
  CHECK(AreSame(ints, MeshOf(ImageOf<vtkDoubleArray>(1000.0))), "integers in double");
}

void CheckComponents(vtkPolyData* expected)
{
  auto image = MakeGrid();
  vtkNew<vtkFloatArray> array;
  array->SetName("labels");
  array->SetNumberOfComponents(3);
  array->SetNumberOfTuples(Size * Size * Size);
  const char* const names[] = { "Background", "first", "second" };
  for (int label = 0; label < 3; ++label)
  {
    const std::vector<double> values = ValuesOf(label);
    array->SetComponentName(label, names[label]);
    for (size_t i = 0; i < values.size(); ++i)
    {
      array->SetComponent(static_cast<vtkIdType>(i), label, values[i]);
    }
  }
  image->GetPointData()->AddArray(array);
  CHECK(AreSame(expected, MeshOf(image)), "one label a component");
  // Beside arrays with one component it is passed over, unless it alone is selected.
  image->GetPointData()->AddArray(MakeArray<vtkFloatArray>("alone", ValuesOf(1)));
  auto mesher = MesherOf(image);
  mesher->GetPointArraySelection()->EnableArray("labels");
  mesher->Update();
  CHECK(AreSame(expected, mesher->GetOutput()), "the selected one");
  mesher->GetPointArraySelection()->RemoveAllArrays();
  mesher->SetBackgroundModeToConstant();
  Messages messages(mesher);
  mesher->Update();
  CHECK(Contains(messages.Warnings, "'labels' has 3 components"), messages.Warnings);
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1 }), "");
}

void CheckCells(vtkPolyData* expected)
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(Size + 1, Size + 1, Size + 1);
  image->SetOrigin(-0.5, -0.5, -0.5);
  const char* const names[] = { "background", "first", "second" };
  for (int label = 0; label < 3; ++label)
  {
    image->GetCellData()->AddArray(MakeArray<vtkFloatArray>(names[label], ValuesOf(label)));
  }
  CHECK(AreSame(expected, MeshOf(image)), "points at the cells' centres");

  // A user interface that offers all arrays selects those of the cells along.
  auto both = MakeImage();
  vtkNew<vtkFloatArray> cells;
  cells->SetName("of cells");
  cells->SetNumberOfTuples(both->GetNumberOfCells());
  cells->Fill(1.0);
  both->GetCellData()->AddArray(cells);
  auto mesher = MesherOf(both);
  for (const char* name : { "000_Background", "first", "second", "of cells" })
  {
    mesher->GetPointArraySelection()->EnableArray(name);
  }
  Messages messages(mesher);
  mesher->Update();
  CHECK(Contains(messages.Warnings, "'of cells' is one of the cells"), messages.Warnings);
  CHECK(AreSame(expected, mesher->GetOutput()), "arrays of the points and of the cells");
}

void CheckExtent(vtkPolyData* expected)
{
  auto image = MakeImage();
  image->SetExtent(5, 5 + Size - 1, -3, -3 + Size - 1, 8, 8 + Size - 1);
  image->SetSpacing(1.0, 1.0, 1.0);
  const double shift[3] = { 5.0, -3.0, 8.0 };
  CHECK(AreSame(expected, MeshOf(image), 1e-9, shift), "extent that does not start at 0");
}

void CheckSelection()
{
  auto mesher = MesherOf(MakeImage());
  vtkDataArraySelection* selection = mesher->GetPointArraySelection();
  selection->EnableArray("000_Background");
  selection->EnableArray("second");
  selection->AddArray("first", false);
  mesher->Update();
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1 }), "one of two balls");
  double bounds[6];
  mesher->GetOutput()->GetBounds(bounds);
  CHECK(bounds[0] > 9.9 - 3.3 - 0.2, "the second ball only");
}

void CheckBackgrounds(vtkPolyData* expected)
{
  auto image = MakeGrid();
  image->GetPointData()->AddArray(MakeArray<vtkFloatArray>("first", ValuesOf(1)));
  image->GetPointData()->AddArray(MakeArray<vtkFloatArray>("second", ValuesOf(2)));
  auto mesher = MesherOf(image);
  mesher->SetBackgroundModeToConstant();
  mesher->Update();
  CHECK(AreSame(expected, mesher->GetOutput()), "constant 0 instead of an array of zeros");
  mesher->SetBackgroundValue(1.0);
  mesher->Update();
  CHECK(!AreSame(expected, mesher->GetOutput()), "smaller balls");
  CHECK(mesher->GetOutput()->GetLength() < expected->GetLength() - 1.0, "smaller balls");

  // Without background the two labels fill the box.
  mesher->SetBackgroundModeToArray();
  mesher->Update();
  double bounds[6];
  mesher->GetOutput()->GetBounds(bounds);
  for (int a = 0; a < 3; ++a)
  {
    CHECK(bounds[2 * a] == 0.0 && bounds[2 * a + 1] == Size - 1.0, "caps all round");
  }
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1, 2 }), "");
  mesher->SetBackgroundArrayName("first");
  mesher->Update();
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1 }), "named background");

  // Probabilities: what p and q leave of 1 is the largest outside.
  auto soft = MakeGrid();
  std::vector<double> p = ValuesOf(1);
  std::vector<double> q = ValuesOf(2);
  for (size_t i = 0; i < p.size(); ++i)
  {
    p[i] = std::min(1.0, std::max(0.0, p[i]));
    q[i] = std::min(1.0 - p[i], std::max(0.0, q[i]));
  }
  soft->GetPointData()->AddArray(MakeArray<vtkFloatArray>("p", p));
  soft->GetPointData()->AddArray(MakeArray<vtkFloatArray>("q", q));
  auto complement = MesherOf(soft);
  complement->SetBackgroundModeToComplement();
  complement->Update();
  CHECK((LabelsOf(complement->GetOutput()) == std::set<int>{ 0, 1, 2 }), "");
  complement->GetOutput()->GetBounds(bounds);
  CHECK(bounds[0] > 0.0 && bounds[1] < Size - 1.0, "the box is background");
}

void CheckIds()
{
  auto image = MakeImage();
  vtkNew<vtkIntArray> ids;
  ids->SetName("LabelIds");
  vtkNew<vtkStringArray> names;
  names->SetName("LabelNames");
  for (int id : { 0, 240, 17 })
  {
    ids->InsertNextValue(id);
    names->InsertNextValue("label " + std::to_string(id));
  }
  image->GetFieldData()->AddArray(ids);
  image->GetFieldData()->AddArray(names);
  auto mesher = MesherOf(image);
  mesher->Update();
  vtkPolyData* surface = mesher->GetOutput();
  CHECK((LabelsOf(surface) == std::set<int>{ 0, 17, 240 }), "ids are kept");
  vtkDataArray* pairs = surface->GetCellData()->GetArray("BoundaryLabels");
  for (vtkIdType c = 0; c < surface->GetNumberOfCells(); ++c)
  {
    const double first = pairs->GetComponent(c, 0);
    const double second = pairs->GetComponent(c, 1);
    CHECK(first == -1 || second == 0 || first < second, "ordered by id, not by array");
  }
  CHECK(surface->GetFieldData()->GetAbstractArray("LabelNames")->GetVariantValue(1).ToString() ==
          "label 240",
    "");
  // One entry an array of the image also counts for a selection of them.
  mesher->GetPointArraySelection()->EnableArray("000_Background");
  mesher->GetPointArraySelection()->EnableArray("second");
  mesher->Update();
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 17 }), "");
}

// Two labels side by side, and a third that is close behind both everywhere: between the two planes
// of grid points that they share out, where no grid point has it, its interpolant is the largest.
void CheckUnseen()
{
  const int middle = Size / 2;
  const double far_behind = -10.0;
  const double close_behind = 0.9;
  std::vector<double> left;
  for (int i = 0; i < Size * Size * Size; ++i)
  {
    left.push_back(i % Size < middle ? 1.0 : far_behind);
  }
  std::vector<double> right = left;
  for (double& value : right)
  {
    value = value == 1.0 ? far_behind : 1.0;
  }
  auto image = MakeGrid();
  image->GetPointData()->AddArray(MakeArray<vtkFloatArray>("left", left));
  image->GetPointData()->AddArray(MakeArray<vtkFloatArray>("right", right));
  image->GetPointData()->AddArray(
    MakeArray<vtkFloatArray>("film", std::vector<double>(left.size(), close_behind)));
  auto mesher = MesherOf(image);
  mesher->Update();
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1, 2, 3 }), "as the interpolants say");
  mesher->SetUnseenLabelsToDrop();
  mesher->Update();
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1, 2 }), "dropped when asked");
  mesher->SetUnseenLabelsToKeep();
  mesher->Update();
  CHECK((LabelsOf(mesher->GetOutput()) == std::set<int>{ 0, 1, 2, 3 }), "and back");
}

void CheckBlanking(vtkPolyData* expected)
{
  auto image = MakeImage();
  vtkNew<vtkUnsignedCharArray> ghosts;
  ghosts->SetName(vtkDataSetAttributes::GhostArrayName());
  const int begin = 9;
  for (int i = 0; i < Size * Size * Size; ++i)
  {
    ghosts->InsertNextValue(i % Size >= begin ? vtkDataSetAttributes::HIDDENPOINT : 0);
  }
  image->GetPointData()->AddArray(ghosts);
  double bounds[6];
  expected->GetBounds(bounds);
  CHECK(bounds[1] > begin + 1, "the labels reach into what will be blanked");
  MeshOf(image)->GetBounds(bounds);
  CHECK(bounds[1] <= begin, "blanked points are background");
  CHECK(bounds[1] > begin - 1.5, "and the others are not");
}

}

int TestMultiLabelInput(int, char*[])
{
  auto expected = MeshOf(MakeImage());
  CheckTypes(expected);
  CheckComponents(expected);
  CheckCells(expected);
  CheckExtent(expected);
  CheckSelection();
  CheckBackgrounds(expected);
  CheckIds();
  CheckUnseen();
  CheckBlanking(expected);
  return Result();
}
