/**
 * A label map on its way to indicators: which array it is, the ids and names of its labels, and the
 * core's products with their owners. Internal.
 */
#ifndef vtkMultiLabelMap_h
#define vtkMultiLabelMap_h

#include "mlim.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

class vtkDataArray;
class vtkFieldData;
class vtkImageData;

namespace vtkMultiLabel
{

class Run;

/** Of the property BackgroundLabel. */
const int default_background_label = 0;

/** Whether a data type counts as a label map by itself: an integer. */
bool IsIntegerType(int vtkType);

/** The core's name of a VTK data type; MLIM_SCALAR_END: one that the core does not read. */
mlim_scalar ScalarType(int vtkType);

struct IndicatorsDeleter
{
  void operator()(mlim_indicators* indicators) const { mlim_indicators_free(indicators); }
};
using IndicatorsPointer = std::unique_ptr<mlim_indicators, IndicatorsDeleter>;

class LabelMap : public mlim_label_map
{
public:
  LabelMap() : mlim_label_map() {}
  LabelMap(const LabelMap&) = delete;
  LabelMap& operator=(const LabelMap&) = delete;
  ~LabelMap() { mlim_label_map_free(this); }

  /** Throws Refusal or Cancelled. */
  void Read(
    const mlim_array& values, const int dimensions[3], const double pointSpacing[3], Run& run);
  /** Keeps these labels and the background; all others become background. None: all are kept. */
  void Select(const std::vector<int>& selected, int background, Run& run);
  /** Names from the field data arrays LabelIds and LabelNames, as far as they are there; others are
   * called background and label_<id>. */
  void ReadNames(vtkFieldData* arrays);
  IndicatorsPointer MakeIndicators(const mlim_indicator_options& options, Run& run) const;

  /** The background's label; LabelCount() if the map does not have it. Throws Refusal if another
   * label has the id 0, which is the background's in every output. */
  size_t FindBackground(int background) const;
  size_t LabelCount() const { return static_cast<size_t>(this->label_count); }
  /** The name of a label; `background` as FindBackground gives it. */
  std::string NameOf(size_t label, size_t background) const;
  /** Empty, or a sentence that names the labels whose indicators win nowhere. */
  std::string LossOf(const mlim_indicators* indicators, size_t background) const;

private:
  std::map<int, std::string> NamesById;
};

}

#endif
