/* Partners across flat films and wedges of known thickness. */
#include "check.h"
#include "partner.h"
#include "shapes.h"
#include "vector.h"

/* The film is label 1, between 0 and 2, all functions linear. Its middle plane is askew to the grid. */
static const double NORMAL[3] = { 2. / 7, 3. / 7, 6. / 7 };
static const double SPACING[3] = { 1, 1, 1 };
static const double SMALLEST = 0.25;
/* In the middle plane: where wedges run to. */
static const double AHEAD[3] = { 3. / 7, -6. / 7, 2. / 7 };
static const double NEAR[3] = { 2.3, 2.2, 2.6 };
static double thickness;
static double slope;    /* of the upper sheet towards the lower one */
static double thinnest; /* the region gets no thinner than that */

static double height_of(const double at[3])
{
  return mlim_dot(NORMAL, at) - 4.1;
}

/* Lost thickness between the sheets, ahead of NEAR. */
static double taper_at(const double at[3])
{
  const double way = mlim_dot(AHEAD, at) - mlim_dot(AHEAD, NEAR);
  return fmin(slope * way, thickness - thinnest);
}

static double film(const double at[3], int label)
{
  const double height = height_of(at);
  const double upper = 0.5 * thickness - taper_at(at);
  return label == 0 ? -height - 0.5 * thickness : label == 1 ? 0 : height - upper;
}

/* Looks for the partners of a vertex on the film's lower sheet, all others of its zone being `room` away. */
static int find(const mlim_field* field, double room, mlim_vertex* vertex, mlim_partners* out)
{
  const mlim_options options = { .smallest_distance = SMALLEST };
  *vertex = (mlim_vertex){ .kind = MLIM_VERTEX_SURFACE, .ball = -1, .sheet = { 0, 1, -1 } };
  const double off = height_of(NEAR) + 0.5 * thickness;
  mlim_cell cell = { .vertices = { 0, 1, 2, 3 } };
  mlim_vertex around[4];
  for (int k = 0; k < 3; ++k)
  {
    vertex->point[k] = NEAR[k] - off * NORMAL[k];
  }
  for (int v = 0; v < 4; ++v)
  {
    around[v] = *vertex;
    around[v].point[v % 3] += v < 3 ? room : -room;
  }
  const int32_t id = 0;
  const mlim_complex complex = {
    .oracle = { .field = field, .tolerance = 1e-9, .mode = MLIM_ORACLE_EXACT },
    .cells = &cell,
    .vertices = around,
    .zone = { .count = 1, .cells = &id },
    .pending = *vertex
  };
  return mlim_partners_find(&complex, &options, vertex, out);
}

static void check_film(double thick, double room, int is_possible, size_t count)
{
  const int32_t dims[3] = { 6, 6, 6 };
  thickness = thick;
  thinnest = fmin(thinnest, thick);
  image* im = image_sample(dims, SPACING, 3, -1, film);
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&im->grid, NULL, &field) == MLIM_OK);
  mlim_vertex vertex;
  mlim_partners partners;
  CHECK_COUNT((size_t)find(field, room, &vertex, &partners), (size_t)is_possible);
  if (is_possible)
  {
    CHECK_COUNT(partners.count, count);
  }
  for (size_t k = 0; is_possible && k < partners.count; ++k)
  {
    /* Straight across, on the sheet between 1 and 2. */
    CHECK(partners.vertices[k].sheet.low == 1 && partners.vertices[k].sheet.high == 2);
    CHECK(partners.vertices[k].sheet.face == -1);
    CHECK_BELOW(fabs(height_of(partners.vertices[k].point) - 0.5 * thick), 1e-6);
    CHECK_BELOW(fabs(mlim_distance(partners.vertices[k].point, vertex.point) - thick), 1e-6);
  }
  mlim_field_free(field);
  image_free(im);
}

/* As flat as a wedge may be, and a film not. */
static void check_taper(double tangent, double least, size_t count)
{
  const double unit = SMALLEST;
  slope = tangent;
  thinnest = least;
  check_film(0.5 * unit, 3 * unit, 1, count);
}

static void test_wedges(void)
{
  const double unit = SMALLEST;
  check_taper(tan(0.07), -10, 1);
  check_taper(tan(0.14), -10, 1);
  check_taper(-tan(0.07), -10, 1);        /* the edge is on the other side */
  check_taper(tan(0.07), 0.25 * unit, 0); /* a film that is thinner there, and goes on */
  check_taper(tan(0.3), -10, 0);          /* too steep to need it */
}

int main(void)
{
  const double unit = SMALLEST;
  check_film(0.02 * unit, 0, 0, 0); /* too thin for any vertex */
  check_film(0.04 * unit, 0.1 * unit, 1, 1);
  check_film(unit, 3.8 * unit, 1, 1);
  check_film(0.5 * unit, 1.9 * unit, 1, 1);
  check_film(0.5 * unit, 3 * unit, 1, 0); /* a pair would be too flat for the room round it */
  check_film(1.3 * unit, unit, 1, 1);
  check_film(1.5 * unit, unit, 1, 0); /* thick enough without */
  test_wedges();
  slope = tan(0.07);
  thinnest = -10;
  check_film(0.5 * unit, 5 * unit, 1, 0); /* for a wedge too */
  return check_result();
}
