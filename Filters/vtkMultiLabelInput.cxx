#include "vtkMultiLabelInput.h"

#include "vtkMultiLabelRun.h"

#include "vtkCellData.h"
#include "vtkDataArraySelection.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <cctype>
#include <climits>
#include <map>

namespace vtkMultiLabel
{

namespace
{

bool IsBackgroundName(const std::string& name)
{
  std::string letters;
  for (char c : name)
  {
    if (std::isalpha(static_cast<unsigned char>(c)))
    {
      letters += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    }
  }
  return letters == "background";
}

std::string NameOfArray(vtkFieldData* arrays, int index)
{
  const char* name = arrays->GetAbstractArray(index)->GetName();
  return name && name[0] != '\0' ? name : "array " + std::to_string(index);
}

bool IsGhostArray(vtkFieldData* arrays, int index)
{
  return NameOfArray(arrays, index) == vtkDataSetAttributes::GhostArrayName();
}

// Names of enabled arrays; empty: none is enabled.
std::vector<std::string> EnabledNames(vtkDataArraySelection* selection)
{
  std::vector<std::string> names;
  for (int i = 0; selection && i < selection->GetNumberOfArrays(); ++i)
  {
    if (selection->GetArraySetting(i))
    {
      names.emplace_back(selection->GetArrayName(i));
    }
  }
  return names;
}

bool HasAny(vtkFieldData* arrays, const std::vector<std::string>& names)
{
  return std::any_of(names.begin(), names.end(),
    [arrays](const std::string& name) { return arrays->HasArray(name.c_str()) != 0; });
}

// Arrays with one component, or one array with several that is alone.
bool HasSuitable(vtkFieldData* arrays)
{
  int singleCount = 0;
  int multipleCount = 0;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    if (arrays->GetArray(i) && !IsGhostArray(arrays, i))
    {
      const bool isSingle = arrays->GetArray(i)->GetNumberOfComponents() == 1;
      singleCount += isSingle ? 1 : 0;
      multipleCount += isSingle ? 0 : 1;
    }
  }
  return singleCount > 0 || multipleCount == 1;
}

std::string Why(vtkAbstractArray* array)
{
  return vtkDataArray::SafeDownCast(array)
           ? "has " + std::to_string(array->GetNumberOfComponents()) + " components"
           : std::string("does not hold numbers");
}

}

Input::Input(vtkImageData* image, const Choice& choice)
{
  if (!image)
  {
    throw Refusal("There is no input image.");
  }
  if (image->GetNumberOfPoints() == 0)
  {
    throw Refusal("The input image is empty.");
  }
  const std::vector<std::string> enabled = EnabledNames(choice.Arrays);
  vtkFieldData* points = image->GetPointData();
  vtkFieldData* cells = image->GetCellData();
  this->IsCellCentred = enabled.empty() ? !HasSuitable(points) && HasSuitable(cells)
                                        : !HasAny(points, enabled) && HasAny(cells, enabled);
  this->GridFrame = FrameOfImage(image, this->IsCellCentred);
  this->ReadArrays(image, choice);
  if (!this->Map)
  {
    this->ReadBackground(choice);
    this->CheckIds();
    this->ShareArrays();
  }
  this->ReadOutside(image);
  std::copy_n(this->GridFrame.Dimensions, 3, this->Grid.dims);
  std::copy_n(this->GridFrame.Spacing, 3, this->Grid.spacing);
  this->Grid.is_outside = this->Outside.empty() ? nullptr : this->Outside.data();
  this->Grid.tie_breaking = choice.TieBreaking;
  this->Grid.unseen = choice.UnseenLabels;
}

void Input::ShareArrays()
{
  for (size_t a = 0; a < this->Arrays.size(); ++a)
  {
    this->Arrays[a].name = this->Names[a].c_str();
  }
  this->Grid.array_count = this->Arrays.size();
  this->Grid.arrays = this->Arrays.data();
}

