/**
 * @class vtkMultiLabelCurveExtractor
 * @brief the curves of a multi-label image where three or more labels meet
 *
 * Input: vtkImageData, see vtkMultiLabelImageAlgorithm. Output: vtkPolyData with double precision
 * points in world space. Its lines are the junction curves: where three or more labels meet, and
 * the creases where interfaces reach the faces of the image's box, its edges included. Its verts
 * are the junctions in which curves end. A closed curve without a junction repeats its first point.
 *
 * Cell arrays, for verts and lines:
 * - `CurveId` (int, active scalars): 0, 1, ... for curves; -1 for junctions.
 * - `LabelSet` (int, as many components as the largest set has codes): ids of the labels that meet
 *   there, ascending, padded with -1. The outside is background, which is 0.
 * - `LabelSetSize` (int): how many of them are not padding.
 * - `LabelCodes` (int): the same sets as vtkMultiLabelCurveProtector reads them: indices into the
 *   field data array LabelIds, and beyond those the box's faces -x +x -y +y -z +z; padded with -1.
 *
 * Field data: `LabelIds` and `LabelNames` (one entry a label), the grid (`GridDimensions`,
 * `GridSpacing`, `GridPosition`, `GridDirection`), the lengths that later stages take by default,
 * named as the properties of vtkMultiLabelInterfaceMesher, `CurveCount`, `JunctionCount`,
 * `TimeField` and `TimeCurves` in seconds.
 *
 * After an error or an abort the output is empty, with its arrays; but from VTK 9.2 on VTK itself takes
 * the arrays away after an abort.
 *
 * @sa vtkMultiLabelCurveProtector vtkMultiLabelInterfaceMesher
 */
#ifndef vtkMultiLabelCurveExtractor_h
#define vtkMultiLabelCurveExtractor_h

#include "vtkMultiLabelImageAlgorithm.h"
#include "vtkMultiLabelInterfaceMesherModule.h" // for export macro

class VTKMULTILABELINTERFACEMESHER_EXPORT vtkMultiLabelCurveExtractor
  : public vtkMultiLabelImageAlgorithm
{
public:
  static vtkMultiLabelCurveExtractor* New();
  vtkTypeMacro(vtkMultiLabelCurveExtractor, vtkMultiLabelImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

protected:
  vtkMultiLabelCurveExtractor();
  ~vtkMultiLabelCurveExtractor() override;

  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMultiLabelCurveExtractor(const vtkMultiLabelCurveExtractor&) = delete;
  void operator=(const vtkMultiLabelCurveExtractor&) = delete;
};

#endif
