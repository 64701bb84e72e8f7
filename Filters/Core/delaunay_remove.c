#include "delaunay_parts.h"

#include "memory.h"
#include "status.h"

#include <string.h>

/* The triangulation of the lighter points (delaunay.h) is one of points in general position, so it is unique:
   its cells are those whose spheres are empty. Let a hole be the union of all cells of the vertices that
   go. Cells outside it stay empty. Those that fill it have vertices of the dead cells alone, and are
   empty with respect to these too: they are cells of the small triangulation of just these vertices, if it
   takes them in the same order. The far vertices, which it has as well, change nothing of that. So the
   filling is cut out of the small triangulation along the border of the hole, ties or not. */

enum
{
  NO_SLOT = -1,
  NOT_AROUND = -1,  /* of vertices: not on a dead cell */
  AROUND = 0,       /* it is */
  LOOK_EVERY = 4096 /* insertions between two looks at the host: about 10 ms */
};

/* A facet between a dead cell and one that lives, or the outside. */
typedef struct rim
{
  int32_t outer, index;
  int32_t vertices[3]; /* small ids, the least first; the normal points out of the hole */
} rim;

typedef struct removal
{
  mlim_delaunay* d;
  mlim_delaunay* small;
  const unsigned char* is_marked;
  int32_t* locals;  /* a vertex: its small id */
  int32_t* globals; /* the other way round */
  int32_t* dead;    /* cells */
  size_t dead_count, dead_capacity;
  rim* rims;
  size_t rim_count, rim_capacity;
  int32_t* slots; /* hashed rims */
  size_t slot_mask;
  int32_t* filling; /* small cells in the hole */
  size_t filling_count;
  int32_t* ids; /* a small cell: its id in place of the dead ones, MLIM_NO_CELL outside the hole */
} removal;

static void removal_free(removal* r)
{
  mlim_delaunay_free(r->small);
  mlim_release(r->locals);
  mlim_release(r->globals);
  mlim_release(r->dead);
  mlim_release(r->rims);
  mlim_release(r->slots);
  mlim_release(r->filling);
  mlim_release(r->ids);
}

/* ---- the hole ---- */

static int is_dying(const removal* r, int32_t cell)
{
  const int32_t* v = r->d->cells[cell].vertices;
  return r->is_marked[v[0]] || r->is_marked[v[1]] || r->is_marked[v[2]] || r->is_marked[v[3]];
}

/* Not 0: out of memory. */
static int list_dead(removal* r)
{
  mlim_delaunay* d = r->d;
  r->locals = mlim_allocate(d->vertex_count, sizeof *r->locals);
  if (r->locals == NULL)
  {
    return 1;
  }
  for (size_t v = 0; v < d->vertex_count; ++v)
  {
    r->locals[v] = v < MLIM_FAR_VERTICES ? (int32_t)v : NOT_AROUND;
  }
  for (size_t c = 0; c < d->cell_count; ++c)
  {
    const int32_t* v = d->cells[c].vertices;
    if (v[0] < 0 || !is_dying(r, (int32_t)c))
    {
      continue;
    }
    if (mlim_reserve(&r->dead, &r->dead_capacity, r->dead_count + 1, sizeof *r->dead))
    {
      return 1;
    }
    r->dead[r->dead_count++] = (int32_t)c;
    for (int k = 0; k < 4; ++k)
    {
      r->locals[v[k]] = v[k] >= MLIM_FAR_VERTICES && !r->is_marked[v[k]] ? AROUND : r->locals[v[k]];
    }
  }
  return 0;
}

static mlim_status insert(removal* r, int32_t vertex, mlim_context* context)
{
  const mlim_vertex* v = &r->d->vertices[vertex];
  mlim_delaunay_zone zone;
  mlim_status status = mlim_delaunay_find(
    r->small, v->point, v->weight, MLIM_NO_CELL, MLIM_START_NEAR, context, &zone);
  status = status == MLIM_OK ? mlim_delaunay_fill(r->small, context, NULL) : status;
  r->locals[vertex] = (int32_t)r->small->vertex_count - 1;
  return status;
}

static mlim_status make_small(removal* r, double done, mlim_context* context)
{
  mlim_status status = mlim_delaunay_create(r->d->size, context, &r->small);
  for (size_t v = MLIM_FAR_VERTICES; v < r->d->vertex_count && status == MLIM_OK; ++v)
  {
    if (r->locals[v] == AROUND)
    {
      status = insert(r, (int32_t)v, context);
      if (status == MLIM_OK && r->locals[v] % LOOK_EVERY == 0)
      {
        status = mlim_progress(context, MLIM_STAGE_SURFACE, done);
      }
    }
  }
  return status;
}

/* ---- its border ---- */

/* The least vertex comes first, the others keep their sense. */
static void turn(int32_t v[3])
{
  while (v[1] < v[0] || v[2] < v[0])
  {
    const int32_t first = v[0];
    v[0] = v[1];
    v[1] = v[2];
    v[2] = first;
  }
}

