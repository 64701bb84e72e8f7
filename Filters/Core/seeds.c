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
  double power;
  const int32_t near = complex->vertices[complex->vertex_count - 1].cell;
  mlim_status status = mlim_complex_probe(complex, &vertex, near, MLIM_START_NEAR, context, &power);
  if (status == MLIM_OK && power >= distance * distance)
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

static int is_known(const mlim_sheet* sheets, size_t count, const mlim_sheet* sheet)
{
  for (size_t k = 0; k < count; ++k)
  {
    if (sheets[k].low == sheet->low && sheets[k].high == sheet->high &&
        sheets[k].face == sheet->face)
    {
      return 1;
    }
  }
  return 0;
}

/* Whether a point and its next ones along the axes have one label, as nearly all have. */
static int is_inner(const mlim_field* field, const int32_t point[3])
{
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  const int32_t label = mlim_field_point_label(field, point);
  for (int k = 0; k < 3; ++k)
  {
    int32_t next[3] = { point[0], point[1], point[2] };
    ++next[k];
    if (point[k] == 0 || next[k] == dims[k] || mlim_field_point_label(field, next) != label)
    {
      return 0;
    }
  }
  return 1;
}

/* Label beyond a side of a grid point: the next point's, or the outside's. */
static int32_t label_beyond(const mlim_field* field, const int32_t point[3], int side)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  int32_t next[3] = { point[0], point[1], point[2] };
  next[side >> 1] += side & 1 ? 1 : -1;
  return next[side >> 1] < 0 || next[side >> 1] >= grid->dims[side >> 1]
           ? mlim_field_outside_label(field)
           : mlim_field_point_label(field, next);
}

static mlim_status seed_point(mlim_complex* complex, const int32_t point[3], double distance,
  mlim_sheet* known, size_t* known_count, size_t known_capacity, mlim_context* context,
  size_t* count)
{
  const mlim_field* field = complex->oracle.field;
  const int32_t label = mlim_field_point_label(field, point);
  for (int side = 0; side < 6; ++side)
  {
    mlim_crossing crossing;
    const int is_last = side & 1 || point[side >> 1] == 0;
    if (!is_last || label_beyond(field, point, side) == label ||
        !cross_grid_edge(complex, point, side, &crossing))
    {
      continue;
    }
    const mlim_sheet sheet = { .low = crossing.from < crossing.to ? crossing.from : crossing.to,
      .high = crossing.from < crossing.to ? crossing.to : crossing.from,
      .face = crossing.face };
    if (*known_count == known_capacity || is_known(known, *known_count, &sheet))
    {
      continue;
    }
    const size_t before = *count;
    const mlim_status status = mlim_seeds_insert(complex, &crossing, distance, context, count);
    if (status != MLIM_OK)
    {
      return status;
    }
    if (*count > before)
    {
      known[(*known_count)++] = sheet;
    }
  }
  return MLIM_OK;
}

static mlim_status seed_block(
  mlim_complex* complex, const block* b, double distance, mlim_context* context, size_t* count)
{
  enum
  {
    MAX_SHEETS = 32 /* of one block; further ones wait for refinement */
  };
  mlim_sheet known[MAX_SHEETS];
  size_t known_count = 0;
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
        const mlim_status status =
          seed_point(complex, p, distance, known, &known_count, MAX_SHEETS, context, count);
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
  mlim_complex* complex, double distance, mlim_context* context, size_t* count)
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
    const mlim_status going = mlim_progress(context, MLIM_STAGE_SURFACE, 0);
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
