#include "delaunay.h"

#include "memory.h"
#include "predicates.h"
#include "status.h"

#include <string.h>

enum
{
  FEW_PLACES = 64, /* borders with so many vertices have a table of edges; larger ones are hashed */
  NO_SLOT = -1,
  FIRST_CELLS = 1 << 8 /* more than there are fours of far vertices */
};

/* A facet between a dead cell and one that lives, or the outside. Its normal points out of the dead one. */
typedef struct border_facet
{
  int32_t outer, index; /* facet `index` of a cell, or MLIM_NO_CELL */
  int32_t vertices[3];
  int32_t places[3]; /* of the vertices in `around` */
} border_facet;

typedef struct weighted_point
{
  double at[4]; /* coordinates and weight */
} weighted_point;

struct mlim_delaunay
{
  mlim_cell* cells;
  mlim_power_sphere* spheres;
  size_t cell_count, cell_capacity, sphere_capacity;
  int32_t* free_cells; /* ids of dead cells, last in first out */
  size_t free_count, free_capacity;
  mlim_vertex* vertices;
  int32_t* places; /* a vertex: its place in `around`, if it is there */
  size_t vertex_count, vertex_capacity, place_capacity;
  int32_t last; /* a cell of the last insertion: what is asked for next is often near */
  uint32_t stamp;

  /* The last find. */
  weighted_point point;
  int has_zone;
  int32_t* zone; /* cells */
  size_t zone_count, zone_capacity;
  border_facet* border;
  size_t border_count, border_capacity;
  int32_t* around; /* vertices of the border */
  size_t around_count, around_capacity;

  /* The last fill. */
  int32_t* made; /* cell k on facet k of the border */
  size_t made_capacity;
  int32_t* slots; /* hashed edges of a large border */
  size_t slot_capacity;
  unsigned char edges[FEW_PLACES][FEW_PLACES]; /* of a small one: the facet that has the edge */
};

static void corners_of(const mlim_delaunay* d, int32_t cell, const double* out[4])
{
  for (int k = 0; k < 4; ++k)
  {
    out[k] = d->vertices[d->cells[cell].vertices[k]].at;
  }
}

/* The three vertices of facet `index`, so that its normal points out of the cell. */
static void facet_of(const mlim_cell* cell, int index, int32_t out[3])
{
  static const unsigned char order[4][3] = { { 1, 2, 3 }, { 0, 3, 2 }, { 0, 1, 3 }, { 0, 2, 1 } };
  for (int k = 0; k < 3; ++k)
  {
    out[k] = cell->vertices[order[index][k]];
  }
}

/* The centre is exact where the plain formula is not good enough; then the sphere decides nothing. */
static mlim_status make_sphere(mlim_delaunay* d, int32_t cell, mlim_context* context)
{
  const double* corners[4];
  double points[4][3];
  double weights[4];
  corners_of(d, cell, corners);
  for (int k = 0; k < 4; ++k)
  {
    memcpy(points[k], corners[k], sizeof points[k]);
    weights[k] = corners[k][3];
  }
  mlim_power_sphere* sphere = &d->spheres[cell];
  return mlim_power_sphere_make((const double(*)[3])points, weights, sphere, &d->cells[cell].bound)
           ? MLIM_OK
           : mlim_predicates_center(corners, context, sphere->center);
}

/* Room for so many more cells. Not 0: out of memory, or of ids. */
static int reserve_cells(mlim_delaunay* d, size_t count)
{
  const size_t needed = d->cell_count + count;
  return needed > INT32_MAX ||
         mlim_reserve_apart(&d->cells, &d->cell_capacity, needed, sizeof *d->cells) ||
         mlim_reserve_apart(&d->spheres, &d->sphere_capacity, needed, sizeof *d->spheres);
}

static int reserve_vertex(mlim_delaunay* d)
{
  const size_t needed = d->vertex_count + 1;
  return needed > INT32_MAX ||
         mlim_reserve_apart(&d->vertices, &d->vertex_capacity, needed, sizeof *d->vertices) ||
         mlim_reserve_apart(&d->places, &d->place_capacity, needed, sizeof *d->places);
}

/* ---- start ---- */

