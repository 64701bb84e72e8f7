/* Edges, patches, figures and closedness of meshes made by hand, broken ones too. */
#include "check.h"
#include "memory.h"
#include "quality.h"

#include <string.h>

enum
{
  MAX_TRIANGLES = 16
};

typedef struct hand_mesh
{
  mlim_mesh mesh;
  double vertices[3 * 12];
  int32_t node_types[12];
  int32_t triangles[3 * MAX_TRIANGLES];
  int32_t labels[2 * MAX_TRIANGLES];
  int32_t faces[MAX_TRIANGLES];
  int32_t patches[MAX_TRIANGLES];
} hand_mesh;

static void clear(hand_mesh* h)
{
  memset(h, 0, sizeof *h);
  h->mesh = (mlim_mesh){ .vertices = h->vertices,
    .node_types = h->node_types,
    .triangles = h->triangles,
    .triangle_labels = h->labels,
    .triangle_faces = h->faces,
    .triangle_patches = h->patches,
    .label_count = 3 };
}

static int32_t add_vertex(hand_mesh* h, double x, double y, double z)
{
  const size_t v = h->mesh.vertex_count++;
  h->vertices[3 * v] = x;
  h->vertices[3 * v + 1] = y;
  h->vertices[3 * v + 2] = z;
  h->node_types[v] = MLIM_NODE_INTERFACE;
  return (int32_t)v;
}

static void add_triangle(hand_mesh* h, int32_t a, int32_t b, int32_t c, int32_t from, int32_t to)
{
  const size_t t = h->mesh.triangle_count++;
  h->triangles[3 * t] = a;
  h->triangles[3 * t + 1] = b;
  h->triangles[3 * t + 2] = c;
  h->labels[2 * t] = from;
  h->labels[2 * t + 1] = to;
  h->faces[t] = -1;
}

/* A regular one with edges of length sqrt(8). */
static void make_tetrahedron(hand_mesh* h)
{
  clear(h);
  add_vertex(h, 1, 1, 1);
  add_vertex(h, 1, -1, -1);
  add_vertex(h, -1, 1, -1);
  add_vertex(h, -1, -1, 1);
  add_triangle(h, 0, 1, 2, 1, 0);
  add_triangle(h, 0, 2, 3, 1, 0);
  add_triangle(h, 0, 3, 1, 1, 0);
  add_triangle(h, 1, 3, 2, 1, 0);
}

/* The unit cube, 12 triangles; its faces are numbered as those of the box. */
static void make_cube(hand_mesh* h)
{
  clear(h);
  for (int k = 0; k < 8; ++k)
  {
    add_vertex(h, k & 1, k >> 1 & 1, k >> 2 & 1);
  }
  const int32_t quads[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 },
    { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };
  for (int face = 0; face < 6; ++face)
  {
    const int32_t* q = quads[face];
    add_triangle(h, q[0], q[1], q[2], 1, 0);
    add_triangle(h, q[0], q[2], q[3], 1, 0);
    h->faces[2 * face] = h->faces[2 * face + 1] = face;
  }
}

/* Two tetrahedra of labels 1 and 2 that share a triangle. */
static void make_pair(hand_mesh* h)
{
  clear(h);
  add_vertex(h, 0, 0, 0);
  add_vertex(h, 2, 0, 0);
  add_vertex(h, 0, 2, 0);
  add_vertex(h, 0, 0, 2);
  add_vertex(h, 0, 0, -2);
  add_triangle(h, 0, 2, 1, 1, 2); /* the normal points down, from 1 above to 2 below */
  add_triangle(h, 0, 1, 3, 1, 0);
  add_triangle(h, 1, 2, 3, 1, 0);
  add_triangle(h, 2, 0, 3, 1, 0);
  add_triangle(h, 1, 0, 4, 2, 0);
  add_triangle(h, 2, 1, 4, 2, 0);
  add_triangle(h, 0, 2, 4, 2, 0);
  for (int v = 0; v < 3; ++v)
  {
    h->node_types[v] = MLIM_NODE_CURVE;
  }
}

static size_t open_edges(hand_mesh* h)
{
  mlim_edges edges;
  CHECK(mlim_edges_create(&h->mesh, 0, NULL, &edges) == MLIM_OK);
  size_t count = 0;
  CHECK(mlim_quality_count_open_edges(&h->mesh, &edges, 0, NULL, &count) == MLIM_OK);
  mlim_edges_free(&edges);
  return count;
}

static void measure(hand_mesh* h)
{
  mlim_edges edges;
  CHECK(mlim_edges_create(&h->mesh, 0, NULL, &edges) == MLIM_OK);
  CHECK(mlim_quality_find_patches(&h->mesh, &edges, NULL) == MLIM_OK);
  CHECK(mlim_quality_settle_edges(&h->mesh, &edges, NULL) == MLIM_OK);
  CHECK(mlim_quality_measure(&h->mesh, &edges, 1, 0, NULL) == MLIM_OK);
  mlim_edges_free(&edges);
  mlim_release(h->mesh.edges);
  mlim_release(h->mesh.edge_curves);
  h->mesh.edges = h->mesh.edge_curves = NULL;
  h->mesh.edge_count = 0;
}

