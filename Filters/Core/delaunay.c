#include "delaunay_parts.h"

#include "memory.h"
#include "predicates.h"
#include "status.h"

#include <string.h>

enum
{
  FIRST_CELLS = 1 << 8, /* more than there are fours of far vertices */
  /* Bytes before the first cell: large blocks of memory begin 16 bytes behind a line of the cache, and a cell
     is as long as a line. So each is in one line and not in two. */
  CELLS_BEGIN = 48
};

int delaunay_reserve_cells(mlim_delaunay* d, size_t count)
{
  const size_t needed = d->cell_count + count + 1; /* one for what is before the first */
  if (needed > INT32_MAX ||
      mlim_reserve_apart(&d->cell_memory, &d->cell_capacity, needed, sizeof *d->cells))
  {
    return 1;
  }
  d->cells = (mlim_cell*)((char*)d->cell_memory + CELLS_BEGIN);
  return mlim_reserve_apart(&d->spheres, &d->sphere_capacity, needed, sizeof *d->spheres);
}

int delaunay_reserve_vertices(mlim_delaunay* d, size_t count)
{
  const size_t needed = d->vertex_count + count;
  return needed > INT32_MAX ||
         mlim_reserve_apart(&d->vertices, &d->vertex_capacity, needed, sizeof *d->vertices) ||
         mlim_reserve_apart(&d->places, &d->place_capacity, needed, sizeof *d->places);
}

mlim_status mlim_delaunay_reserve(mlim_delaunay* delaunay, size_t count, mlim_context* context)
{
  return delaunay_reserve_vertices(delaunay, count) ? mlim_fail_memory(context, "the triangulation")
                                                    : MLIM_OK;
}

/* ---- start ---- */

/* Makes a cell of four far vertices if it is one, that is, if its sphere is empty. Room is there. */
static mlim_status try_cell(mlim_delaunay* d, const int32_t vertices[4], mlim_context* context)
{
  mlim_cell* cell = &d->cells[d->cell_count];
  *cell = (mlim_cell){ .label = 0 };
  memcpy(cell->vertices, vertices, sizeof cell->vertices);
  const double* corners[4];
  delaunay_corners(d, (int32_t)d->cell_count, corners);
  int side;
  mlim_status status =
    mlim_predicates_orientation(corners[0], corners[1], corners[2], corners[3], context, &side);
  if (side < 0)
  {
    cell->vertices[2] = vertices[3];
    cell->vertices[3] = vertices[2];
    delaunay_corners(d, (int32_t)d->cell_count, corners);
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
  delaunay_facet_of(&d->cells[id], index, facet);
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
  if (delaunay_reserve_cells(d, FIRST_CELLS))
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
    const int32_t id = (int32_t)c;
    status = delaunay_make_spheres(d, &id, 1, context);
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
    if (delaunay_reserve_vertices(d, 1))
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
  memcpy(d->size, size, sizeof d->size);
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
  mlim_release(delaunay->cell_memory);
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

mlim_delaunay_zone mlim_delaunay_dead(const mlim_delaunay* delaunay)
{
  return (mlim_delaunay_zone){ .count = delaunay->free_count, .cells = delaunay->free_cells };
}
