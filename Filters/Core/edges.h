/* The edges of a triangle mesh with their triangles. */
#ifndef mlim_edges_h
#define mlim_edges_h

#include "mlim.h"

typedef struct mlim_edge_use
{
  int32_t upper; /* the edge's vertex of higher number */
  int32_t triangle;
  int32_t apex; /* the triangle's third vertex */
  int32_t sign; /* +1: the triangle runs from the lower to the upper vertex */
} mlim_edge_use;

/* Uses of the edges whose lower vertex is v: uses[offsets[v] .. offsets[v + 1]), ascending by upper
   vertex and triangle, so that the uses of one edge follow each other. */
typedef struct mlim_edges
{
  size_t* offsets; /* vertex_count + 1 */
  mlim_edge_use* uses;
  size_t use_count;
} mlim_edges;

/* `done` is reported as the share of the certificate's stage. */
mlim_status mlim_edges_create(
  const mlim_mesh* mesh, double done, mlim_context* context, mlim_edges* out);
void mlim_edges_free(mlim_edges* edges);

/* End of the run of uses that starts at `first` and belongs to one edge of the vertex `lower`. */
size_t mlim_edges_run_end(const mlim_edges* edges, int32_t lower, size_t first);

#endif
