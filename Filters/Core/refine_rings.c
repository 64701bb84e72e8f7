#include "refine_rings.h"

#include "ahead.h"
#include "memory.h"
#include "status.h"

#include <limits.h>

enum
{
  MANY = 4 /* of so many vertices at least one has to be dirty */
};

/* The edges opposite to each vertex of the facets that have it, 2 vertices each. */
typedef struct rings
{
  const mlim_complex* complex;
  size_t facet_count;
  int32_t* facets; /* the restricted ones: 3 vertices each */
  uint32_t* ends;  /* a vertex: where its edges end, and the next one's begin */
  int32_t* edges;
} rings;

static int is_restricted(const mlim_complex* complex, const mlim_facet* facet)
{
  if (!facet->is_alive || !facet->is_multiple)
  {
    return facet->is_alive;
  }
  const mlim_cell* cell = &complex->cells[facet->cell];
  return cell->label != complex->cells[cell->neighbors[facet->index]].label;
}

/* Counts the facets at each vertex. */
static void list_facets(rings* r)
{
  const mlim_complex* complex = r->complex;
  for (size_t f = 1; f < complex->facet_count; ++f)
  {
    const mlim_facet* facet = &complex->facets[f];
    mlim_ahead_of_cell(complex, f, complex->facet_count);
    if (is_restricted(complex, facet))
    {
      int32_t* v = r->facets + 3 * r->facet_count++;
      mlim_complex_facet_vertices(complex, facet->cell, facet->index, v);
      ++r->ends[v[0]];
      ++r->ends[v[1]];
      ++r->ends[v[2]];
    }
  }
}

/* Afterwards `ends` holds where the edges of each vertex begin. */
static void place_edges(rings* r)
{
  for (size_t f = 0; f < r->facet_count; ++f)
  {
    const int32_t* v = r->facets + 3 * f;
    for (int k = 0; k < 3; ++k)
    {
      int32_t* edge = r->edges + 2 * (size_t)--r->ends[v[k]];
      edge[0] = v[(k + 1) % 3];
      edge[1] = v[(k + 2) % 3];
    }
  }
}

/* Not 0: out of memory. */
static int gather(rings* r)
{
  const size_t vertices = r->complex->vertex_count;
  const size_t alive = r->complex->facet_count - 1 - r->complex->free_count;
  r->ends = mlim_allocate_zeroed(vertices + 1, sizeof *r->ends);
  r->facets = mlim_allocate(alive, 3 * sizeof *r->facets);
  if (r->ends == NULL || r->facets == NULL)
  {
    return 1;
  }
  list_facets(r);
  for (size_t v = 1; v <= vertices; ++v)
  {
    r->ends[v] += r->ends[v - 1];
  }
  r->edges = mlim_allocate(2 * (size_t)r->ends[vertices], sizeof *r->edges);
  if (r->edges == NULL)
  {
    return 1;
  }
  place_edges(r);
  return 0;
}

static int has_ring(const rings* r, int32_t vertex)
{
  const size_t begin = r->ends[vertex];
  const size_t end = r->ends[vertex + 1];
  return r->complex->vertices[vertex].ball < 0 &&
         mlim_disk_is_ring(r->edges + 2 * begin, end - begin);
}

mlim_status mlim_rings_settle(mlim_refinement* refinement, mlim_context* context)
{
  mlim_complex* complex = &refinement->complex;
  if (complex->dirty_count * MANY < complex->vertex_count || complex->facet_count > UINT_MAX / 3)
  {
    return MLIM_OK;
  }
  rings r = { .complex = complex };
  const int has_failed = gather(&r);
  size_t kept = 0;
  for (size_t k = 0; k < complex->dirty_count && !has_failed; ++k)
  {
    const int32_t v = complex->dirty[k];
    const int holds = has_ring(&r, v);
    complex->dirty[kept] = v;
    kept += !holds;
    complex->vertices[v].is_dirty = !holds;
    complex->vertices[v].is_broken &= !holds;
  }
  mlim_release(r.facets);
  mlim_release(r.ends);
  mlim_release(r.edges);
  if (has_failed)
  {
    return mlim_fail_memory(context, "the rings of the facets");
  }
  complex->dirty_count = kept;
  return mlim_refine_report(refinement, context);
}
