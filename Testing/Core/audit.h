/* Properties that any mesh of the core has, whatever it was made from. Nothing here shares code with
   the core but vector.h: edges, links, volumes and ratios are worked out anew. */
#ifndef mlim_audit_h
#define mlim_audit_h

#include "audit_index.h"

/* ---- edges ---- */

/* Round an edge the triangles of each label run both ways equally often: its boundary closes and is
   coherently oriented. */
static inline int audit_is_open(const audit* a, size_t first, size_t end)
{
  for (size_t k = 2 * first; k < 2 * end; ++k)
  {
    const int32_t label = a->mesh->triangle_labels[2 * a->uses[k / 2].triangle + (int)(k % 2)];
    int sum = 0;
    for (size_t j = first; j < end; ++j)
    {
      const int32_t* labels = a->mesh->triangle_labels + 2 * a->uses[j].triangle;
      sum += (labels[0] == label) * a->uses[j].sign - (labels[1] == label) * a->uses[j].sign;
    }
    if (sum != 0)
    {
      return 1;
    }
  }
  return 0;
}

static inline size_t audit_count_open_edges(const audit* a)
{
  size_t count = 0;
  size_t end;
  for (size_t first = 0; first < a->use_count; first = end)
  {
    end = audit_run_end(a, first);
    count += (size_t)audit_is_open(a, first, end);
  }
  return count;
}

/* A plain edge has two triangles of one pair of labels. */
static inline size_t audit_count_bad_plain_edges(const audit* a)
{
  size_t count = 0;
  size_t end;
  for (size_t first = 0; first < a->use_count; first = end)
  {
    end = audit_run_end(a, first);
    if (audit_is_curve_edge(a, a->uses[first].lower, a->uses[first].upper))
    {
      continue;
    }
    const int32_t* l = a->mesh->triangle_labels + 2 * a->uses[first].triangle;
    const int32_t* m = a->mesh->triangle_labels + 2 * a->uses[end - 1].triangle;
    count += end - first != 2 || l[0] != m[0] || l[1] != m[1];
  }
  return count;
}

/* Regions meet on the extracted curves and at contacts alone: an edge listed off them was settled
   afterwards. */
static inline size_t audit_count_edges_off_curves(const audit* a)
{
  size_t count = 0;
  for (size_t e = 0; e < a->mesh->edge_count; ++e)
  {
    count += a->mesh->edge_curves[e] < 0 && a->mesh->edge_curves[e] != MLIM_CONTACT;
  }
  return count;
}

/* A curve edge is there once and has two triangles (a crease) or more. */
static inline size_t audit_count_bad_curve_edges(const audit* a)
{
  size_t count = 0;
  for (size_t e = 0; e < a->mesh->edge_count; ++e)
  {
    const audit_use* edge = &a->curve_edges[e];
    const size_t first = audit_find(a->uses, a->use_count, edge->lower, edge->upper);
    size_t uses = 0;
    while (first + uses < a->use_count && a->uses[first + uses].lower == edge->lower &&
           a->uses[first + uses].upper == edge->upper)
    {
      ++uses;
    }
    count += uses < 2 || edge->lower == edge->upper;
    count += e > 0 && edge[-1].lower == edge->lower && edge[-1].upper == edge->upper;
  }
  return count;
}

/* ---- links ---- */

enum
{
  AUDIT_MAX_LINK = 512
};

static inline int audit_place(const int32_t* link, int count, int32_t vertex)
{
  int k = 0;
  while (k < count && link[k] != vertex)
  {
    ++k;
  }
  return k;
}

static inline int audit_root(const int* parent, int k)
{
  while (parent[k] != k)
  {
    k = parent[k];
  }
  return k;
}

static inline int audit_is_contact(const audit* a, int32_t vertex)
{
  const mlim_mesh* mesh = a->mesh;
  size_t j = mesh->junction_count - mesh->contact_count;
  while (j < mesh->junction_count && mesh->junctions[j] != vertex)
  {
    ++j;
  }
  return j < mesh->junction_count;
}

