/**
 * The volume as an unstructured grid, with its figures as field data. Internal.
 */
#ifndef vtkMultiLabelVolume_h
#define vtkMultiLabelVolume_h

#include "vtkMultiLabelSetting.h"

#include "mlim.h"

class vtkUnstructuredGrid;

namespace vtkMultiLabel
{

/** Points, tetrahedra and their arrays; a volume of zeros gives the arrays without tuples. */
void WriteVolume(const mlim_volume& volume, const Setting& setting, bool isSinglePrecision,
  vtkUnstructuredGrid* out);

/** Options, counts and report of the volume, to the field data. */
void WriteVolumeFigures(
  const mlim_volume& volume, const mlim_options& options, vtkUnstructuredGrid* out);

}

#endif
