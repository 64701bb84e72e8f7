#include "mesh.h"

#include "ahead.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <string.h>

enum
{
  ITEMS_A_PIECE = 1 << 16 /* between two looks at the host: some milliseconds */
};

typedef struct reader
{
  const mlim_complex* complex;
  mlim_context* context;
  double done; /* of the stage */
  mlim_mesh* mesh;
  mlim_boundary_facet* facets; /* of each triangle */
  int32_t* vertex_of;          /* mesh vertex of each vertex of the complex, -1 */
  int32_t* vertex_of_ball;     /* the complex's */
  double* volumes;             /* of the cone from the origin over each triangle */
} reader;

/* The output's order of a facet's sides: the background second, else the lower id first. */
static int is_ordered(const mlim_field* field, int32_t first, int32_t second)
{
  const int32_t outside = mlim_field_outside_label(field);
  if (first == outside || second == outside)
  {
    return second == outside;
  }
  return mlim_field_label_id(field, first) < mlim_field_label_id(field, second);
}

static mlim_status run(const reader* r, mlim_body body, size_t count)
{
  return mlim_parallel_stage(r->context, &(mlim_stage_work){ .count = count,
                                           .body = body,
                                           .job = (void*)r,
                                           .stage = MLIM_STAGE_CERTIFICATE,
                                           .from = r->done,
                                           .to = r->done,
                                           .step = ITEMS_A_PIECE });
}

/* With the complex's vertices. */
static void read_triangle(const reader* r, size_t t)
{
  const mlim_complex* complex = r->complex;
  const int32_t id = r->facets[t].cell;
  const int index = r->facets[t].index;
  const mlim_cell* cell = &complex->cells[id];
  const int32_t other = complex->cells[cell->neighbors[index]].label;
  mlim_mesh* mesh = r->mesh;
  int32_t v[3];
  mlim_complex_facet_vertices(complex, id, index, v); /* the normal points out of the cell */
  const int is_swapped = !is_ordered(complex->oracle.field, cell->label, other);
  mesh->triangle_labels[2 * t] = is_swapped ? other : cell->label;
  mesh->triangle_labels[2 * t + 1] = is_swapped ? cell->label : other;
  mesh->triangles[3 * t] = v[0];
  mesh->triangles[3 * t + 1] = v[is_swapped ? 2 : 1];
  mesh->triangles[3 * t + 2] = v[is_swapped ? 1 : 2];
  mesh->triangle_faces[t] = mlim_complex_face(complex, id, index);
}

static double cone_volume(const mlim_complex* complex, const int32_t vertices[3])
{
  const double* a = complex->vertices[vertices[0]].point;
  const double* b = complex->vertices[vertices[1]].point;
  const double* c = complex->vertices[vertices[2]].point;
  double n[3];
  mlim_cross(b, c, n);
  return mlim_dot(a, n) / 6;
}

static void ask_ahead(const reader* r, size_t t, size_t end)
{
  if (t + MLIM_CELLS_AHEAD < end)
  {
    mlim_prefetch(&r->complex->cells[r->facets[t + MLIM_CELLS_AHEAD].cell]);
  }
  if (t + MLIM_VERTICES_AHEAD < end)
  {
    const mlim_boundary_facet* facet = &r->facets[t + MLIM_VERTICES_AHEAD];
    mlim_ahead_of_vertices(r->complex, facet->cell, facet->index, 0);
    mlim_ahead_of_neighbor(r->complex, facet->cell, facet->index);
  }
}

static void triangle_body(void* data, size_t begin, size_t end)
{
  const reader* r = (const reader*)data;
  for (size_t t = begin; t < end; ++t)
  {
    ask_ahead(r, t, end);
    read_triangle(r, t);
    r->volumes[t] = cone_volume(r->complex, r->mesh->triangles + 3 * t);
  }
}

/* Numbers the vertices in the order in which the triangles name them. */
static void number_vertices(reader* r)
{
  mlim_mesh* mesh = r->mesh;
  for (size_t k = 0; k < 3 * mesh->triangle_count; ++k)
  {
    int32_t* number = &r->vertex_of[mesh->triangles[k]];
    if (*number < 0)
    {
      *number = (int32_t)mesh->vertex_count++;
    }
    mesh->triangles[k] = *number;
  }
}

