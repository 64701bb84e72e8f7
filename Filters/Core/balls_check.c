#include "balls.h"

#include "ball_grid.h"
#include "memory.h"
#include "vector.h"

#include <math.h>

/* The conditions' margins. Between neighbours they are parts of the smaller radius, so that a small
   ball may follow a large one (sharp angles at junctions need that): the overlap, and the distance
   by which the larger ball misses the smaller one's centre. Larger margins make flatter chains of
   balls impossible, smaller ones make tiny weighted Delaunay edges. */
static const double OVERLAP_MARGIN = 0.1;
static const double CENTER_MARGIN = 0.05;
/* Balls that are not neighbours are apart by this part of the distance of their centres. */
static const double DISJOINT_MARGIN = 0.01;
/* Below the square of what is left of 1: nearly all pairs are seen to be apart without a root. */
static const double WELL_APART = 0.98;
/* Part of edge_size and facet_distance by which rounding may exceed them. */
static const double ROUNDING = 1e-6;

enum
{
  MIN_OPEN_EDGES = 2, /* so that two curves between the same junctions share no edge */
  MIN_LOOP_EDGES = 4  /* a triangle could be a triangle of the surface */
};

typedef struct examination
{
  const mlim_curves* curves;
  const mlim_balls* balls;
  const unsigned char* is_known; /* NULL: none */
  const mlim_options* options;
  mlim_ball_report report;
  void* user;
} examination;

static double center_distance(const mlim_balls* balls, int32_t a, int32_t b)
{
  return mlim_distance(balls->centers + 3 * (size_t)a, balls->centers + 3 * (size_t)b);
}

static void examine_neighbours(const examination* work)
{
  const mlim_balls* balls = work->balls;
  for (size_t e = 0; e < balls->edge_count; ++e)
  {
    const int32_t a = balls->edges[2 * e];
    const int32_t b = balls->edges[2 * e + 1];
    const double d = center_distance(balls, a, b);
    const int32_t large = balls->radii[a] >= balls->radii[b] ? a : b;
    const double small_radius = mlim_min(balls->radii[a], balls->radii[b]);
    if (balls->radii[a] + balls->radii[b] < d + OVERLAP_MARGIN * small_radius)
    {
      work->report(work->user, MLIM_BALLS_APART, a, b, d);
    }
    if (d < balls->radii[large] + CENTER_MARGIN * small_radius)
    {
      work->report(work->user, MLIM_BALL_HOLDS_CENTER, large, a + b - large, d);
    }
    if (d > work->options->edge_size * (1 + ROUNDING))
    {
      work->report(work->user, MLIM_BALLS_LONG, a, b, d);
    }
  }
}

/* Which balls are neighbours: starts has one more than balls. */
static mlim_status list_neighbours(const mlim_balls* balls, size_t** starts, int32_t** neighbours)
{
  *starts = mlim_allocate_zeroed(balls->ball_count + 2, sizeof(size_t));
  *neighbours = mlim_allocate(2 * balls->edge_count, sizeof(int32_t));
  if (!*starts || !*neighbours)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  for (size_t i = 0; i < 2 * balls->edge_count; ++i)
  {
    ++(*starts)[balls->edges[i] + 2];
  }
  for (size_t i = 2; i < balls->ball_count + 2; ++i)
  {
    (*starts)[i] += (*starts)[i - 1];
  }
  for (size_t i = 0; i < 2 * balls->edge_count; ++i)
  {
    size_t* at = *starts + balls->edges[i] + 1;
    (*neighbours)[*at] = balls->edges[i ^ 1];
    ++*at;
  }
  return MLIM_OK;
}

/* Contacts may overlap any ball. */
static int is_contact(const mlim_balls* balls, size_t ball)
{
  return balls->ball_curves[ball] == MLIM_CONTACT;
}

static int is_known(const examination* work, size_t ball)
{
  return work->is_known != NULL && work->is_known[ball];
}

/* The balls before one, and those of them that are new. */
typedef struct others
{
  size_t* starts; /* of a ball's neighbours; one more at the end */
  int32_t* neighbours;
  mlim_ball_grid all;
  mlim_ball_grid fresh;
} others;

/* May the balls touch? They are neighbours, or one of them is a contact. */
static int may_touch(const mlim_balls* balls, const others* o, size_t i, int32_t j)
{
  int may = is_contact(balls, i) || is_contact(balls, (size_t)j);
  for (size_t n = o->starts[i]; n < o->starts[i + 1] && !may; ++n)
  {
    may = o->neighbours[n] == j;
  }
  return may;
}

