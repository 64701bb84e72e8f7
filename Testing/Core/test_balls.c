/* The balls' conditions hold on networks of every kind. */
#include "pieces.h"
#include "radius_map.h"
#include "scenes.h"
#include "vector.h"

#include <math.h>

static double three_sectors(const double at[3], int label)
{
  const double angle = 0.4 + label * 2.0943951023931953;
  return cos(angle) * (at[0] - 4.3) + sin(angle) * (at[1] - 4.6);
}

static double checkerboard(const double at[3], int label)
{
  return (label & 1 ? 1 : -1) * (at[0] - 3) + (label & 2 ? 1 : -1) * (at[1] - 3) +
         (label & 4 ? 1 : -1) * (at[2] - 3);
}

static double two_spheres(const double at[3], int label)
{
  const double x = at[0] - (label == 1 ? 7.3 : 13.3);
  return label == 0 ? 0 : 5 - sqrt(x * x + pow(at[1] - 9.1, 2) + pow(at[2] - 8.8, 2));
}

static double foam(const double at[3], int label)
{
  const double x = at[0] - fmod(1.3 + 7.7 * label, 11);
  const double y = at[1] - fmod(2.9 + 4.9 * label, 11);
  const double z = at[2] - fmod(4.1 + 6.1 * label, 11);
  return -sqrt(x * x + y * y + z * z);
}

static double one_region(const double at[3], int label)
{
  (void)at;
  return label;
}

/* A wedge of label 1 in label 0, its edge at x = 2.3; 8 and 4 degrees. */
static double wedge(const double at[3], double degrees, int label)
{
  const double slope = tan(0.5 * degrees * 3.141592653589793 / 180);
  return label == 0 ? 0 : slope * (at[0] - 2.3) - fabs(at[1] - 4.4);
}

static double wedge_8(const double at[3], int label)
{
  return wedge(at, 8, label);
}

static double sectors_of_wedge(const double at[3], double degrees, int label)
{
  /* Exact planes: label 1 below, 2 above, 0 the wedge between them. */
  const double slope = tan(0.5 * degrees * 3.141592653589793 / 180);
  const double x = at[0] - 2.3;
  const double y = at[1] - 4.4;
  return label == 0 ? 2 * slope * x : label == 1 ? -y * 2 : y * 2;
}

static double sectors_8(const double at[3], int label)
{
  return sectors_of_wedge(at, 8, label);
}

static double sectors_4(const double at[3], int label)
{
  return sectors_of_wedge(at, 4, label);
}

static size_t fault_count(const mlim_ball_counts* counts)
{
  return counts->apart_count + counts->holding_count + counts->touching_count + counts->long_count +
         counts->stray_count + counts->short_count;
}

/* Parts of the cover: balls that edges connect. */
static size_t part_count(const mlim_balls* balls)
{
  int32_t* parts = mlim_allocate(balls->ball_count, sizeof(int32_t));
  size_t count = 0;
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    parts[b] = (int32_t)b;
  }
  int has_changed = 1;
  while (has_changed)
  {
    has_changed = 0;
    for (size_t e = 0; e < balls->edge_count; ++e)
    {
      int32_t* a = parts + balls->edges[2 * e];
      int32_t* b = parts + balls->edges[2 * e + 1];
      has_changed = has_changed || *a != *b;
      *a = *b = *a < *b ? *a : *b;
    }
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    count += parts[b] == (int32_t)b;
  }
  mlim_release(parts);
  return count;
}

/* Neighbours that do not overlap. */
static size_t gap_count(const mlim_balls* balls)
{
  size_t count = 0;
  for (size_t e = 0; e < balls->edge_count; ++e)
  {
    const size_t a = (size_t)balls->edges[2 * e];
    const size_t b = (size_t)balls->edges[2 * e + 1];
    count += mlim_distance(balls->centers + 3 * a, balls->centers + 3 * b) >=
             balls->radii[a] + balls->radii[b];
  }
  return count;
}

static int has_label(const mlim_sets* sets, int32_t set, int32_t label)
{
  int found = 0;
  for (size_t k = sets->offsets[set]; k < sets->offsets[set + 1]; ++k)
  {
    found = found || sets->labels[k] == label;
  }
  return found;
}

