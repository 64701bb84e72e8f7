/* Steps that take out more cells than a vertex has: the cells round a place give way to new ones that
   all have a vertex there. Which ones go is found by growing a cavity, after Klingner and Shewchuk,
   Aggressive tetrahedral mesh improvement (2007). */
#include "climb.h"
#include "exchange.h"
#include "memory.h"
#include "vector.h"

#include <math.h>
#include <string.h>

enum
{
  MAX_CAVITY = 64, /* cells that a vertex may take out */
  MAX_STAR = 40,   /* of them its own before */
  MAX_FACES = 2 * MAX_CAVITY + 2
};

/* A place whose cells are worse than this part of what they have to be is not climbed from. */
static const double PROMISING_PART = 0.3;

typedef struct cavity_face
{
  int32_t cell;
  int index;
  double shape; /* of the new cell at this face */
} cavity_face;

typedef struct cavity
{
  cavity_face faces[MAX_FACES];
  size_t face_count;
  int32_t cells[MAX_CAVITY];
  size_t cell_count;
  uint32_t stamp;
} cavity;

static void add_face(mlim_solid* solid, cavity* c, int32_t cell, int index, int32_t vertex)
{
  int32_t v[4];
  memcpy(v, solid->cells[cell].vertices, sizeof v);
  v[index] = vertex;
  c->faces[c->face_count++] =
    (cavity_face){ .cell = cell, .index = index, .shape = mlim_solid_shape(solid, v) };
}

/* Adds a cell: its faces that are faces of the cavity vanish, the others become some. */
static void absorb(mlim_solid* solid, cavity* c, int32_t id, int32_t vertex)
{
  mlim_solid_cell* cell = &solid->cells[id];
  cell->mark = c->stamp;
  c->cells[c->cell_count++] = id;
  size_t kept = 0;
  for (size_t f = 0; f < c->face_count; ++f)
  {
    const cavity_face* face = &c->faces[f];
    if (solid->cells[face->cell].neighbors[face->index] != id)
    {
      c->faces[kept++] = *face;
    }
  }
  c->face_count = kept;
  for (int k = 0; k < 4; ++k)
  {
    const int32_t other = cell->neighbors[k];
    if (other == MLIM_SOLID_NOTHING || solid->cells[other].mark != c->stamp)
    {
      add_face(solid, c, id, k, vertex);
    }
  }
}

static size_t worst_face(const cavity* c)
{
  size_t worst = 0;
  for (size_t f = 1; f < c->face_count; ++f)
  {
    worst = c->faces[f].shape < c->faces[worst].shape ? f : worst;
  }
  return worst;
}

/* Where a cavity begins. */
typedef struct cavity_seed
{
  const int32_t* cells;
  size_t count;
  int32_t vertex; /* that its new cells get; of no cell but the seed's */
} cavity_seed;

/* Grows a cavity from its seed, each time by the cell beyond the worst face, up to `limit` cells.
   Returns the number of cells at which the worst new cell is best; *best receives its shape. */
static size_t grow(
  mlim_solid* solid, cavity* c, const cavity_seed* seed, size_t limit, double* best)
{
  c->stamp = ++solid->stamp;
  c->face_count = 0;
  c->cell_count = 0;
  *best = -INFINITY;
  size_t at = 0;
  for (size_t k = 0; k < seed->count; ++k)
  {
    absorb(solid, c, seed->cells[k], seed->vertex);
  }
  for (;;)
  {
    const cavity_face face = c->faces[worst_face(c)];
    if (face.shape > *best)
    {
      *best = face.shape;
      at = c->cell_count;
    }
    const mlim_solid_cell* inner = &solid->cells[face.cell];
    if (c->cell_count >= limit || !mlim_solid_is_open(solid, inner, face.index))
    {
      return at;
    }
    absorb(solid, c, inner->neighbors[face.index], seed->vertex);
  }
}

static void take_cavity(
  const mlim_solid* solid, const cavity* c, int32_t vertex, mlim_solid_change* change)
{
  memcpy(change->old_cells, c->cells, c->cell_count * sizeof *c->cells);
  change->old_count = c->cell_count;
  change->new_count = 0;
  for (size_t f = 0; f < c->face_count; ++f)
  {
    int32_t* v = change->new_cells[change->new_count++];
    memcpy(v, solid->cells[c->faces[f].cell].vertices, sizeof change->new_cells[0]);
    v[c->faces[f].index] = vertex;
  }
}

/* The cavity for the vertex where it is, then a better place in it. Returns the worst shape. */
static double prepare(
  mlim_solid* solid, mlim_solid_change* change, const cavity_seed* seed, double above)
{
  cavity c;
  double best;
  const size_t count = grow(solid, &c, seed, MAX_CAVITY, &best);
  if (best < PROMISING_PART * above)
  {
    return best;
  }
  grow(solid, &c, seed, count, &best);
  take_cavity(solid, &c, seed->vertex, change);
  return mlim_climb(solid, change, seed->vertex);
}

