/* Contacts that enter a complex in place: afterwards it is as if made with them, and known as well. */
#include "audit.h"
#include "refine_contacts.h"
#include "seeds.h"
#include "shapes.h"
#include "spots.h"
#include "vector.h"

#include <stdlib.h>

static const int32_t DIMS[3] = { 24, 15, 15 };
static const double SPACING[3] = { 1, 1, 1 };

/* Two spheres whose film is thinner than two vertices may be apart, over a disc of several spacings. */
static double near_spheres(const double at[3], int label)
{
  const double u[3] = { 0.96, 0.24, 0.144 };
  const double side = label == 1 ? -0.5 : 0.5;
  double squared = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double center = (k == 0 ? 11.5 : 7.3) + side * 10.01 * u[k];
    squared += (at[k] - center) * (at[k] - center);
  }
  return label == 0 ? 0 : 5 - sqrt(squared);
}

typedef struct scene
{
  image* im;
  run r;
  mlim_oracle oracle;
  mlim_components components;
  mlim_refinement refinement;
} scene;

/* The topology refined, as far as it goes without contacts. */
static void scene_start(scene* s)
{
  s->im = image_sample(DIMS, SPACING, 3, 0, near_spheres);
  const mlim_options options = run_options(0);
  CHECK(run_cover(&s->im->grid, &options, NULL, &s->r) == MLIM_OK);
  s->oracle = (mlim_oracle){ .field = s->r.field,
    .tolerance = s->r.options.crossing_tolerance,
    .mode = s->r.options.oracle_mode };
  size_t count;
  unsigned char* is_hidden = calloc(s->r.balls.ball_count + 1, 1);
  CHECK(mlim_components_find(s->r.field, NULL, &s->components) == MLIM_OK);
  CHECK(mlim_refine_start(&s->refinement, &s->oracle, &s->r.balls, &s->r.options, 0, NULL,
          is_hidden, &count) == MLIM_OK);
  CHECK_COUNT(count, 0);
  free(is_hidden);
  mlim_complex* complex = &s->refinement.complex;
  CHECK(mlim_seeds_on_components(complex, &s->components, NULL, 1, NULL, &count) == MLIM_OK);
  CHECK(mlim_seeds_on_sheets(complex, 2 * s->r.options.facet_size, 0, NULL, &count) == MLIM_OK);
  CHECK(mlim_refine_run(&s->refinement, MLIM_GOAL_TOPOLOGY, NULL) == MLIM_OK);
}

static void scene_free(scene* s)
{
  mlim_refine_free(&s->refinement);
  mlim_components_free(&s->components);
  run_free(&s->r);
  image_free(s->im);
}

/* ---- the audit ---- */

/* Facets whose dual crosses a sheet without a record, or that have a record which is not theirs. */
static size_t count_wrong_facets(const mlim_complex* complex)
{
  size_t wrong = 0;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    if (cell->vertices[0] < 0)
    {
      continue;
    }
    wrong += cell->label !=
             mlim_field_label(complex->oracle.field, mlim_complex_center(complex, (int32_t)c));
    for (int k = 0; k < 4; ++k)
    {
      const int32_t n = cell->neighbors[k];
      const int32_t record = cell->facets[k];
      if (n == MLIM_NO_CELL)
      {
        wrong += record != 0;
        continue;
      }
      const mlim_cell* other = &complex->cells[n];
      wrong += other->facets[mlim_complex_index_apart(other, cell)] != record;
      mlim_dual dual = { .labels = { cell->label, other->label }, .is_open = 1 };
      mlim_copy(mlim_complex_center(complex, (int32_t)c), dual.ends[0]);
      mlim_copy(mlim_complex_center(complex, n), dual.ends[1]);
      mlim_complex_facet_vertices(complex, (int32_t)c, k, dual.vertices);
      mlim_duals_cross(&complex->oracle, complex->vertices, &dual, 1);
      wrong += record == 0 && dual.crosses;
      if (record > 0)
      {
        const mlim_facet* facet = &complex->facets[record];
        const int is_here = facet->cell == (int32_t)c && facet->index == k;
        const int is_there =
          facet->cell == n && complex->cells[n].neighbors[facet->index] == (int32_t)c;
        wrong += !facet->is_alive || !(is_here || is_there);
      }
    }
  }
  return wrong;
}

static size_t count_living_records(const mlim_complex* complex)
{
  size_t count = 0;
  for (size_t f = 1; f < complex->facet_count; ++f)
  {
    count += complex->facets[f].is_alive;
  }
  return count;
}

/* Records of cells, each counted once. */
static size_t count_held_records(const mlim_complex* complex)
{
  size_t count = 0;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    for (int k = 0; k < 4 && cell->vertices[0] >= 0; ++k)
    {
      count += cell->facets[k] > 0;
    }
  }
  return count / 2;
}

/* Every vertex is in its cell, every ball has one vertex where it is, and no other vertex is inside a ball. */
static void check_vertices(const mlim_complex* complex)
{
  const mlim_balls* balls = complex->balls;
  unsigned char* has_vertex = calloc(balls->ball_count + 1, 1);
  size_t wrong = 0;
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
  {
    const mlim_vertex* vertex = &complex->vertices[v];
    const int32_t* in = complex->cells[vertex->cell].vertices;
    wrong +=
      in[0] != (int32_t)v && in[1] != (int32_t)v && in[2] != (int32_t)v && in[3] != (int32_t)v;
    if (vertex->kind == MLIM_VERTEX_BALL)
    {
      wrong += has_vertex[vertex->ball] != 0 ||
               mlim_distance(vertex->point, balls->centers + 3 * (size_t)vertex->ball) > 0;
      has_vertex[vertex->ball] = 1;
      continue;
    }
    for (size_t b = 0; b < balls->ball_count; ++b)
    {
      wrong += mlim_distance(vertex->point, balls->centers + 3 * b) <= balls->radii[b];
    }
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    wrong += !has_vertex[b];
  }
  CHECK_COUNT(wrong, 0);
  free(has_vertex);
}

