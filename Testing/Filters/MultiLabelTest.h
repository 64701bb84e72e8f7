// What the tests of the filters share: a failed check reports and continues, a small image with
// known labels, and the errors of a filter.
#ifndef MultiLabelTest_h
#define MultiLabelTest_h

#include "vtkAlgorithm.h"
#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkExecutive.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMultiLabelInterfaceMesher.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkVersion.h"

#include <cmath>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

namespace test
{

inline int& FailureCount()
{
  static int count = 0;
  return count;
}

inline void Check(bool isTrue, const char* text, const std::string& what, int line)
{
  if (!isTrue)
  {
    ++FailureCount();
    std::cerr << "line " << line << ": not true: " << text << " (" << what << ")\n";
  }
}

inline int Result()
{
  return FailureCount() == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

// Signed distances, in index space, of two overlapping balls, the second smaller.
inline double FirstBall(const double x[3])
{
  return 4.1 - std::hypot(x[0] - 5.2, x[1] - 6.1, x[2] - 6.7);
}

inline double SecondBall(const double x[3])
{
  return 3.3 - std::hypot(x[0] - 9.9, x[1] - 7.3, x[2] - 7.2);
}

// Label of a point in index space: 0 background, 1 and 2 the balls.
inline int LabelAt(const double x[3])
{
  const double first = FirstBall(x);
  const double second = SecondBall(x);
  return first <= 0.0 && second <= 0.0 ? 0 : first >= second ? 1 : 2;
}

const int Size = 16;

inline std::vector<double> ValuesOf(int label)
{
  std::vector<double> values;
  for (int k = 0; k < Size; ++k)
  {
    for (int j = 0; j < Size; ++j)
    {
      for (int i = 0; i < Size; ++i)
      {
        const double x[3] = { double(i), double(j), double(k) };
        const double value = label == 0 ? 0.0 : label == 1 ? FirstBall(x) : SecondBall(x);
        values.push_back(static_cast<float>(value));
      }
    }
  }
  return values;
}

template <typename ArrayT>
vtkSmartPointer<ArrayT> MakeArray(const char* name, const std::vector<double>& values)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetName(name);
  array->SetNumberOfComponents(1);
  array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()));
  for (size_t i = 0; i < values.size(); ++i)
  {
    array->SetComponent(static_cast<vtkIdType>(i), 0, values[i]);
  }
  return array;
}

inline vtkSmartPointer<vtkImageData> MakeGrid()
{
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(Size, Size, Size);
  return image;
}

// Point arrays background, first, second in single precision.
inline vtkSmartPointer<vtkImageData> MakeImage()
{
  auto image = MakeGrid();
  const char* const names[] = { "000_Background", "first", "second" };
  for (int label = 0; label < 3; ++label)
  {
    image->GetPointData()->AddArray(MakeArray<vtkFloatArray>(names[label], ValuesOf(label)));
  }
  return image;
}

// Errors and warnings of an algorithm, which are not printed.
class Messages
{
public:
  explicit Messages(vtkAlgorithm* algorithm)
  {
    this->Observe(algorithm, vtkCommand::ErrorEvent, &this->Errors);
    this->Observe(algorithm, vtkCommand::WarningEvent, &this->Warnings);
    this->Observe(algorithm->GetExecutive(), vtkCommand::ErrorEvent, &this->ExecutiveErrors);
  }

  std::string Errors;
  std::string Warnings;
  std::string ExecutiveErrors;

private:
  static void Append(vtkObject*, unsigned long, void* text, void* message)
  {
    *static_cast<std::string*>(text) += static_cast<const char*>(message);
  }

  void Observe(vtkObject* object, unsigned long event, std::string* text)
  {
    vtkNew<vtkCallbackCommand> command;
    command->SetCallback(&Messages::Append);
    command->SetClientData(text);
    object->AddObserver(event, command);
  }
};

inline bool Contains(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

// Every array of the surface's contract is there, with a tuple for each point or cell.
inline bool IsTyped(vtkPolyData* surface)
{
  const vtkIdType cells = surface->GetNumberOfCells();
  bool result = surface->GetPoints() != nullptr;
  for (const char* name : { "BoundaryLabels", "Label", "PatchId", "CurveId" })
  {
    vtkDataArray* array = surface->GetCellData()->GetArray(name);
    result =
      result && array && array->GetDataType() == VTK_INT && array->GetNumberOfTuples() == cells;
  }
  for (const char* name : { "NodeType", "NumberOfLabels" })
  {
    vtkDataArray* array = surface->GetPointData()->GetArray(name);
    result = result && array && array->GetDataType() == VTK_INT &&
             array->GetNumberOfTuples() == surface->GetNumberOfPoints();
  }
  vtkDataArray* scalars = surface->GetCellData()->GetScalars();
  return result && scalars && scalars->GetName() == std::string("BoundaryLabels") &&
         scalars->GetNumberOfComponents() == 2;
}

inline bool IsTypedEmpty(vtkPolyData* surface)
{
  return IsTyped(surface) && surface->GetNumberOfCells() == 0 && surface->GetNumberOfPoints() == 0;
}

// From 9.2 on VTK itself empties the output of an aborted filter, and the flag stays until the host
// takes it back.
inline bool IsAbortedOutput(vtkPolyData* surface)
{
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 0)
  return surface->GetNumberOfCells() == 0 && surface->GetNumberOfPoints() == 0;
#else
  return IsTypedEmpty(surface);
#endif
}

// The same cells, and points that differ by less than the tolerance; 0: not at all.
inline bool AreSame(vtkPolyData* a, vtkPolyData* b, double tolerance, const double shift[3])
{
  if (a->GetNumberOfPoints() != b->GetNumberOfPoints() ||
      a->GetNumberOfCells() != b->GetNumberOfCells() || a->GetNumberOfCells() == 0)
  {
    return false;
  }
  for (vtkIdType p = 0; p < a->GetNumberOfPoints(); ++p)
  {
    double x[3];
    double y[3];
    a->GetPoint(p, x);
    b->GetPoint(p, y);
    for (int c = 0; c < 3; ++c)
    {
      if (!(std::abs(x[c] + shift[c] - y[c]) <= tolerance))
      {
        return false;
      }
    }
  }
  for (vtkIdType c = 0; c < a->GetNumberOfCells(); ++c)
  {
    vtkNew<vtkIdList> ids;
    a->GetCellPoints(c, ids);
    vtkNew<vtkIdList> others;
    b->GetCellPoints(c, others);
    if (ids->GetNumberOfIds() != others->GetNumberOfIds() ||
        !std::equal(
          ids->GetPointer(0), ids->GetPointer(0) + ids->GetNumberOfIds(), others->GetPointer(0)))
    {
      return false;
    }
  }
  return true;
}

inline bool AreSame(vtkPolyData* a, vtkPolyData* b)
{
  const double none[3] = { 0.0, 0.0, 0.0 };
  return AreSame(a, b, 0.0, none);
}

}

#define CHECK(condition, what) test::Check((condition), #condition, (what), __LINE__)

#endif
