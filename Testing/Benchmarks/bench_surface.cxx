// Surfaces beside CGAL Mesh_3's: seconds and vertices, and the targets of the product.
//
//   bench_surface [--data FOLDER] [--runs N] [--write FILE] [--quick] [NAME ...]
//
// Without names all scenes and images; --quick leaves out the largest meshes. --write puts the tables
// between the marks of the file.
#include "surface_tables.h"

#include "report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iostream>
#include <stdexcept>

namespace
{

// Facet sizes that give about the sizes of the targets, of 10,000 to 500,000 vertices for a scene and
// 36,000 to 500,000 for an image, as far as there are such meshes of the image.
const bench_surface_row rows[] = {
  { "disjoint_balls", 10000, 1.25 },
  { "disjoint_balls", 50000, 0.56 },
  { "disjoint_balls", 200000, 0.28 },
  { "disjoint_balls", 500000, 0.176 },
  { "overlapping_spheres", 10000, 1.6 },
  { "overlapping_spheres", 50000, 0.71 },
  { "overlapping_spheres", 200000, 0.36 },
  { "overlapping_spheres", 500000, 0.217 },
  { "grains", 10000, 2.1 },
  { "grains", 50000, 0.74 },
  { "grains", 200000, 0.34 },
  { "grains", 500000, 0.22 },
  { "brain_atlas_mni_prob", 36000, 6.2 },
  { "brain_atlas_mni_prob", 100000, 2.4 },
  { "brain_atlas_mni_prob", 210000, 1.32 },
  { "brain_atlas_mni_prob", 500000, 0.84 },
  { "soft_brain_ants19_prob", 36000, 21.0 },
  { "soft_brain_ants19_prob", 100000, 4.6 },
  { "soft_brain_ants19_prob", 210000, 2.15 },
  { "soft_brain_ants19_prob", 500000, 1.37 },
};

// Larger meshes take long enough to be measured once.
const int most_for_repeats = 100000;
// What --quick leaves out.
const int least_for_slow = 500000;
// Threads are compared on these.
const int threads_from = 200000;
const int threads_to = 210000;
// A wall clock counts what else the machine does: the least of some runs.
const int threads_runs = 3;
// Numbers of vertices that differ less than this part are the same size.
const double same_part = 0.1;
const int scale_tries = 4;
const unsigned max_seconds = 600;

struct Arguments
{
  std::string Folder;
  std::string File;
  int Runs = 3;
  bool IsQuick = false;
  std::vector<std::string> Names;
};

Arguments Parse(int argc, char** argv)
{
  Arguments given;
  const char* folder = std::getenv("MLIM_DATA");
  given.Folder = folder == nullptr ? "" : folder;
  for (int k = 1; k < argc; ++k)
  {
    const std::string word = argv[k];
    const bool hasValue = k + 1 < argc;
    if (word == "--quick")
    {
      given.IsQuick = true;
    }
    else if (word == "--data" && hasValue)
    {
      given.Folder = argv[++k];
    }
    else if (word == "--write" && hasValue)
    {
      given.File = argv[++k];
    }
    else if (word == "--runs" && hasValue && std::atoi(argv[k + 1]) > 0)
    {
      given.Runs = std::atoi(argv[++k]);
    }
    else if (bench_case_find(argv[k]) != nullptr)
    {
      given.Names.push_back(word);
    }
    else
    {
      throw std::runtime_error("usage: bench_surface [--data FOLDER] [--runs N] [--write FILE] "
                               "[--quick] [NAME ...]");
    }
  }
  return given;
}

bool IsWanted(const bench_surface_row& row, const Arguments& given)
{
  const bool isNamed = given.Names.empty() || std::find(given.Names.begin(), given.Names.end(),
                                                row.Scene) != given.Names.end();
  const bool isThere = bench_case_find(row.Scene)->scene != nullptr || !given.Folder.empty();
  return isNamed && isThere && !(given.IsQuick && row.Aim >= least_for_slow);
}

void TakeLess(double* best, double value, bool isFirst)
{
  *best = isFirst ? value : std::min(*best, value);
}

void Add(const bench_surface_figures& figures, bool isFirst, bench_surface_figures* best)
{
  if (isFirst || figures.HasFailed)
  {
    *best = figures;
    return;
  }
  TakeLess(&best->UserSeconds, figures.UserSeconds, false);
  TakeLess(&best->WallSeconds, figures.WallSeconds, false);
}

void Log(const bench_surface_row& row, const char* who, size_t vertices, double user, double wall,
  const char* message)
{
  std::fprintf(stderr, "%s %d: %s %zu vertices, %.2f s, wall clock %.2f s %s\n", row.Scene, row.Aim,
    who, vertices, user, wall, message);
}

class Measurement
{
public:
  Measurement(const bench_surface_row& row, const char* folder) : Folder(folder)
  {
    this->Result.Row = row;
    this->Demand.Ours.one = bench_case_find(row.Scene);
    this->Demand.Ours.facet_size = row.FacetSize;
    this->Demand.Ours.has_bounds_only = 1;
    this->Demand.SizeScale = 1.0;
    this->Demand.MaxSeconds = max_seconds;
  }

