#include "surface.h"

#include "mesh3_domain.h"
#include "process.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <stdexcept>

namespace
{

struct Job
{
  const bench_surface_demand* Demand;
  bench_mesher Mesher;
  const char* Folder;
};

void Throw(mlim_status status, const mlim_context& context)
{
  if (status != MLIM_OK)
  {
    throw std::runtime_error(context.message);
  }
}

double LengthOf(const mlim_curves& curves)
{
  double length = 0.0;
  for (size_t c = 0; c < curves.curve_count; ++c)
  {
    for (size_t p = curves.curve_offsets[c]; p + 1 < curves.curve_offsets[c + 1]; ++p)
    {
      const double* a = curves.points + 3 * curves.curve_points[p];
      const double* b = curves.points + 3 * curves.curve_points[p + 1];
      length += std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
    }
  }
  return length;
}

// As many balls on the curves as we have, or nearly: their size is found by trying. None becomes smaller
// than the smallest of ours.
void MatchEdges(const bench_mesh3_domain& domain, const mlim_curves& curves,
  const mlim_balls& balls, bench_mesh3_criteria* out)
{
  const int tries = 4;
  out->EdgeSize = LengthOf(curves) / static_cast<double>(balls.edge_count);
  out->MinEdgeSize = *std::min_element(balls.radii, balls.radii + balls.ball_count);
  for (int t = 0; t < tries; ++t)
  {
    const size_t count = bench_mesh3_balls(domain, *out);
    out->EdgeSize *= static_cast<double>(count) / static_cast<double>(balls.ball_count);
  }
}

bench_mesh3_mesh RunMesh3(
  const mlim_grid& grid, const bench_surface_demand& demand, bench_mesher mesher)
{
  mlim_context context = {};
  mlim_field* field = nullptr;
  Throw(mlim_field_create(&grid, &context, &field), context);
  mlim_options options;
  Throw(bench_options(&grid, field, &demand.Ours, &context, &options), context);
  mlim_curves curves = {};
  Throw(mlim_curves_extract(field, &options, &context, &curves), context);
  options.facet_size *= demand.SizeScale;
  options.facet_distance *= demand.SizeScale;
  options.edge_size *= demand.SizeScale;
  mlim_balls balls = {};
  Throw(mlim_balls_cover(&curves, &options, &context, &balls), context);
  // A radius-edge ratio of 1 is an angle of 30 degrees.
  bench_mesh3_criteria criteria = {};
  criteria.FacetAngle = 30.0;
  criteria.FacetSize = options.facet_size;
  criteria.FacetDistance = options.facet_distance;
  const bench_mesh3_domain domain =
    bench_mesh3_domain_of(field, &curves, options.min_component_voxels);
  if (balls.edge_count > 0)
  {
    MatchEdges(domain, curves, balls, &criteria);
  }
  // All of this belongs to a process that ends now.
  switch (mesher)
  {
    case bench_mesher::Sequential:
      return bench_mesh3(domain, criteria);
    case bench_mesher::OneThread:
      return bench_mesh3_parallel(domain, criteria, 1);
    case bench_mesher::TwoThreads:
      return bench_mesh3_parallel(domain, criteria, 2);
  }
  return {};
}

void Work(const void* given, void* result)
{
  const Job& job = *static_cast<const Job*>(given);
  bench_surface_figures* out = static_cast<bench_surface_figures*>(result);
  *out = {};
  try
  {
    bench_image image;
    if (bench_case_load(job.Demand->Ours.one, job.Folder, out->Message, &image))
    {
      out->HasFailed = true;
      return;
    }
    const bench_mesh3_mesh mesh = RunMesh3(image.grid, *job.Demand, job.Mesher);
    out->Vertices = mesh.Vertices;
    out->Triangles = mesh.Triangles;
    out->Balls = mesh.Balls;
    out->UserSeconds = mesh.UserSeconds;
    out->WallSeconds = mesh.WallSeconds;
  }
  catch (const std::exception& error)
  {
    out->HasFailed = true;
    std::snprintf(out->Message, sizeof out->Message, "%s", error.what());
  }
}

}

bench_surface_figures bench_surface_run(
  const bench_surface_demand& demand, bench_mesher mesher, const char* folder)
{
  const Job job = { &demand, mesher, folder };
  bench_surface_figures out = {};
  char message[BENCH_MESSAGE_SIZE];
  if (bench_process_run(&Work, &job, demand.MaxSeconds, sizeof out, &out, message))
  {
    out = {};
    out.HasFailed = true;
    std::memcpy(out.Message, message, sizeof message);
  }
  return out;
}
