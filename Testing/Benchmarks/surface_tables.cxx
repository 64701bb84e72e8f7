#include "surface_tables.h"

#include "table.h"

#include <algorithm>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <string>

namespace
{

using Results = std::vector<bench_surface_result>;

// How many times as fast as Mesh_3 a surface of so many vertices has to be; the last that is not
// larger counts.
struct SpeedTarget
{
  int Vertices;
  double Must;
  double Aim;
};
const SpeedTarget speed_targets[] = { { 10000, 2.5, 4 }, { 50000, 4, 6 }, { 200000, 5, 8 },
  { 500000, 6, 10 } };

const double kilobyte = 1024.0;

const SpeedTarget& TargetOf(const bench_surface_result& r)
{
  // The sizes are matched to a tenth.
  const double vertices = 1.1 * static_cast<double>(r.Ours.best.vertex_count);
  const SpeedTarget* found = speed_targets;
  for (const SpeedTarget& target : speed_targets)
  {
    found = vertices >= target.Vertices ? &target : found;
  }
  return *found;
}

bool HasOurs(const bench_surface_result& r)
{
  return r.Ours.run_count > 0 && !r.Ours.best.has_failed;
}

// The field is the oracle, which Mesh_3 is given.
double OurSeconds(const bench_surface_result& r)
{
  return r.Ours.best.total_user - r.Ours.best.user[MLIM_STAGE_FIELD];
}

double Vertices(const bench_surface_result& r)
{
  return static_cast<double>(r.Ours.best.vertex_count);
}

// How many times as fast as another; 0: unknown.
double Speed(const bench_surface_result& r, const bench_surface_figures& other)
{
  return other.HasFailed || other.Vertices == 0 ? 0.0 : other.UserSeconds / OurSeconds(r);
}

class Table
{
public:
  explicit Table(std::initializer_list<const char*> headings) : Cells(new bench_table())
  {
    this->Row();
    for (const char* heading : headings)
    {
      this->Text(heading);
    }
  }

  void Row()
  {
    this->Column = 0;
    bench_table_row(this->Cells.get());
  }
  void Text(const std::string& text)
  {
    bench_table_cell(this->Cells.get(), &this->Column, "%s", text.c_str());
  }
  void Count(size_t value) { this->Text(std::to_string(value)); }
  void Number(const char* form, double value)
  {
    bench_table_cell(this->Cells.get(), &this->Column, form, value);
  }
  // A dash in place of what is unknown.
  void Known(const char* form, double value)
  {
    value > 0.0 ? this->Number(form, value) : this->Text("–");
  }
  void Holds(bool holds) { this->Text(holds ? "yes" : "**no**"); }

