#include "crossings.h"

enum
{
  MAX_ON_EDGE = 8 /* label changes on one grid edge; more say nothing new */
};

static void visit_edge(
  const mlim_oracle* oracle, const int32_t low[3], int axis, mlim_crossing_visit visit, void* user)
{
  const mlim_field_grid* grid = mlim_field_grid_of(oracle->field);
  int32_t high[3] = { low[0], low[1], low[2] };
  ++high[axis];
  double start[3];
  double end[3];
  for (int k = 0; k < 3; ++k)
  {
    start[k] = low[k] * grid->spacing[k];
    end[k] = high[k] * grid->spacing[k];
  }
  mlim_crossing crossing[MAX_ON_EDGE];
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
