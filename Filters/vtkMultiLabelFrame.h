/**
 * Where a grid lies in world space, and how a product's points get there and back. Internal.
 *
 * The core's coordinates are "local": the first point of the image's extent is at 0 and the axes
 * are the grid's. World = Direction * local + Position. A negative spacing becomes a positive one
 * with the axis turned round, so Direction may be a mirror for that reason as well.
 */
#ifndef vtkMultiLabelFrame_h
#define vtkMultiLabelFrame_h

class vtkFieldData;
class vtkImageData;

#include <string>

namespace vtkMultiLabel
{

struct Frame
{
  int Dimensions[3] = { 0, 0, 0 }; // points
  double Spacing[3] = { 1.0, 1.0, 1.0 };
  double Position[3] = { 0.0, 0.0, 0.0 };
  double Direction[9] = { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 }; // by rows
  double Inverse[9] = { 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0 };
  bool IsMirrored = false;

  void ToWorld(const double local[3], double world[3]) const;
  void ToLocal(const double world[3], double local[3]) const;
  /** Puts a local point onto the face 0 .. 5 (-x +x -y +y -z +z) of the box. */
  void Snap(int face, double local[3]) const;
  /** Empty, or in words how another frame differs by more than rounding. */
  std::string DifferenceFrom(const Frame& other) const;
};

/** The frame of the image's points or of its cells' centres. Throws Refusal. */
Frame FrameOfImage(vtkImageData* image, bool isCellCentred);

/** To the arrays GridDimensions, GridSpacing, GridPosition, GridDirection and back; the second
 * throws Refusal, naming `what` as the owner of the arrays. */
void WriteFrame(const Frame& frame, vtkFieldData* out);
Frame ReadFrame(vtkFieldData* arrays, const std::string& what);

}

#endif
