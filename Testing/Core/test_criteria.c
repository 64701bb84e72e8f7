/* Five points: a facet between two cells. Each criterion just above and just below its bound. */
#include "check.h"
#include "criteria.h"
#include "shapes.h"

/* The facet is the triangle 0 1 2 in the plane z = 0; 3 is above it, 4 below. Its circumcentre is
   (1.5, 2, 0) and its circumradius 2.5 = hypot(3, 4) / 2; the shortest edge is 3. */
static const double POINTS[5][3] = { { 0, 0, 0 }, { 3, 0, 0 }, { 0, 4, 0 }, { 1, 1, 3 },
  { 1, 1, -3 } };
/* All are moved by this: 20 below the triangle's middle lies the sphere's, 20 above nothing. */
static const double SHIFT[3] = { 8.5, 8, 30 };
static const double REACH = 20;
static const double RADIUS = 2.5;
static const double SHORTEST = 3;
static const double HEIGHT = 0.5; /* of the crossing above the circumcentre */
static const double STEP = 1e-9;  /* what "just above" and "just below" mean */

typedef struct five
{
  mlim_vertex vertices[5];
  mlim_cell cells[2];
  mlim_facet facet;
  mlim_complex complex;
  double distance_shares[2];
  mlim_balls balls;
  mlim_options options;
} five;

/* Sets of balls: the labels 0 and 1, and the label 1 with the face -x of the box. */
static size_t set_offsets[] = { 0, 2, 4 };
static int32_t set_labels[] = { 0, 1, 1, 2 };
static int32_t ball_sets[] = { 0, 1 };

static void set_up(five* f, const mlim_field* field)
{
  *f = (five){ .distance_shares = { 1, 1 },
    .options = { .facet_size = 100,
      .facet_distance = REACH,
      .facet_radius_edge_ratio = 100,
      .smallest_distance = 1e-3 },
    .balls = { .ball_count = 2,
      .ball_sets = ball_sets,
      .sets = { .count = 2, .offsets = set_offsets, .labels = set_labels } } };
  for (int v = 0; v < 5; ++v)
  {
    f->vertices[v] = (mlim_vertex){
      .ball = -1, .kind = MLIM_VERTEX_SURFACE, .sheet = { .low = 0, .high = 1, .face = -1 }
    };
    for (int k = 0; k < 3; ++k)
    {
      f->vertices[v].point[k] = POINTS[v][k] + SHIFT[k];
    }
  }
  f->cells[0] = (mlim_cell){
    .vertices = { 0, 1, 2, 3 }, .neighbors = { -1, -1, -1, 1 }, .facets = { 0, 0, 0, 1 }
  };
  f->cells[1] = (mlim_cell){
    .vertices = { 0, 2, 1, 4 }, .neighbors = { -1, -1, -1, 0 }, .facets = { 0, 0, 0, 1 }, .label = 1
  };
  f->facet = (mlim_facet){ .crossing = { 1.5 + SHIFT[0], 2 + SHIFT[1], HEIGHT + SHIFT[2] },
    .sheet = { .low = 0, .high = 1, .face = -1 },
    .cell = 0,
    .index = 3,
    .is_alive = 1 };
  f->complex = (mlim_complex){ .oracle = { .field = field },
    .balls = &f->balls,
    .vertices = f->vertices,
    .vertex_count = 5,
    .cells = f->cells,
    .cell_count = 2,
    .distance_shares = f->distance_shares };
}

static mlim_badness judge(const five* f)
{
  return mlim_criteria_judge(&f->complex, &f->options, &f->facet).badness;
}

static void put_ball(five* f, int vertex, int ball, double radius)
{
  f->vertices[vertex].kind = MLIM_VERTEX_BALL;
  f->vertices[vertex].ball = ball;
  f->vertices[vertex].weight = radius * radius;
}

