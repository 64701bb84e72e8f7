/* The disk condition at the middle of eight cells, for every kind of link. */
#include "check.h"
#include "disk.h"

#include <string.h>

/* The vertex 0 with its neighbours 1 .. 6 at -x +x -y +y -z +z. Cell k is the octant whose bits say
   on which side it lies; it has the vertex first, so its neighbour k + 1 is across axis k. */
typedef struct octahedron
{
  mlim_vertex vertices[7];
  mlim_cell cells[8];
  mlim_facet facets[1 + 12];
  mlim_complex complex;
  size_t link_offsets[8];
  int32_t link_neighbors[8];
  mlim_ball_links links;
  int32_t ball_curves[8];
  mlim_balls balls;
} octahedron;

static void set_up(octahedron* o, const int32_t labels[8])
{
  memset(o, 0, sizeof *o);
  for (int v = 0; v < 7; ++v)
  {
    o->vertices[v].kind = MLIM_VERTEX_SURFACE;
    o->vertices[v].ball = -1;
  }
  int32_t record = 0;
  for (int32_t c = 0; c < 8; ++c)
  {
    mlim_cell* cell = &o->cells[c];
    cell->label = labels[c];
    cell->neighbors[0] = MLIM_NO_CELL;
    for (int k = 0; k < 3; ++k)
    {
      cell->vertices[k + 1] = 1 + 2 * k + (c >> k & 1);
      cell->neighbors[k + 1] = c ^ (1 << k);
    }
  }
  for (int32_t c = 0; c < 8; ++c)
  {
    for (int k = 0; k < 3; ++k)
    {
      const int32_t other = c ^ (1 << k);
      if (c < other && labels[c] != labels[other])
      {
        o->facets[++record] = (mlim_facet){ .cell = c, .index = (unsigned char)(k + 1) };
        o->facets[record].is_alive = 1;
        o->cells[c].facets[k + 1] = o->cells[other].facets[k + 1] = record;
      }
    }
  }
  o->complex = (mlim_complex){ .vertices = o->vertices,
    .vertex_count = 7,
    .cells = o->cells,
    .cell_count = 8,
    .facets = o->facets,
    .facet_count = (size_t)record + 1 };
  o->links = (mlim_ball_links){ .offsets = o->link_offsets, .neighbors = o->link_neighbors };
}

/* Balls at the vertex and at some of its neighbours, all of them next to it on curves. */
static void put_balls(octahedron* o, const int* vertices, size_t count)
{
  o->balls.ball_curves = o->ball_curves;
  o->complex.balls = &o->balls;
  o->vertices[0].kind = MLIM_VERTEX_BALL;
  o->vertices[0].ball = 0;
  for (size_t k = 0; k < count; ++k)
  {
    o->vertices[vertices[k]].kind = MLIM_VERTEX_BALL;
    o->vertices[vertices[k]].ball = (int32_t)k + 1;
    o->link_neighbors[k] = (int32_t)k + 1;
  }
  for (size_t b = 1; b < 8; ++b)
  {
    o->link_offsets[b] = count;
  }
}

static mlim_disk check(octahedron* o)
{
  mlim_star star = { 0 };
  mlim_disk disk = MLIM_DISK_EMPTY;
  CHECK(mlim_disk_check(&o->complex, &o->links, 0, &star, NULL, &disk) == MLIM_OK);
  CHECK_COUNT(star.facet_count, o->complex.facet_count - 1);
  mlim_star_free(&star);
  return disk;
}

static void test_sheets(void)
{
  const struct
  {
    int32_t labels[8];
    mlim_disk expected;
  } rows[] = {
    { { 0, 0, 0, 0, 0, 0, 0, 0 }, MLIM_DISK_EMPTY },
    { { 0, 1, 0, 1, 0, 1, 0, 1 }, MLIM_DISK_HOLDS }, /* a wall */
    { { 0, 0, 0, 0, 0, 0, 0, 1 }, MLIM_DISK_HOLDS }, /* a corner */
    { { 0, 0, 0, 1, 0, 0, 0, 1 }, MLIM_DISK_HOLDS }, /* an edge */
    { { 1, 0, 0, 0, 0, 0, 0, 1 }, MLIM_DISK_FAILS }, /* two corners touch: two cycles */
    { { 0, 0, 0, 1, 0, 1, 0, 0 }, MLIM_DISK_FAILS }, /* they share an edge: degree 4 */
    { { 0, 1, 0, 2, 0, 1, 0, 2 }, MLIM_DISK_FAILS }, /* three sheets meet and there is no ball */
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    octahedron o;
    set_up(&o, rows[k].labels);
    CHECK(check(&o) == rows[k].expected);
  }
}