/* The slot of a turned facet, seen from either side, or the empty one where it belongs. */
static size_t slot_of(const removal* r, const int32_t v[3])
{
  const uint32_t sum = (uint32_t)v[1] + (uint32_t)v[2];
  const uint32_t product = (uint32_t)v[1] * (uint32_t)v[2];
  size_t slot = (uint32_t)v[0] * 2654435761u + sum * 2246822519u + product * 3266489917u;
  slot = (slot ^ slot >> 15) & r->slot_mask;
  while (r->slots[slot] != NO_SLOT)
  {
    const int32_t* w = r->rims[r->slots[slot]].vertices;
    if (v[0] == w[0] && ((v[1] == w[1] && v[2] == w[2]) || (v[1] == w[2] && v[2] == w[1])))
    {
      break;
    }
    slot = (slot + 1) & r->slot_mask;
  }
  return slot;
}

/* Not 0: out of memory. */
static int list_rims(removal* r)
{
  const mlim_delaunay* d = r->d;
  for (size_t k = 0; k < r->dead_count; ++k)
  {
    const mlim_cell* cell = &d->cells[r->dead[k]];
    if (mlim_reserve(&r->rims, &r->rim_capacity, r->rim_count + 4, sizeof *r->rims))
    {
      return 1;
    }
    for (int i = 0; i < 4; ++i)
    {
      const int32_t outer = cell->neighbors[i];
      if (outer != MLIM_NO_CELL && is_dying(r, outer))
      {
        continue;
      }
      rim* new_rim = &r->rims[r->rim_count++];
      *new_rim = (rim){ .outer = outer };
      if (outer != MLIM_NO_CELL)
      {
        const int32_t* n = d->cells[outer].neighbors;
        const int32_t id = r->dead[k];
        new_rim->index = (n[1] == id) + 2 * (n[2] == id) + 3 * (n[3] == id);
      }
      int32_t v[3];
      delaunay_facet_of(cell, i, v);
      for (int j = 0; j < 3; ++j)
      {
        new_rim->vertices[j] = r->locals[v[j]];
      }
      turn(new_rim->vertices);
    }
  }
  return r->rim_count > INT32_MAX;
}

/* Not 0: out of memory. */
static int hash_rims(removal* r)
{
  size_t count = 16;
  while (count < 2 * r->rim_count)
  {
    count *= 2;
  }
  r->slots = mlim_allocate(count, sizeof *r->slots);
  if (r->slots == NULL)
  {
    return 1;
  }
  r->slot_mask = count - 1;
  for (size_t s = 0; s < count; ++s)
  {
    r->slots[s] = NO_SLOT;
  }
  for (size_t k = 0; k < r->rim_count; ++k)
  {
    r->slots[slot_of(r, r->rims[k].vertices)] = (int32_t)k;
  }
  return 0;
}

/* ---- the filling ---- */

/* Facet `index` of a small cell on the border, NO_SLOT: it is none. *is_outside: the cell is. */
static int32_t find_rim(const removal* r, const mlim_cell* cell, int index, int* is_outside)
{
  int32_t v[3];
  delaunay_facet_of(cell, index, v);
  turn(v);
  const int32_t found = r->slots[slot_of(r, v)];
  *is_outside = found != NO_SLOT && r->rims[found].vertices[1] != v[1];
  return found;
}

static void take(removal* r, int32_t cell)
{
  if (r->ids[cell] == MLIM_NO_CELL)
  {
    r->ids[cell] = cell; /* until it has one */
    r->filling[r->filling_count++] = cell;
  }
}

static int is_at_border(const removal* r, const mlim_cell* cell)
{
  int is_outside = 1;
  int32_t found = NO_SLOT;
  for (int i = 0; i < 4 && (found == NO_SLOT || is_outside); ++i)
  {
    found = find_rim(r, cell, i, &is_outside);
  }
  return found != NO_SLOT && !is_outside;
}

/* Takes all cells from the border inwards. Returns whether they fill the hole. */
static int fill_hole(removal* r)
{
  mlim_delaunay* s = r->small;
  size_t met = 0;
  for (size_t c = 0; c < s->cell_count; ++c)
  {
    r->ids[c] = MLIM_NO_CELL;
  }
  for (size_t c = 0; c < s->cell_count; ++c)
  {
    if (s->cells[c].vertices[0] >= 0 && is_at_border(r, &s->cells[c]))
    {
      take(r, (int32_t)c);
    }
  }
  for (size_t k = 0; k < r->filling_count; ++k)
  {
    const mlim_cell* cell = &s->cells[r->filling[k]];
    for (int i = 0; i < 4; ++i)
    {
      int is_outside;
      const int32_t found = find_rim(r, cell, i, &is_outside);
      if (is_outside || (found == NO_SLOT && cell->neighbors[i] == MLIM_NO_CELL))
      {
        return 0;
      }
      met += found != NO_SLOT;
      if (found == NO_SLOT)
      {
        take(r, cell->neighbors[i]);
      }
    }
  }
  return met == r->rim_count;
}

