#include "seeds.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>

/* Component seeds keep this many spacings from each other and from balls: two of them on a
   one-voxel island are about 1 apart. */
static const double COMPONENT_SEED_DISTANCE = 0.3;

/* Side of the blocks in units of the distance asked for: one seed a block leaves gaps of up to
   twice the side, which refinement fills. */
static const double BLOCK_SIDE = 2;

/* The crossing on the way from a grid point to the next one in a direction, or out of the box. */
static int cross_grid_edge(
  const mlim_complex* complex, const int32_t point[3], int side, mlim_crossing* out)
{
  const mlim_field_grid* grid = mlim_field_grid_of(complex->oracle.field);
  double start[3];
  double end[3];
  for (int k = 0; k < 3; ++k)
  {
    start[k] = point[k] * grid->spacing[k];
    end[k] = start[k];
  }
  end[side >> 1] = (point[side >> 1] + (side & 1 ? 1 : -1)) * grid->spacing[side >> 1];
  return mlim_oracle_crossings(&complex->oracle, start, end, 1, out) == 1;
}

mlim_status mlim_seeds_insert(mlim_complex* complex, const mlim_crossing* crossing, double distance,
  mlim_context* context, size_t* count)
{
  const int is_up = crossing->from < crossing->to;
  mlim_vertex vertex = { .kind = MLIM_VERTEX_SURFACE,
    .ball = -1,
    .sheet = { .low = is_up ? crossing->from : crossing->to,
      .high = is_up ? crossing->to : crossing->from,
      .face = crossing->face } };
  for (int k = 0; k < 3; ++k)
  {
    vertex.point[k] = crossing->point[k];
  }
  int is_found;
  const int32_t near = complex->vertices[complex->vertex_count - 1].cell;
  mlim_status status =
    mlim_complex_probe(complex, &vertex, near, MLIM_START_NEAR, context, &is_found);
  if (is_found && mlim_complex_power(complex) >= distance * distance)
  {
    status = mlim_complex_commit(complex, context);
    *count += status == MLIM_OK;
  }
  return status;
}

mlim_status mlim_seeds_on_components(mlim_complex* complex, const mlim_components* components,
  const unsigned char* is_wanted, size_t min_voxels, mlim_context* context, size_t* count)
{
  *count = 0;
  const double distance = COMPONENT_SEED_DISTANCE * mlim_field_grid_of(complex->oracle.field)->unit;
  mlim_status status = MLIM_OK;
  for (size_t c = 0; c < components->count; ++c)
  {
    const mlim_component* component = &components->components[c];
    if (component->voxel_count < min_voxels || (is_wanted != NULL && !is_wanted[c]))
    {
      continue;
    }
    for (int side = 0; side < 6 && status == MLIM_OK; ++side)
    {
      mlim_crossing crossing;
      if (cross_grid_edge(complex, component->extremes[side], side, &crossing))
      {
        status = mlim_seeds_insert(complex, &crossing, distance, context, count);
      }
    }
  }
  return status;
}

/* ---- blocks ---- */

typedef struct block
{
  int32_t low[3];
  int32_t high[3]; /* past the last grid point */
} block;

enum
{
  MAX_SHEETS = 32, /* of one block; further ones wait for refinement */
  MAX_TRIES =
    8 /* crossings of a sheet that are too near to a vertex before the block gives it up */
};

/* The sheets met in one block. */
typedef struct sheet_list
{
  mlim_sheet sheets[MAX_SHEETS];
  int tries[MAX_SHEETS]; /* MAX_TRIES: seeded or given up */
  size_t count;
} sheet_list;

/* The sheet's place in the list, appended if it is new; MAX_SHEETS when the list is full. */
static size_t place_of(sheet_list* list, const mlim_sheet* sheet)
{
  size_t k = 0;
  while (
    k < list->count && (list->sheets[k].low != sheet->low || list->sheets[k].high != sheet->high ||
                         list->sheets[k].face != sheet->face))
  {
    ++k;
  }
  if (k == list->count && k < MAX_SHEETS)
  {
    list->sheets[k] = *sheet;
    list->tries[k] = 0;
    ++list->count;
  }
  return k;
}