/* The link of a vertex on a patch is one cycle. On a curve it branches at the curve's two
   neighbours, and at a junction at all of them, and every part of it hangs on one. Curves may end next
   to a contact, where any number of sheets may touch. */
static inline int audit_is_disk(const audit* a, int32_t vertex)
{
  int32_t link[AUDIT_MAX_LINK];
  int degree[AUDIT_MAX_LINK] = { 0 };
  int parent[AUDIT_MAX_LINK];
  int count = 0;
  for (size_t s = a->star_offsets[vertex]; s < a->star_offsets[vertex + 1]; ++s)
  {
    const int32_t* t = a->mesh->triangles + 3 * a->stars[s];
    const int at = t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
    int end[2];
    for (int k = 0; k < 2; ++k)
    {
      end[k] = audit_place(link, count, t[(at + 1 + k) % 3]);
      if (end[k] == count)
      {
        if (count == AUDIT_MAX_LINK)
        {
          return 0;
        }
        parent[count] = count;
        link[count++] = t[(at + 1 + k) % 3];
      }
      ++degree[end[k]];
    }
    parent[audit_root(parent, end[0])] = audit_root(parent, end[1]);
  }
  int branches = 0;
  int parts = 0;
  int contacts = 0;
  int has_branch[AUDIT_MAX_LINK] = { 0 };
  for (int k = 0; k < count; ++k)
  {
    const int is_branch = audit_is_curve_edge(a, vertex, link[k]);
    if (is_branch ? degree[k] < 2 : degree[k] != 2)
    {
      return 0;
    }
    const int is_contact = audit_is_contact(a, link[k]);
    branches += is_branch;
    contacts += is_contact;
    has_branch[audit_root(parent, k)] |= is_branch || is_contact;
  }
  if (audit_is_contact(a, vertex))
  {
    return count > 0;
  }
  for (int k = 0; k < count; ++k)
  {
    parts += parent[k] == k;
    if (parent[k] == k && branches > 0 && !has_branch[k])
    {
      return 0;
    }
  }
  const int32_t type = a->mesh->node_types[vertex] % MLIM_NODE_ON_BOX;
  return type == MLIM_NODE_INTERFACE ? parts == 1 && branches == 0
         : contacts > 0              ? 1
         : type == MLIM_NODE_CURVE   ? branches == 2
                                     : type == MLIM_NODE_JUNCTION && branches > 0;
}

/* Curve vertices that no triangle has. */
static inline size_t audit_count_bare_vertices(const audit* a)
{
  size_t count = 0;
  for (size_t v = 0; v < a->mesh->vertex_count; ++v)
  {
    count += a->star_offsets[v] == a->star_offsets[v + 1];
  }
  return count;
}

static inline size_t audit_count_bad_links(const audit* a)
{
  size_t count = 0;
  for (size_t v = 0; v < a->mesh->vertex_count; ++v)
  {
    count += !audit_is_disk(a, (int32_t)v);
  }
  return count;
}

/* ---- triangles ---- */

static inline double audit_length(const double a[3], const double b[3])
{
  return sqrt(mlim_distance_squared(a, b));
}

/* Twice the area vector. */
static inline void audit_normal(const mlim_mesh* mesh, size_t triangle, double out[3])
{
  const int32_t* t = mesh->triangles + 3 * triangle;
  double u[3];
  double v[3];
  mlim_subtract(audit_point(mesh, t[1]), audit_point(mesh, t[0]), u);
  mlim_subtract(audit_point(mesh, t[2]), audit_point(mesh, t[0]), v);
  mlim_cross(u, v, out);
}

static inline double audit_ratio(const mlim_mesh* mesh, size_t triangle)
{
  const int32_t* t = mesh->triangles + 3 * triangle;
  double n[3];
  double length[3];
  for (int k = 0; k < 3; ++k)
  {
    length[k] = audit_length(audit_point(mesh, t[k]), audit_point(mesh, t[(k + 1) % 3]));
  }
  audit_normal(mesh, triangle, n);
  const double radius = length[0] * length[1] * length[2] / (2 * sqrt(mlim_dot(n, n)));
  return radius / fmin(length[0], fmin(length[1], length[2]));
}

