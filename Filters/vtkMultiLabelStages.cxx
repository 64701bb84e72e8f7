#include "vtkMultiLabelStages.h"

#include "vtkMultiLabelInput.h"
#include "vtkMultiLabelProducts.h"
#include "vtkMultiLabelRun.h"

#include "vtkFieldData.h"
#include "vtkPolyData.h"

namespace vtkMultiLabel
{

namespace
{

// Of EdgeSize: the core's default for FacetDistance, where EdgeSize is FacetSize.
const double facet_distance_part = 0.125;

struct Curves : mlim_curves
{
  Curves() : mlim_curves() {}
  Curves(const Curves&) = delete;
  Curves& operator=(const Curves&) = delete;
  ~Curves() { mlim_curves_free(this); }
};

struct Balls : mlim_balls
{
  Balls() : mlim_balls() {}
  Balls(const Balls&) = delete;
  Balls& operator=(const Balls&) = delete;
  ~Balls() { mlim_balls_free(this); }
};

}

std::vector<mlim_stage> StagesFrom(const Input& input, std::vector<mlim_stage> stages)
{
  if (input.IsLabelMap())
  {
    stages.insert(stages.begin(), MLIM_STAGE_INDICATORS);
  }
  return stages;
}

FieldPointer IndexField(Input& input, Run& run)
{
  if (input.IsLabelMap())
  {
    input.MakeIndicators(run);
  }
  mlim_field* field = nullptr;
  run.Begin(MLIM_STAGE_FIELD);
  const mlim_status status = mlim_field_create(&input.Grid, run.GetContext(), &field);
  FieldPointer owner(field);
  run.End(status);
  return owner;
}

mlim_options CurveOptions(const mlim_field* field, double junctionMergeTolerance, Run& run)
{
  mlim_options options = mlim_options_default(field);
  if (junctionMergeTolerance != 0.0)
  {
    options.junction_merge_tolerance = junctionMergeTolerance;
  }
  run.End(mlim_options_complete(field, run.GetContext(), &options));
  return options;
}

void ExtractCurves(const mlim_field* field, const Setting& setting, Run& run, vtkPolyData* out)
{
  Curves curves;
  run.Begin(MLIM_STAGE_CURVES);
  run.End(mlim_curves_extract(field, &setting.Options, run.GetContext(), &curves));
  WriteCurves(curves, setting, out);
  WriteSetting(setting, out->GetFieldData());
  WriteCount("CurveCount", curves.curve_count, out->GetFieldData());
  WriteCount("JunctionCount", curves.junction_count, out->GetFieldData());
}

void CoverCurves(vtkPolyData* curves, const CoverChoice& choice, Run& run, vtkPolyData* out)
{
  Setting setting = ReadSetting(curves->GetFieldData(), "curves");
  CurveNetwork network = ReadCurves(curves, setting);
  mlim_options& options = setting.Options;
  options.edge_size = choice.EdgeSize != 0.0 ? choice.EdgeSize : options.edge_size;
  options.facet_distance =
    choice.FacetDistance != 0.0 ? choice.FacetDistance : facet_distance_part * options.edge_size;
  options.ball_radius_scale = choice.BallRadiusScale;
  Balls balls;
  const mlim_curves view = network.View();
  run.Begin(MLIM_STAGE_BALLS);
  run.End(mlim_balls_cover(&view, &setting.Options, run.GetContext(), &balls));
  WriteBalls(balls, setting, out);
  WriteSetting(setting, out->GetFieldData());
  WriteCount("BallCount", balls.ball_count, out->GetFieldData());
}

}