static void vertex_body(void* data, size_t begin, size_t end)
{
  const reader* r = (const reader*)data;
  for (size_t v = begin; v < end; ++v)
  {
    if (r->vertex_of[v] >= 0)
    {
      const mlim_vertex* vertex = &r->complex->vertices[v];
      const size_t at = (size_t)r->vertex_of[v];
      r->mesh->node_types[at] = mlim_mesh_node_type(r->complex, vertex, &r->mesh->label_counts[at]);
      mlim_copy(vertex->point, r->mesh->vertices + 3 * at);
    }
  }
}

static void read_junctions(reader* r, const int32_t* vertex_of_ball, int32_t kind)
{
  const mlim_balls* balls = r->complex->balls;
  mlim_mesh* mesh = r->mesh;
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    const int32_t vertex = r->vertex_of[vertex_of_ball[b]];
    if (balls->ball_curves[b] == kind && vertex >= 0)
    {
      mesh->junctions[mesh->junction_count++] = vertex;
    }
  }
}

/* Balls that no triangle has leave no trace: the mesh has no unused vertex. */
static void read_curves(reader* r, const int32_t* vertex_of_ball)
{
  const mlim_balls* balls = r->complex->balls;
  mlim_mesh* mesh = r->mesh;
  for (size_t e = 0; e < balls->edge_count; ++e)
  {
    const int32_t a = r->vertex_of[vertex_of_ball[balls->edges[2 * e]]];
    const int32_t b = r->vertex_of[vertex_of_ball[balls->edges[2 * e + 1]]];
    if (a >= 0 && b >= 0)
    {
      mesh->edges[2 * mesh->edge_count] = a;
      mesh->edges[2 * mesh->edge_count + 1] = b;
      mesh->edge_curves[mesh->edge_count++] = balls->edge_curves[e];
    }
  }
  read_junctions(r, vertex_of_ball, MLIM_JUNCTION);
  const size_t junctions = mesh->junction_count;
  read_junctions(r, vertex_of_ball, MLIM_CONTACT);
  mesh->contact_count = mesh->junction_count - junctions;
}

int32_t mlim_mesh_node_type(
  const mlim_complex* complex, const mlim_vertex* vertex, int32_t* label_count)
{
  const mlim_field* field = complex->oracle.field;
  int32_t type = MLIM_NODE_INTERFACE;
  int32_t count = 2;
  int is_on_box = vertex->sheet.face >= 0;
  if (vertex->kind == MLIM_VERTEX_BALL)
  {
    const mlim_balls* balls = complex->balls;
    const int32_t set = balls->ball_sets[vertex->ball];
    int has_outside = 0;
    count = 0;
    is_on_box = 0;
    for (size_t k = balls->sets.offsets[set]; k < balls->sets.offsets[set + 1]; ++k)
    {
      const int32_t code = balls->sets.labels[k];
      const int is_face = code >= mlim_field_label_count(field);
      is_on_box |= is_face;
      has_outside |= is_face || code == mlim_field_outside_label(field);
      count += !is_face && code != mlim_field_outside_label(field);
    }
    count += has_outside;
    type = balls->ball_curves[vertex->ball] < 0 ? MLIM_NODE_JUNCTION : MLIM_NODE_CURVE;
  }
  *label_count = count;
  return type + (is_on_box ? MLIM_NODE_ON_BOX : 0);
}

/* One after the other, whoever measured them: sums depend on their order. */
static void add_volumes(const reader* r)
{
  mlim_mesh* mesh = r->mesh;
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    mesh->volumes[mesh->triangle_labels[2 * t]] += r->volumes[t];
    mesh->volumes[mesh->triangle_labels[2 * t + 1]] -= r->volumes[t];
  }
  mesh->volumes[mlim_field_outside_label(r->complex->oracle.field)] = 0;
}

static mlim_status allocate_mesh(
  const mlim_complex* complex, mlim_context* context, size_t triangles, mlim_mesh* out)
{
  const size_t vertices = complex->vertex_count;
  const mlim_balls* balls = complex->balls;
  out->label_count = (size_t)mlim_field_label_count(complex->oracle.field);
  out->vertices = mlim_allocate(3 * vertices, sizeof *out->vertices);
  out->node_types = mlim_allocate(vertices, sizeof *out->node_types);
  out->label_counts = mlim_allocate(vertices, sizeof *out->label_counts);
  out->triangles = mlim_allocate(3 * triangles, sizeof *out->triangles);
  out->triangle_labels = mlim_allocate(2 * triangles, sizeof *out->triangle_labels);
  out->triangle_faces = mlim_allocate(triangles, sizeof *out->triangle_faces);
  out->triangle_patches = mlim_allocate(triangles, sizeof *out->triangle_patches);
  out->edges = mlim_allocate(2 * balls->edge_count, sizeof *out->edges);
  out->edge_curves = mlim_allocate(balls->edge_count, sizeof *out->edge_curves);
  out->junctions = mlim_allocate(balls->ball_count, sizeof *out->junctions);
  out->volumes = mlim_allocate_zeroed(out->label_count, sizeof *out->volumes);
  if (out->vertices == NULL || out->node_types == NULL || out->label_counts == NULL ||
      out->triangles == NULL || out->triangle_labels == NULL || out->triangle_faces == NULL ||
      out->triangle_patches == NULL || out->edges == NULL || out->edge_curves == NULL ||
      out->junctions == NULL || out->volumes == NULL)
  {
    return mlim_fail_memory(context, "the mesh");
  }
  return MLIM_OK;
}

