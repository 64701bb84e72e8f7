#include "edges.h"

#include "memory.h"
#include "status.h"

#include <stdlib.h>

static int compare_uses(const void* a, const void* b)
{
  const mlim_edge_use* x = (const mlim_edge_use*)a;
  const mlim_edge_use* y = (const mlim_edge_use*)b;
  if (x->upper != y->upper)
  {
    return x->upper < y->upper ? -1 : 1;
  }
  return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static void place_uses(const mlim_mesh* mesh, mlim_edges* out)
{
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t* v = mesh->triangles + 3 * t;
    for (int k = 0; k < 3; ++k)
    {
      const int32_t a = v[k];
      const int32_t b = v[(k + 1) % 3];
      const int32_t lower = a < b ? a : b;
      out->uses[out->offsets[lower + 1]++] = (mlim_edge_use){ .upper = a < b ? b : a,
        .triangle = (int32_t)t,
        .apex = v[(k + 2) % 3],
        .sign = a < b ? 1 : -1 };
    }
  }
}

mlim_status mlim_edges_create(const mlim_mesh* mesh, mlim_context* context, mlim_edges* out)
{
  out->use_count = 3 * mesh->triangle_count;
  out->offsets = mlim_allocate_zeroed(mesh->vertex_count + 2, sizeof *out->offsets);
  out->uses = mlim_allocate(out->use_count, sizeof *out->uses);
  if (out->offsets == NULL || out->uses == NULL)
  {
    mlim_edges_free(out);
    return mlim_fail_memory(context, "the mesh's edges");
  }
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t* v = mesh->triangles + 3 * t;
    for (int k = 0; k < 3; ++k)
    {
      const int32_t a = v[k];
      const int32_t b = v[(k + 1) % 3];
      ++out->offsets[(a < b ? a : b) + 2];
    }
  }
  for (size_t v = 0; v < mesh->vertex_count; ++v)
  {
    out->offsets[v + 2] += out->offsets[v + 1];
  }
  place_uses(mesh, out);
  for (size_t v = 0; v < mesh->vertex_count; ++v)
  {
    qsort(out->uses + out->offsets[v], out->offsets[v + 1] - out->offsets[v], sizeof *out->uses,
      compare_uses);
  }
  return MLIM_OK;
}

void mlim_edges_free(mlim_edges* edges)
{
  mlim_release(edges->offsets);
  mlim_release(edges->uses);
  *edges = (mlim_edges){ 0 };
}

size_t mlim_edges_run_end(const mlim_edges* edges, int32_t lower, size_t first)
{
  size_t end = first + 1;
  while (end < edges->offsets[lower + 1] && edges->uses[end].upper == edges->uses[first].upper)
  {
    ++end;
  }
  return end;
}