static inline int audit_has_ball(const mlim_mesh* mesh, size_t triangle)
{
  int has_ball = 0;
  for (size_t k = 0; k < 3; ++k)
  {
    const int32_t type = mesh->node_types[mesh->triangles[3 * triangle + k]];
    has_ball |= type % MLIM_NODE_ON_BOX != MLIM_NODE_INTERFACE;
  }
  return has_ball;
}

static inline int audit_compare_triples(const void* a, const void* b)
{
  return memcmp(a, b, 3 * sizeof(int32_t));
}

/* Degenerate ones, and triples of vertices that are there twice. */
static inline size_t audit_count_bad_triangles(const audit* a)
{
  const mlim_mesh* mesh = a->mesh;
  int32_t* triple = malloc((3 * mesh->triangle_count + 1) * sizeof *triple);
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t* v = mesh->triangles + 3 * t;
    const int32_t low = v[0] < v[1] ? (v[0] < v[2] ? v[0] : v[2]) : v[1] < v[2] ? v[1] : v[2];
    const int32_t high = v[0] > v[1] ? (v[0] > v[2] ? v[0] : v[2]) : v[1] > v[2] ? v[1] : v[2];
    triple[3 * t] = low;
    triple[3 * t + 1] = v[0] + v[1] + v[2] - low - high;
    triple[3 * t + 2] = high;
    double n[3];
    audit_normal(mesh, t, n);
    count += v[0] == v[1] || v[1] == v[2] || v[2] == v[0] || !(mlim_dot(n, n) > 0);
  }
  qsort(triple, mesh->triangle_count, 3 * sizeof *triple, audit_compare_triples);
  for (size_t t = 1; t < mesh->triangle_count; ++t)
  {
    count += memcmp(triple + 3 * t, triple + 3 * t - 3, 3 * sizeof *triple) == 0;
  }
  free(triple);
  return count;
}

/* The background second, else ascending ids. */
static inline size_t audit_count_bad_labels(const audit* a)
{
  const int32_t outside = mlim_field_outside_label(a->field);
  size_t count = 0;
  for (size_t t = 0; t < a->mesh->triangle_count; ++t)
  {
    const int32_t* l = a->mesh->triangle_labels + 2 * t;
    count += l[0] == outside || l[0] == l[1] ||
             (l[1] != outside &&
               mlim_field_label_id(a->field, l[0]) >= mlim_field_label_id(a->field, l[1]));
  }
  return count;
}

/* A cap lies exactly on its face, between a region and the outside, with its normal outwards. */
static inline size_t audit_count_bad_caps(const audit* a)
{
  const mlim_mesh* mesh = a->mesh;
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t face = mesh->triangle_faces[t];
    if (face < 0)
    {
      continue;
    }
    const int axis = face / 2;
    const double plane = face % 2 ? a->size[axis] : 0;
    int is_bad = mesh->triangle_labels[2 * t + 1] != mlim_field_outside_label(a->field);
    for (size_t k = 0; k < 3; ++k)
    {
      is_bad |= audit_point(mesh, mesh->triangles[3 * t + k])[axis] != plane;
    }
    double n[3];
    audit_normal(mesh, t, n);
    count += (size_t)(is_bad || !((face % 2 ? n[axis] : -n[axis]) > 0));
  }
  return count;
}

/* Samples on both sides of the centroid, at growing distances since a flat triangle leaves a curved
   interface: one pair of samples has to see the two labels in their order. */
static inline size_t audit_count_wrong_normals(const audit* a, double reach)
{
  const mlim_mesh* mesh = a->mesh;
  size_t count = 0;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    double n[3];
    double center[3] = { 0, 0, 0 };
    audit_normal(mesh, t, n);
    const double length = sqrt(mlim_dot(n, n));
    for (size_t k = 0; k < 9; ++k)
    {
      center[k % 3] += audit_point(mesh, mesh->triangles[3 * t + k / 3])[k % 3] / 3;
    }
    int is_right = 0;
    for (double step = 0.01 * a->unit; step < reach && !is_right; step *= 2)
    {
      double before[3];
      double after[3];
      for (int k = 0; k < 3; ++k)
      {
        before[k] = center[k] - step * n[k] / length;
        after[k] = center[k] + step * n[k] / length;
      }
      is_right = mlim_field_label(a->field, before) == mesh->triangle_labels[2 * t] &&
                 mlim_field_label(a->field, after) == mesh->triangle_labels[2 * t + 1];
    }
    count += !is_right;
  }
  return count;
}

