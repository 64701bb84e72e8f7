#include "quality.h"

#include "memory.h"
#include "status.h"
#include "triangle.h"

#include <math.h>
#include <stdlib.h>

/* The loop and this file round a ratio differently, relative. */
static const double ROUNDING = 1e-9;

enum
{
  ITEMS_A_PIECE = 1 << 16, /* between two looks at the host: some milliseconds */
  BLOCK = 1 << 12          /* vertices whose edges are counted together */
};

static const double DEGREES = 57.29577951308232; /* in a radian */

static int32_t root_of(int32_t* parent, int32_t k)
{
  while (parent[k] != k)
  {
    parent[k] = parent[parent[k]];
    k = parent[k];
  }
  return k;
}

static int same_labels(const mlim_mesh* mesh, int32_t a, int32_t b)
{
  const int32_t* l = mesh->triangle_labels;
  return l[2 * a] == l[2 * b] && l[2 * a + 1] == l[2 * b + 1];
}

/* Joins triangles across edges that exactly two share, both of one pair of labels and one face. */
static void join_patches(const mlim_mesh* mesh, const mlim_edges* edges, int32_t* parent)
{
  for (size_t v = 0; v < mesh->vertex_count; ++v)
  {
    size_t end;
    for (size_t first = edges->offsets[v]; first < edges->offsets[v + 1]; first = end)
    {
      end = mlim_edges_run_end(edges, (int32_t)v, first);
      const int32_t a = edges->uses[first].triangle;
      const int32_t b = edges->uses[end - 1].triangle;
      if (end - first == 2 && same_labels(mesh, a, b) &&
          mesh->triangle_faces[a] == mesh->triangle_faces[b])
      {
        const int32_t ra = root_of(parent, a);
        const int32_t rb = root_of(parent, b);
        parent[ra < rb ? rb : ra] = ra < rb ? ra : rb;
      }
    }
  }
}

mlim_status mlim_quality_find_patches(
  mlim_mesh* mesh, const mlim_edges* edges, mlim_context* context)
{
  int32_t* parent = mlim_allocate(mesh->triangle_count, sizeof *parent);
  if (parent == NULL)
  {
    return mlim_fail_memory(context, "the patches");
  }
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    parent[t] = (int32_t)t;
  }
  join_patches(mesh, edges, parent);
  mesh->patch_count = 0;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    /* A root is the first triangle of its patch. */
    const int32_t root = root_of(parent, (int32_t)t);
    mesh->triangle_patches[t] =
      root == (int32_t)t ? (int32_t)mesh->patch_count++ : mesh->triangle_patches[root];
  }
  mlim_release(parent);
  return MLIM_OK;
}

static int compare_pairs(const void* a, const void* b)
{
  const int32_t* x = (const int32_t*)a;
  const int32_t* y = (const int32_t*)b;
  if (x[0] != y[0])
  {
    return x[0] < y[0] ? -1 : 1;
  }
  return (x[1] > y[1]) - (x[1] < y[1]);
}

/* The curve edges, the lower vertex first, sorted. */
static int32_t* sort_curve_edges(const mlim_mesh* mesh)
{
  int32_t* pairs = mlim_allocate(mesh->edge_count, 2 * sizeof *pairs);
  for (size_t e = 0; pairs != NULL && e < mesh->edge_count; ++e)
  {
    const int32_t* v = mesh->edges + 2 * e;
    pairs[2 * e] = v[0] < v[1] ? v[0] : v[1];
    pairs[2 * e + 1] = v[0] < v[1] ? v[1] : v[0];
  }
  if (pairs != NULL && mesh->edge_count > 1)
  {
    qsort(pairs, mesh->edge_count, 2 * sizeof *pairs, compare_pairs);
  }
  return pairs;
}

static int is_ball(const mlim_mesh* mesh, int32_t vertex)
{
  return mesh->node_types[vertex] % MLIM_NODE_ON_BOX > MLIM_NODE_INTERFACE;
}

