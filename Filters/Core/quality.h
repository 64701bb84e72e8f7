/* Figures of a finished mesh: the paper's Table 3, the pieces of its interfaces, closedness. */
#ifndef mlim_quality_h
#define mlim_quality_h

#include "edges.h"

/* Fills triangle_patches and patch_count. */
mlim_status mlim_quality_find_patches(
  mlim_mesh* mesh, const mlim_edges* edges, mlim_context* context);

/* Appends the edges of three or more triangles that are not among the curve edges, and counts them:
   what is finer than the smallest distance may leave a few. */
mlim_status mlim_quality_add_edges(mlim_mesh* mesh, const mlim_edges* edges, mlim_context* context);

/* Fills the angles and ratios of the report. */
void mlim_quality_measure(mlim_mesh* mesh, const mlim_edges* edges);

/* Number of edges round which the boundary of some region does not close. */
size_t mlim_quality_count_open_edges(const mlim_mesh* mesh, const mlim_edges* edges);

#endif
