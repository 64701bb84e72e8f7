#include "tidy_cell.h"

#include "triangle.h"

int tidy_is_frozen(const mlim_complex* complex, const mlim_cell* cell)
{
  for (int k = 0; k < 4; ++k)
  {
    if (complex->vertices[cell->vertices[k]].kind == MLIM_VERTEX_FAR)
    {
      return 1;
    }
  }
  return 0;
}

int tidy_stray_count(
  const mlim_complex* complex, const mlim_cell* cell, int index, int32_t label, int32_t other)
{
  if (label == other)
  {
    return 0;
  }
  const mlim_sheet sheet = { .low = label < other ? label : other,
    .high = label < other ? other : label,
    .face = mlim_complex_face(complex, (int32_t)(cell - complex->cells), index) };
  int count = 0;
  for (int k = 1; k < 4; ++k)
  {
    count += !mlim_complex_is_on_sheet(
      complex, &complex->vertices[cell->vertices[(index + k) & 3]], &sheet);
  }
  return count;
}

int mlim_tidy_is_stray(const mlim_complex* complex, int32_t cell, int index)
{
  const mlim_cell* own = &complex->cells[cell];
  const int32_t other = own->neighbors[index];
  return other != MLIM_NO_CELL &&
         tidy_stray_count(complex, own, index, own->label, complex->cells[other].label) > 0;
}

int tidy_is_misshapen(const mlim_refinement* r, const mlim_cell* cell, int index)
{
  const double* p[3];
  for (int k = 0; k < 3; ++k)
  {
    const mlim_vertex* v = &r->complex.vertices[cell->vertices[(index + 1 + k) & 3]];
    if (v->kind == MLIM_VERTEX_BALL)
    {
      return 0;
    }
    p[k] = v->point;
  }
  const double bound = r->options->facet_radius_edge_ratio;
  return mlim_radius_edge_ratio_squared(p[0], p[1], p[2]) > bound * bound;
}

int tidy_cell_strays(const mlim_complex* complex, int32_t id, int32_t label)
{
  const mlim_cell* cell = &complex->cells[id];
  int count = 0;
  for (int k = 0; k < 4; ++k)
  {
    count += tidy_stray_count(complex, cell, k, label, complex->cells[cell->neighbors[k]].label);
  }
  return count;
}

int tidy_cell_misshapen(const mlim_refinement* r, int32_t id)
{
  const mlim_cell* cell = &r->complex.cells[id];
  int count = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int32_t other = r->complex.cells[cell->neighbors[k]].label;
    count += cell->label != other && tidy_is_misshapen(r, cell, k);
  }
  return count;
}

int32_t tidy_label_beyond(const mlim_complex* complex, int32_t id, int index)
{
  const mlim_cell* cell = &complex->cells[id];
  return mlim_complex_face(complex, id, index) < 0 ? complex->cells[cell->neighbors[index]].label
                                                   : cell->label;
}

int32_t tidy_best_label(const mlim_complex* complex, int32_t id)
{
  const mlim_cell* cell = &complex->cells[id];
  int32_t best = cell->label;
  int least = tidy_cell_strays(complex, id, best);
  for (int v = 0; v < 4 && least > 0; ++v)
  {
    const mlim_vertex* vertex = &complex->vertices[cell->vertices[v]];
    const int is_inside = vertex->kind == MLIM_VERTEX_SURFACE && vertex->sheet.face < 0;
    const int32_t tried[3] = { tidy_label_beyond(complex, id, v),
      is_inside ? vertex->sheet.low : best, is_inside ? vertex->sheet.high : best };
    for (int t = 0; t < 3; ++t)
    {
      const int count = tidy_cell_strays(complex, id, tried[t]);
      if (count < least)
      {
        least = count;
        best = tried[t];
      }
    }
  }
  return best;
}
