#include "dual.h"

#include "vector.h"

#include <math.h>

enum
{
  MAX_CROSSINGS = 16 /* on one dual; more of them change nothing: it is refined anyway */
};

static float widen(const mlim_cell* cell)
{
  return (float)cell->clearance / MLIM_CLEARANCE_PARTS;
}

/* Round each end lies a cube of its label, and the two cover the dual together. */
int mlim_dual_is_clear(const mlim_complex* complex, int32_t cell, int32_t other)
{
  const double* inverse = mlim_field_grid_of(complex->oracle.field)->inverse_spacing;
  const double* start = mlim_complex_center(complex, cell);
  const double* end = mlim_complex_center(complex, other);
  double longest = 0;
  for (int k = 0; k < 3; ++k)
  {
    longest = mlim_max(longest, fabs(start[k] - end[k]) * inverse[k]);
  }
  return longest * MLIM_CLEARANCE_PARTS <=
         complex->cells[cell].clearance + complex->cells[other].clearance;
}

void mlim_dual_copy(const mlim_complex* complex, int32_t cell, int index, mlim_dual* out)
{
  const mlim_cell* own = &complex->cells[cell];
  const int32_t n = own->neighbors[index];
  const mlim_cell* other = &complex->cells[n];
  out->cells[0] = cell;
  out->cells[1] = n;
  out->labels[0] = own->label;
  out->labels[1] = other->label;
  out->clearances[0] = widen(own);
  out->clearances[1] = widen(other);
  out->indices[0] = (unsigned char)index;
  out->indices[1] = (unsigned char)mlim_complex_index_apart(other, own);
  mlim_copy(mlim_complex_center(complex, cell), out->ends[0]);
  mlim_copy(mlim_complex_center(complex, n), out->ends[1]);
  mlim_copy(complex->vertices[own->vertices[(index + 1) & 3]].point, out->vertex);
}

/* The crossing farthest from the facet: Chew's rule. All its vertices are equally far in power. */
static size_t farthest(const mlim_crossing* crossing, size_t count, const double vertex[3])
{
  size_t best = 0;
  double most = -1;
  for (size_t c = 0; c < count; ++c)
  {
    const double d = mlim_distance_squared(crossing[c].point, vertex);
    if (d > most)
    {
      most = d;
      best = c;
    }
  }
  return best;
}

static mlim_sheet sheet_between(int32_t from, int32_t to, int32_t face)
{
  const int is_up = from < to;
  return (mlim_sheet){ .low = (uint16_t)(is_up ? from : to),
    .high = (uint16_t)(is_up ? to : from),
    .face = (signed char)face };
}

static void take(const mlim_crossing* crossing, size_t count, mlim_dual* dual)
{
  dual->crosses = count > 0;
  if (count > 0)
  {
    const mlim_crossing* far = &crossing[farthest(crossing, count, dual->vertex)];
    mlim_copy(far->point, dual->crossing);
    dual->sheet = sheet_between(far->from, far->to, far->face);
    dual->is_multiple = count > 1 || dual->labels[0] == dual->labels[1];
  }
}

void mlim_duals_cross(const mlim_oracle* oracle, mlim_dual* duals, size_t count)
{
  mlim_segment segments[MLIM_SEGMENTS];
  mlim_crossing crossings[MLIM_SEGMENTS][MAX_CROSSINGS];
  size_t counts[MLIM_SEGMENTS];
  for (size_t begin = 0; begin < count; begin += MLIM_SEGMENTS)
  {
    const size_t some = count - begin < MLIM_SEGMENTS ? count - begin : MLIM_SEGMENTS;
    for (size_t k = 0; k < some; ++k)
    {
      const mlim_dual* dual = &duals[begin + k];
      segments[k] = (mlim_segment){ .ends = { dual->ends[0], dual->ends[1] },
        .labels = { dual->labels[0], dual->labels[1] },
        .clearances = { dual->clearances[0], dual->clearances[1] } };
    }
    mlim_oracle_cross_all(oracle, segments, some, MAX_CROSSINGS, crossings[0], counts);
    for (size_t k = 0; k < some; ++k)
    {
      take(crossings[k], counts[k], &duals[begin + k]);
    }
  }
}