static void test_measures(const mlim_field* field)
{
  const double ball_radius = sqrt(RADIUS * RADIUS + HEIGHT * HEIGHT);
  const struct
  {
    mlim_badness badness;
    double bound;
    size_t option; /* offset of the bound */
  } rows[] = {
    { MLIM_BAD_SIZE, ball_radius, offsetof(mlim_options, facet_size) },
    { MLIM_BAD_DISTANCE, HEIGHT, offsetof(mlim_options, facet_distance) },
    { MLIM_BAD_RATIO, RADIUS / SHORTEST, offsetof(mlim_options, facet_radius_edge_ratio) },
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    five f;
    set_up(&f, field);
    CHECK(judge(&f) == MLIM_BAD_NONE);
    double* option = (double*)((char*)&f.options + rows[k].option);
    *option = rows[k].bound * (1 + STEP);
    CHECK(judge(&f) == MLIM_BAD_NONE);
    *option = rows[k].bound * (1 - STEP);
    CHECK(judge(&f) == rows[k].badness);
    *option = rows[k].bound / 4;
    const mlim_verdict verdict = mlim_criteria_judge(&f.complex, &f.options, &f.facet);
    CHECK_BELOW(fabs(verdict.excess - 4), 1e-12);
    CHECK_BELOW(fabs(verdict.radius_edge_ratio - RADIUS / SHORTEST), 1e-12);
    /* A facet without extent is bad, not undecided. */
    memcpy(f.vertices[2].point, POINTS[1], sizeof POINTS[1]);
    CHECK(judge(&f) != MLIM_BAD_NONE);
  }
}

/* The distance is the height above the facet's plane, wherever the crossing is, and a label that may
   lose less has a smaller bound. */
static void test_distance(const mlim_field* field)
{
  for (int label = 0; label < 2; ++label)
  {
    five f;
    set_up(&f, field);
    f.facet.crossing[0] = 0.2 + SHIFT[0];
    f.options.facet_distance = HEIGHT * (1 + STEP);
    CHECK(judge(&f) == MLIM_BAD_NONE);
    f.distance_shares[label] = 0.5;
    CHECK(judge(&f) == MLIM_BAD_DISTANCE);
    f.options.facet_distance = 2 * HEIGHT * (1 + STEP);
    CHECK(judge(&f) == MLIM_BAD_NONE);
    f.options.facet_distance = 2 * HEIGHT * (1 - STEP);
    CHECK(judge(&f) == MLIM_BAD_DISTANCE);
  }
}

/* Size before distance before shape; topology before all of them. */
static void test_order(const mlim_field* field)
{
  five f;
  set_up(&f, field);
  f.options.facet_radius_edge_ratio = 0.7;
  CHECK(judge(&f) == MLIM_BAD_RATIO);
  f.options.facet_distance = 0.1;
  CHECK(judge(&f) == MLIM_BAD_DISTANCE);
  f.options.facet_size = 0.1;
  CHECK(judge(&f) == MLIM_BAD_SIZE);
  f.vertices[1].sheet.high = 2;
  CHECK(judge(&f) == MLIM_BAD_SHEET);
  f.facet.is_multiple = 1;
  CHECK(judge(&f) == MLIM_BAD_CROSSINGS);
  f.vertices[2].kind = MLIM_VERTEX_FAR;
  CHECK(judge(&f) == MLIM_BAD_FAR);
  CHECK(!(mlim_criteria_judge(&f.complex, &f.options, &f.facet).excess < 1));
}

/* Whether a vertex is on the facet's sheet: each kind of vertex, each part of the sheet's name. */
static void test_sheets(const mlim_field* field)
{
  five f;
  set_up(&f, field);
  f.vertices[0].sheet.face = 1;
  CHECK(judge(&f) == MLIM_BAD_SHEET);
  set_up(&f, field);
  put_ball(&f, 0, 0, 0.5);
  CHECK(judge(&f) == MLIM_BAD_NONE);
  CHECK(mlim_criteria_judge(&f.complex, &f.options, &f.facet).has_ball);
  put_ball(&f, 0, 1, 0.5); /* the crease of label 1 on a face does not name label 0 */
  CHECK(judge(&f) == MLIM_BAD_SHEET);
  for (int v = 0; v < 3; ++v)
  {
    f.vertices[v].sheet.face = 0;
  }
  f.facet.sheet.face = 0; /* on that face the outside's label 0 is the other side */
  CHECK(judge(&f) == MLIM_BAD_NONE);
  f.facet.sheet.face = 1;
  CHECK(judge(&f) == MLIM_BAD_SHEET);
}