static void check_complex(const mlim_complex* complex)
{
  CHECK_COUNT(count_wrong_facets(complex), 0);
  CHECK_COUNT(count_living_records(complex), count_held_records(complex));
  check_vertices(complex);
}

/* ---- removal ---- */

static uint64_t state = 3;

static uint64_t below(uint64_t limit)
{
  state = state * 6364136223846793005u + 1442695040888963407u;
  return (state >> 33) % limit;
}

/* Without one in so many of the surface vertices duals are longer, and some cross the film, which is then between
   two cells of one label. */
static void test_removal(void)
{
  scene s;
  scene_start(&s);
  mlim_complex* complex = &s.refinement.complex;
  for (uint64_t parts = 12; parts > 1; --parts)
  {
    unsigned char* is_marked = calloc(complex->vertex_count, 1);
    size_t left = complex->vertex_count;
    for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
    {
      is_marked[v] = complex->vertices[v].kind == MLIM_VERTEX_SURFACE && below(parts) == 0;
      left -= is_marked[v];
    }
    CHECK(mlim_complex_remove(complex, is_marked, 0, NULL) == MLIM_OK);
    CHECK_COUNT(complex->vertex_count, left);
    CHECK(mlim_refine_update(&s.refinement, NULL) == MLIM_OK);
    check_complex(complex);
    CHECK(mlim_refine_run(&s.refinement, MLIM_GOAL_TOPOLOGY, NULL) == MLIM_OK);
    check_complex(complex);
    free(is_marked);
  }
  scene_free(&s);
}

/* ---- entering ---- */

/* Puts in the contacts that are wanted. Returns how many; the caller frees the balls. */
static size_t enter(scene* s, mlim_balls* balls)
{
  mlim_refinement* r = &s->refinement;
  size_t count;
  size_t hidden;
  CHECK(mlim_spots_cover(r, r->complex.balls, NULL, balls, &count) == MLIM_OK);
  if (count > 0)
  {
    unsigned char* is_hidden = calloc(balls->ball_count, 1);
    r->complex.balls = balls;
    CHECK(mlim_contacts_enter(r, NULL, is_hidden, &hidden) == MLIM_OK);
    CHECK_COUNT(hidden, 0);
    free(is_hidden);
  }
  return count;
}

static void test_entry(void)
{
  scene s;
  scene_start(&s);
  const mlim_complex* complex = &s.refinement.complex;
  check_complex(complex);
  const size_t before = complex->vertex_count;
  mlim_balls first;
  mlim_balls second = { 0 };
  CHECK(enter(&s, &first) > 0);
  CHECK(complex->vertex_count < before);
  CHECK(complex->vertex_count > before / 4);
  check_complex(complex);
  CHECK(mlim_refine_run(&s.refinement, MLIM_GOAL_TOPOLOGY, NULL) == MLIM_OK);
  check_complex(complex);
  enter(&s, &second);
  check_complex(complex);
  CHECK(mlim_refine_run(&s.refinement, MLIM_GOAL_QUALITY, NULL) == MLIM_OK);
  check_complex(complex);
  scene_free(&s);
  mlim_balls_free(&first);
  mlim_balls_free(&second);
}

/* ---- the whole ---- */

/* One item a range, the last one first. */
static void backwards(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  for (size_t k = count; k > 0; --k)
  {
    body(job, k - 1, k);
  }
}

/* The mesh round contacts is sound, and does not depend on the order of parallel work. */
static void test_mesh(void)
{
  image* im = image_sample(DIMS, SPACING, 3, 0, near_spheres);
  const mlim_options options = run_options(0);
  mlim_context context = { .parallel_for = backwards };
  run first;
  run second;
  CHECK(run_grid(&im->grid, &options, NULL, &first) == MLIM_OK);
  CHECK(run_grid(&im->grid, &options, &context, &second) == MLIM_OK);
  const mlim_mesh* a = &first.mesh;
  const mlim_mesh* b = &second.mesh;
  CHECK(a->contact_count > 0);
  CHECK_COUNT(a->certificate.disk_failure_count, 0);
  CHECK_COUNT(a->certificate.lost_component_count, 0);
  audit_partition(first.field, a);
  CHECK_COUNT(a->vertex_count, b->vertex_count);
  CHECK_COUNT(a->triangle_count, b->triangle_count);
  if (a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count)
  {
    CHECK(memcmp(a->vertices, b->vertices, 3 * a->vertex_count * sizeof *a->vertices) == 0);
    CHECK(memcmp(a->triangles, b->triangles, 3 * a->triangle_count * sizeof *a->triangles) == 0);
  }
  run_free(&first);
  run_free(&second);
  image_free(im);
}

/* Stopped at the limit while contacts enter, or at any other time, what is there is still a mesh. */
static void test_limit(void)
{
  image* im = image_sample(DIMS, SPACING, 3, 0, near_spheres);
  mlim_options options = run_options(0);
  for (size_t limit = 10; limit < 400; limit += 13)
  {
    run r;
    options.vertex_limit = limit;
    const mlim_status status = run_grid(&im->grid, &options, NULL, &r);
    CHECK(status == MLIM_OK || status == MLIM_VERTEX_LIMIT);
    CHECK(r.mesh.vertex_count <= limit);
    audit_partition(r.field, &r.mesh);
    run_free(&r);
  }
  image_free(im);
}

int main(void)
{
  test_removal();
  test_entry();
  test_mesh();
  test_limit();
  return check_result();
}
