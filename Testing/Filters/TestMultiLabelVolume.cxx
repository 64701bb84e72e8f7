// Port 1 of the mesher: its type, arrays, options and what it is after an error or an abort.
#include "MultiLabelTest.h"

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkMultiLabelInterfaceMesher.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <array>
#include <set>

using namespace test;

namespace
{

bool IsVolumeTyped(vtkUnstructuredGrid* volume)
{
  vtkDataArray* labels = volume->GetCellData()->GetArray("Label");
  return labels && labels == volume->GetCellData()->GetScalars() &&
         labels->GetNumberOfTuples() == volume->GetNumberOfCells() && volume->GetPoints();
}

double ValueOf(vtkUnstructuredGrid* volume, const char* name)
{
  vtkDataArray* array = volume->GetFieldData()->GetArray(name);
  return array ? array->GetComponent(0, 0) : -1.0;
}

// Six times the volume.
double DeterminantOf(vtkUnstructuredGrid* volume, vtkIdType cell)
{
  vtkIdType count;
  const vtkIdType* ids;
  volume->GetCellPoints(cell, count, ids);
  std::array<std::array<double, 3>, 4> p;
  for (int k = 0; k < 4; ++k)
  {
    volume->GetPoint(ids[k], p[k].data());
  }
  double edge[3][3];
  for (int k = 0; k < 3; ++k)
  {
    vtkMath::Subtract(p[k + 1].data(), p[0].data(), edge[k]);
  }
  return vtkMath::Determinant3x3(edge[0], edge[1], edge[2]);
}

void CheckVolume()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(MakeImage());
  mesher->Update();
  vtkNew<vtkPolyData> alone;
  alone->DeepCopy(mesher->GetOutput());
  CHECK(mesher->GetVolumeOutput()->GetNumberOfCells() == 0, "off by default");
  CHECK(IsVolumeTyped(mesher->GetVolumeOutput()), "typed when off");
  mesher->VolumeMeshOn();
  mesher->Update();
  vtkUnstructuredGrid* volume = mesher->GetVolumeOutput();
  CHECK(AreSame(alone, mesher->GetOutput()), "the surface is the one without the volume");
  CHECK(IsVolumeTyped(volume) && volume->GetNumberOfCells() > 0, "");
  std::set<int> labels;
  vtkIdType flat = 0;
  for (vtkIdType c = 0; c < volume->GetNumberOfCells(); ++c)
  {
    flat += volume->GetCellType(c) != VTK_TETRA || !(DeterminantOf(volume, c) > 0.0);
    labels.insert(static_cast<int>(volume->GetCellData()->GetArray("Label")->GetComponent(c, 0)));
  }
  CHECK(flat == 0, std::to_string(flat) + " cells");
  CHECK(labels.count(0) == 0 && labels.size() == 2, "the background is left out");
  CHECK(ValueOf(volume, "CellCount") == static_cast<double>(volume->GetNumberOfCells()), "");
  CHECK(ValueOf(volume, "SurfaceVertexCount") ==
          static_cast<double>(mesher->GetOutput()->GetNumberOfPoints()),
    "");
  CHECK(ValueOf(volume, "CellSize") > 0.0, "the length filled in");
  CHECK(ValueOf(volume, "TimeVolume") > 0.0, "");

  mesher->KeepBackgroundOn();
  mesher->SetOutputPointsPrecision(vtkAlgorithm::SINGLE_PRECISION);
  mesher->Update();
  CHECK(volume->GetPoints()->GetDataType() == VTK_FLOAT, "");
  vtkDataArray* kept = mesher->GetVolumeOutput()->GetCellData()->GetArray("Label");
  CHECK(kept->GetRange()[0] == 0.0, "the background is kept");
}

