#include "vtkMultiLabelMap.h"

#include "vtkMultiLabelRun.h"

#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkStringArray.h"

#include <algorithm>
#include <climits>

namespace vtkMultiLabel
{

namespace
{

// So many labels are named in a warning; there may be thousands.
const size_t most_named = 10;

}

mlim_scalar ScalarType(int type)
{
  const bool isWide = sizeof(long) == 8;
  switch (type)
  {
    case VTK_CHAR:
      return CHAR_MIN < 0 ? MLIM_INT8 : MLIM_UINT8;
    case VTK_SIGNED_CHAR:
      return MLIM_INT8;
    case VTK_UNSIGNED_CHAR:
      return MLIM_UINT8;
    case VTK_SHORT:
      return MLIM_INT16;
    case VTK_UNSIGNED_SHORT:
      return MLIM_UINT16;
    case VTK_INT:
      return MLIM_INT32;
    case VTK_UNSIGNED_INT:
      return MLIM_UINT32;
    case VTK_LONG:
      return isWide ? MLIM_INT64 : MLIM_INT32;
    case VTK_UNSIGNED_LONG:
      return isWide ? MLIM_UINT64 : MLIM_UINT32;
    case VTK_LONG_LONG:
      return MLIM_INT64;
    case VTK_UNSIGNED_LONG_LONG:
      return MLIM_UINT64;
    case VTK_ID_TYPE:
      return sizeof(vtkIdType) == 8 ? MLIM_INT64 : MLIM_INT32;
    case VTK_FLOAT:
      return MLIM_FLOAT32;
    case VTK_DOUBLE:
      return MLIM_FLOAT64;
    default:
      return MLIM_SCALAR_END;
  }
}

bool IsIntegerType(int type)
{
  const mlim_scalar scalar = ScalarType(type);
  return scalar != MLIM_SCALAR_END && scalar != MLIM_FLOAT32 && scalar != MLIM_FLOAT64;
}

void LabelMap::Read(
  const mlim_array& values, const int dimensions[3], const double pointSpacing[3], Run& run)
{
  run.Begin(MLIM_STAGE_INDICATORS);
  run.End(mlim_label_map_read(dimensions, pointSpacing, &values, run.GetContext(), this));
}

void LabelMap::Select(const std::vector<int>& selected, int background, Run& run)
{
  if (selected.empty())
  {
    return;
  }
  std::vector<int32_t> kept(selected.begin(), selected.end());
  std::sort(kept.begin(), kept.end());
  for (int32_t id : kept)
  {
    if (!std::binary_search(this->ids, this->ids + this->label_count, id))
    {
      throw Refusal("The label map has no label " + std::to_string(id) + ", which is selected.");
    }
  }
  run.Begin(MLIM_STAGE_INDICATORS);
  run.End(mlim_label_map_select(this, kept.data(), kept.size(), background, run.GetContext()));
}

void LabelMap::ReadNames(vtkFieldData* arrays)
{
  vtkDataArray* known = arrays->GetArray("LabelIds");
  vtkStringArray* names = vtkStringArray::SafeDownCast(arrays->GetAbstractArray("LabelNames"));
  if (!known || !names || known->GetNumberOfValues() != names->GetNumberOfValues())
  {
    return;
  }
  for (vtkIdType n = 0; n < names->GetNumberOfValues(); ++n)
  {
    this->NamesById[known->GetVariantValue(n).ToInt()] = names->GetValue(n);
  }
}

IndicatorsPointer LabelMap::MakeIndicators(const mlim_indicator_options& options, Run& run) const
{
  mlim_indicators* indicators = nullptr;
  run.Begin(MLIM_STAGE_INDICATORS);
  const mlim_status status = mlim_indicators_create(this, &options, run.GetContext(), &indicators);
  IndicatorsPointer owner(indicators);
  run.End(status);
  return owner;
}

size_t LabelMap::FindBackground(int background) const
{
  const int32_t* begin = this->ids;
  const int32_t* end = begin + this->label_count;
  if (background != 0 && std::binary_search(begin, end, 0))
  {
    throw Refusal("The label map has the label 0, which is not its background (" +
                  std::to_string(background) +
                  "), but in every output 0 is the background's id; give that label another one.");
  }
  const int32_t* found = std::lower_bound(begin, end, background);
  return static_cast<size_t>((found != end && *found == background ? found : end) - begin);
}

std::string LabelMap::NameOf(size_t label, size_t background) const
{
  const int id = this->ids[label];
  const auto found = this->NamesById.find(id);
  if (label == background)
  {
    return "background";
  }
  return found != this->NamesById.end() && !found->second.empty() ? found->second
                                                                  : "label_" + std::to_string(id);
}

std::string LabelMap::LossOf(const mlim_indicators* indicators, size_t background) const
{
  std::string text;
  size_t count = 0;
  for (size_t label = 0; label < this->LabelCount(); ++label)
  {
    if (mlim_indicators_has(indicators, static_cast<int32_t>(label)))
    {
      continue;
    }
    if (count < most_named)
    {
      text += (text.empty() ? "" : ", ") + std::to_string(this->ids[label]) + " (" +
              this->NameOf(label, background) + ")";
    }
    ++count;
  }
  if (count == 0)
  {
    return {};
  }
  return std::to_string(count) + " of " + std::to_string(this->LabelCount()) +
         " labels are lost, as their indicators are nowhere the largest: " + text +
         (count > most_named ? ", and more." : ".");
}

}
