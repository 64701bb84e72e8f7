#include "crossings.h"

#include "field_index.h"

enum
{
  MAX_ON_EDGE = 8 /* label changes on one grid edge; more say nothing new */
};

/* Along a grid edge indicators are linear, so where two labels alone compete for a cell the crossing on
   its edge is a quotient. Returns 0 when there are more. */
static int cross_pair(const mlim_field* field, const int32_t low[3], int axis, mlim_crossing* out)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  int32_t cell[3];
  int corner = 0;
  for (int k = 0; k < 3; ++k)
  {
    const int is_last = low[k] == grid->cells[k];
    cell[k] = low[k] - is_last;
    corner |= is_last << k;
  }
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

static void visit_edge(
  const mlim_oracle* oracle, const int32_t low[3], int axis, mlim_crossing_visit visit, void* user)
{
  const mlim_field_grid* grid = mlim_field_grid_of(oracle->field);
  int32_t high[3] = { low[0], low[1], low[2] };
  ++high[axis];
  mlim_crossing crossing[MAX_ON_EDGE];
  if (cross_pair(oracle->field, low, axis, crossing))
  {
    visit(user, low, high, crossing);
    return;
  }
  double start[3];
  double end[3];
  for (int k = 0; k < 3; ++k)
  {
    start[k] = low[k] * grid->spacing[k];
    end[k] = high[k] * grid->spacing[k];
  }
  const size_t count = mlim_oracle_crossings(oracle, start, end, MAX_ON_EDGE, crossing);
  for (size_t c = 0; c < count; ++c)
  {
    visit(user, low, high, &crossing[c]);
  }
}

void mlim_crossings_of_slice(
  const mlim_oracle* oracle, int32_t z, mlim_crossing_visit visit, void* user)
{
  const int32_t* dims = mlim_field_grid_of(oracle->field)->dims;
  const size_t steps[3] = { 1, (size_t)dims[0], (size_t)dims[0] * (size_t)dims[1] };
  const uint16_t* label = mlim_field_point_labels(oracle->field) + steps[2] * (size_t)z;
  int32_t p[3] = { 0, 0, z };
  for (p[1] = 0; p[1] < dims[1]; ++p[1])
  {
    for (p[0] = 0; p[0] < dims[0]; ++p[0], ++label)
    {
      for (int axis = 0; axis < 3; ++axis)
      {
        if (p[axis] + 1 < dims[axis] && label[steps[axis]] != *label)
        {
          visit_edge(oracle, p, axis, visit, user);
        }
      }
    }
  }
}
