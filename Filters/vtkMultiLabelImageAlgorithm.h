/**
 * @class vtkMultiLabelImageAlgorithm
 * @brief what the filters that read a multi-label image share: which arrays are labels
 *
 * The image holds one indicator function a label. The label of a point is the one whose function,
 * interpolated trilinearly, is largest there.
 *
 * Arrays: point arrays of any numeric type with one component. Without a suitable point array cell
 * arrays are taken, as points at the cells' centres. One array with several components, alone, is
 * one label a component. Blanked points (cells) and everything outside the image are background.
 * Spacing, origin, direction matrix and an extent that does not start at 0 all count.
 *
 * Label maps: one array of an integer type with one component, alone in the image or selected alone,
 * is a label map if BackgroundMode is Array and BackgroundArrayName empty. Its indicators are made on
 * the way, as vtkMultiLabelIndicators makes them with all its defaults and with the same result, but
 * in memory that does not grow with the number of labels. Its ids are kept; 0 is the background.
 * Whole numbers in floating point are one indicator function; vtkMultiLabelIndicators takes them as
 * labels.
 *
 * Ids: the background is 0, the other arrays are 1, 2, ... in their order, unless the image's field
 * data has `LabelIds` (one entry an array); `LabelNames` gives names in the same way.
 *
 * Refused, with an error and an empty output: no or unsuitable arrays, fewer than 2 points along an
 * axis, values that are not finite, a direction matrix with a shear.
 */
#ifndef vtkMultiLabelImageAlgorithm_h
#define vtkMultiLabelImageAlgorithm_h

#include "vtkMultiLabelInterfaceMesherModule.h" // for export macro
#include "vtkNew.h"                             // for PointArraySelection
#include "vtkPolyDataAlgorithm.h"

#include <string> // for BackgroundArrayName

class vtkDataArraySelection;

namespace vtkMultiLabel
{
struct Choice;
class Input;
}

class VTKMULTILABELINTERFACEMESHER_EXPORT vtkMultiLabelImageAlgorithm : public vtkPolyDataAlgorithm
{
public:
  vtkTypeMacro(vtkMultiLabelImageAlgorithm, vtkPolyDataAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** Where the label of a point without an indicator function of its own comes from. */
  enum BackgroundModes
  {
    Array,     ///< The array that BackgroundArrayName names; without one every array is a region.
    Constant,  ///< One more label, with the indicator BackgroundValue everywhere. 0 suits signed
               ///< distances.
    Complement ///< One more label, with (largest sum of all arrays) - (their sum here). Suits
               ///< probabilities.
  };

  /** Which label wins where two indicator functions are equal in whole cells (integer data). */
  enum TieBreakings
  {
    Smooth,     ///< A low-pass filtered copy of the tied functions decides.
    LowestIndex ///< The first array wins; the interface follows voxel faces there.
  };

  /** What happens to a label between grid points none of which has it. */
  enum UnseenLabelModes
  {
    Keep = 0,
    Drop = 1
  };

  /**
   * The arrays to use. None enabled (the default): all with one component. An enabled array that
   * the image does not have is an error.
   */
  vtkGetNewMacro(PointArraySelection, vtkDataArraySelection);

  ///@{
  /** Array, Constant or Complement. Default: Array. */
  vtkSetClampMacro(BackgroundMode, int, Array, Complement);
  vtkGetMacro(BackgroundMode, int);
  void SetBackgroundModeToArray() { this->SetBackgroundMode(Array); }
  void SetBackgroundModeToConstant() { this->SetBackgroundMode(Constant); }
  void SetBackgroundModeToComplement() { this->SetBackgroundMode(Complement); }
  ///@}

  ///@{
  /** The background's indicator with BackgroundMode Constant, in the arrays' unit. Default: 0. */
  vtkSetMacro(BackgroundValue, double);
  vtkGetMacro(BackgroundValue, double);
  ///@}

  ///@{
  /**
   * Name of the background's array with BackgroundMode Array. Default: empty, which means any
   * whose name is "background" without regard to case, digits and punctuation, as in
   * "000_background", or else the one with the id 0 in LabelIds.
   */
  vtkSetMacro(BackgroundArrayName, std::string);
  vtkGetMacro(BackgroundArrayName, std::string);
  ///@}

  ///@{
  /** Smooth or LowestIndex. Default: Smooth. */
  vtkSetClampMacro(TieBreaking, int, Smooth, LowestIndex);
  vtkGetMacro(TieBreaking, int);
  void SetTieBreakingToSmooth() { this->SetTieBreaking(Smooth); }
  void SetTieBreakingToLowestIndex() { this->SetTieBreaking(LowestIndex); }
  ///@}

  ///@{
  /**
   * Keep or Drop. Default: Keep: the interpolants decide everywhere, as in the paper. Drop: a label that none of the 27 grid points round a grid point
   * has is at most second there: films, wedges and specks that no voxel sees do not become sheets,
   * which helps with noisy data. The interface moves there by up to the thickness of the film.
   */
  vtkSetClampMacro(UnseenLabels, int, Keep, Drop);
  vtkGetMacro(UnseenLabels, int);
  void SetUnseenLabelsToDrop() { this->SetUnseenLabels(Drop); }
  void SetUnseenLabelsToKeep() { this->SetUnseenLabels(Keep); }
  ///@}

  ///@{
  /**
   * Junctions of curves that are closer than this become one, in world units. Default: 0, which
   * means a quarter of the spacing (the cube root of the voxel's volume).
   */
  vtkSetClampMacro(JunctionMergeTolerance, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(JunctionMergeTolerance, double);
  ///@}

  /** Includes the array selection. */
  vtkMTimeType GetMTime() override;

protected:
  vtkMultiLabelImageAlgorithm();
  ~vtkMultiLabelImageAlgorithm() override;

  int FillInputPortInformation(int port, vtkInformation* info) override;
  /** Asks for the whole image, and for everything on a second port. */
  int RequestUpdateExtent(
    vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*) override;

  vtkMultiLabel::Choice GetChoice();
  void WarnOf(const vtkMultiLabel::Input& input);

private:
  vtkMultiLabelImageAlgorithm(const vtkMultiLabelImageAlgorithm&) = delete;
  void operator=(const vtkMultiLabelImageAlgorithm&) = delete;

  vtkNew<vtkDataArraySelection> PointArraySelection;
  int BackgroundMode = Array;
  double BackgroundValue = 0.0;
  std::string BackgroundArrayName;
  int TieBreaking = Smooth;
  int UnseenLabels = Keep;
  double JunctionMergeTolerance = 0.0;
};

#endif