static inline size_t audit_count_bad_ratios(const audit* a, double bound)
{
  size_t count = 0;
  for (size_t t = 0; t < a->mesh->triangle_count; ++t)
  {
    count += !audit_has_ball(a->mesh, t) && !(audit_ratio(a->mesh, t) <= bound * (1 + 1e-9));
  }
  return count;
}

/* ---- vertices ---- */

static inline int audit_compare_points(const void* a, const void* b)
{
  const double* x = (const double*)a;
  const double* y = (const double*)b;
  for (int k = 0; k < 3; ++k)
  {
    if (x[k] < y[k] || x[k] > y[k])
    {
      return x[k] < y[k] ? -1 : 1;
    }
  }
  return 0;
}

/* Outside the box or not finite, there twice, or of no use. */
static inline size_t audit_count_bad_vertices(const audit* a)
{
  const mlim_mesh* mesh = a->mesh;
  const size_t bytes = 3 * mesh->vertex_count * sizeof(double);
  double* sorted = malloc(bytes + 1);
  unsigned char* is_used = calloc(mesh->vertex_count + 1, 1);
  for (size_t k = 0; k < 2 * mesh->edge_count; ++k)
  {
    is_used[mesh->edges[k]] = 1;
  }
  for (size_t k = 0; k < mesh->junction_count; ++k)
  {
    is_used[mesh->junctions[k]] = 1;
  }
  size_t count = 0;
  for (size_t v = 0; v < mesh->vertex_count; ++v)
  {
    for (int k = 0; k < 3; ++k)
    {
      const double x = audit_point(mesh, (int32_t)v)[k];
      count += !(x >= 0 && x <= a->size[k]);
      sorted[3 * v + (size_t)k] = x;
    }
    count += !is_used[v] && a->star_offsets[v] == a->star_offsets[v + 1];
  }
  free(is_used);
  qsort(sorted, mesh->vertex_count, 3 * sizeof *sorted, audit_compare_points);
  for (size_t v = 1; v < mesh->vertex_count; ++v)
  {
    count += audit_compare_points(sorted + 3 * v, sorted + 3 * v - 3) == 0;
  }
  free(sorted);
  return count;
}

/* Vertices of patches that lie inside a protecting ball. */
static inline size_t audit_count_in_balls(const audit* a, const mlim_balls* balls)
{
  size_t count = 0;
  for (size_t v = 0; v < a->mesh->vertex_count; ++v)
  {
    if (a->mesh->node_types[v] % MLIM_NODE_ON_BOX != MLIM_NODE_INTERFACE)
    {
      continue;
    }
    for (size_t b = 0; b < balls->ball_count; ++b)
    {
      count += audit_length(audit_point(a->mesh, (int32_t)v), balls->centers + 3 * b) <
               balls->radii[b] * (1 - 1e-9);
    }
  }
  return count;
}

/* ---- volumes ---- */

/* By the divergence theorem with (0, 0, z): another formula than the core's. */
static inline double audit_volume(const mlim_mesh* mesh, int32_t label)
{
  double sum = 0;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t* l = mesh->triangle_labels + 2 * t;
    double n[3];
    double z = 0;
    audit_normal(mesh, t, n);
    for (size_t k = 0; k < 3; ++k)
    {
      z += audit_point(mesh, mesh->triangles[3 * t + k])[2] / 3;
    }
    sum += ((l[0] == label) - (l[1] == label)) * 0.5 * n[2] * z;
  }
  return sum;
}

