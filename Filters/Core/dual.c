#include "dual.h"

#include "vector.h"

enum
{
  MAX_CROSSINGS = 16 /* on one dual; more of them change nothing: it is refined anyway */
};

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

static void take(
  const mlim_crossing* crossing, size_t count, const double vertex[3], mlim_dual* dual)
{
  dual->crosses = count > 0;
  if (count > 0)
  {
    const mlim_crossing* far = &crossing[farthest(crossing, count, vertex)];
    mlim_copy(far->point, dual->crossing);
    dual->sheet = sheet_between(far->from, far->to, far->face);
    dual->is_multiple = count > 1 || dual->labels[0] == dual->labels[1];
  }
}

/* At most MLIM_SEGMENTS of them. */
static void cross_some(
  const mlim_oracle* oracle, const mlim_vertex* vertices, mlim_dual* const* duals, size_t count)
{
  mlim_segment segments[MLIM_SEGMENTS] = { 0 };
  mlim_crossing crossings[MLIM_SEGMENTS][MAX_CROSSINGS];
  size_t counts[MLIM_SEGMENTS];
  for (size_t k = 0; k < count; ++k)
  {
    const mlim_dual* dual = duals[k];
    segments[k] = (mlim_segment){ .ends = { dual->ends[0], dual->ends[1] },
      .labels = { dual->labels[0], dual->labels[1] },
      .clearances = { dual->clearances[0], dual->clearances[1] } };
  }
  mlim_oracle_cross_all(oracle, segments, count, MAX_CROSSINGS, crossings[0], counts);
  for (size_t k = 0; k < count; ++k)
  {
    take(crossings[k], counts[k], vertices[duals[k]->vertices[0]].point, duals[k]);
  }
}

void mlim_duals_cross(
  const mlim_oracle* oracle, const mlim_vertex* vertices, mlim_dual* duals, size_t count)
{
  mlim_dual* open[MLIM_SEGMENTS];
  size_t open_count = 0;
  for (size_t k = 0; k < count; ++k)
  {
    open[open_count] = &duals[k];
    open_count += duals[k].is_open;
    if (open_count == MLIM_SEGMENTS)
    {
      cross_some(oracle, vertices, open, open_count);
      open_count = 0;
    }
  }
  if (open_count > 0)
  {
    cross_some(oracle, vertices, open, open_count);
  }
}
