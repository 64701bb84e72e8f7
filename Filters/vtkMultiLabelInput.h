/**
 * An image as the core's input: which arrays are labels, what is background, what lies outside, and
 * the labels' ids and names. Values are borrowed where the memory layout allows. Internal.
 */
#ifndef vtkMultiLabelInput_h
#define vtkMultiLabelInput_h

#include "vtkMultiLabelFrame.h"
#include "vtkMultiLabelMap.h"

#include "mlim.h"

#include "vtkDataArray.h"
#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkDataArraySelection;
class vtkImageData;

namespace vtkMultiLabel
{

/** The numbers are those of the filters' property BackgroundMode. */
enum BackgroundModes
{
  BackgroundArray,
  BackgroundConstant,
  BackgroundComplement
};

/** What the user chose. */
struct Choice
{
  vtkDataArraySelection* Arrays = nullptr; // none enabled: all single-component arrays
  int BackgroundMode = BackgroundArray;
  double BackgroundValue = 0.0;
  std::string BackgroundArrayName; // empty: "background" without regard to case, digits, marks
  mlim_tie_breaking TieBreaking = MLIM_TIE_SMOOTH;
  mlim_unseen UnseenLabels = MLIM_UNSEEN_KEEP;
};

class Input
{
public:
  /** Throws Refusal if the image or the choice cannot be used. */
  Input(vtkImageData* image, const Choice& choice);
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  /** Whether the image is a label map: one integer array alone, with BackgroundMode Array and no
   * BackgroundArrayName. Then MakeIndicators fills in what the grid lacks. */
  bool IsLabelMap() const { return this->Map != nullptr; }
  /** Throws Refusal or Cancelled; may add to the warnings. */
  void MakeIndicators(Run& run);

  /** Borrows from this and from the image. */
  mlim_grid Grid = {};
  Frame GridFrame;
  /** What was passed over, in words; usually empty. */
  std::vector<std::string> Warnings;

  /** Name of a label of the field: of its array, or "background" for the extra ones. */
  std::string NameOfLabel(int32_t label) const;

private:
  struct Candidate // an array, or one component of one
  {
    vtkDataArray* Values;
    int Component;
    std::string Name;
    int Position; // among all candidates of the image
  };

  void ReadArrays(vtkImageData* image, const Choice& choice);
  std::vector<Candidate> ReadCandidates(vtkImageData* image, const Choice& choice);
  void ReadLabels(vtkImageData* image, std::vector<Candidate>& used, size_t candidateCount);
  void ReadBackground(const Choice& choice);
  void CheckIds() const;
  void ReadOutside(vtkImageData* image);
  void ShareArrays();
  mlim_array Borrow(const Candidate& candidate, vtkIdType count);

  bool IsCellCentred = false;
  bool HasLabelIds = false;
  size_t CandidateCount = 0;
  std::vector<mlim_array> Arrays;
  std::vector<std::string> ArrayNames;
  std::vector<std::string> Names; // of the labels: LabelNames, else ArrayNames
  std::unique_ptr<LabelMap> Map;
  IndicatorsPointer Indicators;
  std::vector<unsigned char> Outside;
  std::vector<vtkSmartPointer<vtkDataArray>> Copies;
};

}

#endif
