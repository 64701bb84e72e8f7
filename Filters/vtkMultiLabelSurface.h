/**
 * The mesh as polydata, with its figures as field data. Internal.
 */
#ifndef vtkMultiLabelSurface_h
#define vtkMultiLabelSurface_h

#include "vtkMultiLabelSetting.h"

#include "mlim.h"

class vtkPolyData;

namespace vtkMultiLabel
{

/** What of the mesh the surface shows. */
struct SurfaceChoice
{
  bool CapBoundary = true;
  bool OutputCurves = true;
  bool IsLabelActive = false; // the array Label is the active scalars, not BoundaryLabels
  bool IsSinglePrecision = false;
};

/** Points, cells and their arrays; a mesh of zeros gives the arrays without tuples. */
void WriteSurface(
  const mlim_mesh& mesh, const Setting& setting, const SurfaceChoice& choice, vtkPolyData* out);

/** Counts, report and certificate of the mesh, to the field data. */
void WriteFigures(const mlim_mesh& mesh, const Setting& setting, vtkPolyData* out);

}

#endif
