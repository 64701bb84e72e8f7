#include "threads.h"

#include "vtkSMPTools.h"

void bench_threads_set(int count)
{
  vtkSMPTools::Initialize(count);
}

void bench_threads_for(void*, size_t count, mlim_body body, void* job)
{
  vtkSMPTools::For(0, static_cast<vtkIdType>(count),
    [body, job](vtkIdType begin, vtkIdType end)
    { body(job, static_cast<size_t>(begin), static_cast<size_t>(end)); });
}
