/* Memory asked for before it is needed. Facets, cells and vertices that belong together lie far apart:
   passes over all of them would wait for memory most of the time. Nothing changes but the time. */
#ifndef mlim_ahead_h
#define mlim_ahead_h

#include "complex.h"
#include "memory.h"

enum
{
  MLIM_CELLS_AHEAD = 16,  /* facets from the one at work to those whose cells are asked for */
  MLIM_VERTICES_AHEAD = 8 /* and to those whose vertices are, whose cells are there by then */
};

/* Most vertices lie in two lines of the cache. */
static inline void mlim_ahead_of_vertex(const mlim_complex* complex, int32_t vertex)
{
  const mlim_vertex* v = &complex->vertices[vertex];
  mlim_prefetch(v);
  mlim_prefetch(&v->sheet);
}

/* The vertices of a facet, and the cell beyond it. */
static inline void mlim_ahead_of_facet(const mlim_complex* complex, int32_t cell, int index)
{
  const mlim_cell* c = &complex->cells[cell];
  for (int k = 1; k < 4; ++k)
  {
    if (c->vertices[0] >= 0)
    {
      mlim_ahead_of_vertex(complex, c->vertices[(index + k) & 3]);
    }
  }
  if (c->neighbors[index] >= 0)
  {
    mlim_prefetch(&complex->cells[c->neighbors[index]]);
  }
}

/* For the records from f on, of which `end` is past the last. */
static inline void mlim_ahead_of_record(const mlim_complex* complex, size_t f, size_t end)
{
  if (f + MLIM_CELLS_AHEAD < end)
  {
    mlim_prefetch(&complex->cells[complex->facets[f + MLIM_CELLS_AHEAD].cell]);
  }
  if (f + MLIM_VERTICES_AHEAD < end)
  {
    const mlim_facet* facet = &complex->facets[f + MLIM_VERTICES_AHEAD];
    mlim_ahead_of_facet(complex, facet->cell, facet->index);
  }
}

#endif
