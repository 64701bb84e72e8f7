/* Memory asked for before it is needed. Facets, cells and vertices that belong together lie far apart:
   passes over all of them would wait for memory most of the time. Nothing changes but the time. */
#ifndef mlim_ahead_h
#define mlim_ahead_h

#include "complex.h"
#include "memory.h"

enum
{
  MLIM_CELLS_AHEAD = 32,   /* facets from the one at work to those whose cells are asked for */
  MLIM_VERTICES_AHEAD = 16 /* and to those whose vertices are, whose cells are there by then */
};

/* The cells of the records from f on, of which `end` is past the last. */
static inline void mlim_ahead_of_cell(const mlim_complex* complex, size_t f, size_t end)
{
  if (f + MLIM_CELLS_AHEAD < end)
  {
    mlim_prefetch(&complex->cells[complex->facets[f + MLIM_CELLS_AHEAD].cell]);
  }
}

/* The cell beyond a facet. */
static inline void mlim_ahead_of_neighbor(const mlim_complex* complex, int32_t cell, int index)
{
  const int32_t other = complex->cells[cell].neighbors[index];
  if (other >= 0)
  {
    mlim_prefetch(&complex->cells[other]);
  }
}

/* The points and weights of a facet's vertices; with their sheets, which are often in the next line of the
   cache. */
static inline void mlim_ahead_of_vertices(
  const mlim_complex* complex, int32_t cell, int index, int has_sheets)
{
  const mlim_cell* c = &complex->cells[cell];
  for (int k = 1; k < 4 && c->vertices[0] >= 0; ++k)
  {
    const mlim_vertex* v = &complex->vertices[c->vertices[(index + k) & 3]];
    mlim_prefetch(v);
    mlim_prefetch(has_sheets ? (const void*)&v->sheet : (const void*)&v->weight);
  }
}

/* For the records from f on: the vertices with their sheets. */
static inline void mlim_ahead_of_record(const mlim_complex* complex, size_t f, size_t end)
{
  mlim_ahead_of_cell(complex, f, end);
  if (f + MLIM_VERTICES_AHEAD < end)
  {
    const mlim_facet* facet = &complex->facets[f + MLIM_VERTICES_AHEAD];
    mlim_ahead_of_vertices(complex, facet->cell, facet->index, 1);
  }
}

#endif