static mlim_status find_filling(removal* r, mlim_context* context)
{
  r->filling = mlim_allocate(r->small->cell_count, sizeof *r->filling);
  r->ids = mlim_allocate(r->small->cell_count, sizeof *r->ids);
  if (r->filling == NULL || r->ids == NULL || list_rims(r) || hash_rims(r))
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  return fill_hole(r) ? MLIM_OK
                      : mlim_fail(context, MLIM_INTERNAL,
                          "The hole that %zu cells leave in the triangulation cannot be filled.",
                          r->dead_count);
}

/* ---- the change ---- */

/* Room for all that is needed afterwards. Not 0: out of memory. */
static int reserve(removal* r)
{
  mlim_delaunay* d = r->d;
  const size_t free_count = d->free_count + r->dead_count;
  const size_t count = r->filling_count;
  r->globals = mlim_allocate(r->small->vertex_count, sizeof *r->globals);
  return r->globals == NULL ||
         delaunay_reserve_cells(d, count > free_count ? count - free_count : 0) ||
         mlim_reserve_apart(&d->free_cells, &d->free_capacity, free_count, sizeof *d->free_cells) ||
         mlim_reserve(&d->made, &d->made_capacity, count, sizeof *d->made);
}

/* Ids for the new cells, those of the dead ones first. */
static void take_ids(removal* r)
{
  mlim_delaunay* d = r->d;
  for (size_t k = r->dead_count; k > 0; --k)
  {
    d->cells[r->dead[k - 1]].vertices[0] = -1;
    d->free_cells[d->free_count++] = r->dead[k - 1];
  }
  for (size_t k = 0; k < r->filling_count; ++k)
  {
    d->made[k] = d->free_count > 0 ? d->free_cells[--d->free_count] : (int32_t)d->cell_count++;
    r->ids[r->filling[k]] = d->made[k];
  }
}

/* With the old ids of their vertices. */
static void make_cells(removal* r)
{
  mlim_delaunay* d = r->d;
  for (size_t k = 0; k < r->filling_count; ++k)
  {
    const int32_t id = d->made[k];
    const mlim_cell* from = &r->small->cells[r->filling[k]];
    mlim_cell* cell = &d->cells[id];
    *cell = (mlim_cell){ .bound = from->bound };
    d->spheres[id] = r->small->spheres[r->filling[k]];
    for (int i = 0; i < 4; ++i)
    {
      int is_outside;
      const int32_t found = find_rim(r, from, i, &is_outside);
      cell->vertices[i] = r->globals[from->vertices[i]];
      cell->neighbors[i] = found == NO_SLOT ? r->ids[from->neighbors[i]] : r->rims[found].outer;
      if (found != NO_SLOT && r->rims[found].outer != MLIM_NO_CELL)
      {
        d->cells[r->rims[found].outer].neighbors[r->rims[found].index] = id;
      }
    }
  }
  d->last = d->made[0];
}

/* `locals` has done its duty: it takes the new ids. */
static void renumber(removal* r)
{
  mlim_delaunay* d = r->d;
  size_t kept = 0;
  for (size_t v = 0; v < d->vertex_count; ++v)
  {
    r->locals[v] = (int32_t)kept;
    if (!r->is_marked[v])
    {
      d->vertices[kept] = d->vertices[v];
      d->places[kept++] = 0;
    }
  }
  d->vertex_count = kept;
  for (size_t c = 0; c < d->cell_count; ++c)
  {
    int32_t* v = d->cells[c].vertices;
    for (int k = 0; k < 4 && v[0] >= 0; ++k)
    {
      v[k] = r->locals[v[k]];
    }
  }
}

static void change(removal* r)
{
  for (size_t v = 0; v < r->d->vertex_count; ++v)
  {
    if (r->locals[v] != NOT_AROUND)
    {
      r->globals[r->locals[v]] = (int32_t)v;
    }
  }
  r->d->has_zone = 0;
  take_ids(r);
  make_cells(r);
  renumber(r);
}

mlim_status mlim_delaunay_remove(mlim_delaunay* delaunay, const unsigned char* is_marked,
  double done, mlim_context* context, mlim_delaunay_zone* out)
{
  *out = (mlim_delaunay_zone){ 0 };
  removal r = { .d = delaunay, .is_marked = is_marked };
  mlim_status status = list_dead(&r) ? mlim_fail_memory(context, "the triangulation") : MLIM_OK;
  if (status == MLIM_OK && r.dead_count > 0)
  {
    status = make_small(&r, done, context);
    status = status == MLIM_OK ? find_filling(&r, context) : status;
    status =
      status == MLIM_OK && reserve(&r) ? mlim_fail_memory(context, "the triangulation") : status;
    if (status == MLIM_OK)
    {
      change(&r);
      *out = (mlim_delaunay_zone){ .count = r.filling_count, .cells = delaunay->made };
    }
  }
  removal_free(&r);
  return status;
}
