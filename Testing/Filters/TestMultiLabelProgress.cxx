// Progress never falls, an abort at any moment gives an empty typed output without an error, and the
// filter runs again exactly when something has changed.
#include "MultiLabelTest.h"

#include "vtkDataArraySelection.h"
#include "vtkFieldData.h"
#include "vtkMultiLabelCurveExtractor.h"
#include "vtkMultiLabelCurveProtector.h"

#include <algorithm>
#include <set>

using namespace test;

namespace
{

// Counts progress events, and aborts at one of them.
struct Watch
{
  explicit Watch(vtkAlgorithm* algorithm)
  {
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(this);
    command->SetCallback(
      [](vtkObject* caller, unsigned long event, void* self, void*)
      {
        auto* watch = static_cast<Watch*>(self);
        auto* source = static_cast<vtkAlgorithm*>(caller);
        if (event == vtkCommand::StartEvent)
        {
          ++watch->StartCount;
          return;
        }
        watch->Fractions.push_back(source->GetProgress());
        watch->Texts.insert(source->GetProgressText() ? source->GetProgressText() : "");
        // The executive's last event comes when the output is there already.
        if (static_cast<int>(watch->Fractions.size()) == watch->AbortAt &&
            source->GetProgress() < 1.0)
        {
          source->SetAbortExecute(1);
        }
      });
    algorithm->AddObserver(vtkCommand::ProgressEvent, command);
    algorithm->AddObserver(vtkCommand::StartEvent, command);
  }

  int AbortAt = 0;
  int StartCount = 0;
  std::vector<double> Fractions;
  std::set<std::string> Texts;
};

void CheckProgress()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(MakeImage());
  Watch watch(mesher);
  mesher->Update();
  CHECK(std::is_sorted(watch.Fractions.begin(), watch.Fractions.end()), "monotone");
  CHECK(watch.Fractions.size() >= 6, "at least one event a stage");
  CHECK(!watch.Fractions.empty() && watch.Fractions.back() == 1.0, "");
  CHECK(watch.Texts.count("Refining the interface") == 1, "the stage's name");
  CHECK(watch.Texts.count("Extracting curves") == 1, "the stage's name");

  vtkNew<vtkMultiLabelCurveExtractor> extractor;
  extractor->SetInputData(MakeImage());
  Watch stage(extractor);
  extractor->Update();
  CHECK(std::is_sorted(stage.Fractions.begin(), stage.Fractions.end()), "monotone");
  CHECK(stage.Texts.count("Refining the interface") == 0, "the extractor refines nothing");
}

void CheckAbort()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(MakeImage());
  Watch watch(mesher);
  mesher->Update();
  // The first event is the executive's, before the filter; the last one after it.
  const int count = static_cast<int>(watch.Fractions.size());
  const vtkIdType whole = mesher->GetOutput()->GetNumberOfPolys();
  Messages messages(mesher);
  int abortCount = 0;
  for (int at = 2; at < count; ++at)
  {
    watch.Fractions.clear();
    watch.AbortAt = at;
    mesher->SetAbortExecute(0);
    mesher->Modified();
    mesher->Update();
    if (static_cast<int>(watch.Fractions.size()) >= at && mesher->GetAbortExecute())
    {
      ++abortCount;
      CHECK(IsAbortedOutput(mesher->GetOutput()), "abort at event " + std::to_string(at));
    }
  }
  CHECK(abortCount >= std::min(count - 2, 4), "some of the runs were aborted");
  CHECK(messages.Errors.empty() && messages.ExecutiveErrors.empty(), messages.Errors);
  watch.AbortAt = 0;
  mesher->SetAbortExecute(0);
  mesher->Modified();
  mesher->Update();
  CHECK(mesher->GetOutput()->GetNumberOfPolys() == whole, "the next run is whole again");
}

void CheckModified()
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(MakeImage());
  Watch watch(mesher);
  mesher->Update();
  mesher->Update();
  CHECK(watch.StartCount == 1, "nothing has changed");
  const vtkMTimeType before = mesher->GetMTime();
  mesher->GetPointArraySelection()->EnableArray("000_Background");
  mesher->GetPointArraySelection()->EnableArray("first");
  CHECK(mesher->GetMTime() > before, "the selection counts");
  mesher->Update();
  CHECK(watch.StartCount == 2, "");
  mesher->SetFacetSize(mesher->GetFacetSize());
  mesher->Update();
  CHECK(watch.StartCount == 2, "the same value");
  mesher->SetFacetSize(1.7);
  mesher->Update();
  CHECK(watch.StartCount == 3, "");
}

}

int TestMultiLabelProgress(int, char*[])
{
  CheckProgress();
  CheckAbort();
  CheckModified();
  return Result();
}
