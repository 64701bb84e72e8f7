/* The best place of one vertex. The cells round it are a hull of faces, seen from it; where the worst of
   them becomes best is found by climbing a smooth stand-in of the worst. */
#ifndef mlim_climb_h
#define mlim_climb_h

#include "solid.h"

/* The worst shape of the change's new cells, and the shapes of all; but it stops at the first cell
   that is not above `above`, whose shape is as good an answer. */
double mlim_climb_worst(const mlim_solid* solid, mlim_solid_change* change, double above);

/* Moves the vertex that all new cells have uphill from where it is. Returns the worst shape it comes
   to. */
double mlim_climb(mlim_solid* solid, mlim_solid_change* change, int32_t vertex);

#endif