/* Where a new vertex is tried: in the middle of the cell, of each of its faces, and
   of each of its edges. */
enum
{
  PLACES_IN_CELL = 11
};

static void place_in_cell(const mlim_solid* solid, int32_t cell, int place, double out[3])
{
  static const int pairs[6][2] = { { 0, 1 }, { 0, 2 }, { 0, 3 }, { 1, 2 }, { 1, 3 }, { 2, 3 } };
  const int32_t* v = solid->cells[cell].vertices;
  for (int x = 0; x < 3; ++x)
  {
    double p[4];
    for (int k = 0; k < 4; ++k)
    {
      p[k] = solid->points[3 * (size_t)v[k] + (size_t)x];
    }
    const double sum = p[0] + p[1] + p[2] + p[3];
    out[x] = place == 0  ? 0.25 * sum
             : place < 5 ? (sum - p[place - 1]) / 3
                         : 0.5 * (p[pairs[place - 5][0]] + p[pairs[place - 5][1]]);
  }
}

/* Before that, mostly for the radius-edge ratio: from the middle of the shortest edge towards the
   circumcentre, so far that a cell of good shape fits between. Ungor's off-centres. */
static void place_off_center(const mlim_solid* solid, int32_t cell, double part, double out[3])
{
  const int32_t* v = solid->cells[cell].vertices;
  const double* p[4];
  for (int k = 0; k < 4; ++k)
  {
    p[k] = solid->points + 3 * (size_t)v[k];
  }
  double shortest = INFINITY;
  double middle[3] = { 0 };
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < i; ++j)
    {
      const double squared = mlim_distance_squared(p[i], p[j]);
      if (squared < shortest)
      {
        shortest = squared;
        mlim_interpolate(p[i], p[j], 0.5, middle);
      }
    }
  }
  double center[3];
  mlim_shape_center(p, center);
  const double distance = mlim_distance(middle, center);
  mlim_interpolate(middle, center, mlim_min(1, part * sqrt(shortest) / distance), out);
}

/* In shortest edges; 0.87 would make an equilateral triangle with the edge. */
static const double OFF_CENTER_PARTS[] = { 1, 1.6, 0.7 };

enum
{
  PLACES_OFF_CENTER = sizeof OFF_CENTER_PARTS / sizeof *OFF_CENTER_PARTS
};

/* The cavity and the new vertex for one of the places. Returns the worst shape, which has to come
   above `above`. */
static double try_place(
  mlim_solid* solid, mlim_solid_change* change, int32_t cell, int place, double above)
{
  const int32_t vertex = (int32_t)solid->vertex_count;
  double* point = solid->points + 3 * (size_t)vertex;
  if (place < PLACES_OFF_CENTER)
  {
    place_off_center(solid, cell, OFF_CENTER_PARTS[place], point);
  }
  else
  {
    place_in_cell(solid, cell, place - PLACES_OFF_CENTER, point);
  }
  const cavity_seed seed = { .cells = &cell, .count = 1, .vertex = vertex };
  return prepare(solid, change, &seed, above);
}

int mlim_exchange_insert(mlim_solid* solid, mlim_solid_change* change, int32_t cell)
{
  if (solid->vertex_count >= INT32_MAX - 1 || mlim_reserve(&solid->points, &solid->vertex_capacity,
                                                solid->vertex_count + 1, 3 * sizeof *solid->points))
  {
    return -1;
  }
  const double old = solid->cells[cell].shape;
  double most = mlim_exchange_least(old);
  int best = -1;
  for (int place = 0; place < PLACES_OFF_CENTER + PLACES_IN_CELL && most < 1; ++place)
  {
    const double shape = try_place(solid, change, cell, place, most);
    if (shape > most)
    {
      most = shape;
      best = place;
    }
  }
  if (best < 0)
  {
    return 0;
  }
  (void)try_place(solid, change, cell, best, old);
  const int done = mlim_solid_exchange(solid, change, solid->cells[cell].label);
  solid->vertex_count += done > 0;
  return done;
}

int mlim_exchange_star(mlim_solid* solid, mlim_solid_change* change, int32_t cell, int index)
{
  const int32_t vertex = solid->cells[cell].vertices[index];
  if ((size_t)vertex < solid->fixed_count || !mlim_solid_star(solid, cell, vertex, change) ||
      change->old_count > MAX_STAR)
  {
    return 0;
  }
  int32_t star[MAX_STAR];
  memcpy(star, change->old_cells, change->old_count * sizeof *star);
  const cavity_seed seed = { .cells = star, .count = change->old_count, .vertex = vertex };
  const double old = solid->cells[cell].shape;
  double* point = solid->points + 3 * (size_t)vertex;
  double from[3];
  mlim_copy(point, from);
  if (prepare(solid, change, &seed, old) > mlim_exchange_least(old))
  {
    const int done = mlim_solid_exchange(solid, change, solid->cells[cell].label);
    if (done != 0)
    {
      return done;
    }
  }
  mlim_copy(from, point);
  return 0;
}