/* The contact holds no other ball's centre, and has the labels of all that it took the place of. */
static void check_contact(const mlim_balls* old, const mlim_balls* balls, int32_t contact)
{
  const double* center = balls->centers + 3 * (size_t)contact;
  const double radius = balls->radii[contact];
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    CHECK(b == (size_t)contact || mlim_distance(center, balls->centers + 3 * b) > radius);
  }
  for (size_t b = 0; b < old->ball_count; ++b)
  {
    const int32_t set = old->ball_sets[b];
    for (size_t k = old->sets.offsets[set]; k < old->sets.offsets[set + 1]; ++k)
    {
      CHECK(mlim_distance(center, old->centers + 3 * b) > radius ||
            has_label(&balls->sets, balls->ball_sets[contact], old->sets.labels[k]));
    }
  }
}

/* A contact in the place of a ball, and one beside a ball, which touches it alone. */
static void check_contracted(const mlim_balls* balls)
{
  int32_t label = 0;
  size_t offsets[2] = { 0, 1 };
  const mlim_sets sets = { .count = 1, .offsets = offsets, .labels = &label };
  for (size_t b = 0; b < balls->ball_count; b += 5)
  {
    const double r = balls->radii[b];
    mlim_contact contacts[2] = { { .radius = 1.7 * r }, { .radius = 0.3 * r } };
    mlim_copy(balls->centers + 3 * b, contacts[0].center);
    mlim_copy(balls->centers + 3 * b, contacts[1].center);
    contacts[1].center[2] += 2.5 * r;
    mlim_balls made;
    CHECK(mlim_balls_contract(balls, contacts, 2, &sets, NULL, &made) == MLIM_OK);
    CHECK(part_count(&made) <= part_count(balls) + 1);
    CHECK_COUNT(gap_count(&made), 0);
    int32_t found = 0;
    for (size_t m = 0; m < made.ball_count; ++m)
    {
      if (made.ball_curves[m] == MLIM_CONTACT)
      {
        check_contact(balls, &made, (int32_t)m);
        CHECK(has_label(&made.sets, made.ball_sets[m], label));
        ++found;
      }
    }
    CHECK_COUNT(found, 2);
    mlim_balls_free(&made);
  }
}

static void check_scene(const char* name, const scene_spec* scene, double scale, int is_empty)
{
  mlim_field* field = scene_field(scene);
  mlim_options options = { 0 };
  options = mlim_options_default(field);
  options.facet_size *= scale;
  options.edge_size *= scale;
  options.facet_distance *= scale;
  mlim_curves curves;
  mlim_balls balls;
  mlim_ball_counts counts;
  CHECK(mlim_curves_extract(field, &options, NULL, &curves) == MLIM_OK);
  CHECK(mlim_balls_cover(&curves, &options, NULL, &balls) == MLIM_OK);
  CHECK(mlim_balls_check(&curves, &balls, &options, &counts) == MLIM_OK);
  CHECK(is_empty == (balls.ball_count == 0));
  if (fault_count(&counts) > 0)
  {
    fprintf(stderr,
      "%s at %g, %zu balls: %zu apart %zu hold %zu touch %zu long %zu stray %zu short\n", name,
      scale, balls.ball_count, counts.apart_count, counts.holding_count, counts.touching_count,
      counts.long_count, counts.stray_count, counts.short_count);
  }
  CHECK_COUNT(fault_count(&counts), 0);

  check_contracted(&balls);
  mlim_balls_free(&balls);
  mlim_curves_free(&curves);
  mlim_field_free(field);
}

/* A list has what a search from its place meets, in its order, or says that it is too long. */
static void test_pieces(void)
{
  enum
  {
    SAMPLES = 6000
  };
  static double points[3 * SAMPLES]; /* a spiral that winds ever closer */
  const size_t offsets[2] = { 0, SAMPLES };
  for (int s = 0; s < SAMPLES; ++s)
  {
    const double r = 20 * exp(-0.002 * s);
    points[3 * s] = r * cos(0.02 * s);
    points[3 * s + 1] = r * sin(0.02 * s);
    points[3 * s + 2] = 0.1 * r;
  }
  const mlim_piece_source source = {
    .points = points, .offsets = offsets, .curve_count = 1, .step = 0.5, .reach = 2
  };
  mlim_pieces pieces;
  static mlim_piece_list list;
  size_t short_count = 0;
  size_t long_count = 0;
  CHECK(mlim_pieces_create(&source, &pieces) == MLIM_OK);
  const mlim_point_grid* grid = &pieces.levels[0].grid;
  for (size_t s = 0; s < SAMPLES; ++s)
  {
    const double* point = points + 3 * s;
    const int is_whole = mlim_pieces_list(&pieces, point, &list);
    mlim_point_walk walk;
    size_t count = 0;
    for (int32_t p = mlim_point_grid_first(grid, point, pieces.levels[0].reach, &walk); p >= 0;
         p = mlim_point_grid_next(grid, &walk))
    {
      CHECK(!is_whole || (count < list.count && list.pieces[count] == p &&
                           mlim_distance_squared(list.starts[count], points + 3 * (size_t)p) == 0));
      ++count;
    }
    CHECK(is_whole == (count <= MLIM_MAX_NEAR_PIECES));
    CHECK(!is_whole || list.count == count);
    short_count += (size_t)is_whole;
    long_count += (size_t)!is_whole;
  }
  CHECK(short_count > 0 && long_count > 0);
  mlim_pieces_free(&pieces);
}

