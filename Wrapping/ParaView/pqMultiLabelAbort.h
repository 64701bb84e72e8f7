/**
 * The button beside ParaView's progress bar, for the filters of this plugin.
 *
 * ParaView 5.11 shows the button, but enables it for animations only, reads no clicks while a filter
 * runs, and tells no filter of them. While one of our filters runs in the built-in server this class
 * does all three. Of a filter in another process it knows nothing. Later versions of ParaView need no
 * such class.
 */
#ifndef pqMultiLabelAbort_h
#define pqMultiLabelAbort_h

#include <QElapsedTimer>
#include <QObject>
#include <QPointer>

class pqPipelineSource;
class vtkAlgorithm;

class pqMultiLabelAbort : public QObject
{
public:
  /** Called as the plugin is loaded: makes one of it, if this process has a user interface. */
  static void Install();

protected:
  /** While a filter runs: no event that could change the pipeline or end the program. */
  bool eventFilter(QObject* object, QEvent* event) override;

private:
  explicit pqMultiLabelAbort(QObject* parent);

  void Watch(pqPipelineSource* source);
  /** Calls the method, as long as there is this object and the source, with each event. */
  void Listen(vtkAlgorithm* algorithm, unsigned long event, pqPipelineSource* source,
    void (pqMultiLabelAbort::*call)(pqPipelineSource*));

  void OnStart(pqPipelineSource* source);
  void OnProgress(pqPipelineSource* source);
  void OnEnd(pqPipelineSource* source);
  void OnClick();
  void OnUpdateEnd();
  void SettleLater();
  /** Apply again, or a change by a script: the filter may run again. */
  void OnStateChanged(pqPipelineSource* source);
  void OnModified(pqPipelineSource* source);

  QPointer<pqPipelineSource> Executing;
  QPointer<pqPipelineSource> Running; // since the update of the pipeline began
  QPointer<pqPipelineSource> Aborted; // its last run was
  bool IsSettled = false;             // the Apply that was aborted is over
  bool IsReading = false;             // the user's events
  QElapsedTimer LastReading;
};

#endif
