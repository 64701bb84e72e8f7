#include "pqMultiLabelAbort.h"

#include "pqApplicationCore.h"
#include "pqPipelineSource.h"
#include "pqProgressManager.h"
#include "pqServerManagerModel.h"

#include "vtkAlgorithm.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkSMProxy.h"

#include <QApplication>
#include <QEvent>
#include <QTimer>

#include <cstring>
#include <functional>

namespace
{

// So long a click may wait at most; reading events more often would cost the filter time.
const qint64 reading_interval = 100; // milliseconds

// As ParaView calls it.
const char* const abort_button = "AbortButton";

// nullptr: it runs in another process.
vtkAlgorithm* AlgorithmOf(pqPipelineSource* source)
{
  return source ? vtkAlgorithm::SafeDownCast(source->getProxy()->GetClientSideObject()) : nullptr;
}

bool IsOurs(vtkAlgorithm* algorithm)
{
  const char prefix[] = "vtkMultiLabel";
  return std::strncmp(algorithm->GetClassName(), prefix, sizeof prefix - 1) == 0;
}

// Calls a function with each event of one kind.
class Listener : public vtkCommand
{
public:
  static Listener* New() { return new Listener; }
  void Execute(vtkObject*, unsigned long, void*) override { this->Call(); }
  std::function<void()> Call;
};

}

void pqMultiLabelAbort::Install()
{
  // The plugin may be loaded before ParaView has made what this class needs.
  if (qobject_cast<QApplication*>(QCoreApplication::instance()))
  {
    QTimer::singleShot(0, qApp,
      []()
      {
        if (pqApplicationCore* core = pqApplicationCore::instance())
        {
          new pqMultiLabelAbort(core);
        }
      });
  }
}

pqMultiLabelAbort::pqMultiLabelAbort(QObject* parent) : QObject(parent)
{
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  pqProgressManager* progress = pqApplicationCore::instance()->getProgressManager();
  QObject::connect(model, &pqServerManagerModel::sourceAdded, this, &pqMultiLabelAbort::Watch);
  QObject::connect(progress, &pqProgressManager::abort, this, &pqMultiLabelAbort::OnClick);
  QObject::connect(
    progress, &pqProgressManager::progressEndEvent, this, &pqMultiLabelAbort::OnUpdateEnd);
  for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
  {
    this->Watch(source);
  }
}

void pqMultiLabelAbort::Watch(pqPipelineSource* source)
{
  vtkAlgorithm* algorithm = AlgorithmOf(source);
  if (!algorithm || !IsOurs(algorithm))
  {
    return;
  }
  this->Listen(algorithm, vtkCommand::StartEvent, source, &pqMultiLabelAbort::OnStart);
  this->Listen(algorithm, vtkCommand::EndEvent, source, &pqMultiLabelAbort::OnEnd);
  this->Listen(algorithm, vtkCommand::ProgressEvent, source, &pqMultiLabelAbort::OnProgress);
  this->Listen(algorithm, vtkCommand::ModifiedEvent, source, &pqMultiLabelAbort::OnModified);
  QObject::connect(source, &pqPipelineSource::modifiedStateChanged, this,
    [this, source]() { this->OnStateChanged(source); });
}

void pqMultiLabelAbort::Listen(vtkAlgorithm* algorithm, unsigned long event,
  pqPipelineSource* source, void (pqMultiLabelAbort::*call)(pqPipelineSource*))
{
  vtkNew<Listener> listener;
  const QPointer<pqMultiLabelAbort> self(this);
  const QPointer<pqPipelineSource> guarded(source);
  listener->Call = [self, guarded, call]()
  {
    if (self && guarded)
    {
      (self->*call)(guarded);
    }
  };
  algorithm->AddObserver(event, listener);
}

void pqMultiLabelAbort::OnStart(pqPipelineSource* source)
{
  this->Executing = source;
}

void pqMultiLabelAbort::OnEnd(pqPipelineSource*)
{
  this->Executing = nullptr;
}

void pqMultiLabelAbort::OnProgress(pqPipelineSource* source)
{
  if (this->IsReading ||
      (this->LastReading.isValid() && !this->LastReading.hasExpired(reading_interval)))
  {
    return;
  }
  this->Running = source;
  this->IsReading = true;
  pqProgressManager* progress = pqApplicationCore::instance()->getProgressManager();
  progress->setEnableAbort(true);
  // ParaView stops all clicks at the window, those on the button as well.
  const bool wasUnblocked = progress->unblockEvents(true);
  qApp->installEventFilter(this);
  QApplication::processEvents();
  qApp->removeEventFilter(this);
  progress->unblockEvents(wasUnblocked);
  this->IsReading = false;
  this->LastReading.start();
}

bool pqMultiLabelAbort::eventFilter(QObject* object, QEvent* event)
{
  switch (event->type())
  {
    case QEvent::Close:
      event->ignore();
      return true;
    case QEvent::DragEnter:
    case QEvent::Drop:
    case QEvent::Shortcut:
    case QEvent::ShortcutOverride:
      return true;
    case QEvent::ContextMenu:
    case QEvent::KeyPress:
    case QEvent::KeyRelease:
    case QEvent::MouseButtonDblClick:
    case QEvent::MouseButtonPress:
    case QEvent::MouseButtonRelease:
    case QEvent::Wheel:
      // A window hands them on to its widgets.
      return object->isWidgetType() && object->objectName() != abort_button;
    default:
      return this->QObject::eventFilter(object, event);
  }
}

void pqMultiLabelAbort::OnClick()
{
  if (vtkAlgorithm* algorithm = AlgorithmOf(this->Running))
  {
    this->Aborted = this->Running;
    this->IsSettled = false;
    algorithm->SetAbortExecuteAndUpdateTime();
  }
}

void pqMultiLabelAbort::OnUpdateEnd()
{
  if (!this->Running)
  {
    return;
  }
  pqApplicationCore::instance()->getProgressManager()->setEnableAbort(false);
  this->Running = nullptr;
  this->SettleLater();
}

void pqMultiLabelAbort::SettleLater()
{
  // Not before all that belongs to this Apply is over; a source that is shown for the first time is
  // unmodified at the end only. Until then, and as long as nothing changes, the flag stays, so that
  // whatever asks for the output gets the empty one and no new run.
  QTimer::singleShot(0, this,
    [this]()
    {
      if (this->Aborted && !this->IsSettled && !this->Running &&
          this->Aborted->modifiedState() == pqProxy::UNMODIFIED)
      {
        this->IsSettled = true;
        this->Aborted->setModifiedState(pqProxy::MODIFIED); // lets the user apply again
      }
    });
}

void pqMultiLabelAbort::OnStateChanged(pqPipelineSource* source)
{
  if (source != this->Aborted || source->modifiedState() != pqProxy::UNMODIFIED)
  {
    return;
  }
  if (this->IsSettled)
  {
    // For the filter and for those who show it.
    AlgorithmOf(source)->Modified();
    source->getProxy()->MarkModified(source->getProxy());
  }
  else
  {
    this->SettleLater();
  }
}

void pqMultiLabelAbort::OnModified(pqPipelineSource* source)
{
  // While it executes, VTK itself modifies an aborted filter.
  if (source == this->Aborted && source != this->Executing)
  {
    this->Aborted = nullptr;
    this->IsSettled = false;
    AlgorithmOf(source)->SetAbortExecute(0);
  }
}