void Input::MakeIndicators(Run& run)
{
  const mlim_array values = this->Arrays.front();
  this->Map->Read(values, this->GridFrame.Dimensions, this->GridFrame.Spacing, run);
  const size_t background = this->Map->FindBackground(default_background_label);
  this->Indicators = this->Map->MakeIndicators(mlim_indicator_options_default(), run);
  this->Arrays.assign(this->Map->LabelCount(), mlim_array());
  this->Names.clear();
  for (size_t label = 0; label < this->Arrays.size(); ++label)
  {
    this->Arrays[label].id = this->Map->ids[label];
    this->Names.push_back(this->Map->NameOf(label, background));
  }
  const std::string loss = this->Map->LossOf(this->Indicators.get(), background);
  if (!loss.empty())
  {
    this->Warnings.push_back(loss);
  }
  this->Grid.indicators = this->Indicators.get();
  this->Grid.background =
    background < this->Arrays.size() ? MLIM_BACKGROUND_ARRAY : MLIM_BACKGROUND_NONE;
  this->Grid.background_array = background;
  this->ShareArrays();
}

std::string Input::NameOfLabel(int32_t label) const
{
  const bool hasExtra = this->Grid.background == MLIM_BACKGROUND_CONSTANT ||
                        this->Grid.background == MLIM_BACKGROUND_COMPLEMENT;
  const size_t array = static_cast<size_t>(label) - (hasExtra ? 1 : 0);
  return array < this->Names.size() ? this->Names[array] : "background";
}

// The arrays to use, in the image's order: the enabled ones or all with one component; or the
// components of the one array that is given alone.
std::vector<Input::Candidate> Input::ReadCandidates(vtkImageData* image, const Choice& choice)
{
  vtkFieldData* arrays = this->IsCellCentred ? static_cast<vtkFieldData*>(image->GetCellData())
                                             : static_cast<vtkFieldData*>(image->GetPointData());
  const std::vector<std::string> enabled = EnabledNames(choice.Arrays);
  vtkFieldData* others = this->IsCellCentred ? static_cast<vtkFieldData*>(image->GetPointData())
                                             : static_cast<vtkFieldData*>(image->GetCellData());
  for (const std::string& name : enabled)
  {
    if (arrays->HasArray(name.c_str()))
    {
      continue;
    }
    if (!others->HasArray(name.c_str()))
    {
      throw Refusal("The image has no array '" + name + "', which is selected.");
    }
    this->Warnings.push_back("The array '" + name + "' is one of the " +
                             (this->IsCellCentred ? "points" : "cells") +
                             ", unlike the other selected ones, and is not used.");
  }
  std::vector<Candidate> singles;
  std::vector<int> multiples;
  std::vector<std::string> passedOver;
  int position = 0;
  for (int i = 0; i < arrays->GetNumberOfArrays(); ++i)
  {
    if (IsGhostArray(arrays, i))
    {
      continue;
    }
    vtkDataArray* array = arrays->GetArray(i);
    const std::string name = NameOfArray(arrays, i);
    const bool isSingle = array && array->GetNumberOfComponents() == 1;
    const bool isChosen =
      enabled.empty() || std::find(enabled.begin(), enabled.end(), name) != enabled.end();
    if (isChosen && isSingle)
    {
      singles.push_back({ array, 0, name, position });
    }
    else if (isChosen)
    {
      passedOver.push_back("'" + name + "' " + Why(arrays->GetAbstractArray(i)));
      if (array)
      {
        multiples.push_back(i);
      }
    }
    position += isSingle ? 1 : 0;
  }
  this->CandidateCount = static_cast<size_t>(position);
  if (singles.empty() && multiples.size() == 1 && (enabled.empty() || enabled.size() == 1))
  {
    vtkDataArray* array = arrays->GetArray(multiples[0]);
    const std::string name = NameOfArray(arrays, multiples[0]);
    for (int c = 0; c < array->GetNumberOfComponents(); ++c)
    {
      const char* component = array->GetComponentName(c);
      singles.push_back({ array, c, component ? component : name + "_" + std::to_string(c), c });
    }
    this->CandidateCount = singles.size();
    return singles;
  }
  if (singles.empty() || (!enabled.empty() && !passedOver.empty()))
  {
    throw Refusal(passedOver.empty() ? "The image has no arrays."
                                     : "An array with one component for each label is needed; " +
                                         passedOver.front() + ".");
  }
  for (const std::string& reason : passedOver)
  {
    this->Warnings.push_back("The array " + reason + " and is not used.");
  }
  return singles;
}