  // One run of each mesher, in turn.
  void Round()
  {
    const bool isFirst = this->Rounds++ == 0;
    const bench_figures ours = this->RunOurs(0);
    bench_result_add(&this->Result.Ours, &ours);
    this->Result.Ours.one = this->Demand.Ours.one;
    if (this->Result.Row.Aim >= threads_from && this->Result.Row.Aim <= threads_to)
    {
      for (int k = 0; k < threads_runs; ++k)
      {
        TakeLess(&this->Result.OurWall[0], this->RunOurs(1).total_wall, isFirst && k == 0);
        TakeLess(&this->Result.OurWall[1], this->RunOurs(2).total_wall, isFirst && k == 0);
      }
    }
    if (isFirst)
    {
      this->MatchVertices();
    }
    else
    {
      Add(this->RunTheirs(bench_mesher::OneThread), false, &this->Result.OneThread);
    }
    Add(this->RunTheirs(bench_mesher::Sequential), isFirst, &this->Result.Sequential);
    Add(this->RunTheirs(bench_mesher::TwoThreads), isFirst, &this->Result.TwoThreads);
  }

  bench_surface_result Result = {};

private:
  bench_figures RunOurs(int threads)
  {
    bench_figures figures;
    this->Demand.Ours.thread_count = threads;
    bench_measure(&this->Demand.Ours, this->Folder, &figures);
    this->Demand.Ours.thread_count = 0;
    Log(this->Result.Row, "ours", figures.vertex_count, figures.total_user, figures.total_wall,
      figures.message);
    return figures;
  }

  bench_surface_figures RunTheirs(bench_mesher mesher)
  {
    const bench_surface_figures figures = bench_surface_run(this->Demand, mesher, this->Folder);
    Log(this->Result.Row, "Mesh_3", figures.Vertices, figures.UserSeconds, figures.WallSeconds,
      figures.Message);
    return figures;
  }

  // The same bounds first; where they do not give as many vertices as ours, all bounds of Mesh_3 are
  // scaled until they do.
  void MatchVertices()
  {
    const double ours = static_cast<double>(this->Result.Ours.best.vertex_count);
    for (int t = 0; t < scale_tries; ++t)
    {
      this->Result.OneThread = this->RunTheirs(bench_mesher::OneThread);
      if (t == 0)
      {
        this->Result.SameBounds = this->Result.OneThread;
      }
      const double theirs = static_cast<double>(this->Result.OneThread.Vertices);
      this->Result.SizeScale = this->Demand.SizeScale;
      if (this->Result.OneThread.HasFailed || std::fabs(ours / theirs - 1.0) < same_part)
      {
        return;
      }
      // The number goes with the square of the size, less where topology asks for vertices.
      this->Demand.SizeScale *= std::pow(theirs / ours, t == 0 ? 0.5 : 0.75);
    }
  }

  bench_surface_demand Demand = {};
  const char* Folder;
  int Rounds = 0;
};

std::vector<bench_surface_result> MeasureAll(const Arguments& given)
{
  std::vector<Measurement> all;
  for (const bench_surface_row& row : rows)
  {
    if (IsWanted(row, given))
    {
      all.emplace_back(row, given.Folder.c_str());
    }
  }
  for (int round = 0; round < given.Runs; ++round)
  {
    for (Measurement& one : all)
    {
      if (round == 0 || one.Result.Row.Aim < most_for_repeats)
      {
        one.Round();
      }
    }
  }
  std::vector<bench_surface_result> out;
  for (const Measurement& one : all)
  {
    out.push_back(one.Result);
  }
  return out;
}

std::string Describe(const Arguments& given)
{
  std::string text = "bench_surface";
  text += given.Folder.empty() ? "" : " --data $MLIM_DATA";
  text += " --runs " + std::to_string(given.Runs);
  text += given.IsQuick ? " --quick" : "";
  for (const std::string& name : given.Names)
  {
    text += " " + name;
  }
  return text;
}

int Publish(const Arguments& given, const std::vector<bench_surface_result>& results)
{
  char* text = nullptr;
  size_t size = 0;
  FILE* memory = open_memstream(&text, &size);
  if (memory == nullptr)
  {
    throw std::runtime_error("There is not enough memory for the tables.");
  }
  bench_report_machine(Describe(given).c_str(), 2, memory);
  bench_surface_write(results, memory);
  std::fclose(memory);
  std::fputs(text, stdout);
  const int hasFailed =
    !given.File.empty() && bench_report_replace(given.File.c_str(), "surfaces", text);
  std::free(text);
  return hasFailed;
}

}

int main(int argc, char** argv)
{
  try
  {
    const Arguments given = Parse(argc, argv);
    return Publish(given, MeasureAll(given));
  }
  catch (const std::exception& error)
  {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