/* Whether a point and its next ones along the axes have one label, as nearly all have. */
static int is_inner(const mlim_field* field, const int32_t point[3])
{
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  const size_t steps[3] = { 1, (size_t)dims[0], (size_t)dims[0] * (size_t)dims[1] };
  const uint16_t* label = mlim_field_point_labels(field) + (size_t)point[0] +
                          steps[1] * (size_t)point[1] + steps[2] * (size_t)point[2];
  for (int k = 0; k < 3; ++k)
  {
    if (point[k] == 0 || point[k] + 1 == dims[k] || label[steps[k]] != *label)
    {
      return 0;
    }
  }
  return 1;
}

/* The sheet between a grid point and what lies beyond one of its sides: the next point, or the
   outside. Equal labels when there is none. */
static mlim_sheet sheet_beyond(const mlim_field* field, const int32_t point[3], int side)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  const int32_t label = mlim_field_point_label(field, point);
  int32_t next[3] = { point[0], point[1], point[2] };
  next[side >> 1] += side & 1 ? 1 : -1;
  const int is_out = next[side >> 1] < 0 || next[side >> 1] >= grid->dims[side >> 1];
  const int32_t other =
    is_out ? mlim_field_outside_label(field) : mlim_field_point_label(field, next);
  return (mlim_sheet){ .low = label < other ? label : other,
    .high = label < other ? other : label,
    .face = is_out ? side : -1 };
}

static mlim_status seed_point(mlim_complex* complex, const int32_t point[3], double distance,
  sheet_list* list, mlim_context* context, size_t* count)
{
  for (int side = 0; side < 6; ++side)
  {
    mlim_crossing crossing;
    const mlim_sheet sheet = sheet_beyond(complex->oracle.field, point, side);
    const int is_taken = !(side & 1) && point[side >> 1] > 0; /* the point before has looked */
    if (is_taken || sheet.low == sheet.high)
    {
      continue;
    }
    const size_t place = place_of(list, &sheet);
    if (place == MAX_SHEETS || list->tries[place] == MAX_TRIES ||
        !cross_grid_edge(complex, point, side, &crossing))
    {
      continue;
    }
    const size_t before = *count;
    const mlim_status status = mlim_seeds_insert(complex, &crossing, distance, context, count);
    if (status != MLIM_OK)
    {
      return status;
    }
    list->tries[place] = *count > before ? MAX_TRIES : list->tries[place] + 1;
  }
  return MLIM_OK;
}

static mlim_status seed_block(
  mlim_complex* complex, const block* b, double distance, mlim_context* context, size_t* count)
{
  sheet_list list = { .count = 0 };
  int32_t p[3];
  for (p[2] = b->low[2]; p[2] < b->high[2]; ++p[2])
  {
    for (p[1] = b->low[1]; p[1] < b->high[1]; ++p[1])
    {
      for (p[0] = b->low[0]; p[0] < b->high[0]; ++p[0])
      {
        if (is_inner(complex->oracle.field, p))
        {
          continue;
        }
        const mlim_status status = seed_point(complex, p, distance, &list, context, count);
        if (status != MLIM_OK)
        {
          return status;
        }
      }
    }
  }
  return MLIM_OK;
}

mlim_status mlim_seeds_on_sheets(
  mlim_complex* complex, double distance, double done, mlim_context* context, size_t* count)
{
  *count = 0;
  const mlim_field_grid* grid = mlim_field_grid_of(complex->oracle.field);
  int32_t side[3];
  int32_t blocks[3];
  for (int k = 0; k < 3; ++k)
  {
    const double points = mlim_min(ceil(BLOCK_SIDE * distance / grid->spacing[k]), grid->dims[k]);
    side[k] = points < 2 ? 2 : (int32_t)points;
    blocks[k] = (grid->dims[k] + side[k] - 1) / side[k];
  }
  int32_t at[3];
  for (at[2] = 0; at[2] < blocks[2]; ++at[2])
  {
    const mlim_status going = mlim_progress(context, MLIM_STAGE_SURFACE, done);
    if (going != MLIM_OK)
    {
      return going;
    }
    for (at[1] = 0; at[1] < blocks[1]; ++at[1])
    {
      for (at[0] = 0; at[0] < blocks[0]; ++at[0])
      {
        block b;
        for (int k = 0; k < 3; ++k)
        {
          b.low[k] = at[k] * side[k];
          b.high[k] = b.low[k] + side[k] < grid->dims[k] ? b.low[k] + side[k] : grid->dims[k];
        }
        const mlim_status status = seed_block(complex, &b, distance, context, count);
        if (status != MLIM_OK)
        {
          return status;
        }
      }
    }
  }
  return MLIM_OK;
}