void Input::ReadArrays(vtkImageData* image, const Choice& choice)
{
  std::vector<Candidate> used = this->ReadCandidates(image, choice);
  const int* n = this->GridFrame.Dimensions;
  const vtkIdType count = static_cast<vtkIdType>(n[0]) * n[1] * n[2];
  for (const Candidate& candidate : used)
  {
    this->Arrays.push_back(this->Borrow(candidate, count));
    this->ArrayNames.push_back(candidate.Name);
  }
  this->Names = this->ArrayNames;
  const bool isAlone = used.size() == 1 && used.front().Values->GetNumberOfComponents() == 1;
  if (isAlone && IsIntegerType(used.front().Values->GetDataType()) &&
      choice.BackgroundMode == BackgroundArray && choice.BackgroundArrayName.empty())
  {
    this->Map.reset(new LabelMap);
    this->Map->ReadNames(image->GetFieldData());
    this->Arrays.front().name = this->Names.front().c_str();
    return;
  }
  this->ReadLabels(image, used, this->CandidateCount);
}

mlim_array Input::Borrow(const Candidate& candidate, vtkIdType count)
{
  vtkDataArray* values = candidate.Values;
  if (values->GetNumberOfTuples() != count)
  {
    throw Refusal("The array '" + candidate.Name + "' has " +
                  std::to_string(values->GetNumberOfTuples()) + " values for " +
                  std::to_string(count) + (this->IsCellCentred ? " cells." : " points."));
  }
  mlim_array array = {};
  array.type = ScalarType(values->GetDataType());
  if (array.type != MLIM_SCALAR_END && values->HasStandardMemoryLayout())
  {
    const auto* bytes = static_cast<const unsigned char*>(values->GetVoidPointer(0));
    array.values = bytes + candidate.Component * values->GetDataTypeSize();
    array.stride = static_cast<size_t>(values->GetNumberOfComponents());
    return array;
  }
  vtkSmartPointer<vtkDoubleArray> copy = vtkSmartPointer<vtkDoubleArray>::New();
  copy->SetNumberOfTuples(count);
  copy->CopyComponent(0, values, candidate.Component);
  this->Copies.push_back(copy);
  array.type = MLIM_FLOAT64;
  array.values = copy->GetPointer(0);
  array.stride = 1;
  return array;
}

// Ids and names: one entry an array of the image, or one entry an array that is used.
void Input::ReadLabels(vtkImageData* image, std::vector<Candidate>& used, size_t candidateCount)
{
  auto entry = [&](const char* name, vtkAbstractArray* array, size_t a) -> vtkIdType
  {
    if (!array)
    {
      return -1;
    }
    const size_t count = static_cast<size_t>(array->GetNumberOfValues());
    if (count == candidateCount)
    {
      return used[a].Position;
    }
    if (count == used.size())
    {
      return static_cast<vtkIdType>(a);
    }
    if (a == 0)
    {
      this->Warnings.push_back("The field data array '" + std::string(name) + "' has " +
                               std::to_string(count) + " entries for " +
                               std::to_string(candidateCount) + " arrays and is not used.");
    }
    return -1;
  };
  vtkDataArray* ids = image->GetFieldData()->GetArray("LabelIds");
  vtkStringArray* names =
    vtkStringArray::SafeDownCast(image->GetFieldData()->GetAbstractArray("LabelNames"));
  for (size_t a = 0; a < used.size(); ++a)
  {
    const vtkIdType idEntry = entry("LabelIds", ids, a);
    if (idEntry >= 0)
    {
      const double id = ids->GetVariantValue(idEntry).ToDouble();
      if (!(id >= INT_MIN && id <= INT_MAX))
      {
        throw Refusal("The field data array 'LabelIds' holds " + std::to_string(id) +
                      "; ids from " + std::to_string(INT_MIN) + " to " + std::to_string(INT_MAX) +
                      " are needed.");
      }
      this->Arrays[a].id = static_cast<int32_t>(id);
      this->HasLabelIds = true;
    }
    const vtkIdType nameEntry = entry("LabelNames", names, a);
    if (nameEntry >= 0)
    {
      this->Names[a] = names->GetValue(nameEntry);
    }
  }
}