/* Makes a cell of four far vertices if it is one, that is, if its sphere is empty. Room is there. */
static mlim_status try_cell(mlim_delaunay* d, const int32_t vertices[4], mlim_context* context)
{
  mlim_cell* cell = &d->cells[d->cell_count];
  *cell = (mlim_cell){ .label = 0 };
  memcpy(cell->vertices, vertices, sizeof cell->vertices);
  const double* corners[4];
  corners_of(d, (int32_t)d->cell_count, corners);
  int side;
  mlim_status status =
    mlim_predicates_orientation(corners[0], corners[1], corners[2], corners[3], context, &side);
  if (side < 0)
  {
    cell->vertices[2] = vertices[3];
    cell->vertices[3] = vertices[2];
    corners_of(d, (int32_t)d->cell_count, corners);
  }
  int is_hit = side == 0;
  for (int v = 0; v < MLIM_FAR_VERTICES && status == MLIM_OK && !is_hit; ++v)
  {
    status = mlim_predicates_conflict(corners, d->vertices[v].at, context, &is_hit);
  }
  d->cell_count += status == MLIM_OK && !is_hit;
  return status;
}

static int has_vertex(const mlim_cell* cell, int32_t vertex)
{
  return cell->vertices[0] == vertex || cell->vertices[1] == vertex ||
         cell->vertices[2] == vertex || cell->vertices[3] == vertex;
}

/* The other cell that has facet `index` of a cell. */
static int32_t search_neighbor(const mlim_delaunay* d, int32_t id, int index)
{
  int32_t facet[3];
  facet_of(&d->cells[id], index, facet);
  for (size_t c = 0; c < d->cell_count; ++c)
  {
    const mlim_cell* other = &d->cells[c];
    if ((int32_t)c != id && has_vertex(other, facet[0]) && has_vertex(other, facet[1]) &&
        has_vertex(other, facet[2]))
    {
      return (int32_t)c;
    }
  }
  return MLIM_NO_CELL;
}

/* The cells of the far vertices: of all fours those whose sphere is empty. They lie in general position. */
static mlim_status make_first_cells(mlim_delaunay* d, mlim_context* context)
{
  if (reserve_cells(d, FIRST_CELLS))
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  mlim_status status = MLIM_OK;
  for (unsigned set = 0; set < 1u << MLIM_FAR_VERTICES && status == MLIM_OK; ++set)
  {
    int32_t vertices[MLIM_FAR_VERTICES];
    int count = 0;
    for (int32_t v = 0; v < MLIM_FAR_VERTICES; ++v)
    {
      vertices[count] = v;
      count += (int)(set >> v & 1);
    }
    status = count == 4 ? try_cell(d, vertices, context) : MLIM_OK;
  }
  for (size_t c = 0; c < d->cell_count && status == MLIM_OK; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      d->cells[c].neighbors[k] = search_neighbor(d, (int32_t)c, k);
    }
    status = make_sphere(d, (int32_t)c, context);
  }
  return status;
}

/* Far enough that no facet of the mesh can see them after the first insertions, near enough not
   to cost digits; off the cube's corners, since eight points on a sphere are a degenerate start. */
static mlim_status make_far_vertices(mlim_delaunay* d, const double size[3], mlim_context* context)
{
  double largest = size[0] > size[1] ? size[0] : size[1];
  largest = size[2] > largest ? size[2] : largest;
  for (int k = 0; k < MLIM_FAR_VERTICES; ++k)
  {
    if (reserve_vertex(d))
    {
      return mlim_fail_memory(context, "the triangulation");
    }
    const double off = 0.0078125 * k;
    const double shift[3] = { off, -0.75 * off, off * off * 3 };
    mlim_vertex* v = &d->vertices[d->vertex_count];
    *v = (mlim_vertex){ .cell = 0 };
    for (int a = 0; a < 3; ++a)
    {
      const double sign = k >> a & 1 ? 1 : -1;
      v->at[a] = 0.5 * size[a] + largest * (3 * sign + shift[a]);
    }
    d->places[d->vertex_count++] = 0;
  }
  return MLIM_OK;
}

mlim_status mlim_delaunay_create(const double size[3], mlim_context* context, mlim_delaunay** out)
{
  *out = NULL;
  mlim_delaunay* d = mlim_allocate_zeroed(1, sizeof *d);
  if (d == NULL)
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  mlim_status status = make_far_vertices(d, size, context);
  status = status == MLIM_OK ? make_first_cells(d, context) : status;
  if (status != MLIM_OK)
  {
    mlim_delaunay_free(d);
    return status;
  }
  *out = d;
  return MLIM_OK;
}

