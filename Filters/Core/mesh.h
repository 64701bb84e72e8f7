/* Reads the mesh from the finished complex. */
#ifndef mlim_mesh_h
#define mlim_mesh_h

#include "boundary.h"

/* Fills everything of the mesh but its report and certificate. vertex_of receives the mesh's vertex, or
   -1, of each of the complex's vertices; `done` is reported as the share of the certificate's stage. */
mlim_status mlim_mesh_read(const mlim_complex* complex, const mlim_boundary* boundary, double done,
  mlim_context* context, int32_t* vertex_of, mlim_mesh* out);

/* MLIM_NODE_... of a vertex, and the number of labels that meet at it, the outside being one. */
int32_t mlim_mesh_node_type(
  const mlim_complex* complex, const mlim_vertex* vertex, int32_t* label_count);

/* The certificate's disk_failure_count with their places and types: the vertices whose last look at their
   disk failed. Also those of no triangle. */
mlim_status mlim_mesh_list_failures(
  const mlim_complex* complex, mlim_context* context, mlim_mesh* mesh);

#endif
