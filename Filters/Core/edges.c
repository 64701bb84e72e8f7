#include "edges.h"

#include "memory.h"
#include "status.h"

enum
{
  SLABS = 2,                 /* of vertices, whose uses are placed for themselves */
  VERTICES_A_PIECE = 1 << 16 /* between two looks at the host: some milliseconds */
};

/* ---- sorting ---- */

typedef struct sort_job
{
  const size_t* offsets;
  mlim_edge_use* uses;
} sort_job;

/* By upper vertex. A vertex has few uses, placed in the order of their triangles, which is kept. */
static void sort_uses(mlim_edge_use* uses, size_t count)
{
  for (size_t k = 1; k < count; ++k)
  {
    const mlim_edge_use use = uses[k];
    size_t at = k;
    for (; at > 0 && uses[at - 1].upper > use.upper; --at)
    {
      uses[at] = uses[at - 1];
    }
    uses[at] = use;
  }
}

static void sort_body(void* data, size_t begin, size_t end)
{
  const sort_job* job = (const sort_job*)data;
  for (size_t v = begin; v < end; ++v)
  {
    sort_uses(job->uses + job->offsets[v], job->offsets[v + 1] - job->offsets[v]);
  }
}

/* ---- placing ---- */

typedef struct placing
{
  const mlim_mesh* mesh;
  mlim_edges* edges;
  int is_placing; /* else counting: offsets are two ahead */
} placing;

/* Slabs of lower vertices do not meet; each looks at all triangles, in their order. */
static void place_body(void* data, size_t begin, size_t end)
{
  const placing* p = (const placing*)data;
  const mlim_mesh* mesh = p->mesh;
  const size_t first = mesh->vertex_count * begin / SLABS;
  const size_t last = mesh->vertex_count * end / SLABS;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t* v = mesh->triangles + 3 * t;
    for (int k = 0; k < 3; ++k)
    {
      const int32_t a = v[k];
      const int32_t b = v[k < 2 ? k + 1 : 0];
      const size_t lower = (size_t)(a < b ? a : b);
      if (lower < first || lower >= last)
      {
        continue;
      }
      if (!p->is_placing)
      {
        ++p->edges->offsets[lower + 2];
        continue;
      }
      p->edges->uses[p->edges->offsets[lower + 1]++] = (mlim_edge_use){ .upper = a < b ? b : a,
        .triangle = (int32_t)t,
        .apex = v[k > 0 ? k - 1 : 2],
        .sign = a < b ? 1 : -1 };
    }
  }
}

static void place_uses(const mlim_mesh* mesh, mlim_context* context, mlim_edges* out)
{
  placing p = { .mesh = mesh, .edges = out };
  mlim_parallel_for(context, SLABS, place_body, &p);
  for (size_t v = 0; v < mesh->vertex_count; ++v)
  {
    out->offsets[v + 2] += out->offsets[v + 1];
  }
  p.is_placing = 1;
  mlim_parallel_for(context, SLABS, place_body, &p);
}

mlim_status mlim_edges_create(
  const mlim_mesh* mesh, double done, mlim_context* context, mlim_edges* out)
{
  out->use_count = 3 * mesh->triangle_count;
  out->offsets = mlim_allocate_zeroed(mesh->vertex_count + 2, sizeof *out->offsets);
  out->uses = mlim_allocate(out->use_count, sizeof *out->uses);
  if (out->offsets == NULL || out->uses == NULL)
  {
    mlim_edges_free(out);
    return mlim_fail_memory(context, "the mesh's edges");
  }
  place_uses(mesh, context, out);
  const mlim_status status =
    mlim_parallel_stage(context, &(mlim_stage_work){ .count = mesh->vertex_count,
                                   .body = sort_body,
                                   .job = &(sort_job){ .offsets = out->offsets, .uses = out->uses },
                                   .stage = MLIM_STAGE_CERTIFICATE,
                                   .from = done,
                                   .to = done,
                                   .step = VERTICES_A_PIECE });
  if (status != MLIM_OK)
  {
    mlim_edges_free(out);
  }
  return status;
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
