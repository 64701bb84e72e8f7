#include "mesh.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

#include <string.h>

typedef struct reader
{
  const mlim_complex* complex;
  mlim_mesh* mesh;
  int32_t* vertex_of; /* mesh vertex of each vertex of the complex, -1 */
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

static int is_boundary(const mlim_complex* complex, const mlim_cell* cell, int32_t id, int index)
{
  const int32_t other = cell->neighbors[index];
  return cell->vertices[0] >= 0 && other != MLIM_NO_CELL && id < other &&
         complex->cells[other].label != cell->label;
}

static int32_t take_vertex(reader* r, int32_t vertex)
{
  if (r->vertex_of[vertex] < 0)
  {
    r->vertex_of[vertex] = (int32_t)r->mesh->vertex_count++;
  }
  return r->vertex_of[vertex];
}

static void read_triangle(reader* r, int32_t id, int index)
{
  const mlim_complex* complex = r->complex;
  const mlim_cell* cell = &complex->cells[id];
  const int32_t other = complex->cells[cell->neighbors[index]].label;
  mlim_mesh* mesh = r->mesh;
  int32_t v[3];
  mlim_complex_facet_vertices(complex, id, index, v); /* the normal points out of the cell */
  int32_t labels[2] = { cell->label, other };
  if (!is_ordered(complex->oracle.field, cell->label, other))
  {
    labels[0] = other;
    labels[1] = cell->label;
    const int32_t swap = v[1];
    v[1] = v[2];
    v[2] = swap;
  }
  const size_t t = mesh->triangle_count++;
  for (int k = 0; k < 3; ++k)
  {
    mesh->triangles[3 * t + (size_t)k] = take_vertex(r, v[k]);
  }
  mesh->triangle_labels[2 * t] = labels[0];
  mesh->triangle_labels[2 * t + 1] = labels[1];
  mesh->triangle_faces[t] = mlim_complex_face(complex, id, index);
}

static size_t count_triangles(const mlim_complex* complex)
{
  size_t count = 0;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      count += (size_t)is_boundary(complex, &complex->cells[c], (int32_t)c, k);
    }
  }
  return count;
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

static void measure_volumes(mlim_mesh* mesh, const mlim_field* field)
{
  const int32_t outside = mlim_field_outside_label(field);
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const double* a = mesh->vertices + 3 * (size_t)mesh->triangles[3 * t];
    const double* b = mesh->vertices + 3 * (size_t)mesh->triangles[3 * t + 1];
    const double* c = mesh->vertices + 3 * (size_t)mesh->triangles[3 * t + 2];
    double n[3];
    mlim_cross(b, c, n);
    const double volume = mlim_dot(a, n) / 6;
    mesh->volumes[mesh->triangle_labels[2 * t]] += volume;
    mesh->volumes[mesh->triangle_labels[2 * t + 1]] -= volume;
  }
  mesh->volumes[outside] = 0;
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

static void read_all(reader* r, int32_t* vertex_of_ball)
{
  const mlim_complex* complex = r->complex;
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    r->vertex_of[v] = -1;
    if (complex->vertices[v].ball >= 0)
    {
      vertex_of_ball[complex->vertices[v].ball] = (int32_t)v;
    }
  }
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      if (is_boundary(complex, &complex->cells[c], (int32_t)c, k))
      {
        read_triangle(r, (int32_t)c, k);
      }
    }
  }
  read_curves(r, vertex_of_ball);
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    if (r->vertex_of[v] >= 0)
    {
      const size_t at = (size_t)r->vertex_of[v];
      r->mesh->node_types[at] =
        mlim_mesh_node_type(complex, &complex->vertices[v], &r->mesh->label_counts[at]);
      mlim_copy(complex->vertices[v].point, r->mesh->vertices + 3 * at);
    }
  }
}

mlim_status mlim_mesh_read_mapped(
  const mlim_complex* complex, mlim_context* context, int32_t* vertex_of, mlim_mesh* out)
{
  *out = (mlim_mesh){ 0 };
  mlim_status status = allocate_mesh(complex, context, count_triangles(complex), out);
  int32_t* vertex_of_ball = mlim_allocate(complex->balls->ball_count, sizeof *vertex_of_ball);
  if (status == MLIM_OK && vertex_of_ball == NULL)
  {
    status = mlim_fail_memory(context, "the mesh");
  }
  if (status == MLIM_OK)
  {
    reader r = { .complex = complex, .mesh = out, .vertex_of = vertex_of };
    read_all(&r, vertex_of_ball);
    measure_volumes(out, complex->oracle.field);
  }
  mlim_release(vertex_of_ball);
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

mlim_status mlim_mesh_read(const mlim_complex* complex, mlim_context* context, mlim_mesh* out)
{
  *out = (mlim_mesh){ 0 };
  int32_t* vertex_of = mlim_allocate(complex->vertex_count, sizeof *vertex_of);
  const mlim_status status = vertex_of != NULL
                               ? mlim_mesh_read_mapped(complex, context, vertex_of, out)
                               : mlim_fail_memory(context, "the mesh");
  mlim_release(vertex_of);
  return status;
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
