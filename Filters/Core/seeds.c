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

/* The way from a grid point to the next one in a direction, or out of the box. */
typedef struct grid_edge
{
  double ends[2][3];
} grid_edge;

static grid_edge edge_from(const mlim_complex* complex, const int32_t point[3], int side)
{
  const mlim_field_grid* grid = mlim_field_grid_of(complex->oracle.field);
  const int axis = side >> 1;
  grid_edge edge;
  for (int k = 0; k < 3; ++k)
  {
    edge.ends[0][k] = point[k] * grid->spacing[k];
    edge.ends[1][k] = edge.ends[0][k];
  }
  edge.ends[1][axis] = (point[axis] + (side & 1 ? 1 : -1)) * grid->spacing[axis];
  return edge;
}

/* The first crossing of an edge; 0: there is none. */
static int cross_edge(const mlim_complex* complex, const grid_edge* edge, mlim_crossing* out)
{
  return mlim_oracle_crossings(&complex->oracle, edge->ends[0], edge->ends[1], 1, out) == 1;
}

mlim_status mlim_seeds_start(
  mlim_complex* complex, double distance, mlim_context* context, mlim_seeds* out)
{
  *out = (mlim_seeds){ .complex = complex, .distance = distance };
  return mlim_nearby_create(complex, distance, context, &out->nearby);
}

void mlim_seeds_free(mlim_seeds* seeds)
{
  mlim_nearby_free(&seeds->nearby);
  *seeds = (mlim_seeds){ 0 };
}

static int is_too_near(const mlim_seeds* seeds, const double point[3], int32_t vertex)
{
  const mlim_vertex* v = &seeds->complex->vertices[vertex];
  return mlim_distance_squared(v->point, point) - v->weight < seeds->distance * seeds->distance;
}

/* Whether wherever an edge is crossed that is too near to the vertex of its block: what is near is a ball. */
static int is_edge_too_near(const mlim_seeds* seeds, const grid_edge* edge)
{
  const int32_t vertex = *mlim_nearby_at(&seeds->nearby, edge->ends[0]);
  return vertex >= 0 && is_too_near(seeds, edge->ends[0], vertex) &&
         is_too_near(seeds, edge->ends[1], vertex);
}

/* A vertex of the cells that is too near; -1: none. */
static int32_t find_too_near(
  const mlim_seeds* seeds, const double point[3], const int32_t* cells, size_t count)
{
  for (size_t c = 0; c < count; ++c)
  {
    const int32_t* vertices = seeds->complex->cells[cells[c]].vertices;
    for (int k = 0; k < 4; ++k)
    {
      if (is_too_near(seeds, point, vertices[k]))
      {
        return vertices[k];
      }
    }
  }
  return -1;
}

/* Inserts the vertex unless it is too near to another. Most seeds are, and one vertex suffices to tell: the
   block's, which was too near to the last one there, or one of the cell's. */
static mlim_status try_vertex(
  mlim_seeds* seeds, const mlim_vertex* vertex, mlim_context* context, size_t* count)
{
  mlim_complex* complex = seeds->complex;
  int32_t* block = mlim_nearby_at(&seeds->nearby, vertex->point);
  if (*block >= 0 && is_too_near(seeds, vertex->point, *block))
  {
    return MLIM_OK;
  }
  const int32_t last = complex->vertices[complex->vertex_count - 1].cell;
  const int32_t start = *block >= 0 ? complex->vertices[*block].cell : last;
  int32_t cell;
  mlim_status status =
    mlim_delaunay_locate(complex->delaunay, vertex->point, start, context, &cell);
  int32_t near = cell == MLIM_NO_CELL ? -1 : find_too_near(seeds, vertex->point, &cell, 1);
  int is_found = 0;
  if (status == MLIM_OK && near < 0)
  {
    /* A point on a facet is in several cells. That of a walk from the vertex before it is taken, from
       wherever the block would start: what is inserted depends on nothing else. */
    status =
      cell == MLIM_NO_CELL
        ? mlim_complex_probe(complex, vertex, last, MLIM_START_NEAR, context, &is_found)
        : mlim_complex_probe(complex, vertex, cell, MLIM_START_IN_CONFLICT, context, &is_found);
  }
  if (!is_found)
  {
    *block = near < 0 ? *block : near;
    return status;
  }
  near = find_too_near(seeds, vertex->point, complex->zone.cells, complex->zone.count);
  if (near < 0)
  {
    status = mlim_complex_commit(complex, context);
    near = status == MLIM_OK ? (int32_t)complex->vertex_count - 1 : *block;
    *count += status == MLIM_OK;
  }
  *block = near;
  return status;
}