static int append_edge(
  mlim_mesh* mesh, const unsigned char* is_contact, size_t capacity[2], const int32_t pair[2])
{
  const size_t e = mesh->edge_count;
  if (mlim_reserve(&mesh->edges, &capacity[0], 2 * e + 2, sizeof *mesh->edges) ||
      mlim_reserve(&mesh->edge_curves, &capacity[1], e + 1, sizeof *mesh->edge_curves))
  {
    return 1;
  }
  const int is_at_contact = (is_contact[pair[0]] || is_contact[pair[1]]) &&
                            is_ball(mesh, pair[0]) && is_ball(mesh, pair[1]);
  mesh->edges[2 * e] = pair[0];
  mesh->edges[2 * e + 1] = pair[1];
  mesh->edge_curves[e] = is_at_contact ? MLIM_CONTACT : -1;
  ++mesh->edge_count;
  ++*(is_at_contact ? &mesh->report.contact_edge_count : &mesh->report.off_curve_edge_count);
  return 0;
}

static int has_triangle(const mlim_edges* edges, int32_t a, int32_t b)
{
  const int32_t lower = a < b ? a : b;
  const int32_t upper = a < b ? b : a;
  for (size_t k = edges->offsets[lower]; k < edges->offsets[lower + 1]; ++k)
  {
    if (edges->uses[k].upper == upper)
    {
      return 1;
    }
  }
  return 0;
}

static void drop_edges(mlim_mesh* mesh, const mlim_edges* edges)
{
  size_t kept = 0;
  for (size_t e = 0; e < mesh->edge_count; ++e)
  {
    const int32_t a = mesh->edges[2 * e];
    const int32_t b = mesh->edges[2 * e + 1];
    if (has_triangle(edges, a, b))
    {
      mesh->edges[2 * kept] = a;
      mesh->edges[2 * kept + 1] = b;
      mesh->edge_curves[kept++] = mesh->edge_curves[e];
    }
  }
  mesh->report.lost_curve_edge_count = mesh->edge_count - kept;
  mesh->edge_count = kept;
}

static unsigned char* mark_contacts(const mlim_mesh* mesh)
{
  unsigned char* is_contact = mlim_allocate_zeroed(mesh->vertex_count, 1);
  const size_t first = mesh->junction_count - mesh->contact_count;
  for (size_t j = first; is_contact != NULL && j < mesh->junction_count; ++j)
  {
    is_contact[mesh->junctions[j]] = 1;
  }
  return is_contact;
}

mlim_status mlim_quality_settle_edges(
  mlim_mesh* mesh, const mlim_edges* edges, mlim_context* context)
{
  drop_edges(mesh, edges);
  const size_t curve_edges = mesh->edge_count;
  size_t capacity[2] = { 2 * curve_edges, curve_edges };
  int32_t* pairs = sort_curve_edges(mesh);
  unsigned char* is_contact = mark_contacts(mesh);
  int has_failed = pairs == NULL || is_contact == NULL;
  for (size_t v = 0; v < mesh->vertex_count && !has_failed; ++v)
  {
    size_t end;
    for (size_t first = edges->offsets[v]; first < edges->offsets[v + 1] && !has_failed;
         first = end)
    {
      end = mlim_edges_run_end(edges, (int32_t)v, first);
      const int32_t pair[2] = { (int32_t)v, edges->uses[first].upper };
      if (end - first > 2 && (curve_edges == 0 || bsearch(pair, pairs, curve_edges,
                                                    2 * sizeof *pairs, compare_pairs) == NULL))
      {
        has_failed = append_edge(mesh, is_contact, capacity, pair);
      }
    }
  }
  mlim_release(pairs);
  mlim_release(is_contact);
  return has_failed ? mlim_fail_memory(context, "the mesh's curve edges") : MLIM_OK;
}

static double angle_between(const double u[3], const double v[3])
{
  double n[3];
  mlim_cross(u, v, n);
  return DEGREES * atan2(sqrt(mlim_dot(n, n)), mlim_dot(u, v));
}

typedef struct triangle_look
{
  double angle; /* the smallest; 180 where others of the range are known to have a smaller one */
  double ratio;
  int has_ball;
} triangle_look;

typedef struct triangle_job
{
  const mlim_mesh* mesh;
  size_t first; /* triangle of looks[0] */
  triangle_look* looks;
} triangle_job;

typedef struct least_angle
{
  double angle;
  double tangent; /* a little above its tangent; INFINITY: from 90 degrees on */
} least_angle;

/* The angle between two directions, and *least lowered to it. What is larger than that for certain costs
   no arc tangent, and counts as 180. */
