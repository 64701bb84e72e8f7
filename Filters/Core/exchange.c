#include "exchange.h"

#include "vector.h"

#include <math.h>
#include <string.h>

enum
{
  MAX_RING =
    10 /* cells round an edge that is exchanged; longer rings rarely have a better filling */
};

static void add_new(mlim_solid_change* change, int32_t a, int32_t b, int32_t c, int32_t d)
{
  int32_t* v = change->new_cells[change->new_count++];
  v[0] = a;
  v[1] = b;
  v[2] = c;
  v[3] = d;
}

/* Shapes of the new cells, as long as all are above the bound. */
static int measure_new(const mlim_solid* solid, mlim_solid_change* change, double above)
{
  for (size_t c = 0; c < change->new_count; ++c)
  {
    change->new_shapes[c] = mlim_solid_shape(solid, change->new_cells[c]);
    if (!(change->new_shapes[c] > above))
    {
      return 0;
    }
  }
  return 1;
}

static double worst_old(const mlim_solid* solid, const mlim_solid_change* change)
{
  double worst = INFINITY;
  for (size_t c = 0; c < change->old_count; ++c)
  {
    worst = mlim_min(worst, solid->cells[change->old_cells[c]].shape);
  }
  return worst;
}

/* ---- edges ---- */

/* Orders of the vertices that leave the orientation as it is, an edge first. */
static const int EDGES[6][4] = { { 0, 1, 2, 3 }, { 0, 2, 3, 1 }, { 0, 3, 1, 2 }, { 1, 2, 0, 3 },
  { 1, 3, 2, 0 }, { 2, 3, 0, 1 } };

/* The cells round an edge a, b: cell k has the ring's vertices k and k + 1. */
typedef struct ring
{
  int32_t a, b;
  int32_t vertices[MAX_RING];
  int count;
} ring;

static int index_of(const int32_t vertices[4], int32_t vertex)
{
  for (int k = 0; k < 3; ++k)
  {
    if (vertices[k] == vertex)
    {
      return k;
    }
  }
  return 3;
}

/* Returns 0 when the edge is on the surface, or the ring too long. */
static int walk_ring(
  const mlim_solid* solid, int32_t first, int edge, mlim_solid_change* change, ring* out)
{
  const int32_t* v = solid->cells[first].vertices;
  out->a = v[EDGES[edge][0]];
  out->b = v[EDGES[edge][1]];
  int32_t left = v[EDGES[edge][2]];
  int32_t right = v[EDGES[edge][3]];
  int32_t id = first;
  out->count = 0;
  change->old_count = 0;
  do
  {
    if (out->count == MAX_RING)
    {
      return 0;
    }
    out->vertices[out->count++] = left;
    change->old_cells[change->old_count++] = id;
    const mlim_solid_cell* cell = &solid->cells[id];
    const int index = index_of(cell->vertices, left);
    if (!mlim_solid_is_open(solid, cell, index))
    {
      return 0;
    }
    id = cell->neighbors[index];
    const int32_t* next = solid->cells[id].vertices;
    left = right;
    right = next[0] ^ next[1] ^ next[2] ^ next[3] ^ out->a ^ out->b ^ left;
  } while (id != first);
  return 1;
}

/* The best triangulation of a ring, after Klincsek: best[i][j] is the worst shape over the triangles
   of the polygon i, i + 1, ..., j, and middle[i][j] the third vertex of the one at its side i, j. */
typedef struct filling
{
  double best[MAX_RING][MAX_RING];
  int middle[MAX_RING][MAX_RING];
} filling;

static double shape_of_triangle(const mlim_solid* solid, const ring* r, int i, int k, int j)
{
  const int32_t low[4] = { r->a, r->vertices[i], r->vertices[k], r->vertices[j] };
  const double shape = mlim_solid_shape(solid, low);
  if (!(shape > 0))
  {
    return shape;
  }
  const int32_t high[4] = { r->b, r->vertices[k], r->vertices[i], r->vertices[j] };
  return mlim_min(shape, mlim_solid_shape(solid, high));
}

