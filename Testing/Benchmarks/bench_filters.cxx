// VTK's own filters for label maps beside ours, all as filters, on one thread.
//
//   bench_filters --data FOLDER [--write FILE] [--quick]
//
// Ours comes first with its default options; what VTK's make is brought to as many triangles.
#include "clock.h"
#include "process.h"
#include "report.h"
#include "table.h"
#include "threads.h"

#include "vtkMultiLabelInterfaceMesher.h"

#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkDataArray.h"
#include "vtkDiscreteFlyingEdges3D.h"
#include "vtkImageData.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkQuadricDecimation.h"
#include "vtkSmartPointer.h"
#include "vtkWindowedSincPolyDataFilter.h"
#include "vtkXMLImageDataReader.h"

#if __has_include("vtkSurfaceNets3D.h")
#include "vtkSurfaceNets3D.h"
#define BENCH_HAS_SURFACE_NETS
#endif

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

struct Scene
{
  const char* Name;
  double FacetSize; // in spacings; 0: the default
  bool IsSlow;
};

// The last one is no label map: VTK's filters have nothing to say to it.
const Scene scenes[] = { { "torso_ct_labels", 0, false },
  { "polycrystal_damask20_labels", 0, false }, { "brain_atlas_mni_thr25_labels", 0, false },
  { "brain_aal116_labels", 0, true }, { "brain_atlas_mni_prob", 7.3, false } };

enum class Maker
{
  Ours,
  FlyingEdges,
  SurfaceNets
};

struct Arguments
{
  std::string Folder;
  std::string File;
  bool IsQuick = false;
};

struct Job
{
  const Scene* Of;
  Maker Who;
  size_t Triangles; // to be left; 0: all
  const char* Folder;
};

struct Figures
{
  bool HasFailed;
  char Message[BENCH_MESSAGE_SIZE];
  size_t Points;
  size_t Made; // triangles before the decimation
  size_t Triangles;
  double Seconds[3]; // making, smoothing, decimation
  double MinAngle;   // degrees
  double SharpPart;  // of triangles with an angle below 15 degrees
};

const double sharp_angle = 15.0;

double SmallestAngle(const double corners[3][3])
{
  double smallest = 180.0;
  for (int k = 0; k < 3; ++k)
  {
    double a[3];
    double b[3];
    vtkMath::Subtract(corners[(k + 1) % 3], corners[k], a);
    vtkMath::Subtract(corners[(k + 2) % 3], corners[k], b);
    smallest = std::min(smallest, vtkMath::DegreesFromRadians(vtkMath::AngleBetweenVectors(a, b)));
  }
  return smallest;
}

void Measure(vtkPolyData* mesh, Figures* out)
{
  out->Points = static_cast<size_t>(mesh->GetNumberOfPoints());
  out->MinAngle = 180.0;
  size_t sharp = 0;
  auto polygons = vtk::TakeSmartPointer(mesh->GetPolys()->NewIterator());
  for (polygons->GoToFirstCell(); !polygons->IsDoneWithTraversal(); polygons->GoToNextCell())
  {
    vtkIdType count;
    const vtkIdType* points;
    polygons->GetCurrentCell(count, points);
    double corners[3][3];
    for (int k = 0; k < 3; ++k)
    {
      mesh->GetPoint(points[k], corners[k]);
    }
    const double angle = SmallestAngle(corners);
    out->MinAngle = std::min(out->MinAngle, angle);
    sharp += angle < sharp_angle;
    ++out->Triangles;
  }
  out->SharpPart = static_cast<double>(sharp) / static_cast<double>(out->Triangles);
}

