/* Reads the mesh from the finished complex. */
#ifndef mlim_mesh_h
#define mlim_mesh_h

#include "complex.h"

/* Fills everything of the mesh but its report and certificate. */
mlim_status mlim_mesh_read(const mlim_complex* complex, mlim_context* context, mlim_mesh* out);

/* The same; vertex_of receives the mesh's vertex, or -1, of each of the complex's vertices. */
mlim_status mlim_mesh_read_mapped(
  const mlim_complex* complex, mlim_context* context, int32_t* vertex_of, mlim_mesh* out);

#endif
