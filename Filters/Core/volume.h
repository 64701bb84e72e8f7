/* The volume: the triangulation's cells in their regions, refined and freed of slivers. */
#ifndef mlim_volume_h
#define mlim_volume_h

#include "complex.h"

typedef struct mlim_volume_input
{
  mlim_complex* complex; /* its surface has been read; used up */
  const mlim_mesh* mesh;
  const int32_t* mesh_vertices; /* the mesh's vertex, or -1, of each vertex of the complex */
  size_t mesh_vertices_count;   /* vertices the complex had when the mesh was read */
  const mlim_options* options;
} mlim_volume_input;

/* MLIM_VERTEX_LIMIT: the volume is valid but unfinished. */
mlim_status mlim_volume_make(
  const mlim_volume_input* input, mlim_context* context, mlim_volume* out);

#endif