/* Beside a ball the sheet has to pass near the triangle's middle, not only through its crossing. */
static void test_off_sheet(const mlim_field* field)
{
  five f;
  set_up(&f, field);
  f.options.facet_distance = 1; /* 1 below and 1 above the middle there is nothing but label 0 */
  CHECK(judge(&f) == MLIM_BAD_NONE);
  put_ball(&f, 0, 0, 0.5);
  CHECK(judge(&f) == MLIM_BAD_DISTANCE);
  f.options.facet_distance = REACH;
  CHECK(judge(&f) == MLIM_BAD_NONE);
}

static int may_insert(const five* f, mlim_badness badness)
{
  return mlim_criteria_may_insert(&f->complex, &f->options, &f->facet, badness);
}

static void test_floor(const mlim_field* field)
{
  five f;
  set_up(&f, field);
  const double nearest = sqrt(RADIUS * RADIUS + HEIGHT * HEIGHT);
  for (mlim_badness b = MLIM_BAD_CROSSINGS; b < MLIM_BAD_NONE; ++b)
  {
    f.options.smallest_distance = nearest * (1 - STEP);
    CHECK(may_insert(&f, b));
    f.options.smallest_distance = nearest * (1 + STEP);
    CHECK(!may_insert(&f, b));
  }
}

/* The power distance to a ball, d^2 - r^2, against the ball's own r^2: a quarter of it will do for
   topology and distance, all of it for size. The other two vertices are equally far in power. */
static void test_guards(const mlim_field* field)
{
  const struct
  {
    mlim_badness badness;
    double guard;
  } rows[] = { { MLIM_BAD_CROSSINGS, 0.25 }, { MLIM_BAD_SHEET, 0.25 }, { MLIM_BAD_DISK, 0.25 },
    { MLIM_BAD_SIZE, 1 }, { MLIM_BAD_DISTANCE, 0.25 } };
  const double d_squared = RADIUS * RADIUS + HEIGHT * HEIGHT;
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    const double bound = sqrt(d_squared / (1 + rows[k].guard));
    for (int side = -1; side <= 1; side += 2)
    {
      five f;
      set_up(&f, field);
      for (int v = 0; v < 3; ++v)
      {
        put_ball(&f, v, 0, bound * (1 + side * STEP));
      }
      CHECK(may_insert(&f, rows[k].badness) == (side < 0));
    }
  }
}

/* Near a ball shape alone does not make an edge shorter than the facet has; elsewhere it may. */
static void test_shape_near_ball(const mlim_field* field)
{
  five f;
  set_up(&f, field);
  CHECK(may_insert(&f, MLIM_BAD_RATIO)); /* 6.5 from the vertices squared, shortest edge 9 */
  for (int v = 0; v < 3; ++v)
  {
    put_ball(&f, v, 0, 0.1);
  }
  CHECK(may_insert(&f, MLIM_BAD_SIZE));
  CHECK(!may_insert(&f, MLIM_BAD_RATIO));
  f.facet.crossing[2] = 2 + SHIFT[2]; /* 10.25 squared */
  CHECK(may_insert(&f, MLIM_BAD_RATIO));
}

int main(void)
{
  /* Two labels; label 0 is the background. */
  const shape s = shape_of(SHAPE_SPHERE);
  image* im = shape_sample(&s);
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&im->grid, NULL, &field) == MLIM_OK);
  test_measures(field);
  test_distance(field);
  test_order(field);
  test_sheets(field);
  test_off_sheet(field);
  test_floor(field);
  test_guards(field);
  test_shape_near_ball(field);
  mlim_field_free(field);
  image_free(im);
  return check_result();
}
