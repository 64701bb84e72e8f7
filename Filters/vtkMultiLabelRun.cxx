#include "vtkMultiLabelRun.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkSMPTools.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkVersion.h"

#include <algorithm>

namespace vtkMultiLabel
{

namespace
{

// Shares of the stages in the time of a typical run; only the look of the progress bar depends on
// them.
const double stage_weights[MLIM_STAGE_END] = { 0.15, 0.05, 0.1, 0.05, 0.7, 0.1, 1.0 };

const char* const stage_arrays[MLIM_STAGE_END] = { "TimeIndicators", "TimeField", "TimeCurves",
  "TimeBalls", "TimeSurface", "TimeCertificate", "TimeVolume" };

// A progress event every 20 ms, or 1/200 of the way: a user interface reads its events in them, so
// this is also the delay of an abort, and more would cost time.
const std::chrono::milliseconds event_interval(20);
const double event_step = 0.005;

}

Run::Run(vtkAlgorithm* algorithm, const std::vector<mlim_stage>& stages) : Algorithm(algorithm)
{
  this->Context.progress = &Run::Progress;
  this->Context.parallel_for = &Run::ParallelFor;
  this->Context.user = this;
  for (mlim_stage stage : stages)
  {
    this->Use(stage);
  }
}

void Run::Use(mlim_stage stage)
{
  this->InUse[stage] = true;
  double total = 0.0;
  for (int s = 0; s < MLIM_STAGE_END; ++s)
  {
    total += this->InUse[s] ? stage_weights[s] : 0.0;
  }
  double start = 0.0;
  for (int s = 0; s < MLIM_STAGE_END; ++s)
  {
    this->Start[s] = start;
    this->Weight[s] = this->InUse[s] ? stage_weights[s] / total : 0.0;
    start += this->Weight[s];
  }
}

void Run::SwitchTo(mlim_stage stage)
{
  const Clock::time_point now = Clock::now();
  if (this->Stage != MLIM_STAGE_END)
  {
    this->Seconds[this->Stage] += std::chrono::duration<double>(now - this->StageBegin).count();
  }
  this->Stage = stage;
  this->StageBegin = now;
  if (stage != MLIM_STAGE_END)
  {
    this->Algorithm->SetProgressText(mlim_stage_text(stage));
  }
}

void Run::Begin(mlim_stage stage)
{
  if (this->Report(stage, 0.0))
  {
    throw Cancelled();
  }
}

void Run::End(mlim_status status)
{
  this->SwitchTo(MLIM_STAGE_END);
  switch (status)
  {
    case MLIM_OK:
    case MLIM_VERTEX_LIMIT:
      return;
    case MLIM_CANCELLED:
      throw Cancelled();
    case MLIM_OUT_OF_MEMORY:
    case MLIM_INVALID_ARGUMENT:
    case MLIM_INTERNAL:
    case MLIM_STATUS_END:
      break;
  }
  throw Refusal(
    this->Context.message[0] != '\0' ? this->Context.message : mlim_status_text(status));
}

bool Run::Report(mlim_stage stage, double fraction)
{
  const bool isNewStage = stage != this->Stage;
  if (isNewStage)
  {
    this->SwitchTo(stage);
  }
  const double share = std::min(std::max(fraction, 0.0), 1.0) * this->Weight[stage];
  const double progress = std::max(this->LastProgress, std::min(1.0, this->Start[stage] + share));
  const Clock::time_point now = Clock::now();
  if (isNewStage || progress >= this->LastProgress + event_step ||
      now - this->LastEvent >= event_interval)
  {
    this->LastProgress = progress;
    this->LastEvent = now;
    this->Algorithm->UpdateProgress(progress);
#if VTK_VERSION_NUMBER >= VTK_VERSION_CHECK(9, 2, 20220920)
    if (this->Algorithm->CheckAbort())
    {
      return true;
    }
#endif
  }
  return this->Algorithm->GetAbortExecute() != 0;
}

int Run::Progress(void* user, mlim_stage stage, double fraction)
{
  try
  {
    return static_cast<Run*>(user)->Report(stage, fraction) ? 1 : 0;
  }
  catch (...)
  {
    // An observer threw; nothing may pass the core, and to go on would be against its wish.
    return 1;
  }
}

void Run::ParallelFor(void*, size_t count, mlim_body body, void* job)
{
  vtkSMPTools::For(0, static_cast<vtkIdType>(count),
    [body, job](vtkIdType begin, vtkIdType end)
    { body(job, static_cast<size_t>(begin), static_cast<size_t>(end)); });
}

void Run::WriteTimes(vtkFieldData* out) const
{
  for (int s = 0; s < MLIM_STAGE_END; ++s)
  {
    if (this->InUse[s] || !out->HasArray(stage_arrays[s]))
    {
      vtkNew<vtkDoubleArray> array;
      array->SetName(stage_arrays[s]);
      array->InsertNextValue(this->Seconds[s]);
      out->AddArray(array);
    }
  }
}

bool IsLaterPiece(vtkInformationVector* outputs)
{
  vtkInformation* information = outputs->GetInformationObject(0);
  vtkInformationIntegerKey* piece = vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER();
  return information->Has(piece) && information->Get(piece) > 0;
}

}
