/**
 * Curves and balls as polydata and back. Reading what was written gives the same product up to the
 * rounding of the points. Internal.
 *
 * Label sets are written twice: LabelSet holds the ids for people, LabelCodes the core's codes.
 */
#ifndef vtkMultiLabelProducts_h
#define vtkMultiLabelProducts_h

#include "vtkMultiLabelSetting.h"

#include "mlim.h"

#include <map>
#include <vector>

class vtkPolyData;

namespace vtkMultiLabel
{

/** Owns what an mlim_sets borrows. */
class SetTable
{
public:
  /** The index of the set with these codes, which are ascending. */
  int32_t IndexOf(const std::vector<int32_t>& codes);
  mlim_sets View();

private:
  std::map<std::vector<int32_t>, int32_t> Indices;
  std::vector<size_t> Offsets = { 0 };
  std::vector<int32_t> Codes;
};

struct CurveNetwork
{
  std::vector<double> Points;
  std::vector<size_t> CurveOffsets = { 0 };
  std::vector<int32_t> CurvePoints;
  std::vector<int32_t> CurveSets;
  std::vector<int32_t> JunctionPoints;
  std::vector<int32_t> JunctionSets;
  SetTable Sets;

  mlim_curves View();
};

struct BallCover
{
  std::vector<double> Centers;
  std::vector<double> Radii;
  std::vector<int32_t> BallCurves;
  std::vector<int32_t> BallSets;
  std::vector<int32_t> Edges;
  std::vector<int32_t> EdgeCurves;
  SetTable Sets;

  mlim_balls View();
};

/** Points, cells and their arrays; a product of zeros gives the arrays without tuples. */
void WriteCurves(const mlim_curves& curves, const Setting& setting, vtkPolyData* out);
void WriteBalls(const mlim_balls& balls, const Setting& setting, vtkPolyData* out);

/** Throw Refusal for polydata that WriteCurves or WriteBalls cannot have made. */
CurveNetwork ReadCurves(vtkPolyData* curves, const Setting& setting);
BallCover ReadBalls(vtkPolyData* balls, const Setting& setting);

}

#endif
