/**
 * @class vtkMultiLabelCurveProtector
 * @brief protecting balls on the curves of a multi-label image
 *
 * Input: what vtkMultiLabelCurveExtractor made (its points may not be moved, its arrays and field
 * data are needed). Output: vtkPolyData with double precision points in world space: one vert for
 * each protecting ball, at its centre, and one line between each two neighbours on a curve.
 * Together the balls cover the curves; vtkMultiLabelInterfaceMesher takes them on its second port.
 *
 * Point arrays:
 * - `Radius` (double, active scalars): in world units.
 * - `CurveId` (int): of the ball's curve; -1 for the ball of a junction.
 * - `LabelSet`, `LabelSetSize`, `LabelCodes` (int): as vtkMultiLabelCurveExtractor writes them.
 * Cell array, for verts and lines: `CurveId` (int).
 *
 * Field data: that of the input, with EdgeSize, FacetDistance and BallRadiusScale as used,
 * `BallCount` and `TimeBalls` in seconds.
 *
 * After an error or an abort the output is empty, with its arrays; but from VTK 9.2 on VTK itself takes
 * the arrays away after an abort.
 *
 * @sa vtkMultiLabelCurveExtractor vtkMultiLabelInterfaceMesher
 */
#ifndef vtkMultiLabelCurveProtector_h
#define vtkMultiLabelCurveProtector_h

#include "vtkMultiLabelInterfaceMesherModule.h" // for export macro
#include "vtkPolyDataAlgorithm.h"

class VTKMULTILABELINTERFACEMESHER_EXPORT vtkMultiLabelCurveProtector : public vtkPolyDataAlgorithm
{
public:
  static vtkMultiLabelCurveProtector* New();
  vtkTypeMacro(vtkMultiLabelCurveProtector, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Largest distance of neighbours on a curve, in world units. Default: 0, which means twice the
   * spacing (the cube root of the voxel's volume).
   */
  vtkSetClampMacro(EdgeSize, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(EdgeSize, double);
  ///@}

  ///@{
  /**
   * Largest distance of a curve from the line between neighbours, in world units. Default: 0, which
   * means an eighth of EdgeSize. vtkMultiLabelInterfaceMesher uses its own FacetDistance here.
   */
  vtkSetClampMacro(FacetDistance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(FacetDistance, double);
  ///@}

  ///@{
  /** Scales the first radii of the balls, without unit, from 0.01 to 1. Default: 1. */
  vtkSetClampMacro(BallRadiusScale, double, 0.01, 1.0);
  vtkGetMacro(BallRadiusScale, double);
  ///@}

protected:
  vtkMultiLabelCurveProtector();
  ~vtkMultiLabelCurveProtector() override;

  int RequestUpdateExtent(
    vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMultiLabelCurveProtector(const vtkMultiLabelCurveProtector&) = delete;
  void operator=(const vtkMultiLabelCurveProtector&) = delete;

  double EdgeSize = 0.0;
  double FacetDistance = 0.0;
  double BallRadiusScale;
};

#endif