/* Every use is there once, under its lower vertex, in order, with the right sign and apex. */
static void test_edges(void)
{
  hand_mesh h;
  make_cube(&h);
  mlim_edges edges;
  CHECK(mlim_edges_create(&h.mesh, 0, NULL, &edges) == MLIM_OK);
  CHECK_COUNT(edges.use_count, 36);
  size_t runs = 0;
  for (int32_t v = 0; v < 8; ++v)
  {
    size_t end;
    for (size_t first = edges.offsets[v]; first < edges.offsets[v + 1]; first = end, ++runs)
    {
      end = mlim_edges_run_end(&edges, v, first);
      CHECK_COUNT(end - first, 2);
      CHECK(first == edges.offsets[v] || edges.uses[first - 1].upper < edges.uses[first].upper);
      CHECK(edges.uses[first].sign + edges.uses[first + 1].sign == 0);
      CHECK(edges.uses[first].triangle < edges.uses[first + 1].triangle);
      for (size_t k = first; k < end; ++k)
      {
        const int32_t* t = h.triangles + 3 * edges.uses[k].triangle;
        CHECK(edges.uses[k].upper > v);
        CHECK(t[0] + t[1] + t[2] == v + edges.uses[k].upper + edges.uses[k].apex);
        const int at = t[0] == v ? 0 : t[1] == v ? 1 : 2;
        CHECK(t[(at + (edges.uses[k].sign > 0 ? 1 : 2)) % 3] == edges.uses[k].upper);
      }
    }
  }
  CHECK_COUNT(runs, 18);
  mlim_edges_free(&edges);
}

static void test_open(void)
{
  hand_mesh h;
  make_tetrahedron(&h);
  CHECK_COUNT(open_edges(&h), 0);
  make_cube(&h);
  CHECK_COUNT(open_edges(&h), 0);
  make_pair(&h);
  CHECK_COUNT(open_edges(&h), 0);
  clear(&h);
  CHECK_COUNT(open_edges(&h), 0);
  make_tetrahedron(&h); /* a hole */
  --h.mesh.triangle_count;
  CHECK_COUNT(open_edges(&h), 3);
  make_tetrahedron(&h); /* one triangle the wrong way round */
  h.triangles[0] = 1;
  h.triangles[1] = 0;
  CHECK_COUNT(open_edges(&h), 3);
  make_tetrahedron(&h); /* one triangle of another region */
  h.labels[0] = 2;
  CHECK_COUNT(open_edges(&h), 3);
  make_tetrahedron(&h); /* both faults in one make a good triangle again */
  h.triangles[0] = 1;
  h.triangles[1] = 0;
  h.labels[0] = 0;
  h.labels[1] = 1;
  CHECK_COUNT(open_edges(&h), 0);
  make_pair(&h); /* the wall between two regions is missing */
  h.triangles[0] = h.triangles[1] = h.triangles[2] = 0;
  memmove(h.triangles, h.triangles + 3, 18 * sizeof *h.triangles);
  memmove(h.labels, h.labels + 2, 12 * sizeof *h.labels);
  --h.mesh.triangle_count;
  CHECK_COUNT(open_edges(&h), 3);
  make_pair(&h); /* the wall's labels are exchanged */
  h.labels[0] = 2;
  h.labels[1] = 1;
  CHECK_COUNT(open_edges(&h), 3);
}

static void test_patches(void)
{
  hand_mesh h;
  make_tetrahedron(&h);
  measure(&h);
  CHECK_COUNT(h.mesh.patch_count, 1);
  make_cube(&h); /* creases part the caps */
  measure(&h);
  CHECK_COUNT(h.mesh.patch_count, 6);
  for (int t = 0; t < 12; ++t)
  {
    CHECK(h.patches[t] == t / 2);
  }
  make_pair(&h);
  measure(&h);
  CHECK_COUNT(h.mesh.patch_count, 3);
  CHECK(h.patches[0] == 0 && h.patches[1] == 1 && h.patches[3] == 1 && h.patches[6] == 2);
  clear(&h);
  measure(&h);
  CHECK_COUNT(h.mesh.patch_count, 0);
}

static void test_figures(void)
{
  hand_mesh h;
  make_tetrahedron(&h);
  measure(&h);
  CHECK_BELOW(fabs(h.mesh.report.min_angle - 60), 1e-9);
  CHECK_BELOW(fabs(h.mesh.report.max_radius_edge_ratio - 1 / sqrt(3)), 1e-12);
  CHECK_BELOW(fabs(h.mesh.report.mean_radius_edge_ratio - 1 / sqrt(3)), 1e-12);
  CHECK_BELOW(h.mesh.report.max_ball_radius_edge_ratio, 0);
  CHECK_BELOW(fabs(h.mesh.report.min_dihedral_angle - 180), 0);
  make_cube(&h); /* halves of squares: circumradius sqrt(2) / 2, shortest edge 1 */
  measure(&h);
  CHECK_BELOW(fabs(h.mesh.report.min_angle - 45), 1e-9);
  CHECK_BELOW(fabs(h.mesh.report.max_radius_edge_ratio - sqrt(0.5)), 1e-12);
  h.node_types[0] = MLIM_NODE_JUNCTION + MLIM_NODE_ON_BOX; /* in six triangles: three squares */
  h.vertices[0] = h.vertices[1] = h.vertices[2] = -3;
  measure(&h);
  CHECK_BELOW(fabs(h.mesh.report.max_radius_edge_ratio - sqrt(0.5)), 1e-12);
  CHECK(h.mesh.report.max_ball_radius_edge_ratio > 1);
  make_pair(&h); /* at (0,0,0)-(2,0,0): sheets up, down and to the side, at right angles */
  measure(&h);
  const double at_slope = 54.735610317245346; /* between z = 0 and x + y + z = 2 */
  CHECK_BELOW(fabs(h.mesh.report.min_dihedral_angle - at_slope), 1e-9);
  clear(&h);
  measure(&h);
  CHECK_BELOW(h.mesh.report.mean_radius_edge_ratio, 0);
}

int main(void)
{
  test_edges();
  test_open();
  test_patches();
  test_figures();
  return check_result();
}
