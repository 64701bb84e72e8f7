/**
 * @class vtkMultiLabelIndicators
 * @brief one indicator function for each label of a label map
 *
 * Input: vtkImageData with a label map: a point or cell array of one component whose values are whole
 * numbers of 32 bits with a sign, of any integer or floating-point type. Ids may have gaps and may be
 * negative; there may be 32000. Other values are an error that says how many there are, and where
 * the first is. SetInputArrayToProcess selects the array; by default it is the active scalars, or
 * else the one array that has one component.
 *
 * Output: vtkImageData of the same geometry with one float array a label, as
 * vtkMultiLabelInterfaceMesher and vtkMultiLabelCurveExtractor read them, on points or cells as the
 * input. The arrays are in ascending order of the ids, and named by the input's field data
 * `LabelNames` where its `LabelIds` has the id, else label_<id>; the background's is named
 * background. Field data: `LabelIds` and `LabelNames`, one entry an array. Ids are kept as they are,
 * but for the background's, which is 0 in every output.
 *
 * For each label, as in section 4.1 of Dey, Janoos and Levine: mask, median, dilation, signed
 * distance, Gaussian, curvature anisotropic diffusion. Distances are Euclidean, in world units, from
 * the grid point to the nearest face of the label's voxels (inside positive; half a spacing next to a
 * face), so the boundary of two labels is half-way between their points. Beyond the box the map goes
 * on as its mirror image. All stages are computed in tiles of 32 x 32 x 32 points, for the labels
 * near each tile, in its part of their bounding boxes, on all threads; the result does not depend on
 * the number of threads.
 *
 * Limits: the reach of all filters together, in grid points along each axis, is at most 64: the
 * radii, DistanceBand, 4 times GaussianSigma (3 times without PreserveVolume) and one a step of
 * diffusion.
 *
 * Memory: the output takes 4 bytes a point and label, for 117 labels at 181 x 217 x 181 points 3.3
 * GB. What is computed takes 4 bytes a point for each label within DistanceBand and the reach of the
 * smoothing, 0.15 GB there, in 3 seconds on 2 cores, and some megabytes a thread. The mesher and the
 * extractor run this stage themselves, with all defaults, on an image whose only array is a label
 * map of an integer type: without the output's memory, and with the same result.
 *
 * Smoothing can make small labels disappear: a label whose indicator is nowhere the largest is named
 * in a warning. KeepThinLabels, the default, prevents it.
 *
 * After an error or an abort the output has its geometry and no arrays; but from VTK 9.2 on VTK itself
 * empties it after an abort, so that it has no points either.
 *
 * @sa vtkMultiLabelInterfaceMesher vtkMultiLabelCurveExtractor
 */
#ifndef vtkMultiLabelIndicators_h
#define vtkMultiLabelIndicators_h

#include "vtkImageAlgorithm.h"
#include "vtkMultiLabelInterfaceMesherModule.h" // for export macro

#include <vector> // for Labels