mlim_status mlim_seeds_insert(
  mlim_seeds* seeds, const mlim_crossing* crossing, mlim_context* context, size_t* count)
{
  const int is_up = crossing->from < crossing->to;
  mlim_vertex vertex = { .kind = MLIM_VERTEX_SURFACE,
    .ball = -1,
    .sheet = { .low = is_up ? crossing->from : crossing->to,
      .high = is_up ? crossing->to : crossing->from,
      .face = crossing->face } };
  mlim_copy(crossing->point, vertex.point);
  return try_vertex(seeds, &vertex, context, count);
}

mlim_status mlim_seeds_on_components(mlim_complex* complex, const mlim_components* components,
  const unsigned char* is_wanted, size_t min_voxels, mlim_context* context, size_t* count)
{
  *count = 0;
  const double distance = COMPONENT_SEED_DISTANCE * mlim_field_grid_of(complex->oracle.field)->unit;
  mlim_seeds seeds;
  mlim_status status = mlim_seeds_start(complex, distance, context, &seeds);
  for (size_t c = 0; c < components->count && status == MLIM_OK; ++c)
  {
    const mlim_component* component = &components->components[c];
    if (component->voxel_count < min_voxels || (is_wanted != NULL && !is_wanted[c]))
    {
      continue;
    }
    for (int side = 0; side < 6 && status == MLIM_OK; ++side)
    {
      mlim_crossing crossing;
      const grid_edge edge = edge_from(complex, component->extremes[side], side);
      if (cross_edge(complex, &edge, &crossing))
      {
        status = mlim_seeds_insert(&seeds, &crossing, context, count);
      }
    }
  }
  mlim_seeds_free(&seeds);
  return status;
}

/* ---- blocks ---- */

typedef struct block
{
  const uint16_t* labels; /* of all grid points */
  const int32_t* dims;
  int32_t low[3];
  int32_t high[3]; /* past the last grid point */
} block;