enum
{
  RING = 400 /* points of each of two rings */
};

/* Two rings that face each other. */
static mlim_curves rings_apart(double distance)
{
  static double points[3 * 2 * RING];
  static int32_t ids[2 * (RING + 1)];
  static size_t offsets[3] = { 0, RING + 1, 2 * (RING + 1) };
  for (int p = 0; p < 2 * RING; ++p)
  {
    const double angle = 6.283185307179586 * (p % RING) / RING;
    points[3 * p] = 15 * cos(angle);
    points[3 * p + 1] = 15 * sin(angle);
    points[3 * p + 2] = p < RING ? 0 : distance;
  }
  for (int k = 0; k < 2 * (RING + 1); ++k)
  {
    ids[k] = k / (RING + 1) * RING + k % (RING + 1) % RING;
  }
  return (mlim_curves){ .point_count = 2 * RING,
    .points = points,
    .curve_count = 2,
    .curve_offsets = offsets,
    .curve_points = ids };
}

/* Small radii follow from what is near, large ones from what is far away: no curve is left out. */
static void test_limits(void)
{
  const mlim_options options = {
    .edge_size = 24, .ball_radius_scale = 1, .smallest_distance = 0.1
  };
  const double most = 24 / 1.5;
  for (double distance = 0.5; distance < 50; distance *= 1.4)
  {
    const mlim_curves curves = rings_apart(distance);
    const double expected = fmin(0.47 * distance, most);
    mlim_radius_map map;
    CHECK(mlim_radius_map_create(&curves, &options, NULL, &map) == MLIM_OK);
    for (size_t s = 0; s < map.sample_count; ++s)
    {
      CHECK(fabs(map.limits[s] - expected) < 1e-9 * most);
    }
    mlim_radius_map_free(&map);
  }
}

int main(void)
{
  const double scales[3] = { 1, 0.4, 3 };
  for (int s = 0; s < 3; ++s)
  {
    const scene_spec sectors = { .dims = { 9, 10, 6 },
      .spacing = { 1, 1, 1 },
      .label_count = 3,
      .background = 0,
      .function = three_sectors };
    check_scene("sectors", &sectors, scales[s], 0);
    const scene_spec board = { .dims = { 7, 7, 7 },
      .spacing = { 1, 1, 1 },
      .label_count = 8,
      .background = -1,
      .function = checkerboard };
    check_scene("checkerboard", &board, scales[s], 0);
    const scene_spec spheres = { .dims = { 22, 19, 19 },
      .spacing = { 1, 1, 1 },
      .label_count = 3,
      .background = 0,
      .function = two_spheres };
    check_scene("spheres", &spheres, scales[s], 0);
    const scene_spec cells = { .dims = { 12, 12, 12 },
      .spacing = { 1, 1, 1 },
      .label_count = 9,
      .background = -1,
      .function = foam };
    check_scene("foam", &cells, scales[s], 0);
    const scene_spec box = { .dims = { 5, 4, 3 },
      .spacing = { 1, 2, 0.5 },
      .label_count = 2,
      .background = 0,
      .function = one_region };
    check_scene("box", &box, scales[s], 0);
    const scene_function wedges[3] = { wedge_8, sectors_8, sectors_4 };
    const char* names[3] = { "wedge of 8", "sectors of 8", "sectors of 4" };
    for (int w = 0; w < 3; ++w)
    {
      const scene_spec sharp = { .dims = { 20, 10, 6 },
        .spacing = { 1, 1, 1 },
        .label_count = w == 0 ? 2 : 3,
        .background = w == 0 ? 0 : -1,
        .function = wedges[w] };
      /* Small balls at a sharp angle would fall below the floor. */
      if (w < 2 || scales[s] >= 1)
      {
        check_scene(names[w], &sharp, scales[s], 0);
      }
    }
  }
  test_pieces();
  test_limits();
  return check_result();
}
