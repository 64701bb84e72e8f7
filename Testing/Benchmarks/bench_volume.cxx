// Volumes beside CGAL Mesh_3's: cells a second, and the shapes of the cells.
//
//   bench_volume [--data FOLDER] [--write FILE] [--quick]
//
// --write puts the tables between the marks of the file; --quick leaves out what takes minutes.
#include "cases.h"
#include "clock.h"
#include "mesh3_domain.h"
#include "report.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkMeshQuality.h"
#include "vtkNew.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

namespace
{

const char* const begin_mark = "<!-- volumes: begin -->\n";
const char* const end_mark = "<!-- volumes: end -->";

// Upper ends, in degrees, of the histogram's bins of the smallest dihedral angle.
const double bins[] = { 3, 5, 10, 15, 20, 30, 40, 90 };
const size_t bin_count = sizeof bins / sizeof *bins;

struct Arguments
{
  std::string Folder;
  std::string File;
  bool IsQuick = false;
};

struct Scene
{
  const char* Name;
  double FacetSize; // in the smallest spacing; 0: the default
  double CellSize;  // of FacetSize
  bool IsSlow;
};

// Facets and cells of one size. The scene's sizes give about 10,000 to 2,000,000 cells.
const Scene speed_scenes[] = { { "disjoint_balls", 3.8, 1, false },
  { "disjoint_balls", 2.2, 1, false }, { "disjoint_balls", 1.38, 1, false },
  { "disjoint_balls", 0.81, 1, true }, { "disjoint_balls", 0.64, 1, true } };

// Default options.
const Scene image_scenes[] = { { "spheres8_indicators", 0, 2, false },
  { "cleaver_spheres_indicators", 2.03, 2, false },
  { "polycrystal_damask20_indicators", 0, 2, false }, { "thalamus_prob", 0, 2, false },
  { "torso_ct_indicators", 0, 2, true }, { "brain_atlas_mni_prob", 0, 2, true } };

struct Quality
{
  double MinAngle = 180.0;
  double MeanAngle = 0.0;
  double MinRadiusRatio = 1.0; // inradius / circumradius, 1 for a regular tetrahedron
  std::vector<size_t> Histogram = std::vector<size_t>(bin_count, 0);
};

struct Figures
{
  size_t Cells = 0;
  double Seconds = 0.0;
  Quality Shapes;
};

vtkDataArray* Measure(vtkMeshQuality* filter, int measure)
{
  filter->SetTetQualityMeasure(measure);
  filter->Update();
  return filter->GetOutput()->GetCellData()->GetArray("Quality");
}

Quality MeasureCells(const double* points, size_t pointCount, const int32_t* cells, size_t count)
{
  vtkNew<vtkPoints> vtkpoints;
  vtkpoints->SetDataTypeToDouble();
  for (size_t p = 0; p < pointCount; ++p)
  {
    vtkpoints->InsertNextPoint(points + 3 * p);
  }
  vtkNew<vtkCellArray> array;
  for (size_t c = 0; c < count; ++c)
  {
    const int32_t* v = cells + 4 * c;
    array->InsertNextCell({ v[0], v[1], v[2], v[3] });
  }
  vtkNew<vtkUnstructuredGrid> grid;
  grid->SetPoints(vtkpoints);
  grid->SetCells(VTK_TETRA, array);
  vtkNew<vtkMeshQuality> filter;
  filter->SetInputData(grid);
  Quality out;
  vtkDataArray* angles = Measure(filter, VTK_QUALITY_MIN_ANGLE);
  for (size_t c = 0; c < count; ++c)
  {
    const double angle = angles->GetComponent(static_cast<vtkIdType>(c), 0);
    const size_t bin = static_cast<size_t>(std::upper_bound(bins, bins + bin_count, angle) - bins);
    out.MinAngle = std::min(out.MinAngle, angle);
    out.MeanAngle += angle / static_cast<double>(count);
    ++out.Histogram[std::min(bin, bin_count - 1)];
  }
  vtkDataArray* ratios = Measure(filter, VTK_QUALITY_RADIUS_RATIO);
  for (size_t c = 0; c < count; ++c)
  {
    // Verdict gives circumradius / (3 inradius).
    out.MinRadiusRatio =
      std::min(out.MinRadiusRatio, 1.0 / ratios->GetComponent(static_cast<vtkIdType>(c), 0));
  }
  return out;
}

void Throw(mlim_status status, const mlim_context& context)
{
  if (status != MLIM_OK)
  {
    throw std::runtime_error(context.message);
  }
}

Figures RunOurs(const mlim_field* field, const mlim_options& options)
{
  mlim_context context = {};
  mlim_curves curves = {};
  mlim_balls balls = {};
  mlim_mesh mesh = {};
  mlim_volume volume = {};
  Figures out;
  const double begin = bench_clock_user();
  Throw(mlim_curves_extract(field, &options, &context, &curves), context);
  Throw(mlim_balls_cover(&curves, &options, &context, &balls), context);
  Throw(mlim_volume_refine(field, &balls, &options, &context, &mesh, &volume), context);
  out.Seconds = bench_clock_user() - begin;
  out.Cells = volume.cell_count;
  out.Shapes = MeasureCells(volume.vertices, volume.vertex_count, volume.cells, volume.cell_count);
  mlim_volume_free(&volume);
  mlim_mesh_free(&mesh);
  mlim_balls_free(&balls);
  mlim_curves_free(&curves);
  return out;
}

Figures RunMesh3(const mlim_field* field, const mlim_options& options)
{
  // A radius-edge ratio of 1 is an angle of 30 degrees.
  const bench_mesh3_criteria criteria = { 30.0, options.facet_size, options.facet_distance, 0.0,
    0.0, options.cell_size, options.cell_radius_edge_ratio };
  const bench_mesh3_mesh cells =
    bench_mesh3(bench_mesh3_domain_of(field, nullptr, options.min_component_voxels), criteria);
  Figures out;
  out.Seconds = cells.UserSeconds;
  out.Cells = cells.Cells.size() / 4;
  out.Shapes =
    MeasureCells(cells.Points.data(), cells.Points.size() / 3, cells.Cells.data(), out.Cells);
  return out;
}

void Run(const Scene& scene, const Arguments& given, Figures* ours, Figures* theirs)
{
  char message[BENCH_MESSAGE_SIZE];
  bench_image image;
  if (bench_case_load(bench_case_find(scene.Name), given.Folder.c_str(), message, &image))
  {
    throw std::runtime_error(message);
  }
  mlim_context context = {};
  mlim_field* field = nullptr;
  Throw(mlim_field_create(&image.grid, &context, &field), context);
  mlim_options options = mlim_options_default(field);
  if (scene.FacetSize > 0)
  {
    options = mlim_options();
    options.facet_size =
      scene.FacetSize * *std::min_element(image.grid.spacing, image.grid.spacing + 3);
    options.facet_radius_edge_ratio = 1;
    options.ball_radius_scale = 1;
    options.junction_merge_tolerance = -1;
    options.vertex_limit = 20000000;
    options.min_component_voxels = 30;
    options.remove_slivers = 1;
    options.cell_size = scene.CellSize * options.facet_size;
    Throw(mlim_options_complete(field, &context, &options), context);
  }
  *ours = RunOurs(field, options);
  *theirs = RunMesh3(field, options);
  mlim_field_free(field);
  if (image.release)
  {
    image.release(image.owner);
  }
}

template <typename... Values>
std::string Format(const char* form, Values... values)
{
  char text[256];
  std::snprintf(text, sizeof text, form, values...);
  return text;
}

std::string SpeedRow(const Scene& scene, const Figures& a, const Figures& b)
{
  const double ours = static_cast<double>(a.Cells) / a.Seconds;
  const double theirs = static_cast<double>(b.Cells) / b.Seconds;
  return Format("| %s | %.2f | %zu | %.2f | %.0f | %zu | %.2f | %.0f | %.1f |\n", scene.Name,
    scene.FacetSize, a.Cells, a.Seconds, ours, b.Cells, b.Seconds, theirs, ours / theirs);
}

std::string ShapeRow(const Scene& scene, const char* mesher, const Figures& f)
{
  std::string row = Format("| %s | %s | %zu | %.2f | %.1f | %.1f | %.3f |", scene.Name, mesher,
    f.Cells, f.Seconds, f.Shapes.MinAngle, f.Shapes.MeanAngle, f.Shapes.MinRadiusRatio);
  for (size_t count : f.Shapes.Histogram)
  {
    row += Format(" %zu |", count);
  }
  return row + "\n";
}

std::string ShapeHeading()
{
  std::string heading = "| image | mesher | cells | seconds | smallest angle | mean smallest | "
                        "smallest radius ratio |";
  std::string rule = "|---|---|---:|---:|---:|---:|---:|";
  for (double bin : bins)
  {
    heading += Format(" < %.0f° |", bin);
    rule += "---:|";
  }
  return heading + "\n" + rule + "\n";
}

std::string Tables(const Arguments& given)
{
  std::string speed = "| scene | facet and cell size | our cells | our seconds | our cells/s | "
                      "Mesh_3 cells | Mesh_3 seconds | Mesh_3 cells/s | times as fast |\n"
                      "|---|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  std::string shapes = ShapeHeading();
  auto measure = [&](const Scene& scene, bool isSpeed)
  {
    if ((scene.IsSlow && given.IsQuick) || (!isSpeed && given.Folder.empty()))
    {
      return;
    }
    Figures ours;
    Figures theirs;
    Run(scene, given, &ours, &theirs);
    speed += isSpeed ? SpeedRow(scene, ours, theirs) : std::string();
    shapes += ShapeRow(scene, "ours", ours) + ShapeRow(scene, "Mesh_3", theirs);
    std::cerr << scene.Name << " " << ours.Cells << " cells\n";
  };
  for (const Scene& scene : speed_scenes)
  {
    measure(scene, true);
  }
  for (const Scene& scene : image_scenes)
  {
    measure(scene, false);
  }
  return "\nCells a second, sliver removal included:\n\n" + speed +
         "\nCells by their smallest dihedral angle, as vtkMeshQuality measures it; the radius "
         "ratio is "
         "three times inradius over circumradius:\n\n" +
         shapes + "\n";
}

Arguments Parse(int argc, char** argv)
{
  Arguments given;
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
      throw std::runtime_error(
        std::string("usage: ") + argv[0] + " [--data FOLDER] [--write FILE] [--quick]");
    }
  }
  return given;
}

}

int main(int argc, char** argv)
{
  try
  {
    const Arguments given = Parse(argc, argv);
    const std::string text = Tables(given);
    std::cout << text;
    return !given.File.empty() && bench_report_replace(given.File.c_str(), "volumes", text.c_str());
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
