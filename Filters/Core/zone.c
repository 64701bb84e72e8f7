#include "zone.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

int mlim_zone_is_free(const mlim_complex* complex, const mlim_delaunay_zone* zone,
  const double point[3], const mlim_zone_demand* demand)
{
  for (size_t k = 0; k < zone->count; ++k)
  {
    const mlim_cell* cell = &complex->cells[zone->cells[k]];
    if (cell->label != demand->label)
    {
      return 0;
    }
    for (int i = 0; i < 4; ++i)
    {
      const mlim_vertex* v = &complex->vertices[cell->vertices[i]];
      if (v->kind == MLIM_VERTEX_FAR
            ? !demand->may_have_far
            : mlim_distance_squared(v->point, point) - v->weight < demand->least_squared)
      {
        return 0;
      }
    }
  }
  return zone->count > 0;
}

static void take_cells(mlim_complex* complex, const mlim_delaunay_zone* made, int32_t label)
{
  mlim_complex_borrow_cells(complex);
  for (size_t k = 0; k < made->count; ++k)
  {
    mlim_complex_take_cell(complex, made->cells[k]);
    complex->cells[made->cells[k]].label = label;
  }
}

mlim_status mlim_zone_fill(
  mlim_complex* complex, int32_t label, mlim_context* context, mlim_delaunay_zone* made)
{
  if (complex->vertex_count >= complex->vertex_limit)
  {
    return mlim_fail(context, MLIM_VERTEX_LIMIT,
      "The mesh has %zu vertices, the limit; what is still bad is counted.",
      complex->vertex_limit - MLIM_FAR_VERTICES);
  }
  const mlim_status status = mlim_delaunay_fill(complex->delaunay, context, made);
  if (status == MLIM_OK)
  {
    mlim_complex_borrow_vertices(complex, &(mlim_vertex){ .kind = MLIM_VERTEX_INSIDE, .ball = -1 });
    take_cells(complex, made, label);
  }
  return status;
}