void CheckMirror()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  vtkSmartPointer<vtkImageData> image = MakeImage();
  image->GetDirectionMatrix()->SetElement(2, 2, -1.0);
  mesher->SetInputData(image);
  mesher->VolumeMeshOn();
  mesher->Update();
  vtkUnstructuredGrid* volume = mesher->GetVolumeOutput();
  bool isPositive = volume->GetNumberOfCells() > 0;
  for (vtkIdType c = 0; c < volume->GetNumberOfCells(); ++c)
  {
    isPositive &= DeterminantOf(volume, c) > 0.0;
  }
  CHECK(isPositive, "");
}

void CheckOptions()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  const vtkMTimeType before = mesher->GetMTime();
  mesher->SetLabelCellSize(2, 1.5);
  CHECK(mesher->GetMTime() > before, "");
  CHECK(mesher->GetLabelCellSize(2) == 1.5 && mesher->GetLabelCellSize(1) == 0.0, "");
  const vtkMTimeType after = mesher->GetMTime();
  mesher->SetLabelCellSize(2, 1.5);
  mesher->SetLabelCellSize(2, -1.0);
  mesher->SetLabelCellSize(7, 0.0);
  CHECK(mesher->GetMTime() == after, "nothing has changed");
  mesher->SetLabelCellSize(2, 0.0);
  CHECK(mesher->GetLabelCellSize(2) == 0.0, "");
  const double pair[2] = { -5.0, 0.5 };
  mesher->SetLabelCellSize(pair);
  CHECK(mesher->GetLabelCellSize(-5) == 0.5, "");
  const vtkMTimeType last = mesher->GetMTime();
  for (double id : { 2.5, 1e300, -1e300, vtkMath::Nan() })
  {
    const double none[2] = { id, 0.5 };
    mesher->SetLabelCellSize(none);
  }
  CHECK(mesher->GetMTime() == last, "no label has such an id");
  mesher->SetLabelCellSize(3, 1.0);
  mesher->RemoveAllLabelCellSizes();
  CHECK(mesher->GetLabelCellSize(3) == 0.0, "");
  mesher->SetCellSize(-1.0);
  CHECK(mesher->GetCellSize() == 0.0, "clamped");
  mesher->SetCellRadiusEdgeRatio(0.5);
  CHECK(mesher->GetCellRadiusEdgeRatio() == 1.0, "clamped");
}

void CheckFailure()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->VolumeMeshOn();
  mesher->SetInputData(MakeImage());
  mesher->Update();
  Messages messages(mesher);
  mesher->SetBackgroundArrayName("there is none");
  mesher->Update();
  CHECK(!messages.Errors.empty(), "");
  CHECK(IsTypedEmpty(mesher->GetOutput()), "");
  CHECK(mesher->GetVolumeOutput()->GetNumberOfCells() == 0, "");
  CHECK(IsVolumeTyped(mesher->GetVolumeOutput()), "");
}

// Aborts in the last stage, when the surface is there.
struct Stopper
{
  static void Stop(vtkObject* caller, unsigned long, void* seen, void*)
  {
    vtkAlgorithm* algorithm = vtkAlgorithm::SafeDownCast(caller);
    const char* text = algorithm->GetProgressText();
    if (text && std::string(text) == "Filling the regions")
    {
      *static_cast<bool*>(seen) = true;
      algorithm->AbortExecuteOn();
    }
  }
};

void CheckAbort()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->VolumeMeshOn();
  mesher->SetInputData(MakeImage());
  bool isSeen = false;
  vtkNew<vtkCallbackCommand> command;
  command->SetCallback(&Stopper::Stop);
  command->SetClientData(&isSeen);
  mesher->AddObserver(vtkCommand::ProgressEvent, command);
  mesher->Update();
  CHECK(isSeen, "");
  CHECK(IsAbortedOutput(mesher->GetOutput()), "");
  CHECK(mesher->GetVolumeOutput()->GetNumberOfCells() == 0, "");
}

}

int TestMultiLabelVolume(int, char*[])
{
  CheckVolume();
  CheckMirror();
  CheckOptions();
  CheckFailure();
  CheckAbort();
  return Result();
}
