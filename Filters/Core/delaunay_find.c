#include "delaunay_parts.h"

#include "memory.h"
#include "predicates.h"
#include "status.h"

#include <string.h>

/* On which side of a facet the point is: above 0, inside. */
static mlim_status side_of_facet(
  const mlim_delaunay* d, int32_t cell, int index, mlim_context* context, int* out)
{
  const double* corners[4];
  delaunay_corners(d, cell, corners);
  corners[index] = d->point.at;
  return mlim_predicates_orientation(corners[0], corners[1], corners[2], corners[3], context, out);
}

/* Walks from a cell to the one that has the point, MLIM_NO_CELL outside. A step goes through a facet that
   separates the cell from the point. In a weighted Delaunay triangulation no such walk comes back to
   a cell: the power of the point with respect to the cells grows. *is_inner: no other cell has it. */
static mlim_status locate(
  mlim_delaunay* d, int32_t start, mlim_context* context, int32_t* out, int* is_inner)
{
  int32_t at = start;
  int32_t before = MLIM_NO_CELL;
  for (size_t step = 0; step <= d->cell_count; ++step)
  {
    const mlim_cell* cell = &d->cells[at];
    int exit = -1;
    *is_inner = 1;
    for (int k = 0; k < 4 && exit < 0; ++k)
    {
      int side = 1;
      if (before == MLIM_NO_CELL || cell->neighbors[k] != before)
      {
        const mlim_status status = side_of_facet(d, at, k, context, &side);
        if (status != MLIM_OK)
        {
          return status;
        }
      }
      exit = side < 0 ? k : exit;
      *is_inner &= side > 0;
    }
    *out = exit < 0 ? at : cell->neighbors[exit];
    if (exit < 0 || *out == MLIM_NO_CELL)
    {
      return MLIM_OK;
    }
    before = at;
    at = *out;
  }
  return mlim_fail(context, MLIM_INTERNAL, "A walk through the triangulation does not end.");
}

/* The sphere decides if it can, else exact arithmetic. */
static inline mlim_status is_in_conflict(
  const mlim_delaunay* d, int32_t cell, mlim_context* context, int* out)
{
  const int side =
    mlim_power_sphere_side(&d->spheres[cell], &d->cells[cell].bound, d->point.at, d->point.at[3]);
  *out = side < 0;
  if (side != 0)
  {
    return MLIM_OK;
  }
  const double* corners[4];
  delaunay_corners(d, cell, corners);
  return mlim_predicates_conflict(corners, d->point.at, context, out);
}

/* Marks of cells: the stamp for one without conflict, and one more for one in conflict. */
static void next_stamp(mlim_delaunay* d)
{
  if (d->stamp > UINT32_MAX - 4)
  {
    for (size_t c = 0; c < d->cell_count; ++c)
    {
      d->cells[c].seen = 0;
    }
    d->stamp = 0;
  }
  d->stamp += 2;
}

/* Room for what one more cell of the zone may add. Not 0: out of memory. */
static int reserve_zone(mlim_delaunay* d)
{
  return mlim_reserve(&d->zone, &d->zone_capacity, d->zone_count + 4, sizeof *d->zone) ||
         mlim_reserve(&d->border, &d->border_capacity, d->border_count + 4, sizeof *d->border) ||
         mlim_reserve(&d->around, &d->around_capacity, d->around_count + 12, sizeof *d->around);
}

static inline int is_around(const mlim_delaunay* d, int32_t vertex)
{
  const size_t place = (size_t)d->places[vertex];
  return place < d->around_count && d->around[place] == vertex;
}

static inline void add_border(mlim_delaunay* d, const mlim_cell* cell, int32_t id, int index)
{
  delaunay_facet* facet = &d->border[d->border_count++];
  facet->outer = cell->neighbors[index];
  if (facet->outer != MLIM_NO_CELL)
  {
    const int32_t* n = d->cells[facet->outer].neighbors;
    facet->index = (n[1] == id) + 2 * (n[2] == id) + 3 * (n[3] == id);
  }
  delaunay_facet_of(cell, index, facet->vertices);
  for (int k = 0; k < 3; ++k)
  {
    const int32_t v = facet->vertices[k];
    if (!is_around(d, v))
    {
      d->places[v] = (int32_t)d->around_count;
      d->around[d->around_count++] = v;
      mlim_prefetch(&d->vertices[v]); /* for the spheres of the new cells */
    }
    facet->places[k] = d->places[v];
  }
}

/* Sends for the neighbours of a cell, which are about to be looked at: the search waits for memory most of
   the time. */
