#include "delaunay_parts.h"

#include "memory.h"
#include "status.h"

enum
{
  NO_SLOT = -1
};

/* Slots of the hash table for a border: more than its edges. */
static size_t count_slots(const mlim_delaunay* d)
{
  size_t count = 1;
  while (count < 6 * d->border_count)
  {
    count *= 2;
  }
  return d->around_count > DELAUNAY_FEW ? count : 0;
}

/* Room for all that the insertion makes. Not 0: out of memory, and nothing has changed. */
static int reserve_fill(mlim_delaunay* d)
{
  const size_t free_count = d->free_count + d->zone_count;
  const size_t count = d->border_count;
  return 3 * count > INT32_MAX ||
         delaunay_reserve_cells(d, count > free_count ? count - free_count : 0) ||
         delaunay_reserve_vertices(d, 1) ||
         mlim_reserve_apart(&d->free_cells, &d->free_capacity, free_count, sizeof *d->free_cells) ||
         mlim_reserve(&d->made, &d->made_capacity, count, sizeof *d->made) ||
         mlim_reserve(&d->slots, &d->slot_capacity, count_slots(d), sizeof *d->slots);
}

/* Ids for the new cells, those of the zone first. */
static void take_ids(mlim_delaunay* d)
{
  for (size_t z = d->zone_count; z > 0; --z)
  {
    d->cells[d->zone[z - 1]].vertices[0] = -1;
    d->free_cells[d->free_count++] = d->zone[z - 1];
  }
  for (size_t k = 0; k < d->border_count; ++k)
  {
    d->made[k] = d->free_count > 0 ? d->free_cells[--d->free_count] : (int32_t)d->cell_count++;
  }
}

/* A cell on each facet of the border, linked to what is outside; what the client knows of the facet is there. */
static void make_cells(mlim_delaunay* d, int32_t vertex)
{
  for (size_t k = 0; k < d->border_count; ++k)
  {
    const delaunay_facet* facet = &d->border[k];
    const int32_t* v = facet->vertices;
    mlim_cell* cell = &d->cells[d->made[k]];
    *cell = (mlim_cell){ .vertices = { vertex, v[0], v[1], v[2] }, .neighbors = { facet->outer } };
    if (facet->outer != MLIM_NO_CELL)
    {
      mlim_cell* outer = &d->cells[facet->outer];
      outer->neighbors[facet->index] = d->made[k];
      cell->facets[0] = outer->facets[facet->index];
    }
  }
}

/* Links the new cells with each other. Edge e of a facet, opposite to its vertex e, runs the other way round
   in the facet beyond it. */
static void link_few(mlim_delaunay* d)
{
  for (size_t k = 0; k < d->border_count; ++k)
  {
    const int32_t* p = d->border[k].places;
    d->edges[p[0]][p[1]] = d->edges[p[1]][p[2]] = d->edges[p[2]][p[0]] = (unsigned char)k;
  }
  for (size_t k = 0; k < d->border_count; ++k)
  {
    const int32_t* p = d->border[k].places;
    int32_t* neighbors = d->cells[d->made[k]].neighbors;
    neighbors[1] = d->made[d->edges[p[2]][p[1]]];
    neighbors[2] = d->made[d->edges[p[0]][p[2]]];
    neighbors[3] = d->made[d->edges[p[1]][p[0]]];
  }
}

/* The slot of the edge between two places, or the empty one where it belongs. */
static size_t slot_of(const mlim_delaunay* d, size_t mask, int32_t from, int32_t to)
{
  size_t slot = (uint32_t)from * 2654435761u + (uint32_t)to * 2246822519u;
  slot = (slot ^ slot >> 15) & mask;
  while (d->slots[slot] != NO_SLOT)
  {
    const int32_t* p = d->border[d->slots[slot] / 3].places;
    const int e = d->slots[slot] % 3;
    if (p[(e + 1) % 3] == from && p[(e + 2) % 3] == to)
    {
      break;
    }
    slot = (slot + 1) & mask;
  }
  return slot;
}

static void link_many(mlim_delaunay* d)
{
  const size_t mask = count_slots(d) - 1;
  for (size_t s = 0; s <= mask; ++s)
  {
    d->slots[s] = NO_SLOT;
  }
  for (int32_t k = 0; k < (int32_t)d->border_count; ++k)
  {
    const int32_t* p = d->border[k].places;
    for (int e = 0; e < 3; ++e)
    {
      d->slots[slot_of(d, mask, p[(e + 1) % 3], p[(e + 2) % 3])] = 3 * k + e;
    }
  }
  for (size_t k = 0; k < d->border_count; ++k)
  {
    const int32_t* p = d->border[k].places;
    for (int e = 0; e < 3; ++e)
    {
      const size_t slot = slot_of(d, mask, p[(e + 2) % 3], p[(e + 1) % 3]);
      d->cells[d->made[k]].neighbors[e + 1] = d->made[d->slots[slot] / 3];
    }
  }
}

mlim_status mlim_delaunay_fill(
  mlim_delaunay* delaunay, mlim_context* context, mlim_delaunay_zone* out)
{
  if (out != NULL)
  {
    *out = (mlim_delaunay_zone){ 0 };
  }
  mlim_delaunay* d = delaunay;
  if (!d->has_zone)
  {
    return mlim_fail(context, MLIM_INTERNAL, "A point was inserted without its zone.");
  }
  if (reserve_fill(d))
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  d->has_zone = 0;
  const int32_t vertex = (int32_t)d->vertex_count++;
  d->vertices[vertex] = (mlim_vertex){ .cell = 0 };
  memcpy(d->vertices[vertex].at, d->point.at, sizeof d->point.at);
  d->places[vertex] = 0;
  take_ids(d);
  make_cells(d, vertex);
  if (d->around_count > DELAUNAY_FEW)
  {
    link_many(d);
  }
  else
  {
    link_few(d);
  }
  d->last = d->made[0];
  const mlim_status status = delaunay_make_spheres(d, d->made, d->border_count, context);
  if (out != NULL && status == MLIM_OK)
  {
    *out = (mlim_delaunay_zone){ .count = d->border_count, .cells = d->made };
  }
  return status;
}
