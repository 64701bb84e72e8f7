// Bad input gives one clear sentence and an empty typed output, and no trace of an earlier mesh.
#include "MultiLabelTest.h"

#include "vtkDataArraySelection.h"
#include "vtkFieldData.h"
#include "vtkIntArray.h"
#include "vtkMultiLabelCurveExtractor.h"
#include "vtkMultiLabelCurveProtector.h"
#include "vtkStringArray.h"

#include <functional>
#include <limits>

using namespace test;

namespace
{

using Mesher = vtkMultiLabelInterfaceMesher;

// A good run, then the change, then a run that fails with the text.
void CheckRefused(
  const std::string& text, const std::function<void(Mesher*, vtkImageData*)>& change)
{
  vtkNew<Mesher> mesher;
  auto image = MakeImage();
  mesher->SetInputData(image);
  mesher->Update();
  CHECK(mesher->GetOutput()->GetNumberOfPolys() > 0, text);
  change(mesher, image);
  image->Modified();
  Messages messages(mesher);
  mesher->Update();
  CHECK(Contains(messages.Errors, text), "wanted: " + text + "; got: " + messages.Errors);
  CHECK(IsTypedEmpty(mesher->GetOutput()), text);
}

void AddIds(vtkImageData* image, std::initializer_list<int> values)
{
  vtkNew<vtkIntArray> ids;
  ids->SetName("LabelIds");
  for (int id : values)
  {
    ids->InsertNextValue(id);
  }
  image->GetFieldData()->AddArray(ids);
}

void CheckImages()
{
  CheckRefused("The input image is empty",
    [](Mesher* mesher, vtkImageData*)
    {
      vtkNew<vtkImageData> empty;
      mesher->SetInputData(empty);
    });
  CheckRefused("16 x 16 x 1 points; a volume",
    [](Mesher* mesher, vtkImageData*)
    {
      vtkNew<vtkImageData> flat;
      flat->SetDimensions(16, 16, 1);
      flat->AllocateScalars(VTK_FLOAT, 1);
      mesher->SetInputData(flat);
    });
  CheckRefused("The image has no arrays",
    [](Mesher*, vtkImageData* image) { image->GetPointData()->Initialize(); });
  CheckRefused("'names' does not hold numbers",
    [](Mesher*, vtkImageData* image)
    {
      image->GetPointData()->Initialize();
      vtkNew<vtkStringArray> names;
      names->SetName("names");
      names->SetNumberOfTuples(image->GetNumberOfPoints());
      image->GetPointData()->AddArray(names);
    });
  CheckRefused("not a rotation or a mirror", [](Mesher*, vtkImageData* image)
    { image->SetDirectionMatrix(1.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0); });
  CheckRefused("spacing", [](Mesher*, vtkImageData* image) { image->SetSpacing(1.0, 0.0, 1.0); });
}

void CheckArrays()
{
  CheckRefused("no array 'third', which is selected",
    [](Mesher* mesher, vtkImageData*) { mesher->GetPointArraySelection()->EnableArray("third"); });
  CheckRefused("'vectors' has 3 components",
    [](Mesher* mesher, vtkImageData* image)
    {
      vtkNew<vtkFloatArray> vectors;
      vectors->SetName("vectors");
      vectors->SetNumberOfComponents(3);
      vectors->SetNumberOfTuples(image->GetNumberOfPoints());
      image->GetPointData()->AddArray(vectors);
      mesher->GetPointArraySelection()->EnableArray("vectors");
      mesher->GetPointArraySelection()->EnableArray("first");
    });
  CheckRefused("first",
    [](Mesher*, vtkImageData* image)
    {
      image->GetPointData()->GetArray("first")->SetComponent(
        77, 0, std::numeric_limits<double>::quiet_NaN());
    });
  CheckRefused("background array 'air' is not",
    [](Mesher* mesher, vtkImageData*) { mesher->SetBackgroundArrayName("air"); });
  CheckRefused("has the id 0", [](Mesher*, vtkImageData* image) { AddIds(image, { 0, 0, 3 }); });
  CheckRefused("same id 3", [](Mesher*, vtkImageData* image) { AddIds(image, { 0, 3, 3 }); });
  CheckRefused("'LabelIds' holds 3000000000",
    [](Mesher*, vtkImageData* image) {
      image->GetFieldData()->AddArray(MakeArray<vtkDoubleArray>("LabelIds", { 0.0, 3e9, 3.0 }));
    });
}

void CheckBalls()
{
  CheckRefused("no field data array 'GridDimensions'",
    [](Mesher* mesher, vtkImageData*)
    {
      vtkNew<vtkPolyData> foreign;
      mesher->SetBallsData(foreign);
    });
  // Balls of the same image at another place, and of other arrays.
  vtkNew<vtkMultiLabelCurveExtractor> extractor;
  auto image = MakeImage();
  extractor->SetInputData(image);
  vtkNew<vtkMultiLabelCurveProtector> protector;
  protector->SetInputConnection(extractor->GetOutputPort());
  protector->Update();
  vtkPolyData* balls = protector->GetOutput();
  CHECK(balls->GetNumberOfPoints() > 0, "");
  CheckRefused("made for another image",
    [&](Mesher* mesher, vtkImageData* moved)
    {
      moved->SetOrigin(0.5, 0.0, 0.0);
      mesher->SetBallsData(balls);
    });
  CheckRefused("made for 3 labels",
    [&](Mesher* mesher, vtkImageData*)
    {
      mesher->GetPointArraySelection()->EnableArray("000_Background");
      mesher->GetPointArraySelection()->EnableArray("first");
      mesher->SetBallsData(balls);
    });
  CheckRefused("no array 'Radius'",
    [&](Mesher* mesher, vtkImageData*)
    {
      vtkNew<vtkPolyData> without;
      without->DeepCopy(balls);
      without->GetPointData()->RemoveArray("Radius");
      mesher->SetBallsData(without);
    });
  CheckRefused("'LabelCodes' of the balls holds 99",
    [&](Mesher* mesher, vtkImageData*)
    {
      vtkNew<vtkPolyData> wrong;
      wrong->DeepCopy(balls);
      wrong->GetPointData()->GetArray("LabelCodes")->SetComponent(0, 0, 99);
      mesher->SetBallsData(wrong);
    });
}

void CheckStages()
{
  vtkNew<vtkImageData> empty;
  vtkNew<vtkMultiLabelCurveExtractor> extractor;
  extractor->SetInputData(empty);
  Messages extractorMessages(extractor);
  extractor->Update();
  CHECK(Contains(extractorMessages.Errors, "image is empty"), extractorMessages.Errors);
  vtkNew<vtkPolyData> foreign;
  vtkNew<vtkMultiLabelCurveProtector> protector;
  protector->SetInputData(foreign);
  Messages protectorMessages(protector);
  protector->Update();
  CHECK(Contains(protectorMessages.Errors, "The curves carry no field data array 'GridDimensions'"),
    protectorMessages.Errors);
  vtkFieldData* const typed[] = { extractor->GetOutput()->GetCellData(),
    protector->GetOutput()->GetPointData() };
  for (vtkFieldData* arrays : typed)
  {
    for (const char* name : { "CurveId", "LabelSet", "LabelSetSize", "LabelCodes" })
    {
      CHECK(arrays->GetArray(name) && arrays->GetArray(name)->GetNumberOfTuples() == 0, name);
    }
  }
  CHECK(protector->GetOutput()->GetPointData()->GetArray("Radius") != nullptr, "");
}

}

int TestMultiLabelErrors(int, char*[])
{
  CheckImages();
  CheckArrays();
  CheckBalls();
  CheckStages();
  return Result();
}
