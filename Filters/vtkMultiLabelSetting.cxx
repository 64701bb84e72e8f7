#include "vtkMultiLabelSetting.h"

#include "vtkMultiLabelInput.h"
#include "vtkMultiLabelRun.h"

#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"

#include <algorithm>

namespace vtkMultiLabel
{

namespace
{

struct Real
{
  const char* Name;
  double mlim_options::*Member;
};

const Real reals[] = {
  { "FacetSize", &mlim_options::facet_size },
  { "FacetRadiusEdgeRatio", &mlim_options::facet_radius_edge_ratio },
  { "FacetDistance", &mlim_options::facet_distance },
  { "EdgeSize", &mlim_options::edge_size },
  { "BallRadiusScale", &mlim_options::ball_radius_scale },
  { "CrossingTolerance", &mlim_options::crossing_tolerance },
  { "JunctionMergeTolerance", &mlim_options::junction_merge_tolerance },
  { "SmallestDistance", &mlim_options::smallest_distance },
  { "VolumeTolerance", &mlim_options::volume_tolerance },
};

vtkDataArray* Find(vtkFieldData* arrays, const char* name, const std::string& what)
{
  vtkDataArray* array = arrays->GetArray(name);
  if (!array || array->GetNumberOfValues() < 1)
  {
    throw Refusal("The " + what + " carry no field data array '" + name + "'.");
  }
  return array;
}

}

Setting MakeSetting(const mlim_field* field, const Input& input)
{
  Setting setting;
  setting.GridFrame = input.GridFrame;
  const int32_t count = mlim_field_label_count(field);
  for (int32_t label = 0; label < count; ++label)
  {
    setting.Ids.push_back(mlim_field_label_id(field, label));
    setting.Names.push_back(input.NameOfLabel(label));
  }
  return setting;
}

void WriteSetting(const Setting& setting, vtkFieldData* out)
{
  WriteFrame(setting.GridFrame, out);
  for (const Real& real : reals)
  {
    WriteValue(real.Name, setting.Options.*real.Member, out);
  }
  WriteCount("OracleMode", static_cast<size_t>(setting.Options.oracle_mode), out);
  WriteCount("VertexLimit", setting.Options.vertex_limit, out);
  WriteCount("MinimumComponentVoxels", setting.Options.min_component_voxels, out);
  vtkNew<vtkIntArray> ids;
  ids->SetName("LabelIds");
  vtkNew<vtkStringArray> names;
  names->SetName("LabelNames");
  for (size_t label = 0; label < setting.Ids.size(); ++label)
  {
    ids->InsertNextValue(setting.Ids[label]);
    names->InsertNextValue(setting.Names[label]);
  }
  out->AddArray(ids);
  out->AddArray(names);
}

Setting ReadSetting(vtkFieldData* arrays, const std::string& what)
{
  Setting setting;
  setting.GridFrame = ReadFrame(arrays, what);
  for (const Real& real : reals)
  {
    setting.Options.*real.Member = Find(arrays, real.Name, what)->GetComponent(0, 0);
  }
  auto count = [&](const char* name)
  {
    const double value = Find(arrays, name, what)->GetComponent(0, 0);
    if (!(value >= 0.0 && value <= static_cast<double>(VTK_ID_MAX)))
    {
      throw Refusal("The " + what + " carry " + std::to_string(value) + " as " + name + ".");
    }
    return static_cast<size_t>(value);
  };
  setting.Options.oracle_mode =
    count("OracleMode") == 0 ? MLIM_ORACLE_EXACT : MLIM_ORACLE_BISECTION;
  setting.Options.vertex_limit = count("VertexLimit");
  setting.Options.min_component_voxels = count("MinimumComponentVoxels");
  vtkDataArray* ids = Find(arrays, "LabelIds", what);
  vtkStringArray* names = vtkStringArray::SafeDownCast(arrays->GetAbstractArray("LabelNames"));
  for (vtkIdType label = 0; label < ids->GetNumberOfValues(); ++label)
  {
    setting.Ids.push_back(static_cast<int32_t>(ids->GetVariantValue(label).ToInt()));
    const bool hasName = names && label < names->GetNumberOfValues();
    setting.Names.push_back(
      hasName ? std::string(names->GetValue(label)) : std::to_string(setting.Ids.back()));
  }
  return setting;
}

void WriteValue(const char* name, double value, vtkFieldData* out)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName(name);
  array->InsertNextValue(value);
  out->AddArray(array);
}

void WriteCount(const char* name, size_t value, vtkFieldData* out)
{
  vtkNew<vtkIdTypeArray> array;
  array->SetName(name);
  array->InsertNextValue(static_cast<vtkIdType>(value));
  out->AddArray(array);
}

void WriteLabelVolumes(const double* volumes, size_t count, vtkFieldData* out)
{
  vtkNew<vtkDoubleArray> array;
  array->SetName("LabelVolumes");
  for (size_t label = 0; label < count; ++label)
  {
    array->InsertNextValue(volumes[label]);
  }
  out->AddArray(array);
}

}
