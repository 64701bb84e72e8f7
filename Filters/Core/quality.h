/* Figures of a finished mesh: the paper's Table 3, the pieces of its interfaces, closedness. */
#ifndef mlim_quality_h
#define mlim_quality_h

#include "edges.h"

/* Fills triangle_patches and patch_count. */
mlim_status mlim_quality_find_patches(
  mlim_mesh* mesh, const mlim_edges* edges, mlim_context* context);

/* Drops curve edges that no triangle has, and appends the edges of three or more triangles that are not
   among them: sheets that touch at a contact, and a few where the data are finer than the smallest
   distance. Counts each kind. */
mlim_status mlim_quality_settle_edges(
  mlim_mesh* mesh, const mlim_edges* edges, mlim_context* context);

/* Fills the angles and ratios of the report. relabeled_ratio_count receives all triangles without a
   ball vertex above the bound. `done`, here and below, is reported as the share of the certificate's
   stage. */
mlim_status mlim_quality_measure(
  mlim_mesh* mesh, const mlim_edges* edges, double bound, double done, mlim_context* context);

/* Number of edges round which the boundary of some region does not close. */
mlim_status mlim_quality_count_open_edges(const mlim_mesh* mesh, const mlim_edges* edges,
  double done, mlim_context* context, size_t* count);

#endif
