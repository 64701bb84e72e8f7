/**
 * One execution of a filter: the core's context, with the filter's progress, abort flag and threads
 * behind it, the time of each stage, and one guard round all of it. Internal.
 */
#ifndef vtkMultiLabelRun_h
#define vtkMultiLabelRun_h

#include "mlim.h"

#include "vtkAlgorithm.h"
#include "vtkSetGet.h"

#include <array>
#include <chrono>
#include <exception>
#include <new>
#include <stdexcept>
#include <vector>

class vtkFieldData;
class vtkInformationVector;

namespace vtkMultiLabel
{

/** An input that cannot be used, or a failure of the core; what() is the sentence for the user. */
class Refusal : public std::runtime_error
{
public:
  using std::runtime_error::runtime_error;
};

/** The user asked to stop. */
class Cancelled : public std::exception
{
};

class Run
{
public:
  Run(vtkAlgorithm* algorithm, const std::vector<mlim_stage>& stages);
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

  /** Counts one more stage in. Before anything is reported. */
  void Use(mlim_stage stage);

  mlim_context* GetContext() { return &this->Context; }

  /** Shows the stage's name and starts its clock. The core's progress reports do so as well. */
  void Begin(mlim_stage stage);
  /** Stops the clock. Throws Cancelled or Refusal unless the status is a success; the vertex limit
   * is one. */
  void End(mlim_status status);

  /** Arrays TimeIndicators, TimeField, TimeCurves, TimeBalls, TimeSurface, TimeCertificate and
   * TimeVolume, in seconds. A stage that is not of this run keeps the time that came with the input,
   * or gets 0. */
  void WriteTimes(vtkFieldData* out) const;

private:
  static int Progress(void* user, mlim_stage stage, double fraction);
  static void ParallelFor(void* user, size_t count, mlim_body body, void* job);

  void SwitchTo(mlim_stage stage);
  bool Report(mlim_stage stage, double fraction);

  using Clock = std::chrono::steady_clock;
  vtkAlgorithm* Algorithm;
  mlim_context Context = {};
  std::array<bool, MLIM_STAGE_END> InUse = {};
  std::array<double, MLIM_STAGE_END> Start = {};  // of the whole progress
  std::array<double, MLIM_STAGE_END> Weight = {}; // share of the whole progress
  std::array<double, MLIM_STAGE_END> Seconds = {};
  mlim_stage Stage = MLIM_STAGE_END;
  Clock::time_point StageBegin;
  Clock::time_point LastEvent;
  double LastProgress = 0.0;
};

/** Whether this execution is for a piece other than the first. Meshes are made whole, so the first
 * piece is everything and the others are empty. */
bool IsLaterPiece(vtkInformationVector* outputs);

/** Runs body(); turns what it throws into an error event. Whatever is not a success leaves what
 * clear() makes. The result is RequestData's. */
template <typename Body, typename Clear>
int Guard(vtkAlgorithm* algorithm, const Body& body, const Clear& clear)
{
  int result = 1;
  try
  {
    body();
    return result;
  }
  catch (const Cancelled&)
  {
  }
  catch (const std::bad_alloc&)
  {
    vtkErrorWithObjectMacro(algorithm, "There is not enough memory.");
    result = 0;
  }
  catch (const std::exception& error)
  {
    vtkErrorWithObjectMacro(algorithm, << error.what());
    result = 0;
  }
  catch (...)
  {
    vtkErrorWithObjectMacro(algorithm, "An unknown error occurred.");
    result = 0;
  }
  try
  {
    clear();
  }
  catch (...)
  {
    result = 0;
  }
  return result;
}

}

#endif
