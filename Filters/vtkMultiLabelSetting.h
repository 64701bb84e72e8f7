/**
 * What every product carries in its field data: the options used, the grid it was made on and the
 * labels. The next stage reads it back. Internal.
 */
#ifndef vtkMultiLabelSetting_h
#define vtkMultiLabelSetting_h

#include "vtkMultiLabelFrame.h"

#include "mlim.h"

#include <string>
#include <vector>

class vtkFieldData;

namespace vtkMultiLabel
{

class Input;

struct Setting
{
  Frame GridFrame;
  mlim_options Options = {};
  std::vector<int32_t> Ids; // one a label of the field
  std::vector<std::string> Names;

  int32_t LabelCount() const { return static_cast<int32_t>(this->Ids.size()); }
  bool IsFace(int32_t code) const { return code >= this->LabelCount(); }
  /** The id for people: a face of the box is the outside, which is background. */
  int32_t IdOf(int32_t code) const { return this->IsFace(code) ? 0 : this->Ids[code]; }
};

/** Labels and grid; the options are left to the caller. */
Setting MakeSetting(const mlim_field* field, const Input& input);

/** To field data; from field data, throwing Refusal, with `what` as the owner of the arrays. */
void WriteSetting(const Setting& setting, vtkFieldData* out);
Setting ReadSetting(vtkFieldData* arrays, const std::string& what);

/** One value under a name. */
void WriteValue(const char* name, double value, vtkFieldData* out);
void WriteCount(const char* name, size_t value, vtkFieldData* out);

/** LabelVolumes: one value a label. */
void WriteLabelVolumes(const double* volumes, size_t count, vtkFieldData* out);

}

#endif