static void find_balls(const reader* r)
{
  const mlim_complex* complex = r->complex;
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    r->vertex_of[v] = -1;
    if (complex->vertices[v].ball >= 0)
    {
      r->vertex_of_ball[complex->vertices[v].ball] = (int32_t)v;
    }
  }
}

static mlim_status read_all(reader* r)
{
  mlim_status status = run(r, triangle_body, r->mesh->triangle_count);
  if (status != MLIM_OK)
  {
    return status;
  }
  find_balls(r);
  number_vertices(r);
  add_volumes(r);
  status = run(r, vertex_body, r->complex->vertex_count);
  if (status == MLIM_OK)
  {
    read_curves(r, r->vertex_of_ball);
  }
  return status;
}

mlim_status mlim_mesh_read(const mlim_complex* complex, const mlim_boundary* boundary, double done,
  mlim_context* context, int32_t* vertex_of, mlim_mesh* out)
{
  *out = (mlim_mesh){ 0 };
  const size_t count = mlim_boundary_count(boundary);
  reader r = { .complex = complex,
    .context = context,
    .done = done,
    .mesh = out,
    .facets = mlim_allocate(count, sizeof *r.facets),
    .vertex_of = vertex_of,
    .vertex_of_ball = mlim_allocate(complex->balls->ball_count, sizeof *r.vertex_of_ball),
    .volumes = mlim_allocate(count, sizeof *r.volumes) };
  mlim_status status = r.facets != NULL && r.vertex_of_ball != NULL && r.volumes != NULL
                         ? allocate_mesh(complex, context, count, out)
                         : mlim_fail_memory(context, "the mesh");
  if (status == MLIM_OK)
  {
    out->triangle_count = count;
    mlim_boundary_list(boundary, r.facets);
    status = read_all(&r);
  }
  mlim_release(r.facets);
  mlim_release(r.vertex_of_ball);
  mlim_release(r.volumes);
  if (status != MLIM_OK)
  {
    mlim_mesh_free(out);
  }
  return status;
}

mlim_status mlim_mesh_list_failures(
  const mlim_complex* complex, mlim_context* context, mlim_mesh* mesh)
{
  const size_t count = mlim_complex_count_broken(complex);
  mesh->disk_failures = mlim_allocate(3 * count, sizeof *mesh->disk_failures);
  mesh->disk_failure_types = mlim_allocate(count, sizeof *mesh->disk_failure_types);
  if (mesh->disk_failures == NULL || mesh->disk_failure_types == NULL)
  {
    return mlim_fail_memory(context, "the mesh");
  }
  size_t at = 0;
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
  {
    const mlim_vertex* vertex = &complex->vertices[v];
    int32_t label_count;
    if (vertex->is_broken)
    {
      mlim_copy(vertex->point, mesh->disk_failures + 3 * at);
      mesh->disk_failure_types[at++] = mlim_mesh_node_type(complex, vertex, &label_count);
    }
  }
  mesh->certificate.disk_failure_count = count;
  return MLIM_OK;
}

void mlim_mesh_free(mlim_mesh* mesh)
{
  mlim_release(mesh->vertices);
  mlim_release(mesh->node_types);
  mlim_release(mesh->label_counts);
  mlim_release(mesh->triangles);
  mlim_release(mesh->triangle_labels);
  mlim_release(mesh->triangle_faces);
  mlim_release(mesh->triangle_patches);
  mlim_release(mesh->edges);
  mlim_release(mesh->edge_curves);
  mlim_release(mesh->junctions);
  mlim_release(mesh->volumes);
  mlim_release(mesh->disk_failures);
  mlim_release(mesh->disk_failure_types);
  *mesh = (mlim_mesh){ 0 };
}
