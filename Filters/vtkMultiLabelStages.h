/**
 * The stages before refinement, one function each. A filter that runs one stage and the mesher that
 * runs them all call the same functions and pass the same polydata between them, so their results
 * are the same bytes. Internal.
 */
#ifndef vtkMultiLabelStages_h
#define vtkMultiLabelStages_h

#include "vtkMultiLabelSetting.h"

#include "mlim.h"

#include <memory>
#include <vector>

class vtkPolyData;

namespace vtkMultiLabel
{

class Input;
class Run;

struct FieldDeleter
{
  void operator()(mlim_field* field) const { mlim_field_free(field); }
};
using FieldPointer = std::unique_ptr<mlim_field, FieldDeleter>;

/** Of the property BallRadiusScale. */
const double default_ball_radius_scale = 1.0;

/** Makes the indicators of a label map first. */
FieldPointer IndexField(Input& input, Run& run);

/** The stages of a run, those of the input's own among them. */
std::vector<mlim_stage> StagesFrom(const Input& input, std::vector<mlim_stage> stages);

/** The core's defaults with every length filled in, and the tolerance if it is not 0. */
mlim_options CurveOptions(const mlim_field* field, double junctionMergeTolerance, Run& run);

/** Curves of the field; the setting goes into the field data. */
void ExtractCurves(const mlim_field* field, const Setting& setting, Run& run, vtkPolyData* out);

/** The properties of vtkMultiLabelCurveProtector, which the mesher has as well. */
struct CoverChoice
{
  double EdgeSize = 0.0;      // 0: the curves' EdgeSize
  double FacetDistance = 0.0; // 0: an eighth of EdgeSize
  double BallRadiusScale = default_ball_radius_scale;
};

/** Balls on curves that ExtractCurves made. */
void CoverCurves(vtkPolyData* curves, const CoverChoice& choice, Run& run, vtkPolyData* out);

}

#endif
