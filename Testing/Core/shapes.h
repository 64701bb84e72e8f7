/* Scenes whose mesh is known beforehand, and the way from their samples to the mesh. */
#ifndef mlim_shapes_h
#define mlim_shapes_h

#include "balls.h"
#include "check.h"
#include "mlim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- from a grid to its mesh ---- */

/* Value of indicator `label` at a point. */
typedef double (*shape_function)(const double at[3], int label);

/* A grid with the samples that its arrays borrow. */
typedef struct image
{
  mlim_grid grid;
  mlim_array arrays[16];
  double* values;
} image;

/* Array k is label k; `background` is one of them, or -1 if every label is a region. */
static inline image* image_sample(const int32_t dims[3], const double spacing[3], int label_count,
  int background, shape_function function)
{
  const size_t nx = (size_t)dims[0];
  const size_t ny = (size_t)dims[1];
  const size_t count = nx * ny * (size_t)dims[2];
  image* im = calloc(1, sizeof *im);
  im->values = malloc(count * (size_t)label_count * sizeof *im->values);
  im->grid = (mlim_grid){ .array_count = (size_t)label_count,
    .arrays = im->arrays,
    .background = background < 0 ? MLIM_BACKGROUND_NONE : MLIM_BACKGROUND_ARRAY,
    .background_array = background < 0 ? 0 : (size_t)background,
    .unseen = MLIM_UNSEEN_KEEP };
  memcpy(im->grid.dims, dims, sizeof im->grid.dims);
  memcpy(im->grid.spacing, spacing, sizeof im->grid.spacing);
  for (int label = 0; label < label_count; ++label)
  {
    double* values = im->values + count * (size_t)label;
    for (size_t p = 0; p < count; ++p)
    {
      const double at[3] = { (double)(p % nx) * spacing[0], (double)(p / nx % ny) * spacing[1],
        (double)(p / nx / ny) * spacing[2] };
      values[p] = function(at, label);
    }
    im->arrays[label] = (mlim_array){
      .values = values, .type = MLIM_FLOAT64, .stride = 1, .id = label == background ? 0 : label + 1
    };
  }
  return im;
}

static inline void image_free(image* im)
{
  free(im->values);
  free(im);
}

typedef struct run
{
  mlim_field* field;
  mlim_options options; /* complete */
  mlim_curves curves;
  mlim_balls balls;
  mlim_mesh mesh;
  mlim_volume volume; /* of run_volume */
} run;

/* Lengths from the data; facets of one spacing, so that small shapes are rendered to a percent. */
static inline mlim_options run_options(double unit)
{
  return (mlim_options){ .facet_size = unit,
    .facet_radius_edge_ratio = 1,
    .ball_radius_scale = 1,
    .junction_merge_tolerance = -1,
    .volume_tolerance = 0.02,
    .oracle_mode = MLIM_ORACLE_EXACT,
    .vertex_limit = 100000,
    .min_component_voxels = 1,
    .remove_slivers = 1 };
}

/* Field, curves, balls; stops at the first that is not MLIM_OK. */
static inline mlim_status run_cover(
  const mlim_grid* grid, const mlim_options* options, mlim_context* context, run* out)
{
  *out = (run){ .options = *options };
  mlim_status status = mlim_field_create(grid, context, &out->field);
  if (status == MLIM_OK)
  {
    status = mlim_options_complete(out->field, context, &out->options);
  }
  if (status == MLIM_OK)
  {
    status = mlim_curves_extract(out->field, &out->options, context, &out->curves);
  }
  if (status == MLIM_OK)
  {
    status = mlim_balls_cover(&out->curves, &out->options, context, &out->balls);
  }
  return status;
}

/* The same, and the mesh. */
static inline mlim_status run_grid(
  const mlim_grid* grid, const mlim_options* options, mlim_context* context, run* out)
{
  const mlim_status status = run_cover(grid, options, context, out);
  return status == MLIM_OK
           ? mlim_mesh_refine(out->field, &out->balls, &out->options, context, &out->mesh)
           : status;
}

/* The same, and the volume. */
static inline mlim_status run_volume(
  const mlim_grid* grid, const mlim_options* options, mlim_context* context, run* out)
{
  const mlim_status status = run_cover(grid, options, context, out);
  return status == MLIM_OK ? mlim_volume_refine(out->field, &out->balls, &out->options, context,
                               &out->mesh, &out->volume)
                           : status;
}

