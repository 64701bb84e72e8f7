/* Single steps that better the worst cell of a small set: other cells for the same space, other
   places for vertices. Each takes place only if the worst shape of the set rises.

   Every step returns 1 when it took place: change->new_ids are the cells that are new or reshaped.
   0: nothing has changed. -1: out of memory. */
#ifndef mlim_exchange_h
#define mlim_exchange_h

#include "solid.h"
#include "vector.h"

#include <math.h>

/* What the worst of the new shapes has to come above. Less of a gain is noise, and steps might go round in
   circles. An old shape may be below 0 though its cell is in order, where that is as thin as rounding errors:
   no reason to take inverted cells for it. */
static inline double mlim_exchange_least(double worst)
{
  static const double least_gain = 1e-3;
  return mlim_max(0, worst + least_gain * fabs(worst));
}

/* Edge `edge` (0 to 5) of a cell gives way to triangles across the ring of its cells. */
int mlim_exchange_edge(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int edge);

/* The face opposite to vertex `index` gives way to an edge between the vertices beside it. */
int mlim_exchange_face(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index);

/* Vertex `index`, unless fixed, is merged with one of its neighbours. */
int mlim_exchange_vertex(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index);

/* Vertex `index`, unless fixed, moves. */
int mlim_exchange_move(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index);

/* The same, and other cells round it become cells of it. */
int mlim_exchange_star(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index);

/* A new vertex takes the place of faces round the cell. */
int mlim_exchange_insert(mlim_solid* solid, mlim_solid_change* change, int32_t cell);

#endif