class VTKMULTILABELINTERFACEMESHER_EXPORT vtkMultiLabelIndicators : public vtkImageAlgorithm
{
public:
  static vtkMultiLabelIndicators* New();
  vtkTypeMacro(vtkMultiLabelIndicators, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /** What an indicator is before it is smoothed. */
  enum Methods
  {
    SignedDistance, ///< The distance to the label's boundary, inside positive.
    GaussianMask    ///< 1 where the label is, 0 elsewhere.
  };

  ///@{
  /**
   * The labels that get an indicator, by id. Default: none given, which means all. With some, all
   * other labels are one background.
   */
  void AddLabel(int id);
  void RemoveAllLabels();
  int GetNumberOfLabels() const { return static_cast<int>(this->Labels.size()); }
  int GetLabel(int index) const;
  ///@}

  ///@{
  /**
   * The id of the background. Default: 0. With an id that the map does not have every label is a
   * region; but a region cannot have the id 0, which is the background's in every output.
   */
  vtkSetMacro(BackgroundLabel, int);
  vtkGetMacro(BackgroundLabel, int);
  ///@}

  ///@{
  /**
   * Each label's mask is replaced by the majority in a cube of 2 MedianRadius + 1 points. From 0 to
   * 8. Default: 0, off.
   */
  vtkSetClampMacro(MedianRadius, int, 0, 8);
  vtkGetMacro(MedianRadius, int);
  ///@}

  ///@{
  /**
   * Each label's mask grows by a ball of so many points, the background's too. From 0 to 8. Default:
   * 0, off. The volumes are not kept then.
   */
  vtkSetClampMacro(DilateRadius, int, 0, 8);
  vtkGetMacro(DilateRadius, int);
  ///@}

  ///@{
  /** SignedDistance or GaussianMask. Default: SignedDistance. */
  vtkSetClampMacro(Method, int, SignedDistance, GaussianMask);
  vtkGetMacro(Method, int);
  void SetMethodToSignedDistance() { this->SetMethod(SignedDistance); }
  void SetMethodToGaussianMask() { this->SetMethod(GaussianMask); }
  ///@}

  ///@{
  /**
   * Distances are cut off at this length on either side, in world units: at least the diagonal of a
   * voxel. Default: 0, which means 3 times the largest spacing.
   */
  vtkSetClampMacro(DistanceBand, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(DistanceBand, double);
  ///@}

  ///@{
  /** Whether there is a Gaussian. Default: on. */
  vtkSetMacro(GaussianSmoothing, bool);
  vtkGetMacro(GaussianSmoothing, bool);
  vtkBooleanMacro(GaussianSmoothing, bool);
  ///@}

  ///@{
  /**
   * Standard deviation of the Gaussian in world units. Default:
   * 0, which means 1.5 spacings, along each axis its own.
   */
  vtkSetClampMacro(GaussianSigma, double, 0.0, VTK_DOUBLE_MAX);
  vtkGetMacro(GaussianSigma, double);
  ///@}

  ///@{
  /**
   * Signed distances are smoothed by twice the Gaussian less the Gaussian of the Gaussian, whose
   * second moment is 0, so that curved boundaries stay where they are; and each label gets a constant,
   * of at most six tenths of the smallest spacing, that makes the volume of its region what its
   * voxels have. Default: on. Without effect on masks.
   */
  vtkSetMacro(PreserveVolume, bool);
  vtkGetMacro(PreserveVolume, bool);
  vtkBooleanMacro(PreserveVolume, bool);
  ///@}

  ///@{
  /**
   * Where a label is a sheet, a thread or a speck one grid point thick, and none of its thicker parts
   * is next to it, and at all points of a label whose indicator would win nowhere, its lead over the
   * others is what it was before smoothing, at least. Default: on.
   */
  vtkSetMacro(KeepThinLabels, bool);
  vtkGetMacro(KeepThinLabels, bool);
  vtkBooleanMacro(KeepThinLabels, bool);
  ///@}

  ///@{
  /** Steps of curvature anisotropic diffusion, after the Gaussian. From 0 to 64. Default: 0, off. */
  vtkSetClampMacro(CurvatureDiffusionIterations, int, 0, 64);
  vtkGetMacro(CurvatureDiffusionIterations, int);
  ///@}

  ///@{
  /** Length of such a step, in squares of the smallest spacing, up to 0.125. Default: 0.0625. */
  vtkSetClampMacro(CurvatureDiffusionTimeStep, double, 1e-6, 0.125);
  vtkGetMacro(CurvatureDiffusionTimeStep, double);
  ///@}

protected:
  vtkMultiLabelIndicators();
  ~vtkMultiLabelIndicators() override;

  int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  /** Asks for the whole image. */
  int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

private:
  vtkMultiLabelIndicators(const vtkMultiLabelIndicators&) = delete;
  void operator=(const vtkMultiLabelIndicators&) = delete;

  void Make(vtkImageData* image, vtkImageData* out);

  std::vector<int> Labels;
  int BackgroundLabel;
  int MedianRadius = 0;
  int DilateRadius = 0;
  int Method = SignedDistance;
  double DistanceBand = 0.0;
  bool GaussianSmoothing = true;
  double GaussianSigma = 0.0;
  bool PreserveVolume = true;
  bool KeepThinLabels = true;
  int CurvatureDiffusionIterations = 0;
  double CurvatureDiffusionTimeStep = 0.0625;
};

#endif
