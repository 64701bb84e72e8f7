/* Small label maps for tests, and the naive answer: distances by looking at every voxel near. */
#ifndef label_scenes_h
#define label_scenes_h

#include "mlim.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct label_scene
{
  int32_t dims[3];
  double spacing[3];
  size_t count;
  int32_t* values;
} label_scene;

/* The label's value at a grid point. */
typedef int32_t (*label_rule)(const int32_t at[3]);

static inline label_scene label_scene_make(
  const int32_t dims[3], const double spacing[3], label_rule rule)
{
  label_scene s;
  memcpy(s.dims, dims, sizeof s.dims);
  memcpy(s.spacing, spacing, sizeof s.spacing);
  s.count = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
  s.values = malloc(s.count * sizeof *s.values);
  for (size_t p = 0; p < s.count; ++p)
  {
    const int32_t at[3] = { (int32_t)(p % (size_t)dims[0]),
      (int32_t)(p / (size_t)dims[0] % (size_t)dims[1]),
      (int32_t)(p / ((size_t)dims[0] * (size_t)dims[1])) };
    s.values[p] = rule(at);
  }
  return s;
}

static inline mlim_label_map label_scene_read(const label_scene* s, mlim_context* context)
{
  const mlim_array array = { .values = s->values, .type = MLIM_INT32, .stride = 1 };
  mlim_label_map map;
  if (mlim_label_map_read(s->dims, s->spacing, &array, context, &map) != MLIM_OK)
  {
    memset(&map, 0, sizeof map);
  }
  return map;
}

/* Blocks of 3 x 3 x 3 points with ids far apart, one of them negative. */
static inline int32_t label_rule_blocks(const int32_t at[3])
{
  static const int32_t ids[5] = { 0, -70000, 5, 17, 1000000 };
  uint32_t hash = (uint32_t)(at[0] / 3 * 73856093) ^ (uint32_t)(at[1] / 3 * 19349663) ^
                  (uint32_t)(at[2] / 3 * 83492791);
  hash ^= hash >> 13;
  hash *= 1274126177u;
  return ids[(hash >> 16) % 5];
}

/* Mirrored at the outermost points. */
static inline int32_t label_fold(int32_t at, int32_t length)
{
  while (at < 0 || at >= length)
  {
    at = at < 0 ? -at : 2 * (length - 1) - at;
  }
  return at;
}

static inline size_t label_point(const label_scene* s, int32_t x, int32_t y, int32_t z)
{
  return (size_t)label_fold(x, s->dims[0]) +
         (size_t)s->dims[0] * ((size_t)label_fold(y, s->dims[1]) +
                                (size_t)s->dims[1] * (size_t)label_fold(z, s->dims[2]));
}

/* Signed distance of a grid point to the boundary of the id's voxels, at most `band`. */
static inline double label_distance(
  const label_scene* s, const int32_t at[3], int32_t id, double band)
{
  const int is_inside = s->values[label_point(s, at[0], at[1], at[2])] == id;
  int32_t reach[3];
  for (int k = 0; k < 3; ++k)
  {
    reach[k] = (int32_t)ceil(band / s->spacing[k] + 0.5);
  }
  double best = band * band;
  for (int32_t z = -reach[2]; z <= reach[2]; ++z)
  {
    for (int32_t y = -reach[1]; y <= reach[1]; ++y)
    {
      for (int32_t x = -reach[0]; x <= reach[0]; ++x)
      {
        const size_t q = label_point(s, at[0] + x, at[1] + y, at[2] + z);
        if ((s->values[q] == id) == is_inside)
        {
          continue;
        }
        const double length[3] = { s->spacing[0] * fmax(abs(x) - 0.5, 0),
          s->spacing[1] * fmax(abs(y) - 0.5, 0), s->spacing[2] * fmax(abs(z) - 0.5, 0) };
        const double squared =
          length[0] * length[0] + length[1] * length[1] + length[2] * length[2];
        best = squared < best ? squared : best;
      }
    }
  }
  return is_inside ? sqrt(best) : -sqrt(best);
}

/* The grid whose indicators are those of the map; `arrays` has room for one a label. */
static inline mlim_grid label_grid(
  const mlim_label_map* map, const mlim_indicators* indicators, mlim_array* arrays)
{
  mlim_grid grid = { .array_count = (size_t)map->label_count,
    .arrays = arrays,
    .indicators = indicators,
    .background = MLIM_BACKGROUND_NONE };
  memcpy(grid.dims, map->dims, sizeof grid.dims);
  memcpy(grid.spacing, map->spacing, sizeof grid.spacing);
  for (int32_t l = 0; l < map->label_count; ++l)
  {
    arrays[l] = (mlim_array){ .type = MLIM_FLOAT32, .stride = 1, .id = map->ids[l] };
    if (map->ids[l] == 0)
    {
      grid.background = MLIM_BACKGROUND_ARRAY;
      grid.background_array = (size_t)l;
    }
  }
  return grid;
}

#endif