static inline void audit_volumes(const audit* a)
{
  const double box = a->size[0] * a->size[1] * a->size[2];
  const int32_t outside = mlim_field_outside_label(a->field);
  double sum = 0;
  for (int32_t l = 0; l < (int32_t)a->mesh->label_count; ++l)
  {
    const double expected = l == outside ? 0 : audit_volume(a->mesh, l);
    CHECK_BELOW(fabs(a->mesh->volumes[l] - expected), 1e-9 * box);
    CHECK(a->mesh->volumes[l] >= -1e-9 * box);
    sum += a->mesh->volumes[l];
  }
  CHECK_BELOW(sum, box * (1 + 1e-9));
}

/* ---- all of it ---- */

static inline void audit_partition_of(const audit* a)
{
  CHECK_COUNT(audit_count_open_edges(a), 0);
  CHECK_COUNT(a->mesh->certificate.open_edge_count, 0);
  CHECK_COUNT(audit_count_bad_triangles(a), 0);
  CHECK_COUNT(audit_count_bad_labels(a), 0);
  CHECK_COUNT(audit_count_bad_vertices(a), 0);
  audit_volumes(a);
}

/* What holds at every moment of refinement: a labelled partition with closed regions. */
static inline void audit_partition(const mlim_field* field, const mlim_mesh* mesh)
{
  CHECK_COUNT(mesh->label_count, (size_t)mlim_field_label_count(field));
  if (audit_has_valid_ids(mesh))
  {
    audit a = audit_start(field, mesh);
    audit_partition_of(&a);
    audit_end(&a);
  }
}

/* What holds for a finished mesh. `options` are complete. */
static inline void audit_mesh(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, const mlim_mesh* mesh)
{
  CHECK_COUNT(mesh->label_count, (size_t)mlim_field_label_count(field));
  if (!audit_has_valid_ids(mesh))
  {
    return;
  }
  audit a = audit_start(field, mesh);
  audit_partition_of(&a);
  CHECK_COUNT(audit_count_bad_plain_edges(&a), 0);
  CHECK_COUNT(audit_count_bad_curve_edges(&a), 0);
  CHECK_COUNT(audit_count_edges_off_curves(&a), 0);
  CHECK_COUNT(audit_count_bare_vertices(&a), 0);
  CHECK_COUNT(audit_count_bad_links(&a), 0);
  CHECK_COUNT(mesh->certificate.disk_failure_count, 0);
  CHECK_COUNT(audit_count_bad_caps(&a), 0);
  CHECK_COUNT(audit_count_bad_ratios(&a, options->facet_radius_edge_ratio), 0);
  const double reach = fmax(0.5 * a.unit, 4 * options->facet_distance);
  CHECK_BELOW((double)audit_count_wrong_normals(&a, reach), 0.01 * (double)mesh->triangle_count);
  if (mesh->report.hidden_ball_count == 0)
  {
    CHECK_COUNT(audit_count_in_balls(&a, balls), 0);
  }
  audit_end(&a);
}

/* Vertices - edges + triangles of the boundary of one label. */
static inline int audit_euler(const mlim_field* field, const mlim_mesh* mesh, int32_t label)
{
  audit a = audit_start(field, mesh);
  int euler = 0;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t* l = mesh->triangle_labels + 2 * t;
    euler += l[0] == label || l[1] == label;
  }
  size_t end;
  for (size_t first = 0; first < a.use_count; first = end)
  {
    end = audit_run_end(&a, first);
    int is_there = 0;
    for (size_t k = first; k < end; ++k)
    {
      const int32_t* l = mesh->triangle_labels + 2 * a.uses[k].triangle;
      is_there |= l[0] == label || l[1] == label;
    }
    euler -= is_there;
  }
  for (size_t v = 0; v < mesh->vertex_count; ++v)
  {
    int is_there = 0;
    for (size_t s = a.star_offsets[v]; s < a.star_offsets[v + 1]; ++s)
    {
      const int32_t* l = mesh->triangle_labels + 2 * a.stars[s];
      is_there |= l[0] == label || l[1] == label;
    }
    euler += is_there;
  }
  audit_end(&a);
  return euler;
}

#endif