enum
{
  RUN = 8,         /* points that are looked at together */
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
static int is_inner(const block* b, const int32_t point[3])
{
  const size_t row = (size_t)b->dims[0];
  const size_t steps[3] = { 1, row, row * (size_t)b->dims[1] };
  const uint16_t* label =
    b->labels + (size_t)point[0] + row * (size_t)point[1] + steps[2] * (size_t)point[2];
  for (int k = 0; k < 3; ++k)
  {
    if (point[k] == 0 || point[k] + 1 == b->dims[k] || label[steps[k]] != *label)
    {
      return 0;
    }
  }
  return 1;
}

/* The same for RUN points along x from one on. All of them, and the next one, are off the box's faces.
   Without branches: nearly all runs are. */
static int is_inner_run(const block* b, const int32_t first[3])
{
  const size_t row = (size_t)b->dims[0];
  const uint16_t* here =
    b->labels + (size_t)first[0] + row * ((size_t)first[1] + (size_t)b->dims[1] * (size_t)first[2]);
  const uint16_t* above = here + row;
  const uint16_t* behind = here + row * (size_t)b->dims[1];
  unsigned differs = 0;
  for (size_t x = 0; x < RUN; ++x)
  {
    differs |= (unsigned)((here[x] ^ here[x + 1]) | (here[x] ^ above[x]) | (here[x] ^ behind[x]));
  }
  return differs == 0;
}

/* The sheet between a grid point and what lies beyond one of its sides: the next point, or the
   outside. Equal labels when there is none, and on the side of a point before, which has looked already. */
static mlim_sheet sheet_beyond(
  const block* b, int32_t outside_label, const int32_t point[3], int side)
{
  const int axis = side >> 1;
  const size_t row = (size_t)b->dims[0];
  const size_t steps[3] = { 1, row, row * (size_t)b->dims[1] };
  const uint16_t* here =
    b->labels + (size_t)point[0] + row * (size_t)point[1] + steps[2] * (size_t)point[2];
  const int is_out = side & 1 ? point[axis] + 1 == b->dims[axis] : point[axis] == 0;
  const int32_t label = *here;
  const int32_t other = is_out ? outside_label : side & 1 ? here[steps[axis]] : label;
  return (mlim_sheet){ .low = (uint16_t)(label < other ? label : other),
    .high = (uint16_t)(label < other ? other : label),
    .face = (signed char)(is_out ? side : -1) };
}

static mlim_status seed_point(mlim_seeds* seeds, const block* b, const int32_t point[3],
  sheet_list* list, mlim_context* context, size_t* count)
{
  const mlim_complex* complex = seeds->complex;
  const int32_t outside = mlim_field_outside_label(complex->oracle.field);
  for (int side = 0; side < 6; ++side)
  {
    mlim_crossing crossing;
    const mlim_sheet sheet = sheet_beyond(b, outside, point, side);
    if (sheet.low == sheet.high)
    {
      continue;
    }
    const size_t place = place_of(list, &sheet);
    if (place == MAX_SHEETS || list->tries[place] == MAX_TRIES)
    {
      continue;
    }
    const grid_edge edge = edge_from(complex, point, side);
    if (is_edge_too_near(seeds, &edge))
    {
      ++list->tries[place];
      continue;
    }
    if (!cross_edge(complex, &edge, &crossing))
    {
      continue;
    }
    const size_t before = *count;
    const mlim_status status = mlim_seeds_insert(seeds, &crossing, context, count);
    if (status != MLIM_OK)
    {
      return status;
    }
    list->tries[place] = *count > before ? MAX_TRIES : list->tries[place] + 1;
  }
  return MLIM_OK;
}

/* One row of a block. */
static mlim_status seed_row(mlim_seeds* seeds, const block* b, const int32_t row[3],
  sheet_list* list, mlim_context* context, size_t* count)
{
  const int is_off_faces =
    row[1] > 0 && row[1] + 1 < b->dims[1] && row[2] > 0 && row[2] + 1 < b->dims[2];
  mlim_status status = MLIM_OK;
  for (int32_t x = b->low[0]; x < b->high[0] && status == MLIM_OK; ++x)
  {
    const int32_t point[3] = { x, row[1], row[2] };
    const int is_run = is_off_faces && (x - b->low[0]) % RUN == 0 && x > 0 && b->high[0] - x > RUN;
    if (is_run && is_inner_run(b, point))
    {
      x += RUN - 1;
    }
    else if (!is_inner(b, point))
    {
      status = seed_point(seeds, b, point, list, context, count);
    }
  }
  return status;
}

static mlim_status seed_block(
  mlim_seeds* seeds, const block* b, mlim_context* context, size_t* count)
{
  sheet_list list = { .count = 0 };
  mlim_status status = MLIM_OK;
  int32_t row[3] = { 0 };
  for (row[2] = b->low[2]; row[2] < b->high[2] && status == MLIM_OK; ++row[2])
  {
    for (row[1] = b->low[1]; row[1] < b->high[1] && status == MLIM_OK; ++row[1])
    {
      status = seed_row(seeds, b, row, &list, context, count);
    }
  }
  return status;
}

/* Blocks of so many grid points along each axis. */
static mlim_status seed_blocks(
  mlim_seeds* seeds, const int32_t side[3], double done, mlim_context* context, size_t* count)
{
  const int32_t* dims = mlim_field_grid_of(seeds->complex->oracle.field)->dims;
  block b = { .labels = mlim_field_point_labels(seeds->complex->oracle.field), .dims = dims };
  for (b.low[2] = 0; b.low[2] < dims[2]; b.low[2] += side[2])
  {
    const mlim_status going = mlim_progress(context, MLIM_STAGE_SURFACE, done);
    if (going != MLIM_OK)
    {
      return going;
    }
    for (b.low[1] = 0; b.low[1] < dims[1]; b.low[1] += side[1])
    {
      for (b.low[0] = 0; b.low[0] < dims[0]; b.low[0] += side[0])
      {
        for (int k = 0; k < 3; ++k)
        {
          b.high[k] = dims[k] - b.low[k] > side[k] ? b.low[k] + side[k] : dims[k];
        }
        const mlim_status status = seed_block(seeds, &b, context, count);
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
  for (int k = 0; k < 3; ++k)
  {
    const double points = mlim_min(ceil(BLOCK_SIDE * distance / grid->spacing[k]), grid->dims[k]);
    side[k] = points < 2 ? 2 : (int32_t)points;
  }
  mlim_seeds seeds;
  mlim_status status = mlim_seeds_start(complex, distance, context, &seeds);
  status = status == MLIM_OK ? seed_blocks(&seeds, side, done, context, count) : status;
  mlim_seeds_free(&seeds);
  return status;
}
