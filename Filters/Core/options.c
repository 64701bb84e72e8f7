#include "field.h"
#include "status.h"
#include "vector.h"

#include <math.h>

/* Defaults as multiples of the field's unit or of another length; mlim.h states them. */
static const double FACET_SIZE = 2;
static const double FACET_DISTANCE_PART = 0.125; /* of facet_size: flat to about 1 in 8 */
static const double CROSSING_TOLERANCE = 1e-6;
static const double JUNCTION_MERGE_TOLERANCE = 0.25;
static const double CELL_SIZE = 2; /* of facet_size */
static const double CELL_RADIUS_EDGE_RATIO = 2;
static const double SMALLEST_PART =
  0.125; /* of facet_size: a finer spot costs a fan of triangles */
static const double LARGEST_SMALLEST = 0.25; /* what the voxels separate is not given up */

mlim_options mlim_options_default(const mlim_field* field)
{
  mlim_options options = { .facet_radius_edge_ratio = 1,
    .ball_radius_scale = 1,
    .junction_merge_tolerance = -1,
    .volume_tolerance = 0.02,
    .oracle_mode = MLIM_ORACLE_EXACT,
    .vertex_limit = 20000000,
    .min_component_voxels = 30,
    .remove_slivers = 1 };
  (void)mlim_options_complete(field, NULL, &options);
  return options;
}

static mlim_status check_length(
  mlim_context* context, const char* name, double value, int may_be_zero)
{
  if (isfinite(value) && (value > 0 || (may_be_zero && value == 0)))
  {
    return MLIM_OK;
  }
  return mlim_fail(context, MLIM_INVALID_ARGUMENT, "%s is %g; it has to be finite and %s 0.", name,
    value, may_be_zero ? "at least" : "above");
}

static mlim_status check_range(
  mlim_context* context, const char* name, double value, double low, double high)
{
  if (value >= low && value <= high)
  {
    return MLIM_OK;
  }
  return mlim_fail(context, MLIM_INVALID_ARGUMENT, "%s is %g; it has to be from %g to %g.", name,
    value, low, high);
}

static mlim_status check_options(mlim_context* context, const mlim_options* o)
{
  const struct
  {
    const char* name;
    double value;
    int may_be_zero;
  } lengths[] = {
    { "FacetSize", o->facet_size, 0 },
    { "FacetDistance", o->facet_distance, 0 },
    { "EdgeSize", o->edge_size, 0 },
    { "CrossingTolerance", o->crossing_tolerance, 0 },
    { "JunctionMergeTolerance", o->junction_merge_tolerance, 1 },
    { "SmallestDistance", o->smallest_distance, 0 },
    { "CellSize", o->cell_size, 0 },
  };
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < sizeof lengths / sizeof *lengths && status == MLIM_OK; ++k)
  {
    status = check_length(context, lengths[k].name, lengths[k].value, lengths[k].may_be_zero);
  }
  if (status == MLIM_OK)
  {
    /* Below 1 Delaunay refinement need not end before the length floor; 1/sqrt(3) is the ratio of
       the equilateral triangle. */
    status = check_range(context, "FacetRadiusEdgeRatio", o->facet_radius_edge_ratio, 0.6, 1e6);
  }
  if (status == MLIM_OK)
  {
    status = check_range(context, "BallRadiusScale", o->ball_radius_scale, 0.01, 1);
  }
  if (status == MLIM_OK)
  {
    status = check_range(context, "VolumeTolerance", o->volume_tolerance, 0, 0.999);
  }
  if (status == MLIM_OK)
  {
    /* The same for cells: below 2 refinement need not end before the floor. */
    status = check_range(context, "CellRadiusEdgeRatio", o->cell_radius_edge_ratio, 1, 1e6);
  }
  if (status == MLIM_OK && o->label_size_count > 0 && o->label_sizes == NULL)
  {
    status = mlim_fail(context, MLIM_INVALID_ARGUMENT, "The cell sizes of labels are NULL.");
  }
  for (size_t k = 0; k < o->label_size_count && status == MLIM_OK; ++k)
  {
    status = check_length(context, "The cell size of a label", o->label_sizes[k].size, 0);
  }
  if (status == MLIM_OK && (o->vertex_limit < 1 || o->vertex_limit > 1000000000))
  {
    status = mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "VertexLimit is %zu; it has to be from 1 to 1000000000.", o->vertex_limit);
  }
  if (status == MLIM_OK && o->min_component_voxels < 1)
  {
    status = mlim_fail(
      context, MLIM_INVALID_ARGUMENT, "MinimumComponentVoxels is 0; it has to be at least 1.");
  }
  if (status == MLIM_OK && o->oracle_mode != MLIM_ORACLE_EXACT &&
      o->oracle_mode != MLIM_ORACLE_BISECTION)
  {
    status = mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "OracleMode is %d; it has to be 0 (exact) or 1 (bisection).", (int)o->oracle_mode);
  }
  return status;
}

/* 0 asks for the default; a negative junction_merge_tolerance does, since 0 means "never merge". */
static double or_default(double value, double fallback)
{
  return value == 0 ? fallback : value;
}

mlim_status mlim_options_complete(
  const mlim_field* field, mlim_context* context, mlim_options* options)
{
  if (field == NULL || options == NULL)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT, "The field or the options are NULL.");
  }
  const double unit = mlim_field_grid_of(field)->unit;
  options->facet_size = or_default(options->facet_size, FACET_SIZE * unit);
  options->facet_distance =
    or_default(options->facet_distance, FACET_DISTANCE_PART * options->facet_size);
  options->edge_size = or_default(options->edge_size, options->facet_size);
  options->crossing_tolerance = or_default(options->crossing_tolerance, CROSSING_TOLERANCE * unit);
  if (options->junction_merge_tolerance < 0)
  {
    options->junction_merge_tolerance = JUNCTION_MERGE_TOLERANCE * unit;
  }
  options->smallest_distance = or_default(options->smallest_distance,
    mlim_min(SMALLEST_PART * options->facet_size, LARGEST_SMALLEST * unit));
  options->cell_radius_edge_ratio =
    or_default(options->cell_radius_edge_ratio, CELL_RADIUS_EDGE_RATIO);
  options->cell_size = or_default(options->cell_size, CELL_SIZE * options->facet_size);
  return check_options(context, options);
}
