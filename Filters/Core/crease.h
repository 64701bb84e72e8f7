/* The creases of the caps: where a region that reaches the box is closed by a face of the box.

   Outside the box everything is background. On a face of the box each region other than the
   background has a cap; creases are the curves between two caps, between a cap and the background,
   and the box's edges where a region fills them. */
#ifndef mlim_crease_h
#define mlim_crease_h

#include "curve_cell.h"

/* Adds the creases on one face of the box (0 .. 5 for -x +x -y +y -z +z). */
mlim_status mlim_crease_trace_face(mlim_cell_work* work, int face);

/* Adds the creases along the four edges of the box parallel to an axis, with the box's corners. */
mlim_status mlim_crease_trace_edges(mlim_cell_work* work, int axis);

#endif
