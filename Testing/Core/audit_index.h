/* A mesh with its edges and stars, for the audit. */
#ifndef mlim_audit_index_h
#define mlim_audit_index_h

#include "check.h"
#include "field.h"
#include "mlim.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* One triangle at one edge; sign +1: it runs from the lower to the upper vertex. */
typedef struct audit_use
{
  int32_t lower, upper, triangle, sign;
} audit_use;

typedef struct audit
{
  const mlim_field* field;
  const mlim_mesh* mesh;
  double unit;    /* one spacing as a length */
  double size[3]; /* of the box */
  audit_use* uses;
  size_t use_count;
  audit_use* curve_edges; /* triangle: number of the edge */
  size_t* star_offsets;   /* vertex_count + 1, into stars */
  int32_t* stars;         /* triangles round each vertex */
} audit;

static inline int audit_compare_uses(const void* a, const void* b)
{
  const audit_use* x = (const audit_use*)a;
  const audit_use* y = (const audit_use*)b;
  if (x->lower != y->lower)
  {
    return x->lower < y->lower ? -1 : 1;
  }
  if (x->upper != y->upper)
  {
    return x->upper < y->upper ? -1 : 1;
  }
  return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

static inline audit_use audit_use_of(int32_t from, int32_t to, int32_t triangle)
{
  return (audit_use){ .lower = from < to ? from : to,
    .upper = from < to ? to : from,
    .triangle = triangle,
    .sign = from < to ? 1 : -1 };
}

static inline const double* audit_point(const mlim_mesh* mesh, int32_t vertex)
{
  return mesh->vertices + 3 * (size_t)vertex;
}

/* Ids in range: everything else relies on it. */
static inline int audit_has_valid_ids(const mlim_mesh* mesh)
{
  const int32_t vertices = (int32_t)mesh->vertex_count;
  size_t bad = 0;
  for (size_t k = 0; k < 3 * mesh->triangle_count; ++k)
  {
    bad += mesh->triangles[k] < 0 || mesh->triangles[k] >= vertices;
  }
  for (size_t k = 0; k < 2 * mesh->edge_count; ++k)
  {
    bad += mesh->edges[k] < 0 || mesh->edges[k] >= vertices;
  }
  for (size_t k = 0; k < mesh->junction_count; ++k)
  {
    bad += mesh->junctions[k] < 0 || mesh->junctions[k] >= vertices;
  }
  for (size_t k = 0; k < 2 * mesh->triangle_count; ++k)
  {
    bad += mesh->triangle_labels[k] < 0 || mesh->triangle_labels[k] >= (int32_t)mesh->label_count;
  }
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    bad += mesh->triangle_faces[t] < -1 || mesh->triangle_faces[t] > 5;
    bad += mesh->triangle_patches[t] < 0 || (size_t)mesh->triangle_patches[t] >= mesh->patch_count;
  }
  CHECK_COUNT(bad, 0);
  return bad == 0;
}

static inline void audit_fill_stars(audit* a)
{
  const mlim_mesh* mesh = a->mesh;
  a->star_offsets = calloc(mesh->vertex_count + 2, sizeof *a->star_offsets);
  a->stars = malloc((3 * mesh->triangle_count + 1) * sizeof *a->stars);
  for (size_t k = 0; k < 3 * mesh->triangle_count; ++k)
  {
    ++a->star_offsets[mesh->triangles[k] + 2];
  }
  for (size_t v = 0; v < mesh->vertex_count; ++v)
  {
    a->star_offsets[v + 2] += a->star_offsets[v + 1];
  }
  for (size_t k = 0; k < 3 * mesh->triangle_count; ++k)
  {
    a->stars[a->star_offsets[mesh->triangles[k] + 1]++] = (int32_t)(k / 3);
  }
}

static inline audit audit_start(const mlim_field* field, const mlim_mesh* mesh)
{
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  audit a = { .field = field, .mesh = mesh, .unit = grid->unit };
  mlim_copy(grid->size, a.size);
  a.use_count = 3 * mesh->triangle_count;
  a.uses = malloc((a.use_count + 1) * sizeof *a.uses);
  for (size_t k = 0; k < a.use_count; ++k)
  {
    const int32_t* t = mesh->triangles + k / 3 * 3;
    a.uses[k] = audit_use_of(t[k % 3], t[(k + 1) % 3], (int32_t)(k / 3));
  }
  qsort(a.uses, a.use_count, sizeof *a.uses, audit_compare_uses);
  a.curve_edges = malloc((mesh->edge_count + 1) * sizeof *a.curve_edges);
  for (size_t e = 0; e < mesh->edge_count; ++e)
  {
    a.curve_edges[e] = audit_use_of(mesh->edges[2 * e], mesh->edges[2 * e + 1], (int32_t)e);
  }
  qsort(a.curve_edges, mesh->edge_count, sizeof *a.curve_edges, audit_compare_uses);
  audit_fill_stars(&a);
  return a;
}

static inline void audit_end(audit* a)
{
  free(a->uses);
  free(a->curve_edges);
  free(a->star_offsets);
  free(a->stars);
}

/* First place in sorted uses at or after an edge. */
static inline size_t audit_find(const audit_use* uses, size_t count, int32_t lower, int32_t upper)
{
  const audit_use key = { .lower = lower, .upper = upper, .triangle = -1 };
  size_t low = 0;
  size_t high = count;
  while (low < high)
  {
    const size_t middle = (low + high) / 2;
    const int is_before = audit_compare_uses(&uses[middle], &key) < 0;
    low = is_before ? middle + 1 : low;
    high = is_before ? high : middle;
  }
  return low;
}

static inline int audit_is_curve_edge(const audit* a, int32_t v, int32_t w)
{
  const int32_t lower = v < w ? v : w;
  const int32_t upper = v < w ? w : v;
  const size_t at = audit_find(a->curve_edges, a->mesh->edge_count, lower, upper);
  return at < a->mesh->edge_count && a->curve_edges[at].lower == lower &&
         a->curve_edges[at].upper == upper;
}

static inline size_t audit_run_end(const audit* a, size_t first)
{
  size_t end = first;
  while (end < a->use_count && a->uses[end].lower == a->uses[first].lower &&
         a->uses[end].upper == a->uses[first].upper)
  {
    ++end;
  }
  return end;
}

#endif