/* A ball that is known is compared with the new ones alone. */
static void examine_pairs(const examination* work, const others* o, size_t i)
{
  const mlim_balls* balls = work->balls;
  const mlim_ball_grid* grid = is_known(work, i) ? &o->fresh : &o->all;
  const double* center = balls->centers + 3 * i;
  const double most = balls->radii[i] + grid->largest;
  mlim_point_walk walk;
  for (int32_t j = mlim_point_grid_first(&grid->points, center, most, &walk); j >= 0;
       j = mlim_point_grid_next(&grid->points, &walk))
  {
    const double reach = balls->radii[i] + balls->radii[j];
    if (reach * reach < WELL_APART * mlim_distance_squared(balls->centers + 3 * (size_t)j, center))
    {
      continue;
    }
    const double d = center_distance(balls, (int32_t)i, j);
    if (reach >= (1 - DISJOINT_MARGIN) * d && !may_touch(balls, o, i, j))
    {
      work->report(work->user, MLIM_BALLS_TOUCH, j, (int32_t)i, d);
    }
  }
}

static mlim_status examine_others(const examination* work)
{
  const mlim_balls* balls = work->balls;
  others o = { 0 };
  mlim_status status = list_neighbours(balls, &o.starts, &o.neighbours);
  status = status ? status : mlim_ball_grid_create(balls, &o.all);
  status = status ? status : mlim_ball_grid_create(balls, &o.fresh);
  for (size_t i = 0; i < balls->ball_count && !status; ++i)
  {
    examine_pairs(work, &o, i);
    mlim_point_grid_add(&o.all.points, balls->centers + 3 * i, (int32_t)i);
    if (!is_known(work, i))
    {
      mlim_point_grid_add(&o.fresh.points, balls->centers + 3 * i, (int32_t)i);
    }
  }
  mlim_ball_grid_free(&o.all);
  mlim_ball_grid_free(&o.fresh);
  mlim_release(o.starts);
  mlim_release(o.neighbours);
  return status;
}

/* A place on a curve: its piece, from 0, and the part of the piece. */
typedef struct curve_place
{
  size_t piece;
  double part;
} curve_place;

static const double* curve_point(const mlim_curves* curves, size_t curve, size_t index)
{
  const int32_t point = curves->curve_points[curves->curve_offsets[curve] + index];
  return curves->points + 3 * (size_t)point;
}

/* Squared distance of a point from a segment, and where it is nearest. */
static double segment_distance_squared(
  const double point[3], const double a[3], const double b[3], double* part)
{
  double along[3];
  double to[3];
  mlim_subtract(b, a, along);
  mlim_subtract(point, a, to);
  const double length_squared = mlim_dot(along, along);
  const double t = length_squared > 0 ? mlim_dot(to, along) / length_squared : 0;
  *part = mlim_min(mlim_max(t, 0), 1);
  double nearest[3];
  mlim_interpolate(a, b, *part, nearest);
  return mlim_distance_squared(point, nearest);
}

/* Moves the place on to the first one that the centre lies on. 0: there is none. */
static int find_place(
  const examination* work, size_t curve, const double center[3], curve_place* place)
{
  const mlim_curves* curves = work->curves;
  const size_t count = curves->curve_offsets[curve + 1] - curves->curve_offsets[curve];
  const double tolerance = ROUNDING * work->options->edge_size;
  for (size_t piece = place->piece; piece + 1 < count; ++piece)
  {
    double part;
    const double d = segment_distance_squared(
      center, curve_point(curves, curve, piece), curve_point(curves, curve, piece + 1), &part);
    if (d <= tolerance * tolerance && (piece > place->piece || part >= place->part - ROUNDING))
    {
      *place = (curve_place){ .piece = piece, .part = part };
      return 1;
    }
  }
  return 0;
}

static double power(const mlim_balls* balls, int32_t ball, const double point[3])
{
  const double r = balls->radii[ball];
  return mlim_distance_squared(point, balls->centers + 3 * (size_t)ball) - r * r;
}

/* Does the straight piece of curve stay in the union and near the chord? Its ends and the point
   where it changes from one ball's side of the radical plane to the other's decide. */
static int is_piece_good(
  const examination* work, const int32_t ends[2], const double from[3], const double to[3])
{
  const mlim_balls* balls = work->balls;
  double part;
  const double deviation = segment_distance_squared(
    to, balls->centers + 3 * (size_t)ends[0], balls->centers + 3 * (size_t)ends[1], &part);
  const double bound = work->options->facet_distance * (1 + ROUNDING);
  const double d0 = power(balls, ends[0], from) - power(balls, ends[1], from);
  const double d1 = power(balls, ends[0], to) - power(balls, ends[1], to);
  double worst[3];
  mlim_interpolate(from, to, d0 < 0 && d1 > 0 ? d0 / (d0 - d1) : 1, worst);
  return deviation <= bound * bound &&
         mlim_min(power(balls, ends[0], worst), power(balls, ends[1], worst)) <= 0;
}