static void fill_ring(const mlim_solid* solid, const ring* r, double above, filling* out)
{
  for (int length = 1; length < r->count; ++length)
  {
    for (int i = 0; i + length < r->count; ++i)
    {
      const int j = i + length;
      out->best[i][j] = length == 1 ? INFINITY : -INFINITY;
      for (int k = i + 1; k < j; ++k)
      {
        double shape = mlim_min(out->best[i][k], out->best[k][j]);
        if (shape > above && shape > out->best[i][j])
        {
          shape = mlim_min(shape, shape_of_triangle(solid, r, i, k, j));
        }
        if (shape > out->best[i][j])
        {
          out->best[i][j] = shape;
          out->middle[i][j] = k;
        }
      }
    }
  }
}

static void take_filling(const filling* f, const ring* r, mlim_solid_change* change)
{
  int stack[MAX_RING][2] = { { 0, r->count - 1 } };
  int count = 1;
  change->new_count = 0;
  while (count > 0)
  {
    --count;
    const int i = stack[count][0];
    const int j = stack[count][1];
    const int k = f->middle[i][j];
    add_new(change, r->a, r->vertices[i], r->vertices[k], r->vertices[j]);
    add_new(change, r->b, r->vertices[k], r->vertices[i], r->vertices[j]);
    const int sides[2][2] = { { i, k }, { k, j } };
    for (int s = 0; s < 2; ++s)
    {
      if (sides[s][1] - sides[s][0] > 1)
      {
        stack[count][0] = sides[s][0];
        stack[count++][1] = sides[s][1];
      }
    }
  }
}

int mlim_exchange_edge(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int edge)
{
  ring r;
  if (!walk_ring(solid, cell, edge, change, &r) || r.count < 3)
  {
    return 0;
  }
  const double above = mlim_exchange_least(worst_old(solid, change));
  filling f;
  fill_ring(solid, &r, above, &f);
  if (!(f.best[0][r.count - 1] > above))
  {
    return 0;
  }
  take_filling(&f, &r, change);
  return measure_new(solid, change, above)
           ? mlim_solid_exchange(solid, change, solid->cells[cell].label)
           : 0;
}

/* ---- faces ---- */

/* The same, a vertex first. */
static const int VERTICES[4][4] = { { 0, 1, 2, 3 }, { 1, 0, 3, 2 }, { 2, 3, 0, 1 },
  { 3, 2, 1, 0 } };

int mlim_exchange_face(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index)
{
  const mlim_solid_cell* c = &solid->cells[cell];
  if (!mlim_solid_is_open(solid, c, index))
  {
    return 0;
  }
  const int32_t other = c->neighbors[index];
  const int32_t* v = c->vertices;
  const int32_t* w = solid->cells[other].vertices;
  const int32_t a = v[index];
  const int32_t face[3] = { v[VERTICES[index][1]], v[VERTICES[index][2]], v[VERTICES[index][3]] };
  const int32_t b = w[0] ^ w[1] ^ w[2] ^ w[3] ^ face[0] ^ face[1] ^ face[2];
  change->old_count = 2;
  change->old_cells[0] = cell;
  change->old_cells[1] = other;
  change->new_count = 0;
  for (int k = 0; k < 3; ++k)
  {
    add_new(change, a, b, face[k], face[(k + 1) % 3]);
  }
  const double above = mlim_exchange_least(worst_old(solid, change));
  return measure_new(solid, change, above) ? mlim_solid_exchange(solid, change, c->label) : 0;
}

/* ---- vertices ---- */

int mlim_exchange_vertex(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index)
{
  const int32_t vertex = solid->cells[cell].vertices[index];
  if ((size_t)vertex < solid->fixed_count || !mlim_solid_star(solid, cell, vertex, change))
  {
    return 0;
  }
  const int32_t label = solid->cells[cell].label;
  const double above = mlim_exchange_least(worst_old(solid, change));
  /* The neighbours in the cell itself are the likely ones: one of them may be too near. */
  for (int k = 0; k < 4; ++k)
  {
    if (k == index)
    {
      continue;
    }
    const int32_t target = solid->cells[cell].vertices[k];
    change->new_count = 0;
    for (size_t c = 0; c < change->old_count; ++c)
    {
      const int32_t* v = solid->cells[change->old_cells[c]].vertices;
      if (v[0] == target || v[1] == target || v[2] == target || v[3] == target)
      {
        continue;
      }
      int32_t* fresh = change->new_cells[change->new_count++];
      memcpy(fresh, v, sizeof change->new_cells[0]);
      fresh[index_of(v, vertex)] = target;
    }
    if (measure_new(solid, change, above))
    {
      return mlim_solid_exchange(solid, change, label);
    }
  }
  return 0;
}