static inline void run_free(run* r)
{
  mlim_volume_free(&r->volume);
  mlim_mesh_free(&r->mesh);
  mlim_balls_free(&r->balls);
  mlim_curves_free(&r->curves);
  mlim_field_free(r->field);
}

/* Products that have not been made, or are given up, are empty. */
static inline int run_is_empty_from(const run* r, mlim_stage stage)
{
  const int has_field = r->field != NULL;
  const int has_curves = r->curves.points != NULL || r->curves.curve_offsets != NULL ||
                         r->curves.sets.offsets != NULL || r->curves.curve_count > 0;
  const int has_balls = r->balls.centers != NULL || r->balls.radii != NULL ||
                        r->balls.sets.offsets != NULL || r->balls.ball_count > 0;
  const int has_mesh = r->mesh.vertices != NULL || r->mesh.triangles != NULL ||
                       r->mesh.volumes != NULL || r->mesh.triangle_count > 0;
  const int has_volume =
    r->volume.vertices != NULL || r->volume.cells != NULL || r->volume.cell_count > 0;
  return !(stage <= MLIM_STAGE_FIELD && has_field) && !(stage <= MLIM_STAGE_CURVES && has_curves) &&
         !(stage <= MLIM_STAGE_BALLS && has_balls) && !has_mesh && !has_volume;
}

/* ---- the functions ---- */

static inline double shape_distance(const double at[3], double x, double y, double z)
{
  return sqrt((at[0] - x) * (at[0] - x) + (at[1] - y) * (at[1] - y) + (at[2] - z) * (at[2] - z));
}

static inline double shape_sphere(const double at[3], int label)
{
  return label == 0 ? 0 : 7.3 - shape_distance(at, 9.4, 9.7, 10.3);
}

static inline double shape_two_spheres(const double at[3], int label)
{
  return label == 0 ? 0 : 7 - shape_distance(at, label == 1 ? 9.2 : 17.8, 10.1, 9.8);
}

static inline double shape_shells(const double at[3], int label)
{
  const double r = shape_distance(at, 10.6, 10.4, 10.5);
  return label == 0 ? r - 9.5 : label == 1 ? fmin(9.5 - r, r - 7) : 7 - r;
}

static inline double shape_torus(const double at[3], int label)
{
  const double ring = 11 - shape_distance(at, 17.1, 16.8, at[2]);
  return label == 0 ? 0 : 4.5 - sqrt(ring * ring + (at[2] - 6.1) * (at[2] - 6.1));
}

/* Three half-spaces: sectors of 120 degrees about an axis. */
static inline double shape_sectors(const double at[3], int label)
{
  const double angle = label * 2.0943951023931953;
  return cos(angle) * (at[0] - 5.3) + sin(angle) * (at[1] - 5.8);
}

/* 2 x 2 x 2 boxes: four meet at each axis, eight at the middle. */
static inline double shape_octants(const double at[3], int label)
{
  return (label & 1 ? 1 : -1) * (at[0] - 4.3) + (label & 2 ? 1 : -1) * (at[1] - 4.6) +
         (label & 4 ? 1 : -1) * (at[2] - 4.4);
}

static inline double shape_halves(const double at[3], int label)
{
  return label == 0 ? 4.3 - at[0] : at[0] - 4.3;
}

/* One voxel of label 2 in the middle of label 1. */
static inline double shape_island(const double at[3], int label)
{
  const double r = shape_distance(at, 6, 6, 6);
  return label == 0 ? 0 : label == 1 ? 5.2 - r : r < 0.5 ? 12 : -1;
}

static inline double shape_cut_sphere(const double at[3], int label)
{
  return label == 0 ? 0 : 7.3 - shape_distance(at, 2.2, 9.7, 10.3);
}

static inline double shape_constant(const double at[3], int label)
{
  (void)at;
  return 1 - label;
}

static inline double shape_slices(const double at[3], int label)
{
  return label == 0 ? 0 : 4.6 - shape_distance(at, 6.4, 7.2, at[2]);
}

/* ---- the shapes ---- */

enum
{
  SHAPE_MAX_LABELS = 8
};

typedef struct shape
{
  const char* name;
  int32_t dims[3];
  int label_count;
  int background; /* -1: every label is a region */
  shape_function function;
  int euler[SHAPE_MAX_LABELS];     /* of each label's boundary */
  double volume[SHAPE_MAX_LABELS]; /* of each region; 0: too small to tell, or background */
} shape;

static inline double shape_ball_volume(double radius)
{
  return 4.0 / 3 * 3.141592653589793 * radius * radius * radius;
}