  void Write(const char* title, FILE* out) const
  {
    std::fprintf(out, "%s\n\n", title);
    bench_table_write(this->Cells.get(), out);
    std::fputc('\n', out);
  }

private:
  std::unique_ptr<bench_table> Cells;
  size_t Column = 0;
};

void WriteCounts(const Results& results, FILE* out)
{
  const double most = 1.1;
  Table table({ "scene", "facet size", "vertices", "Mesh_3's", "more than Mesh_3", "at most 10 %",
    "balls", "Mesh_3's balls", "triangles", "Mesh_3's triangles" });
  for (const bench_surface_result& r : results)
  {
    const bench_surface_figures& same = r.SameBounds;
    if (HasOurs(r) && !same.HasFailed)
    {
      const double part = Vertices(r) / static_cast<double>(same.Vertices);
      table.Row();
      table.Text(r.Row.Scene);
      table.Number("%.3f", r.Ours.best.facet_size);
      table.Count(r.Ours.best.vertex_count);
      table.Count(same.Vertices);
      table.Number("%+.0f %%", 100 * (part - 1));
      table.Holds(part <= most);
      table.Count(r.Ours.best.ball_count);
      table.Count(same.Balls);
      table.Count(r.Ours.best.triangle_count);
      table.Count(same.Triangles);
    }
  }
  table.Write("For the same bounds:", out);
}

void WriteSeconds(const Results& results, FILE* out)
{
  Table table(
    { "scene", "vertices", "Mesh_3's", "its bounds", "field s", "ours s", "refinement s", "bulk s",
      "wall clock", "Mesh_3 s", "P1 s", "P2 wall clock", "× Mesh_3", "must", "aim", "× P1" });
  for (const bench_surface_result& r : results)
  {
    if (HasOurs(r))
    {
      const SpeedTarget& target = TargetOf(r);
      table.Row();
      table.Text(r.Row.Scene);
      table.Count(r.Ours.best.vertex_count);
      table.Known("%.0f", static_cast<double>(r.Sequential.Vertices));
      table.Number("× %.2f", r.SizeScale);
      table.Number("%.2f", r.Ours.best.user[MLIM_STAGE_FIELD]);
      table.Number("%.2f", OurSeconds(r));
      table.Number("%.2f", r.Ours.best.user[MLIM_STAGE_SURFACE]);
      table.Known("%.2f", r.Ours.best.bulk);
      table.Number("%.2f", r.Ours.best.total_wall);
      table.Known("%.2f", r.Sequential.UserSeconds);
      table.Known("%.2f", r.OneThread.UserSeconds);
      table.Known("%.2f", r.TwoThreads.WallSeconds);
      table.Known("%.2f", Speed(r, r.Sequential));
      table.Number("%g", target.Must);
      table.Number("%g", target.Aim);
      table.Known("%.2f", Speed(r, r.OneThread));
    }
  }
  table.Write("Seconds for the same number of vertices:", out);
}

// Bounds of a figure. Of a speed they are lower bounds, of a cost upper ones.
struct Target
{
  const char* Name;
  const char* Form;
  double Must;
  double Aim;
  bool IsSpeed;
};

void AddTarget(const Target& target, const bench_surface_result& r, double value, Table* table)
{
  if (value <= 0.0)
  {
    return;
  }
  table->Row();
  table->Text(target.Name);
  table->Text(std::string(r.Row.Scene) + " " + std::to_string(r.Ours.best.vertex_count));
  table->Number(target.Form, target.Must);
  table->Number(target.Form, target.Aim);
  table->Number(target.Form, value);
  table->Holds(target.IsSpeed ? value >= target.Must : value <= target.Must);
}

// Of all meshes with at least so many vertices the one where a figure is worst.
template <typename Figure>
void AddWorst(const Results& results, const Target& target, int least, Figure figure, Table* table)
{
  const bench_surface_result* worst = nullptr;
  double value = 0.0;
  for (const bench_surface_result& r : results)
  {
    const double one = HasOurs(r) && r.Row.Aim >= least ? figure(r) : 0.0;
    const bool isWorse = target.IsSpeed ? one < value : one > value;
    if (one > 0.0 && (worst == nullptr || isWorse))
    {
      worst = &r;
      value = one;
    }
  }
  if (worst != nullptr)
  {
    AddTarget(target, *worst, value, table);
  }
}

// From the mesh of about 50,000 vertices of the same scene, or the next larger one of an image.
double Growth(const Results& results, const bench_surface_result& large)
{
  const int small_from = 50000;
  const int large_from = 500000;
  for (const bench_surface_result& r : results)
  {
    if (large.Row.Aim >= large_from && std::strcmp(r.Row.Scene, large.Row.Scene) == 0 &&
        HasOurs(r) && r.Row.Aim >= small_from && r.Row.Aim < large_from)
    {
      return 100.0 * (OurSeconds(large) / Vertices(large) / (OurSeconds(r) / Vertices(r)) - 1.0);
    }
  }
  return 0.0;
}

void WriteTargets(const Results& results, FILE* out)
{
  Table table({ "target", "worst: scene, vertices", "must", "aim", "measured", "must holds" });
  for (const SpeedTarget& target : speed_targets)
  {
    Results size;
    std::copy_if(results.begin(), results.end(), std::back_inserter(size),
      [&target](const bench_surface_result& r) { return TargetOf(r).Vertices == target.Vertices; });
    AddWorst(
      size, { "as fast as Mesh_3, times", "%.2f", target.Must, target.Aim, true }, 0,
      [](const bench_surface_result& r) { return Speed(r, r.Sequential); }, &table);
  }
  AddWorst(
    results, { "as fast as P1, times", "%.2f", 2, 3, true }, 50000,
    [](const bench_surface_result& r) { return Speed(r, r.OneThread); }, &table);
  AddWorst(
    results, { "refinement over bulk insertion", "%.2f", 3, 2, false }, 50000,
    [](const bench_surface_result& r)
    { return r.Ours.best.bulk > 0 ? r.Ours.best.user[MLIM_STAGE_SURFACE] / r.Ours.best.bulk : 0; },
    &table);
  AddWorst(
    results, { "growth of time a vertex to 500,000, %", "%.0f", 25, 10, false }, 0,
    [&results](const bench_surface_result& r) { return Growth(results, r); }, &table);
  AddWorst(
    results, { "refinement memory, KB a vertex", "%.2f", 1, 0.6, false }, 36000,
    [](const bench_surface_result& r)
    { return static_cast<double>(r.Ours.best.refinement_memory) / kilobyte / Vertices(r); },
    &table);
  AddWorst(
    results, { "two threads against one, times", "%.2f", 1.5, 1.85, true }, 0,
    [](const bench_surface_result& r)
    { return r.OurWall[1] > 0 ? r.OurWall[0] / r.OurWall[1] : 0; },
    &table);
  Results atlas;
  std::copy_if(results.begin(), results.end(), std::back_inserter(atlas),
    [](const bench_surface_result& r)
    { return r.Row.Aim == 36000 && std::strcmp(r.Row.Scene, "brain_atlas_mni_prob") == 0; });
  AddWorst(
    atlas, { "field, curves and balls, s", "%.2f", 2, 0.5, false }, 0,
    [](const bench_surface_result& r)
    {
      const double* user = r.Ours.best.user;
      return user[MLIM_STAGE_FIELD] + user[MLIM_STAGE_CURVES] + user[MLIM_STAGE_BALLS];
    },
    &table);
  AddWorst(
    atlas, { "all of it with the certificate, s", "%.2f", 3, 0.85, false }, 0,
    [](const bench_surface_result& r) { return r.Ours.best.total_user; }, &table);
  table.Write("Targets, each where it is farthest:", out);
}

void WriteFailures(const Results& results, FILE* out)
{
  for (const bench_surface_result& r : results)
  {
    const std::string name =
      std::string(r.Row.Scene) + ", facet size " + std::to_string(r.Row.FacetSize);
    if (r.Ours.best.message[0] != '\0')
    {
      std::fprintf(out, "- %s: %s\n", name.c_str(), r.Ours.best.message);
    }
    for (const bench_surface_figures* f : { &r.Sequential, &r.OneThread, &r.TwoThreads })
    {
      if (f->HasFailed)
      {
        std::fprintf(out, "- %s, Mesh_3: %s\n", name.c_str(), f->Message);
      }
    }
  }
}

}

void bench_surface_write(const Results& results, FILE* out)
{
  WriteCounts(results, out);
  WriteSeconds(results, out);
  WriteTargets(results, out);
  WriteFailures(results, out);
}