/* The piece of the curve from a place to the next one: are all its straight pieces good? */
static int is_edge_good(const examination* work, size_t curve, const int32_t ends[2],
  const curve_place* begin, const curve_place* end)
{
  const double* from = work->balls->centers + 3 * (size_t)ends[0];
  for (size_t piece = begin->piece; piece < end->piece; ++piece)
  {
    const double* to = curve_point(work->curves, curve, piece + 1);
    if (!is_piece_good(work, ends, from, to))
    {
      return 0;
    }
    from = to;
  }
  return is_piece_good(work, ends, from, work->balls->centers + 3 * (size_t)ends[1]);
}

/* The edges of one curve: are all their balls known? */
static int are_known(const examination* work, size_t first, size_t end)
{
  const int32_t* edges = work->balls->edges;
  int known = 1;
  for (size_t edge = first; edge < end && known; ++edge)
  {
    known = is_known(work, (size_t)edges[2 * edge]) && is_known(work, (size_t)edges[2 * edge + 1]);
  }
  return known;
}

static size_t count_points(const examination* work, size_t curve)
{
  return work->curves->curve_offsets[curve + 1] - work->curves->curve_offsets[curve];
}

/* They run along the curve. */
static void examine_pieces(const examination* work, size_t curve, size_t first, size_t end)
{
  const mlim_balls* balls = work->balls;
  curve_place place = { .piece = 0, .part = 0 };
  for (size_t edge = first; edge < end; ++edge)
  {
    const int32_t* ends = balls->edges + 2 * edge;
    const int is_last = edge + 1 == end;
    const curve_place begin = place;
    /* The last centre may be the curve's end, where an earlier place would be found first. */
    const int is_found =
      is_last || find_place(work, curve, balls->centers + 3 * (size_t)ends[1], &place);
    if (is_last)
    {
      place = (curve_place){ .piece = count_points(work, curve) - 2, .part = 1 };
    }
    if (!is_found || !is_edge_good(work, curve, ends, &begin, &place))
    {
      work->report(
        work->user, MLIM_BALLS_STRAY, ends[0], ends[1], center_distance(balls, ends[0], ends[1]));
    }
  }
}

/* The edges of a curve are consecutive. */
static void examine_curves(const examination* work)
{
  const mlim_balls* balls = work->balls;
  size_t edge = 0;
  for (size_t curve = 0; curve < work->curves->curve_count; ++curve)
  {
    const size_t first = edge;
    while (edge < balls->edge_count && balls->edge_curves[edge] == (int32_t)curve)
    {
      ++edge;
    }
    if (!are_known(work, first, edge))
    {
      examine_pieces(work, curve, first, edge);
    }
    const size_t count = count_points(work, curve);
    const int is_closed =
      curve_point(work->curves, curve, 0) == curve_point(work->curves, curve, count - 1);
    if (edge - first < (is_closed ? MIN_LOOP_EDGES : MIN_OPEN_EDGES))
    {
      work->report(work->user, MLIM_BALLS_SHORT, (int32_t)curve, (int32_t)curve, 0);
    }
  }
}

mlim_status mlim_balls_examine(const mlim_curves* curves, const mlim_balls* balls,
  const unsigned char* is_known, const mlim_options* options, mlim_ball_report report, void* user)
{
  const examination work = { .curves = curves,
    .balls = balls,
    .is_known = is_known,
    .options = options,
    .report = report,
    .user = user };
  examine_neighbours(&work);
  if (curves)
  {
    examine_curves(&work);
  }
  return examine_others(&work);
}

static void count_fault(void* user, mlim_ball_fault fault, int32_t a, int32_t b, double distance)
{
  mlim_ball_counts* counts = user;
  (void)a;
  (void)b;
  (void)distance;
  switch (fault)
  {
    case MLIM_BALLS_APART:
      ++counts->apart_count;
      break;
    case MLIM_BALL_HOLDS_CENTER:
      ++counts->holding_count;
      break;
    case MLIM_BALLS_TOUCH:
      ++counts->touching_count;
      break;
    case MLIM_BALLS_LONG:
      ++counts->long_count;
      break;
    case MLIM_BALLS_STRAY:
      ++counts->stray_count;
      break;
    case MLIM_BALLS_SHORT:
      ++counts->short_count;
      break;
  }
}

mlim_status mlim_balls_check(const mlim_curves* curves, const mlim_balls* balls,
  const mlim_options* options, mlim_ball_counts* out)
{
  *out = (mlim_ball_counts){ 0 };
  return mlim_balls_examine(curves, balls, NULL, options, count_fault, out);
}