static double lower_angle(least_angle* least, const double u[3], const double v[3])
{
  double n[3];
  mlim_cross(u, v, n);
  const double across = sqrt(mlim_dot(n, n));
  const double along = mlim_dot(u, v);
  if (along <= 0 ? least->tangent < INFINITY : across > least->tangent * along)
  {
    return 180;
  }
  const double angle = DEGREES * atan2(across, along);
  if (angle < least->angle)
  {
    least->angle = angle;
    least->tangent = along > 0 ? across / along * (1 + ROUNDING) : INFINITY;
  }
  return angle;
}

static void look_at_triangle(
  const mlim_mesh* mesh, size_t t, least_angle* least, triangle_look* out)
{
  const int32_t* id = mesh->triangles + 3 * t;
  const double* p[3];
  *out = (triangle_look){ .angle = 180 };
  for (int k = 0; k < 3; ++k)
  {
    p[k] = mesh->vertices + 3 * (size_t)id[k];
    out->has_ball |= mesh->node_types[id[k]] % MLIM_NODE_ON_BOX != MLIM_NODE_INTERFACE;
  }
  for (int k = 0; k < 3; ++k)
  {
    double u[3];
    double v[3];
    mlim_subtract(p[(k + 1) % 3], p[k], u);
    mlim_subtract(p[(k + 2) % 3], p[k], v);
    out->angle = mlim_min(out->angle, lower_angle(least, u, v));
  }
  out->ratio = sqrt(mlim_radius_edge_ratio_squared(p[0], p[1], p[2]));
}

static void triangle_body(void* data, size_t begin, size_t end)
{
  const triangle_job* job = (const triangle_job*)data;
  least_angle least = { .angle = 180, .tangent = INFINITY };
  for (size_t k = begin; k < end; ++k)
  {
    look_at_triangle(job->mesh, job->first + k, &least, &job->looks[k]);
  }
}

static void add_look(mlim_report* report, const triangle_look* look, double bound)
{
  double* worst =
    look->has_ball ? &report->max_ball_radius_edge_ratio : &report->max_radius_edge_ratio;
  report->min_angle = mlim_min(report->min_angle, look->angle);
  *worst = mlim_max(*worst, look->ratio);
  report->relabeled_ratio_count += !look->has_ball && look->ratio > bound * (1 + ROUNDING);
}

/* Piece by piece, so that few looks have to be kept; summed one after the other, whoever took them. */
static mlim_status measure_triangles(
  mlim_mesh* mesh, double bound, double done, mlim_context* context, double* ratio_sum)
{
  triangle_job job = { .mesh = mesh, .looks = mlim_allocate(ITEMS_A_PIECE, sizeof *job.looks) };
  mlim_status status =
    job.looks != NULL ? MLIM_OK : mlim_fail_memory(context, "the shapes of the triangles");
  for (; job.first < mesh->triangle_count && status == MLIM_OK; job.first += ITEMS_A_PIECE)
  {
    const size_t left = mesh->triangle_count - job.first;
    const size_t count = left < ITEMS_A_PIECE ? left : ITEMS_A_PIECE;
    mlim_parallel_for(context, count, triangle_body, &job);
    for (size_t k = 0; k < count; ++k)
    {
      add_look(&mesh->report, &job.looks[k], bound);
      *ratio_sum += job.looks[k].ratio;
    }
    status = mlim_progress(context, MLIM_STAGE_CERTIFICATE, done);
  }
  mlim_release(job.looks);
  return status;
}

/* Direction from an edge into a triangle, perpendicular to the edge. */
static void direction_into(
  const double a[3], const double b[3], const double apex[3], double out[3])
{
  double along[3];
  double to[3];
  mlim_subtract(b, a, along);
  mlim_subtract(apex, a, to);
  const double t = mlim_dot(to, along) / mlim_dot(along, along);
  for (int k = 0; k < 3; ++k)
  {
    out[k] = to[k] - t * along[k];
  }
}

static double smallest_dihedral(
  const mlim_mesh* mesh, const mlim_edges* edges, int32_t lower, size_t first, size_t end)
{
  double least = 180;
  const double* a = mesh->vertices + 3 * (size_t)lower;
  const double* b = mesh->vertices + 3 * (size_t)edges->uses[first].upper;
  for (size_t i = first; i < end; ++i)
  {
    double u[3];
    direction_into(a, b, mesh->vertices + 3 * (size_t)edges->uses[i].apex, u);
    for (size_t j = first; j < i; ++j)
    {
      double v[3];
      direction_into(a, b, mesh->vertices + 3 * (size_t)edges->uses[j].apex, v);
      least = mlim_min(least, angle_between(u, v));
    }
  }
  return least;
}