void mlim_delaunay_free(mlim_delaunay* delaunay)
{
  if (delaunay == NULL)
  {
    return;
  }
  mlim_release(delaunay->cells);
  mlim_release(delaunay->spheres);
  mlim_release(delaunay->free_cells);
  mlim_release(delaunay->vertices);
  mlim_release(delaunay->places);
  mlim_release(delaunay->zone);
  mlim_release(delaunay->border);
  mlim_release(delaunay->around);
  mlim_release(delaunay->made);
  mlim_release(delaunay->slots);
  mlim_release(delaunay);
}

mlim_vertex* mlim_delaunay_vertices(mlim_delaunay* delaunay)
{
  return delaunay->vertices;
}

mlim_delaunay_cells mlim_delaunay_all(mlim_delaunay* delaunay)
{
  return (mlim_delaunay_cells){
    .count = delaunay->cell_count, .cells = delaunay->cells, .spheres = delaunay->spheres
  };
}

/* ---- find ---- */

/* On which side of a facet the point is: above 0, inside. */
static mlim_status side_of_facet(
  const mlim_delaunay* d, int32_t cell, int index, mlim_context* context, int* out)
{
  const double* corners[4];
  corners_of(d, cell, corners);
  corners[index] = d->point.at;
  return mlim_predicates_orientation(corners[0], corners[1], corners[2], corners[3], context, out);
}

/* Walks from a cell to the one that has the point, MLIM_NO_CELL outside. A step goes through a facet that
   separates the cell from the point. In a weighted Delaunay triangulation no such walk comes back to
   a cell: the power of the point with respect to the cells grows. */
static mlim_status locate(mlim_delaunay* d, int32_t start, mlim_context* context, int32_t* out)
{
  int32_t at = start;
  int32_t before = MLIM_NO_CELL;
  for (size_t step = 0; step <= d->cell_count; ++step)
  {
    const mlim_cell* cell = &d->cells[at];
    int exit = -1;
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
  corners_of(d, cell, corners);
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
  border_facet* facet = &d->border[d->border_count++];
  facet->outer = cell->neighbors[index];
  if (facet->outer != MLIM_NO_CELL)
  {
    const int32_t* n = d->cells[facet->outer].neighbors;
    facet->index = (n[1] == id) + 2 * (n[2] == id) + 3 * (n[3] == id);
  }
  facet_of(cell, index, facet->vertices);
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
  mlim_status status = kind == MLIM_START_NEAR ? locate(d, from, context, &from) : MLIM_OK;
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

/* ---- fill ---- */

/* Slots of the hash table for a border: more than its edges. */
static size_t count_slots(const mlim_delaunay* d)
{
  size_t count = 1;
  while (count < 6 * d->border_count)
  {
    count *= 2;
  }
  return d->around_count > FEW_PLACES ? count : 0;
}

/* Room for all that the insertion makes. Not 0: out of memory, and nothing has changed. */
static int reserve_fill(mlim_delaunay* d)
{
  const size_t free_count = d->free_count + d->zone_count;
  const size_t count = d->border_count;
  return 3 * count > INT32_MAX || reserve_cells(d, count > free_count ? count - free_count : 0) ||
         reserve_vertex(d) ||
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

/* A cell on each facet of the border, linked to what is outside. */
static void make_cells(mlim_delaunay* d, int32_t vertex)
{
  for (size_t k = 0; k < d->border_count; ++k)
  {
    const border_facet* facet = &d->border[k];
    const int32_t* v = facet->vertices;
    d->cells[d->made[k]] =
      (mlim_cell){ .vertices = { vertex, v[0], v[1], v[2] }, .neighbors = { facet->outer } };
    if (facet->outer != MLIM_NO_CELL)
    {
      d->cells[facet->outer].neighbors[facet->index] = d->made[k];
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
  if (d->around_count > FEW_PLACES)
  {
    link_many(d);
  }
  else
  {
    link_few(d);
  }
  d->last = d->made[0];
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < d->border_count; ++k)
  {
    const mlim_status made = make_sphere(d, d->made[k], context);
    status = status == MLIM_OK ? made : status;
  }
  if (out != NULL && status == MLIM_OK)
  {
    *out = (mlim_delaunay_zone){ .count = d->border_count, .cells = d->made };
  }
  return status;
}