void Input::ReadBackground(const Choice& choice)
{
  const size_t count = this->Arrays.size();
  size_t background = count;
  this->Grid.background = MLIM_BACKGROUND_NONE;
  if (choice.BackgroundMode == BackgroundConstant)
  {
    this->Grid.background = MLIM_BACKGROUND_CONSTANT;
    this->Grid.background_value = choice.BackgroundValue;
  }
  else if (choice.BackgroundMode == BackgroundComplement)
  {
    this->Grid.background = MLIM_BACKGROUND_COMPLEMENT;
  }
  else
  {
    const std::string& wanted = choice.BackgroundArrayName;
    for (size_t a = count; a-- > 0;)
    {
      const std::string& name = this->ArrayNames[a];
      const std::string& label = this->Names[a];
      if (wanted.empty() ? IsBackgroundName(name) || IsBackgroundName(label)
                         : name == wanted || label == wanted)
      {
        background = a;
      }
    }
    if (!wanted.empty() && background == count)
    {
      throw Refusal("The background array '" + wanted + "' is not among the arrays used.");
    }
    for (size_t a = count; background == count && this->HasLabelIds && a-- > 0;)
    {
      if (this->Arrays[a].id == 0)
      {
        background = a;
      }
    }
    if (background < count)
    {
      this->Grid.background = MLIM_BACKGROUND_ARRAY;
      this->Grid.background_array = background;
      this->Arrays[background].id = 0;
    }
    else if (count == 1)
    {
      this->Warnings.push_back("There is one array and no background, so the only region is the "
                               "whole image. (Labels in floating point go through "
                               "vtkMultiLabelIndicators first.)");
    }
  }
  int32_t next = 1;
  for (size_t a = 0; a < count && !this->HasLabelIds; ++a)
  {
    if (a != background)
    {
      this->Arrays[a].id = next++;
    }
  }
}

void Input::CheckIds() const
{
  std::map<int32_t, size_t> owners;
  for (size_t a = 0; a < this->Arrays.size(); ++a)
  {
    const int32_t id = this->Arrays[a].id;
    const bool isBackground =
      this->Grid.background == MLIM_BACKGROUND_ARRAY && this->Grid.background_array == a;
    if (id == 0 && !isBackground)
    {
      throw Refusal(
        "The array '" + this->Names[a] +
        "' has the id 0 in the field data array 'LabelIds', which is the background's.");
    }
    const auto inserted = owners.emplace(id, a);
    if (!inserted.second)
    {
      throw Refusal("The arrays '" + this->Names[inserted.first->second] + "' and '" +
                    this->Names[a] + "' have the same id " + std::to_string(id) +
                    " in the field data array 'LabelIds'.");
    }
  }
}

void Input::ReadOutside(vtkImageData* image)
{
  vtkFieldData* arrays = this->IsCellCentred ? static_cast<vtkFieldData*>(image->GetCellData())
                                             : static_cast<vtkFieldData*>(image->GetPointData());
  vtkUnsignedCharArray* ghosts = vtkUnsignedCharArray::SafeDownCast(
    arrays->GetAbstractArray(vtkDataSetAttributes::GhostArrayName()));
  if (!ghosts)
  {
    return;
  }
  const int hidden = this->IsCellCentred ? static_cast<int>(vtkDataSetAttributes::HIDDENCELL)
                                         : static_cast<int>(vtkDataSetAttributes::HIDDENPOINT);
  const vtkIdType count = ghosts->GetNumberOfValues();
  const int* n = this->GridFrame.Dimensions;
  if (count != static_cast<vtkIdType>(n[0]) * n[1] * n[2])
  {
    this->Warnings.emplace_back("The array 'vtkGhostType' has the wrong length and is not used.");
    return;
  }
  std::vector<unsigned char> outside(static_cast<size_t>(count));
  bool hasAny = false;
  for (vtkIdType i = 0; i < count; ++i)
  {
    const bool isHidden = (ghosts->GetValue(i) & hidden) != 0;
    outside[static_cast<size_t>(i)] = isHidden ? 1 : 0;
    hasAny = hasAny || isHidden;
  }
  if (hasAny)
  {
    this->Outside.swap(outside);
  }
}

}