static void test_balls(void)
{
  const int32_t sectors[8] = { 0, 1, 0, 2, 0, 1, 0, 2 };   /* three along the z axis */
  const int32_t quadrants[8] = { 0, 1, 2, 3, 0, 1, 2, 3 }; /* four along it */
  const int32_t wall[8] = { 0, 1, 0, 1, 0, 1, 0, 1 };
  const int32_t octants[8] = { 0, 1, 2, 3, 4, 5, 6, 7 };
  const int32_t touching[8] = { 1, 0, 0, 0, 0, 0, 0, 1 };
  const int32_t none[8] = { 0 };
  const struct
  {
    const int32_t* labels;
    int neighbors[6];
    size_t count;
    mlim_disk expected;
  } rows[] = {
    { sectors, { 5, 6 }, 2, MLIM_DISK_HOLDS }, { quadrants, { 5, 6 }, 2, MLIM_DISK_HOLDS },
    { octants, { 1, 2, 3, 4, 5, 6 }, 6, MLIM_DISK_HOLDS },
    { wall, { 5, 6 }, 2, MLIM_DISK_HOLDS }, /* a crease has two half-disks */
    { wall, { 1, 2 }, 2, MLIM_DISK_FAILS }, /* its neighbours are not in the link */
    { sectors, { 5 }, 1, MLIM_DISK_FAILS }, /* branches where there is no curve */
    { octants, { 1, 2, 3, 4, 5 }, 5, MLIM_DISK_FAILS },
    { touching, { 1, 3 }, 2, MLIM_DISK_FAILS }, /* a part of the link hangs on no curve */
    { none, { 5, 6 }, 2, MLIM_DISK_FAILS },     /* a curve without sheets */
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    octahedron o;
    set_up(&o, rows[k].labels);
    put_balls(&o, rows[k].neighbors, rows[k].count);
    CHECK(check(&o) == rows[k].expected);
  }
}

/* Sheets may touch at a contact, and end at it. */
static void test_contacts(void)
{
  const int32_t sectors[8] = { 0, 1, 0, 2, 0, 1, 0, 2 };
  const int32_t touching[8] = { 1, 0, 0, 0, 0, 0, 0, 1 };
  const int32_t sharing[8] = { 0, 0, 0, 1, 0, 1, 0, 0 };
  const int32_t none[8] = { 0 };
  const struct
  {
    const int32_t* labels;
    int is_contact; /* the middle */
    int contact;    /* a neighbour, 0: none */
    mlim_disk expected;
  } rows[] = {
    { touching, 1, 0, MLIM_DISK_HOLDS }, /* two cycles */
    { sharing, 1, 0, MLIM_DISK_FAILS },  /* they share an edge to a vertex that is no ball */
    { sharing, 1, 2, MLIM_DISK_HOLDS },  /* to a ball */
    { none, 1, 0, MLIM_DISK_FAILS },
    { sectors, 0, 6, MLIM_DISK_HOLDS }, /* a curve from 5 that goes on at the contact */
    { sectors, 0, 4, MLIM_DISK_FAILS }, /* it does not lead there */
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    octahedron o;
    const int curve_neighbor[1] = { 5 };
    set_up(&o, rows[k].labels);
    put_balls(&o, curve_neighbor, rows[k].is_contact ? 0 : 1);
    o.ball_curves[0] = rows[k].is_contact ? MLIM_CONTACT : 0;
    if (rows[k].contact > 0)
    {
      o.vertices[rows[k].contact].kind = MLIM_VERTEX_BALL;
      o.vertices[rows[k].contact].ball = 2;
      o.ball_curves[2] = MLIM_CONTACT;
    }
    CHECK(check(&o) == rows[k].expected);
  }
}

/* The links list both ends of every edge of the balls. */
static void test_links(void)
{
  int32_t edges[] = { 0, 3, 3, 1, 1, 0 };
  const mlim_balls balls = { .ball_count = 4, .edge_count = 3, .edges = edges };
  mlim_ball_links links;
  CHECK(mlim_ball_links_create(&balls, NULL, &links) == MLIM_OK);
  const size_t expected[4] = { 2, 2, 0, 2 };
  for (size_t b = 0; b < 4; ++b)
  {
    CHECK_COUNT(links.offsets[b + 1] - links.offsets[b], expected[b]);
  }
  CHECK(links.neighbors[0] + links.neighbors[1] == 4);
  mlim_ball_links_free(&links);
}

int main(void)
{
  test_sheets();
  test_balls();
  test_contacts();
  test_links();
  return check_result();
}
