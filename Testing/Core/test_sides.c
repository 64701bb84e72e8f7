/* Facets on a flat film of known thickness: wide from half their circumradius on. */
#include "check.h"
#include "shapes.h"
#include "sides.h"

#include "vector.h"

/* The film is label 1, between 0 and 2, all functions linear. It is askew to the grid. */
static const double NORMAL[3] = { 2. / 7, 3. / 7, 6. / 7 };
static const double ALONG[3] = { 3. / 7, -6. / 7, 2. / 7 };
static const double ASIDE[3] = { 6. / 7, 2. / 7, -3. / 7 };
static const double MIDDLE[3] = { 2.3, 2.2, 2.6 }; /* of the film */
static double thickness;

static double film(const double at[3], int label)
{
  const double height = mlim_dot(NORMAL, at) - mlim_dot(NORMAL, MIDDLE);
  return label == 0 ? -height - 0.5 * thickness : label == 1 ? 0 : height - 0.5 * thickness;
}

/* A facet of a sheet at a height of the film, equilateral, its dual crossing at its circumcentre. */
typedef struct flat_facet
{
  mlim_cell cells[2]; /* below and above */
  mlim_vertex vertices[4];
  mlim_facet facet;
} flat_facet;

static flat_facet make_facet(double height, double radius, int32_t below)
{
  flat_facet out = { .cells = { { .vertices = { 0, 1, 2, 3 }, .label = below },
                       { .vertices = { 0, 1, 3, 2 }, .label = below + 1 } },
    .facet = { .sheet = { below, below + 1, -1 }, .cell = 0, .index = 0, .is_alive = 1 } };
  out.cells[0].neighbors[0] = 1;
  for (int k = 0; k < 3; ++k)
  {
    out.facet.crossing[k] = MIDDLE[k] + height * NORMAL[k];
  }
  for (int v = 0; v < 4; ++v)
  {
    const double angle = 2 * v * acos(-1.) / 3;
    out.vertices[v] = (mlim_vertex){ .kind = MLIM_VERTEX_SURFACE, .ball = -1 };
    for (int k = 0; k < 3; ++k)
    {
      /* Anticlockwise from above for 1, 2, 3. */
      const double off = cos(angle) * ALONG[k] + sin(angle) * ASIDE[k];
      out.vertices[v].point[k] = out.facet.crossing[k] + radius * off;
    }
  }
  return out;
}

static int is_wide(const mlim_field* field, flat_facet* f)
{
  const mlim_complex complex = {
    .oracle = { .field = field, .tolerance = 1e-9, .mode = MLIM_ORACLE_EXACT },
    .cells = f->cells,
    .cell_count = 2,
    .vertices = f->vertices,
    .vertex_count = 4
  };
  return mlim_sides_are_wide(&complex, &f->facet);
}

static void check_film(double thick, double radius, int expected)
{
  const int32_t dims[3] = { 6, 6, 6 };
  const double spacing[3] = { 1, 1, 1 };
  thickness = thick;
  image* im = image_sample(dims, spacing, 3, -1, film);
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&im->grid, NULL, &field) == MLIM_OK);
  /* The film is above the facets of its lower sheet, and below those of its upper one. */
  for (int32_t below = 0; below < 2; ++below)
  {
    flat_facet f = make_facet((below == 0 ? -0.5 : 0.5) * thick, radius, below);
    CHECK_COUNT((size_t)is_wide(field, &f), (size_t)expected);
    f.facet.sheet.face = 0;
    CHECK(is_wide(field, &f)); /* caps have nothing beyond them */
    f.facet.sheet.face = -1;
    f.vertices[2].weight = 0.01;
    CHECK(is_wide(field, &f)); /* beside balls cells may be flat */
  }
  mlim_field_free(field);
  image_free(im);
}

int main(void)
{
  check_film(0.26, 0.5, 1);
  check_film(0.24, 0.5, 0);
  check_film(0.13, 0.25, 1);
  check_film(0.12, 0.25, 0);
  check_film(0.02, 0.5, 0);
  check_film(1, 0.5, 1);
  return check_result();
}