/* Between the sheets round a curve's edge; 180 at a crease, which has two triangles. */
static double dihedral_at(const mlim_mesh* mesh, const mlim_edges* edges, const int32_t edge[2])
{
  const int32_t lower = edge[0] < edge[1] ? edge[0] : edge[1];
  const int32_t upper = edge[0] < edge[1] ? edge[1] : edge[0];
  size_t first = edges->offsets[lower];
  while (first < edges->offsets[lower + 1] && edges->uses[first].upper != upper)
  {
    ++first;
  }
  if (first == edges->offsets[lower + 1])
  {
    return 180;
  }
  const size_t end = mlim_edges_run_end(edges, lower, first);
  return end - first > 2 ? smallest_dihedral(mesh, edges, lower, first, end) : 180;
}

mlim_status mlim_quality_measure(
  mlim_mesh* mesh, const mlim_edges* edges, double bound, double done, mlim_context* context)
{
  mlim_report* report = &mesh->report;
  report->min_angle = mesh->triangle_count > 0 ? 180 : 0;
  report->min_dihedral_angle = 180;
  report->max_radius_edge_ratio = 0;
  report->max_ball_radius_edge_ratio = 0;
  double ratio_sum = 0;
  const mlim_status status = measure_triangles(mesh, bound, done, context, &ratio_sum);
  report->mean_radius_edge_ratio =
    mesh->triangle_count > 0 ? ratio_sum / (double)mesh->triangle_count : 0;
  /* At contacts sheets touch, at any angle. */
  for (size_t e = 0; e < mesh->edge_count && status == MLIM_OK; ++e)
  {
    if (mesh->edge_curves[e] != MLIM_CONTACT)
    {
      report->min_dihedral_angle =
        mlim_min(report->min_dihedral_angle, dihedral_at(mesh, edges, mesh->edges + 2 * e));
    }
  }
  return status;
}

/* Balance of one label round an edge: its triangles run both ways equally often. */
static int balance(
  const mlim_mesh* mesh, const mlim_edges* edges, size_t first, size_t end, int32_t label)
{
  int sum = 0;
  for (size_t k = first; k < end; ++k)
  {
    const int32_t* labels = mesh->triangle_labels + 2 * (size_t)edges->uses[k].triangle;
    sum += labels[0] == label ? edges->uses[k].sign : 0;
    sum -= labels[1] == label ? edges->uses[k].sign : 0;
  }
  return sum;
}

static int is_open(const mlim_mesh* mesh, const mlim_edges* edges, size_t first, size_t end)
{
  for (size_t k = first; k < end; ++k)
  {
    const int32_t* labels = mesh->triangle_labels + 2 * (size_t)edges->uses[k].triangle;
    if (balance(mesh, edges, first, end, labels[0]) != 0 ||
        balance(mesh, edges, first, end, labels[1]) != 0)
    {
      return 1;
    }
  }
  return 0;
}

typedef struct open_job
{
  const mlim_mesh* mesh;
  const mlim_edges* edges;
} open_job;

/* Of the edges whose lower vertex is in the range. */
static size_t count_open(const void* data, size_t begin, size_t end)
{
  const open_job* job = (const open_job*)data;
  size_t count = 0;
  for (size_t v = begin; v < end; ++v)
  {
    size_t run_end;
    for (size_t first = job->edges->offsets[v]; first < job->edges->offsets[v + 1]; first = run_end)
    {
      run_end = mlim_edges_run_end(job->edges, (int32_t)v, first);
      count += (size_t)is_open(job->mesh, job->edges, first, run_end);
    }
  }
  return count;
}

mlim_status mlim_quality_count_open_edges(
  const mlim_mesh* mesh, const mlim_edges* edges, double done, mlim_context* context, size_t* count)
{
  return mlim_parallel_count(context,
    &(mlim_counting){ .item_count = mesh->vertex_count,
      .block = BLOCK,
      .count = count_open,
      .job = &(open_job){ .mesh = mesh, .edges = edges },
      .stage = MLIM_STAGE_CERTIFICATE,
      .done = done },
    count);
}
