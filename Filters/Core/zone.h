/* Points inside one label: the cells of a zone give way to cells of the same label, so that no facet
   between two labels dies. Records of facets are not kept. */
#ifndef mlim_zone_h
#define mlim_zone_h

#include "complex.h"

typedef struct mlim_zone_demand
{
  int32_t label;        /* that all cells have to have */
  double least_squared; /* smallest power distance of the point from all vertices */
  int may_have_far;     /* cells with far vertices may be in the zone */
} mlim_zone_demand;

/* Whether the zone of a point is not empty and as it has to be. */
int mlim_zone_is_free(const mlim_complex* complex, const mlim_delaunay_zone* zone,
  const double point[3], const mlim_zone_demand* demand);

/* Inserts the point of the last find. `made` are the new cells, borrowed until the next call.
   MLIM_VERTEX_LIMIT, and nothing has changed, when that many vertices are there. */
mlim_status mlim_zone_fill(
  mlim_complex* complex, int32_t label, mlim_context* context, mlim_delaunay_zone* made);

#endif