static inline double shape_cap_volume(double radius, double height)
{
  return 3.141592653589793 * height * height * (3 * radius - height) / 3;
}

enum
{
  SHAPE_SPHERE,
  SHAPE_TWO_SPHERES,
  SHAPE_SHELLS,
  SHAPE_TORUS,
  SHAPE_SECTORS,
  SHAPE_OCTANTS,
  SHAPE_HALVES,
  SHAPE_ISLAND,
  SHAPE_CUT_SPHERE,
  SHAPE_CONSTANT,
  SHAPE_EMPTY,
  SHAPE_SLICES,
  SHAPE_COUNT
};

static inline shape shape_of(int kind)
{
  const double lens = shape_ball_volume(7) - shape_cap_volume(7, 2.7);
  /* The rays at +-60 degrees from (5.3, 5.8) bound sector 0 of the square of side 11. */
  const double first = 11 * (11 - 5.3) - 0.5 * (5.2 * 5.2 + 5.8 * 5.8) / sqrt(3.0);
  const double second = 5.3 * 5.2 + 0.5 * 5.2 * 5.2 / sqrt(3.0);
  const shape shapes[SHAPE_COUNT] = {
    [SHAPE_SPHERE] = { "sphere", { 20, 20, 21 }, 2, 0, shape_sphere, { 2, 2 },
      { 0, shape_ball_volume(7.3) } },
    [SHAPE_TWO_SPHERES] = { "two spheres", { 28, 21, 21 }, 3, 0, shape_two_spheres, { 2, 2, 2 },
      { 0, lens, lens } },
    [SHAPE_SHELLS] = { "shells", { 22, 22, 22 }, 3, 0, shape_shells, { 2, 4, 2 },
      { 0, shape_ball_volume(9.5) - shape_ball_volume(7), shape_ball_volume(7) } },
    [SHAPE_TORUS] = { "torus", { 35, 35, 13 }, 2, 0, shape_torus, { 0, 0 },
      { 0, 2 * 3.141592653589793 * 3.141592653589793 * 11 * 4.5 * 4.5 } },
    [SHAPE_SECTORS] = { "sectors", { 12, 12, 12 }, 3, -1, shape_sectors, { 2, 2, 2 },
      { 11 * first, 11 * second, 11 * (121 - first - second) } },
    [SHAPE_OCTANTS] = { "octants", { 10, 10, 10 }, 8, -1, shape_octants, { 2, 2, 2, 2, 2, 2, 2, 2 },
      { 4.3 * 4.6 * 4.4, 4.7 * 4.6 * 4.4, 4.3 * 4.4 * 4.4, 4.7 * 4.4 * 4.4, 4.3 * 4.6 * 4.6,
        4.7 * 4.6 * 4.6, 4.3 * 4.4 * 4.6, 4.7 * 4.4 * 4.6 } },
    [SHAPE_HALVES] = { "halves", { 10, 9, 8 }, 2, -1, shape_halves, { 2, 2 },
      { 4.3 * 56, 4.7 * 56 } },
    [SHAPE_ISLAND] = { "island", { 13, 13, 13 }, 3, 0, shape_island, { 2, 4, 2 }, { 0 } },
    [SHAPE_CUT_SPHERE] = { "cut sphere", { 13, 20, 21 }, 2, 0, shape_cut_sphere, { 2, 2 },
      { 0, shape_ball_volume(7.3) - shape_cap_volume(7.3, 5.1) } },
    [SHAPE_CONSTANT] = { "constant", { 6, 5, 4 }, 1, -1, shape_constant, { 2 }, { 60 } },
    [SHAPE_EMPTY] = { "empty", { 6, 5, 4 }, 2, 0, shape_constant, { 0, 0 }, { 0 } },
    [SHAPE_SLICES] = { "slices", { 14, 15, 2 }, 2, 0, shape_slices, { 2, 2 },
      { 0, 3.141592653589793 * 4.6 * 4.6 } },
  };
  return shapes[kind];
}

static inline image* shape_sample(const shape* s)
{
  const double spacing[3] = { 1, 1, 1 };
  return image_sample(s->dims, spacing, s->label_count, s->background, s->function);
}

/* Names the shape when checks of it have failed. */
static inline void shape_report(const char* name, int failures_before)
{
  if (check_failures > failures_before)
  {
    fprintf(stderr, "  ^ in \"%s\"\n", name);
  }
}

#endif