static inline void fetch_neighbors(const mlim_delaunay* d, int32_t id)
{
  for (int k = 0; k < 4; ++k)
  {
    const int32_t n = d->cells[id].neighbors[k];
    if (n != MLIM_NO_CELL)
    {
      mlim_prefetch(&d->cells[n]);
      mlim_prefetch(&d->spheres[n]);
    }
  }
}

/* Looks at the neighbours of a cell of the zone. *is_inside becomes 0 where the point is not inside a facet
   of the hull. */
static mlim_status visit(mlim_delaunay* d, int32_t id, mlim_context* context, int* is_inside)
{
  const mlim_cell* cell = &d->cells[id];
  for (int k = 0; k < 4; ++k)
  {
    const int32_t n = cell->neighbors[k];
    if (n == MLIM_NO_CELL)
    {
      int side;
      const mlim_status status = side_of_facet(d, id, k, context, &side);
      if (status != MLIM_OK)
      {
        return status;
      }
      *is_inside &= side > 0;
      add_border(d, cell, id, k);
      continue;
    }
    mlim_cell* other = &d->cells[n];
    if (other->seen < d->stamp)
    {
      int is_hit;
      const mlim_status status = is_in_conflict(d, n, context, &is_hit);
      if (status != MLIM_OK)
      {
        return status;
      }
      other->seen = d->stamp + (uint32_t)is_hit;
      if (is_hit)
      {
        d->zone[d->zone_count++] = n;
        fetch_neighbors(d, n);
      }
    }
    if (other->seen == d->stamp)
    {
      add_border(d, cell, id, k);
    }
  }
  return MLIM_OK;
}

/* A vertex of the zone that is not on its border would vanish. */
static int hides_vertex(const mlim_delaunay* d)
{
  for (size_t z = 0; z < d->zone_count; ++z)
  {
    const int32_t* v = d->cells[d->zone[z]].vertices;
    if (!is_around(d, v[0]) || !is_around(d, v[1]) || !is_around(d, v[2]) || !is_around(d, v[3]))
    {
      return 1;
    }
  }
  return 0;
}

/* Collects the zone and its border from a cell in conflict. */
static mlim_status collect(mlim_delaunay* d, int32_t start, mlim_context* context)
{
  next_stamp(d);
  if (reserve_zone(d))
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  d->zone[d->zone_count++] = start;
  d->cells[start].seen = d->stamp + 1;
  fetch_neighbors(d, start);
  int is_inside = 1;
  for (size_t z = 0; z < d->zone_count && is_inside; ++z)
  {
    if (reserve_zone(d))
    {
      return mlim_fail_memory(context, "the triangulation");
    }
    const mlim_status status = visit(d, d->zone[z], context, &is_inside);
    if (status != MLIM_OK)
    {
      return status;
    }
  }
  d->has_zone = is_inside && !hides_vertex(d);
  return MLIM_OK;
}

mlim_status mlim_delaunay_locate(mlim_delaunay* delaunay, const double point[3], int32_t start,
  mlim_context* context, int32_t* out)
{
  mlim_delaunay* d = delaunay;
  int is_inner = 0;
  d->has_zone = 0;
  memcpy(d->point.at, point, 3 * sizeof *point);
  const mlim_status status = locate(d, start, context, out, &is_inner);
  *out = status == MLIM_OK && is_inner ? *out : MLIM_NO_CELL;
  return status;
}

mlim_status mlim_delaunay_find(mlim_delaunay* delaunay, const double point[3], double weight,
  int32_t start, mlim_delaunay_start kind, mlim_context* context, mlim_delaunay_zone* out)
{
  *out = (mlim_delaunay_zone){ 0 };
  mlim_delaunay* d = delaunay;
  d->has_zone = 0;
  d->zone_count = d->border_count = d->around_count = 0;
  memcpy(d->point.at, point, 3 * sizeof *point);
  d->point.at[3] = weight;
  int32_t from = start == MLIM_NO_CELL ? d->last : start;
  int is_inner;
  mlim_status status =
    kind == MLIM_START_NEAR ? locate(d, from, context, &from, &is_inner) : MLIM_OK;
  if (status != MLIM_OK || from == MLIM_NO_CELL)
  {
    return status;
  }
  int is_hit;
  status = is_in_conflict(d, from, context, &is_hit);
  if (status != MLIM_OK || !is_hit)
  {
    return status;
  }
  status = collect(d, from, context);
  if (d->has_zone)
  {
    *out = (mlim_delaunay_zone){ .count = d->zone_count, .cells = d->zone };
  }
  return status;
}