vtkSmartPointer<vtkImageData> Read(const Job& job)
{
  const std::string path = std::string(job.Folder) + "/" + job.Of->Name + ".vti";
  vtkNew<vtkXMLImageDataReader> reader;
  if (!reader->CanReadFile(path.c_str()))
  {
    throw std::runtime_error("The file " + path + " is missing or is not an image.");
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkSmartPointer<vtkImageData> image = reader->GetOutput();
  vtkPointData* arrays = image->GetPointData();
  arrays->SetActiveScalars(arrays->GetArrayName(0));
  return image;
}

// All but the background.
std::vector<int> LabelsOf(vtkImageData* image)
{
  vtkDataArray* scalars = image->GetPointData()->GetScalars();
  std::set<int> labels;
  for (vtkIdType p = 0; p < scalars->GetNumberOfTuples(); ++p)
  {
    labels.insert(static_cast<int>(scalars->GetComponent(p, 0)));
  }
  labels.erase(0);
  return std::vector<int>(labels.begin(), labels.end());
}

template <typename Filter>
double Update(Filter* filter)
{
  const double begin = bench_clock_user();
  filter->Update();
  return bench_clock_user() - begin;
}

void RunOurs(vtkImageData* image, const Job& job, Figures* out)
{
  vtkNew<vtkMultiLabelInterfaceMesher> mesher;
  mesher->SetInputData(image);
  if (job.Of->FacetSize > 0)
  {
    mesher->SetFacetSize(
      job.Of->FacetSize * *std::min_element(image->GetSpacing(), image->GetSpacing() + 3));
  }
  out->Seconds[0] = Update(mesher.Get());
  vtkPolyData* mesh = vtkPolyData::SafeDownCast(mesher->GetOutputDataObject(0));
  if (mesh == nullptr || mesh->GetNumberOfPolys() == 0)
  {
    throw std::runtime_error("There is no mesh.");
  }
  out->Made = static_cast<size_t>(mesh->GetNumberOfPolys());
  Measure(mesh, out);
}

// Smoothing with the settings of VTK's examples for medical label maps.
void Finish(vtkPolyData* made, const Job& job, Figures* out)
{
  vtkNew<vtkWindowedSincPolyDataFilter> smoother;
  smoother->SetInputData(made);
  smoother->SetNumberOfIterations(15);
  smoother->SetPassBand(0.001);
  smoother->BoundarySmoothingOff();
  smoother->FeatureEdgeSmoothingOff();
  smoother->NonManifoldSmoothingOn();
  smoother->NormalizeCoordinatesOn();
  out->Seconds[1] = Update(smoother.Get());
  vtkPolyData* mesh = smoother->GetOutput();
  vtkNew<vtkQuadricDecimation> decimation;
  if (job.Triangles > 0 && job.Triangles < out->Made)
  {
    decimation->SetInputData(mesh);
    decimation->SetTargetReduction(
      1.0 - static_cast<double>(job.Triangles) / static_cast<double>(out->Made));
    out->Seconds[2] = Update(decimation.Get());
    mesh = decimation->GetOutput();
  }
  Measure(mesh, out);
}

template <typename Filter>
void RunLabels(Filter* filter, vtkImageData* image, const Job& job, Figures* out)
{
  const std::vector<int> labels = LabelsOf(image);
  filter->SetInputData(image);
  for (size_t l = 0; l < labels.size(); ++l)
  {
    filter->SetValue(static_cast<int>(l), labels[l]);
  }
  out->Seconds[0] = Update(filter);
  out->Made = static_cast<size_t>(filter->GetOutput()->GetNumberOfPolys());
  Finish(filter->GetOutput(), job, out);
}

void RunFlyingEdges(vtkImageData* image, const Job& job, Figures* out)
{
  vtkNew<vtkDiscreteFlyingEdges3D> filter;
  filter->ComputeNormalsOff();
  filter->ComputeGradientsOff();
  RunLabels(filter.Get(), image, job, out);
}

#ifdef BENCH_HAS_SURFACE_NETS
void RunSurfaceNets(vtkImageData* image, const Job& job, Figures* out)
{
  vtkNew<vtkSurfaceNets3D> filter;
  filter->SmoothingOff();
  filter->SetOutputMeshTypeToTriangles();
  RunLabels(filter.Get(), image, job, out);
}
#else
void RunSurfaceNets(vtkImageData*, const Job&, Figures*)
{
  throw std::runtime_error("This VTK has no vtkSurfaceNets3D.");
}
#endif

void Work(const void* given, void* result)
{
  const Job& job = *static_cast<const Job*>(given);
  Figures* out = static_cast<Figures*>(result);
  *out = {};
  try
  {
    bench_threads_set(1);
    const auto image = Read(job);
    switch (job.Who)
    {
      case Maker::Ours:
        RunOurs(image, job, out);
        break;
      case Maker::FlyingEdges:
        RunFlyingEdges(image, job, out);
        break;
      case Maker::SurfaceNets:
        RunSurfaceNets(image, job, out);
        break;
    }
  }
  catch (const std::exception& error)
  {
    out->HasFailed = true;
    std::snprintf(out->Message, sizeof out->Message, "%s", error.what());
  }
}

Figures Run(const Job& job)
{
  Figures out = {};
  if (bench_process_run(&Work, &job, 0, sizeof out, &out, out.Message))
  {
    out.HasFailed = true;
  }
  std::fprintf(stderr, "%s: %zu triangles, %.2f s %s\n", job.Of->Name, out.Triangles,
    out.Seconds[0] + out.Seconds[1] + out.Seconds[2], out.Message);
  return out;
}

void AddRow(const Scene& scene, const char* who, const Figures& f, bench_table* table)
{
  if (f.HasFailed)
  {
    return;
  }
  size_t column = 0;
  bench_table_row(table);
  bench_table_cell(table, &column, "%s", scene.Name);
  bench_table_cell(table, &column, "%s", who);
  bench_table_cell(table, &column, "%zu", f.Made);
  bench_table_cell(table, &column, "%zu", f.Triangles);
  bench_table_cell(table, &column, "%zu", f.Points);
  for (double seconds : f.Seconds)
  {
    bench_table_cell(table, &column, "%.2f", seconds);
  }
  bench_table_cell(table, &column, "%.2f", f.Seconds[0] + f.Seconds[1] + f.Seconds[2]);
  bench_table_cell(table, &column, "%.2f", f.MinAngle);
  bench_table_cell(table, &column, "%.2f %%", 100 * f.SharpPart);
}

void MeasureScene(const Scene& scene, const char* folder, bench_table* table)
{
  const Figures ours = Run({ &scene, Maker::Ours, 0, folder });
  AddRow(scene, "ours", ours, table);
  if (scene.FacetSize > 0)
  {
    return;
  }
  for (const size_t triangles : { static_cast<size_t>(0), ours.Triangles })
  {
    AddRow(scene, "discrete flying edges", Run({ &scene, Maker::FlyingEdges, triangles, folder }),
      table);
#ifdef BENCH_HAS_SURFACE_NETS
    AddRow(scene, "surface nets", Run({ &scene, Maker::SurfaceNets, triangles, folder }), table);
#endif
  }
}

Arguments Parse(int argc, char** argv)
{
  Arguments given;
  const char* folder = std::getenv("MLIM_DATA");
  given.Folder = folder == nullptr ? "" : folder;
  bool isUnderstood = true;
  for (int k = 1; k < argc; ++k)
  {
    const std::string word = argv[k];
    if (word == "--quick")
    {
      given.IsQuick = true;
    }
    else if (word == "--data" && k + 1 < argc)
    {
      given.Folder = argv[++k];
    }
    else if (word == "--write" && k + 1 < argc)
    {
      given.File = argv[++k];
    }
    else
    {
      isUnderstood = false;
    }
  }
  if (!isUnderstood || given.Folder.empty())
  {
    throw std::runtime_error("usage: bench_filters --data FOLDER [--write FILE] [--quick]");
  }
  return given;
}

int Publish(const Arguments& given, const bench_table* table)
{
  char* text = nullptr;
  size_t size = 0;
  FILE* memory = open_memstream(&text, &size);
  if (memory == nullptr)
  {
    throw std::runtime_error("There is not enough memory for the table.");
  }
  bench_report_machine(
    given.IsQuick ? "bench_filters --data $MLIM_DATA --quick" : "bench_filters --data $MLIM_DATA",
    1, memory);
  bench_table_write(table, memory);
  std::fputc('\n', memory);
#ifndef BENCH_HAS_SURFACE_NETS
  std::fputs("This VTK has no vtkSurfaceNets3D, which is left out.\n\n", memory);
#endif
  std::fclose(memory);
  std::fputs(text, stdout);
  const int hasFailed =
    !given.File.empty() && bench_report_replace(given.File.c_str(), "filters", text);
  std::free(text);
  return hasFailed;
}

}

int main(int argc, char** argv)
{
  try
  {
    const Arguments given = Parse(argc, argv);
    const auto table = std::make_unique<bench_table>();
    size_t column = 0;
    bench_table_row(table.get());
    for (const char* heading : { "image", "filter", "made", "triangles", "points", "making s",
           "smoothing s", "decimation s", "all s", "smallest angle", "below 15°" })
    {
      bench_table_cell(table.get(), &column, "%s", heading);
    }
    for (const Scene& scene : scenes)
    {
      if (!(scene.IsSlow && given.IsQuick))
      {
        MeasureScene(scene, given.Folder.c_str(), table.get());
      }
    }
    return Publish(given, table.get());
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
