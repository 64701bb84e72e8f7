#include "complex.h"

#include "memory.h"
#include "status.h"

#include <assert.h>

/* A dual round the hole becomes longer, against the rule for insertions: what is known of it is forgotten, and
   the cells on both its ends count as made just now, so that it is looked along again. */

/* The facet opposite to vertex k of a cell that goes. */
static void forget_facet(mlim_complex* complex, int32_t id, int k)
{
  mlim_cell* cell = &complex->cells[id];
  const int32_t record = cell->facets[k];
  if (record > 0)
  {
    mlim_cell* other = &complex->cells[cell->neighbors[k]];
    other->facets[mlim_complex_index_apart(other, cell)] = 0;
    cell->facets[k] = 0;
    mlim_complex_kill_record(complex, record);
  }
}

static int goes(const mlim_cell* cell, const unsigned char* is_marked)
{
  const int32_t* v = cell->vertices;
  return v[0] >= 0 && (is_marked[v[0]] || is_marked[v[1]] || is_marked[v[2]] || is_marked[v[3]]);
}

/* Not 0: out of memory. */
static int open_hole(mlim_complex* complex, const unsigned char* is_marked)
{
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    if (!goes(cell, is_marked))
    {
      continue;
    }
    if (mlim_reserve_apart(
          &complex->made, &complex->made_capacity, complex->made_count + 4, sizeof *complex->made))
    {
      return 1;
    }
    for (int k = 0; k < 4; ++k)
    {
      const int32_t n = cell->neighbors[k];
      forget_facet(complex, (int32_t)c, k);
      if (n != MLIM_NO_CELL && !goes(&complex->cells[n], is_marked))
      {
        complex->cells[n].label = MLIM_NO_LABEL;
        complex->made[complex->made_count++] = n;
      }
    }
  }
  return 0;
}

mlim_status mlim_complex_remove(
  mlim_complex* complex, const unsigned char* is_marked, double done, mlim_context* context)
{
  assert(complex->dirty_count == 0 && complex->made_count == 0);
  mlim_delaunay_zone made;
  mlim_status status = open_hole(complex, is_marked)
                         ? mlim_fail_memory(context, "the triangulation")
                         : mlim_delaunay_remove(complex->delaunay, is_marked, done, context, &made);
  if (status != MLIM_OK)
  {
    return status;
  }
  size_t left = 0;
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    left += !is_marked[v];
  }
  complex->vertex_count = left;
  status = mlim_complex_expect_cells(complex, made.count, context);
  for (size_t k = 0; k < made.count && status == MLIM_OK; ++k)
  {
    mlim_complex_take_new_cell(complex, made.cells[k]);
    mlim_complex_touch_cell(complex, made.cells[k]);
  }
  return status;
}
