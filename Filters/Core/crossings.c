#include "crossings.h"

#include "field_index.h"

#include <string.h>

enum
{
  MAX_ON_EDGE = 8, /* label changes on one grid edge; more say nothing new */
  EDGES = 32,      /* that wait for memory together */
  POINTS = 32      /* of a row that are compared with their neighbours together */
};

/* A cell that has the grid point, which is corner `corner` of it. */
static int find_cell(const mlim_field_grid* grid, const int32_t point[3], int32_t cell[3])
{
  int corner = 0;
  for (int k = 0; k < 3; ++k)
  {
    const int is_last = point[k] == grid->cells[k];
    cell[k] = point[k] - is_last;
    corner |= is_last << k;
  }
  return corner;
}

/* Along a grid edge indicators are linear, so where two labels alone compete for a cell the crossing on
   its edge is a quotient. Returns 0 when there are more. */
static int cross_pair(const mlim_field* field, const int32_t low[3], int axis, mlim_crossing* out)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  int32_t cell[3];
  const int corner = find_cell(grid, low, cell);
  const uint32_t word = field_cell_word(field, cell);
  if (!(word & (uint32_t)MIXED) || (word & (uint32_t)MANY))
  {
    return 0;
  }
  const uint32_t* entry = field_pool_entry(field, cell, word);
  const double before = (double)field_float(entry[1 + corner]);
  const double after = (double)field_float(entry[1 + (corner | 1 << axis)]);
  const int32_t first = (int32_t)(entry[0] & 0xffffu);
  const int32_t second = (int32_t)(entry[0] >> 16);
  if ((before >= 0) == (after >= 0))
  {
    return 0;
  }
  *out = (mlim_crossing){
    .from = before >= 0 ? first : second, .to = before >= 0 ? second : first, .face = -1
  };
  for (int k = 0; k < 3; ++k)
  {
    const double along = k == axis ? before / (before - after) : 0;
    out->point[k] = (low[k] + along) * grid->spacing[k];
  }
  return 1;
}

/* Edges of the grid whose ends differ in label, with what they wait for on its way from memory. */
typedef struct batch
{
  const mlim_oracle* oracle;
  mlim_crossings_visit visit;
  void* user;
  size_t edge_count;
  struct
  {
    int32_t low[3];
    int32_t cell[3];
    int axis;
  } edges[EDGES];
  size_t count;
  mlim_grid_crossing crossings[EDGES + MAX_ON_EDGE];
} batch;

static void hand_over(batch* b)
{
  if (b->count > 0)
  {
    b->visit(b->user, b->crossings, b->count);
  }
  b->count = 0;
}

static void cross_edge(batch* b, const int32_t low[3], int axis)
{
  const mlim_field_grid* grid = mlim_field_grid_of(b->oracle->field);
  int32_t high[3] = { low[0], low[1], low[2] };
  ++high[axis];
  mlim_crossing crossing[MAX_ON_EDGE];
  size_t count = (size_t)cross_pair(b->oracle->field, low, axis, crossing);
  if (count == 0)
  {
    double start[3];
    double end[3];
    for (int k = 0; k < 3; ++k)
    {
      start[k] = low[k] * grid->spacing[k];
      end[k] = high[k] * grid->spacing[k];
    }
    count = mlim_oracle_crossings(b->oracle, start, end, MAX_ON_EDGE, crossing);
  }
  for (size_t c = 0; c < count; ++c)
  {
    mlim_grid_crossing* out = &b->crossings[b->count++];
    out->crossing = crossing[c];
    memcpy(out->low, low, sizeof out->low);
    memcpy(out->high, high, sizeof out->high);
  }
}

static void cross_edges(batch* b)
{
  const mlim_field* field = b->oracle->field;
  for (size_t e = 0; e < b->edge_count; ++e)
  {
    find_cell(mlim_field_grid_of(field), b->edges[e].low, b->edges[e].cell);
    field_word_ahead(field, b->edges[e].cell);
  }
  for (size_t e = 0; e < b->edge_count; ++e)
  {
    field_entry_ahead(field, b->edges[e].cell);
  }
  for (size_t e = 0; e < b->edge_count; ++e)
  {
    cross_edge(b, b->edges[e].low, b->edges[e].axis);
    if (b->count >= EDGES)
    {
      hand_over(b);
    }
  }
  b->edge_count = 0;
}

/* Grid points of a row, and how far it is from each to the next one along each axis; 0 where there is none. */
typedef struct grid_row
{
  const uint16_t* labels;
  size_t steps[3];
} grid_row;

/* Whether an edge that begins at one of some points has two labels. Without branches, so that compilers take
   many points at a time. */
static int has_change(const uint16_t* labels, const size_t steps[3])
{
  uint16_t changes = 0;
  for (size_t k = 0; k < POINTS; ++k)
  {
    changes |= (uint16_t)((labels[k] ^ labels[k + steps[0]]) | (labels[k] ^ labels[k + steps[1]]) |
                          (labels[k] ^ labels[k + steps[2]]));
  }
  return changes != 0;
}

static void add_edges(batch* b, const grid_row* row, const int32_t point[3])
{
  const uint16_t* label = row->labels + point[0];
  for (int axis = 0; axis < 3; ++axis)
  {
    if (label[row->steps[axis]] != *label)
    {
      memcpy(b->edges[b->edge_count].low, point, sizeof b->edges->low);
      b->edges[b->edge_count++].axis = axis;
      if (b->edge_count == EDGES)
      {
        cross_edges(b);
      }
    }
  }
}

static void cross_row(batch* b, grid_row* row, int32_t y, int32_t z)
{
  const int32_t count = mlim_field_grid_of(b->oracle->field)->dims[0];
  for (int32_t begin = 0; begin < count; begin += POINTS)
  {
    const int32_t end = begin + POINTS < count ? begin + POINTS : count;
    if (end < count && !has_change(row->labels + begin, row->steps))
    {
      continue;
    }
    for (int32_t x = begin; x < end; ++x)
    {
      row->steps[0] = x + 1 < count;
      add_edges(b, row, (const int32_t[3]){ x, y, z });
    }
  }
}

void mlim_crossings_of_slice(
  const mlim_oracle* oracle, int32_t z, mlim_crossings_visit visit, void* user)
{
  const int32_t* dims = mlim_field_grid_of(oracle->field)->dims;
  const size_t width = (size_t)dims[0];
  const size_t slice = width * (size_t)dims[1];
  const uint16_t* labels = mlim_field_point_labels(oracle->field) + slice * (size_t)z;
  batch b = { .oracle = oracle, .visit = visit, .user = user };
  for (int32_t y = 0; y < dims[1]; ++y)
  {
    grid_row row = { .labels = labels + width * (size_t)y,
      .steps = { 1, y + 1 < dims[1] ? width : 0, z + 1 < dims[2] ? slice : 0 } };
    cross_row(&b, &row, y, z);
  }
  cross_edges(&b);
  hand_over(&b);
}
