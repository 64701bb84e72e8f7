/* Fields sampled from functions, for tests of curves and balls. */
#ifndef mlim_scenes_h
#define mlim_scenes_h

#include "balls.h"
#include "check.h"
#include "memory.h"
#include "mlim.h"

#include <stdint.h>
#include <string.h>

/* Value of indicator `label` at a grid point, in units of the grid. */
typedef double (*scene_function)(const double at[3], int label);

typedef struct scene_spec
{
  int32_t dims[3];
  double spacing[3];
  int label_count;
  int background; /* -1: every label is a region */
  scene_function function;
  const int* order; /* label at each place; NULL: as they are */
} scene_spec;

static inline mlim_field* scene_field(const scene_spec* scene)
{
  const size_t count = (size_t)scene->dims[0] * (size_t)scene->dims[1] * (size_t)scene->dims[2];
  mlim_array arrays[16];
  mlim_field* field = NULL;
  mlim_context context = { 0 };
  mlim_grid grid = { .array_count = (size_t)scene->label_count, .arrays = arrays };
  memcpy(grid.dims, scene->dims, sizeof grid.dims);
  memcpy(grid.spacing, scene->spacing, sizeof grid.spacing);
  for (int a = 0; a < scene->label_count; ++a)
  {
    const int label = scene->order ? scene->order[a] : a;
    double* values = mlim_allocate(count, sizeof(double));
    for (size_t p = 0; p < count; ++p)
    {
      const size_t nx = (size_t)scene->dims[0];
      const size_t ny = (size_t)scene->dims[1];
      const double at[3] = { (double)(p % nx) * scene->spacing[0],
        (double)(p / nx % ny) * scene->spacing[1], (double)(p / nx / ny) * scene->spacing[2] };
      values[p] = scene->function(at, label);
    }
    arrays[a] = (mlim_array){ .values = values,
      .type = MLIM_FLOAT64,
      .stride = 1,
      .id = label == scene->background ? 0 : label + 1 };
    if (label == scene->background)
    {
      grid.background = MLIM_BACKGROUND_ARRAY;
      grid.background_array = (size_t)a;
    }
  }
  const mlim_status status = mlim_field_create(&grid, &context, &field);
  if (status)
  {
    fprintf(stderr, "%s\n", context.message);
  }
  CHECK(status == MLIM_OK);
  for (int a = 0; a < scene->label_count; ++a)
  {
    mlim_release((void*)(uintptr_t)arrays[a].values);
  }
  return field;
}

/* Number of labels of a set that are not faces of the box. */
static inline size_t scene_label_count(const mlim_sets* sets, int32_t set, int32_t label_count)
{
  size_t count = 0;
  for (size_t i = sets->offsets[set]; i < sets->offsets[set + 1]; ++i)
  {
    count += sets->labels[i] < label_count;
  }
  return count;
}

#endif
