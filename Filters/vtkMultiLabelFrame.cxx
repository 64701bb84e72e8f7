#include "vtkMultiLabelFrame.h"

#include "vtkMultiLabelRun.h"

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace vtkMultiLabel
{

namespace
{

// Largest entry of D^T D - 1 of a direction matrix. Matrices from headers in single precision or
// in decimals are off by 1e-6 to 1e-4; a shear, which would change lengths, by more.
const double max_skew = 1e-3;

// Frames that differ by less, in parts of a spacing, are the same: text files keep fewer digits.
const double max_frame_difference = 1e-6;

void Complete(Frame& frame)
{
  const double* d = frame.Direction;
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 3; ++j)
    {
      const double dot = d[i] * d[j] + d[3 + i] * d[3 + j] + d[6 + i] * d[6 + j];
      if (!(std::abs(dot - (i == j ? 1.0 : 0.0)) <= max_skew))
      {
        throw Refusal("The image's direction matrix is not a rotation or a mirror: the product of "
                      "its columns " +
                      std::to_string(i) + " and " + std::to_string(j) + " is " +
                      std::to_string(dot) + ".");
      }
    }
  }
  vtkMatrix3x3::Invert(frame.Direction, frame.Inverse);
  frame.IsMirrored = vtkMatrix3x3::Determinant(frame.Direction) < 0.0;
}

vtkDataArray* Find(
  vtkFieldData* arrays, const char* name, vtkIdType values, const std::string& what)
{
  vtkDataArray* array = arrays->GetArray(name);
  if (!array || array->GetNumberOfValues() != values)
  {
    throw Refusal("The " + what + " carry no field data array '" + name + "' of " +
                  std::to_string(values) + " values.");
  }
  return array;
}

template <typename ArrayT, typename T>
void Write(const char* name, const T* values, int count, vtkFieldData* out)
{
  vtkNew<ArrayT> array;
  array->SetName(name);
  array->SetNumberOfComponents(count);
  array->InsertNextTypedTuple(values);
  out->AddArray(array);
}

}

void Frame::ToWorld(const double local[3], double world[3]) const
{
  for (int r = 0; r < 3; ++r)
  {
    const double* row = this->Direction + 3 * r;
    world[r] = row[0] * local[0] + row[1] * local[1] + row[2] * local[2] + this->Position[r];
  }
}

void Frame::ToLocal(const double world[3], double local[3]) const
{
  const double moved[3] = { world[0] - this->Position[0], world[1] - this->Position[1],
    world[2] - this->Position[2] };
  for (int r = 0; r < 3; ++r)
  {
    const double* row = this->Inverse + 3 * r;
    local[r] = row[0] * moved[0] + row[1] * moved[1] + row[2] * moved[2];
  }
}

void Frame::Snap(int face, double local[3]) const
{
  const int axis = face / 2;
  local[axis] = face % 2 == 0 ? 0.0 : (this->Dimensions[axis] - 1) * this->Spacing[axis];
}

std::string Frame::DifferenceFrom(const Frame& other) const
{
  std::ostringstream text;
  for (int a = 0; a < 3; ++a)
  {
    const double tolerance = max_frame_difference * this->Spacing[a];
    if (this->Dimensions[a] != other.Dimensions[a])
    {
      text << this->Dimensions[a] << " points along axis " << a << ", not " << other.Dimensions[a];
      return text.str();
    }
    if (!(std::abs(this->Spacing[a] - other.Spacing[a]) <= tolerance))
    {
      text << "spacing " << this->Spacing[a] << " along axis " << a << ", not " << other.Spacing[a];
      return text.str();
    }
    if (!(std::abs(this->Position[a] - other.Position[a]) <= tolerance))
    {
      text << "coordinate " << this->Position[a] << " of the first point along axis " << a
           << ", not " << other.Position[a];
      return text.str();
    }
  }
  for (int i = 0; i < 9; ++i)
  {
    if (!(std::abs(this->Direction[i] - other.Direction[i]) <= max_frame_difference))
    {
      return "another direction matrix";
    }
  }
  return {};
}

Frame FrameOfImage(vtkImageData* image, bool isCellCentred)
{
  Frame frame;
  int extent[6];
  image->GetExtent(extent);
  double first[3];
  for (int a = 0; a < 3; ++a)
  {
    frame.Dimensions[a] = extent[2 * a + 1] - extent[2 * a] + (isCellCentred ? 0 : 1);
    first[a] = extent[2 * a] + (isCellCentred ? 0.5 : 0.0);
    const double spacing = image->GetSpacing()[a];
    frame.Spacing[a] = std::abs(spacing);
    for (int r = 0; r < 3; ++r)
    {
      const double entry = image->GetDirectionMatrix()->GetElement(r, a);
      frame.Direction[3 * r + a] = spacing < 0.0 ? -entry : entry;
    }
  }
  const int* n = frame.Dimensions;
  if (n[0] < 2 || n[1] < 2 || n[2] < 2)
  {
    throw Refusal("The image has " + std::to_string(n[0]) + " x " + std::to_string(n[1]) + " x " +
                  std::to_string(n[2]) + (isCellCentred ? " cells" : " points") +
                  "; a volume of at least 2 along every axis is needed.");
  }
  image->TransformContinuousIndexToPhysicalPoint(first, frame.Position);
  Complete(frame);
  return frame;
}

void WriteFrame(const Frame& frame, vtkFieldData* out)
{
  Write<vtkIntArray>("GridDimensions", frame.Dimensions, 3, out);
  Write<vtkDoubleArray>("GridSpacing", frame.Spacing, 3, out);
  Write<vtkDoubleArray>("GridPosition", frame.Position, 3, out);
  Write<vtkDoubleArray>("GridDirection", frame.Direction, 9, out);
}

Frame ReadFrame(vtkFieldData* arrays, const std::string& what)
{
  Frame frame;
  vtkDataArray* dimensions = Find(arrays, "GridDimensions", 3, what);
  vtkDataArray* spacing = Find(arrays, "GridSpacing", 3, what);
  vtkDataArray* position = Find(arrays, "GridPosition", 3, what);
  vtkDataArray* direction = Find(arrays, "GridDirection", 9, what);
  for (int i = 0; i < 3; ++i)
  {
    frame.Dimensions[i] = static_cast<int>(dimensions->GetVariantValue(i).ToInt());
    frame.Spacing[i] = spacing->GetVariantValue(i).ToDouble();
    frame.Position[i] = position->GetVariantValue(i).ToDouble();
  }
  for (int i = 0; i < 9; ++i)
  {
    frame.Direction[i] = direction->GetVariantValue(i).ToDouble();
  }
  Complete(frame);
  return frame;
}

}
