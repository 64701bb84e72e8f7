/* Curves of fields whose curves are known. */
#include "scenes.h"

#include <stdlib.h>

/* What there is to count in a network. Inner curves have no face of the box in their set. */
typedef struct counts
{
  size_t inner_curves;
  size_t inner_loops;
  size_t inner_junctions;
  size_t box_curves;
  size_t box_loops;
  size_t box_junctions;
  size_t loose_ends;
} counts;

static counts count_all(const mlim_curves* curves, int32_t label_count)
{
  counts found = { 0 };
  size_t* degrees = mlim_allocate_zeroed(curves->point_count, sizeof(size_t));
  for (size_t c = 0; c < curves->curve_count; ++c)
  {
    const int32_t set = curves->curve_sets[c];
    const int32_t first = curves->curve_points[curves->curve_offsets[c]];
    const int32_t last = curves->curve_points[curves->curve_offsets[c + 1] - 1];
    const int is_on_box = curves->sets.labels[curves->sets.offsets[set + 1] - 1] >= label_count;
    ++degrees[first];
    ++degrees[last];
    found.box_curves += is_on_box ? 1 : 0;
    found.inner_curves += is_on_box ? 0 : 1;
    found.box_loops += is_on_box && first == last;
    found.inner_loops += !is_on_box && first == last;
  }
  for (size_t j = 0; j < curves->junction_count; ++j)
  {
    const int32_t set = curves->junction_sets[j];
    const int is_on_box = curves->sets.labels[curves->sets.offsets[set + 1] - 1] >= label_count;
    found.box_junctions += is_on_box ? 1 : 0;
    found.inner_junctions += is_on_box ? 0 : 1;
    found.loose_ends += degrees[curves->junction_points[j]] == 1;
  }
  mlim_release(degrees);
  return found;
}

static counts extract(const scene_spec* scene, mlim_curves* curves)
{
  mlim_field* field = scene_field(scene);
  mlim_context context = { 0 };
  const mlim_options options = mlim_options_default(field);
  CHECK(mlim_curves_extract(field, &options, &context, curves) == MLIM_OK);
  const counts found = count_all(curves, mlim_field_label_count(field));
  CHECK_COUNT(found.loose_ends, 0);
  mlim_field_free(field);
  return found;
}

/* Three sectors round the axis through (4.3, 4.6). */
static double three_sectors(const double at[3], int label)
{
  const double angle = 0.4 + label * 2.0943951023931953;
  return cos(angle) * (at[0] - 4.3) + sin(angle) * (at[1] - 4.6);
}

static void test_three_half_spaces_meet_in_a_line(void)
{
  const scene_spec scene = { .dims = { 9, 10, 6 },
    .spacing = { 1, 1, 1 },
    .label_count = 3,
    .background = 0,
    .function = three_sectors };
  mlim_curves curves;
  const counts found = extract(&scene, &curves);
  CHECK_COUNT(found.inner_curves, 1);
  CHECK_COUNT(found.inner_junctions, 0);
  double worst = 0;
  for (size_t c = 0; c < curves.curve_count; ++c)
  {
    const int32_t set = curves.curve_sets[c];
    if (curves.sets.offsets[set + 1] - curves.sets.offsets[set] != 3 ||
        curves.sets.labels[curves.sets.offsets[set] + 2] > 2)
    {
      continue;
    }
    for (size_t i = curves.curve_offsets[c]; i < curves.curve_offsets[c + 1]; ++i)
    {
      const double* p = curves.points + 3 * (size_t)curves.curve_points[i];
      worst = fmax(worst, hypot(p[0] - 4.3, p[1] - 4.6));
    }
  }
  CHECK_BELOW(worst, 1e-5);
  mlim_curves_free(&curves);
}

/* Four sectors of space round a point, as at a junction of foam. */
static double four_regions(const double at[3], int label)
{
  static const double directions[4][3] = { { 1, 1, 1 }, { 1, -1, -1 }, { -1, 1, -1 },
    { -1, -1, 1 } };
  const double* d = directions[label];
  return d[0] * (at[0] - 4.2) + d[1] * (at[1] - 3.9) + d[2] * (at[2] - 4.4);
}

static void test_four_regions_meet_in_a_point(void)
{
  const scene_spec scene = { .dims = { 9, 9, 9 },
    .spacing = { 1, 1, 1 },
    .label_count = 4,
    .background = -1,
    .function = four_regions };
  mlim_curves curves;
  const counts found = extract(&scene, &curves);
  CHECK_COUNT(found.inner_curves, 4);
  CHECK_COUNT(found.inner_junctions, 1);
  for (size_t j = 0; j < curves.junction_count; ++j)
  {
    const int32_t set = curves.junction_sets[j];
    if (scene_label_count(&curves.sets, set, 4) == 4)
    {
      const double* p = curves.points + 3 * (size_t)curves.junction_points[j];
      CHECK_BELOW(fabs(p[0] - 4.2) + fabs(p[1] - 3.9) + fabs(p[2] - 4.4), 1e-5);
    }
  }
  mlim_curves_free(&curves);
}

static double checkerboard(const double at[3], int label)
{
  return (label & 1 ? 1 : -1) * (at[0] - 3) + (label & 2 ? 1 : -1) * (at[1] - 3) +
         (label & 4 ? 1 : -1) * (at[2] - 3);
}

static double checkerboard_off_grid(const double at[3], int label)
{
  const double moved[3] = { at[0] - 0.5, at[1] - 0.5, at[2] - 0.5 };
  return checkerboard(moved, label);
}

static void test_checkerboard_has_one_junction_and_six_curves(void)
{
  const scene_function functions[2] = { checkerboard, checkerboard_off_grid };
  for (int f = 0; f < 2; ++f)
  {
    const scene_spec scene = { .dims = { 7, 7, 7 },
      .spacing = { 1, 1, 1 },
      .label_count = 8,
      .background = -1,
      .function = functions[f] };
    mlim_curves curves;
    const counts found = extract(&scene, &curves);
    CHECK_COUNT(found.inner_curves, 6);
    CHECK_COUNT(found.inner_junctions, 1);
    /* A cross on each face of the box, and four pieces of each box edge. */
    CHECK_COUNT(found.box_curves, 6 * 4 + 12 * 2);
    CHECK_COUNT(found.box_junctions, 6 + 12 + 8);
    for (size_t c = 0; c < curves.curve_count; ++c)
    {
      const int32_t set = curves.curve_sets[c];
      const size_t count = curves.sets.offsets[set + 1] - curves.sets.offsets[set];
      const size_t labels = scene_label_count(&curves.sets, set, 9);
      CHECK(labels == 4 ? count == 4 : labels + (count - labels) == 3);
    }
    mlim_curves_free(&curves);
  }
}

static double lattice(const double at[3], int label)
{
  const double x = at[0] - 4;
  const double y = at[1] - 4;
  return label == 0 ? x : label == 1 ? -x : label == 2 ? y : -y;
}

static void test_lattice_planes_meet_in_one_curve_of_four_labels(void)
{
  const scene_spec scene = { .dims = { 9, 9, 5 },
    .spacing = { 1, 1, 1 },
    .label_count = 4,
    .background = -1,
    .function = lattice };
  mlim_curves curves;
  const counts found = extract(&scene, &curves);
  CHECK_COUNT(found.inner_curves, 1);
  CHECK_COUNT(found.inner_junctions, 0);
  mlim_curves_free(&curves);
}

/* A wall askew to the grid, in floating point: at some grid points it ties but for rounding. */
static double rounded_wall(const double at[3], int label)
{
  const double x = at[0] - 6.3 - 0.12 * (at[2] - 5);
  const double y = at[1] - 7.4 - 0.2 * (at[2] - 5);
  const double angle = 0.1 * (label == 0 ? 1 : -1);
  return (label == 0 ? y : -y) * cos(angle) - x * sin(fabs(angle));
}

static void test_near_tie_at_a_grid_point_leaves_no_gap(void)
{
  const scene_spec scene = { .dims = { 6, 16, 11 },
    .spacing = { 1, 1, 1 },
    .label_count = 2,
    .background = -1,
    .function = rounded_wall };
  mlim_curves curves;
  CHECK_COUNT(extract(&scene, &curves).loose_ends, 0);
  mlim_curves_free(&curves);
}

/* Two spheres of radius 5 with centres 6 apart on x, in background 0. */
static double two_spheres(const double at[3], int label)
{
  const double x = at[0] - (label == 1 ? 7.3 : 13.3);
  return label == 0 ? 0 : 5 - sqrt(x * x + pow(at[1] - 9.1, 2) + pow(at[2] - 8.8, 2));
}

static void test_two_spheres_meet_in_a_circle(void)
{
  const scene_spec scene = { .dims = { 22, 19, 19 },
    .spacing = { 1, 1, 1 },
    .label_count = 3,
    .background = 0,
    .function = two_spheres };
  mlim_curves curves;
  const counts found = extract(&scene, &curves);
  CHECK_COUNT(found.inner_curves, 1);
  CHECK_COUNT(found.inner_loops, 1);
  CHECK_COUNT(found.box_curves, 0);
  CHECK_COUNT(curves.junction_count, 0);
  double worst = 0;
  for (size_t p = 0; p < curves.point_count; ++p)
  {
    const double* at = curves.points + 3 * p;
    worst = fmax(worst, fabs(at[0] - 10.3));
    worst = fmax(worst, fabs(hypot(at[1] - 9.1, at[2] - 8.8) - 4));
  }
  CHECK_BELOW(worst, 0.1);
  mlim_curves_free(&curves);
}

static double one_region(const double at[3], int label)
{
  (void)at;
  return label;
}

static void test_region_that_fills_the_box_has_its_edges(void)
{
  const scene_spec scene = { .dims = { 5, 4, 3 },
    .spacing = { 1, 2, 0.5 },
    .label_count = 2,
    .background = 0,
    .function = one_region };
  mlim_curves curves;
  const counts found = extract(&scene, &curves);
  CHECK_COUNT(found.inner_curves, 0);
  CHECK_COUNT(found.box_curves, 12);
  CHECK_COUNT(found.box_junctions, 8);
  mlim_curves_free(&curves);
}

static double background_only(const double at[3], int label)
{
  (void)at;
  return -label;
}

static void test_background_has_nothing(void)
{
  const scene_spec scene = { .dims = { 2, 2, 2 },
    .spacing = { 1, 1, 1 },
    .label_count = 2,
    .background = 0,
    .function = background_only };
  mlim_curves curves;
  extract(&scene, &curves);
  CHECK_COUNT(curves.curve_count, 0);
  CHECK_COUNT(curves.point_count, 0);
  mlim_curves_free(&curves);
}

static double two_halves(const double at[3], int label)
{
  return (label == 0 ? 1 : -1) * (at[0] - 2.3);
}

static void test_two_halves_have_a_crease_round_the_box(void)
{
  const scene_spec scene = { .dims = { 6, 6, 6 },
    .spacing = { 1, 1, 1 },
    .label_count = 2,
    .background = -1,
    .function = two_halves };
  mlim_curves curves;
  const counts found = extract(&scene, &curves);
  CHECK_COUNT(found.inner_curves, 0);
  CHECK_COUNT(found.box_curves, 8 + 8 + 4);
  CHECK_COUNT(found.box_junctions, 8 + 4);
  for (size_t p = 0; p < curves.point_count; ++p)
  {
    const double* at = curves.points + 3 * p;
    int on_faces = 0;
    for (int k = 0; k < 3; ++k)
    {
      on_faces += !(at[k] > 0) || !(at[k] < 5);
    }
    CHECK(on_faces > 0);
  }
  mlim_curves_free(&curves);
}

/* A sphere that reaches out of the box at x = 0. */
static double cut_sphere(const double at[3], int label)
{
  const double r = sqrt(pow(at[0] - 2.2, 2) + pow(at[1] - 7.1, 2) + pow(at[2] - 6.8, 2));
  return label == 0 ? 0 : 5 - r;
}

static void test_sphere_cut_by_the_box_has_a_circle_on_it(void)
{
  const scene_spec scene = { .dims = { 12, 15, 15 },
    .spacing = { 1, 1, 1 },
    .label_count = 2,
    .background = 0,
    .function = cut_sphere };
  mlim_curves curves;
  const counts found = extract(&scene, &curves);
  CHECK_COUNT(found.box_curves, 1);
  CHECK_COUNT(found.box_loops, 1);
  for (size_t p = 0; p < curves.point_count; ++p)
  {
    CHECK(!(curves.points[3 * p] > 0) && !(curves.points[3 * p] < 0));
  }
  mlim_curves_free(&curves);
}

static double foam(const double at[3], int label)
{
  const double x = at[0] - fmod(1.3 + 7.7 * label, 11);
  const double y = at[1] - fmod(2.9 + 4.9 * label, 11);
  const double z = at[2] - fmod(4.1 + 6.1 * label, 11);
  return -sqrt(x * x + y * y + z * z);
}

static void test_order_of_labels_does_not_matter(void)
{
  const int order[9] = { 4, 0, 8, 2, 6, 1, 7, 3, 5 };
  scene_spec scene = { .dims = { 12, 12, 12 },
    .spacing = { 1, 1, 1 },
    .label_count = 9,
    .background = -1,
    .function = foam };
  mlim_curves curves[2];
  extract(&scene, &curves[0]);
  scene.order = order;
  extract(&scene, &curves[1]);
  CHECK_COUNT(curves[1].curve_count, curves[0].curve_count);
  CHECK_COUNT(curves[1].junction_count, curves[0].junction_count);
  CHECK_COUNT(curves[1].point_count, curves[0].point_count);
  double worst = 0;
  for (size_t p = 0; p < curves[0].point_count; ++p)
  {
    double nearest = HUGE_VAL;
    for (size_t q = 0; q < curves[1].point_count; ++q)
    {
      const double* a = curves[0].points + 3 * p;
      const double* b = curves[1].points + 3 * q;
      nearest = fmin(nearest, fabs(a[0] - b[0]) + fabs(a[1] - b[1]) + fabs(a[2] - b[2]));
    }
    worst = fmax(worst, nearest);
  }
  /* The tie-breaking bonus moves points a little where indicators are nearly parallel. */
  CHECK_BELOW(worst, 1e-4);
  mlim_curves_free(&curves[0]);
  mlim_curves_free(&curves[1]);
}

/* Values on a coarse lattice with many exact ties; a linear congruence is enough of a mixture. */
static double plateaus(const double at[3], int label)
{
  const unsigned x = (unsigned)at[0] + 7u * (unsigned)at[1] + 49u * (unsigned)at[2];
  return (double)((x * 1103515245u + (unsigned)label * 12345u + (x ^ 40503u) * 69069u) >> 16 & 3u);
}

static void test_plateaus_end(void)
{
  const scene_spec scene = { .dims = { 7, 7, 7 },
    .spacing = { 1, 1, 1 },
    .label_count = 8,
    .background = 0,
    .function = plateaus };
  mlim_field* field = scene_field(&scene);
  const mlim_options options = mlim_options_default(field);
  mlim_curves curves[2];
  for (int run = 0; run < 2; ++run)
  {
    CHECK(mlim_curves_extract(field, &options, NULL, &curves[run]) == MLIM_OK);
  }
  CHECK_COUNT(curves[1].point_count, curves[0].point_count);
  CHECK(!memcmp(curves[0].points, curves[1].points, 3 * curves[0].point_count * sizeof(double)));
  mlim_curves_free(&curves[0]);
  mlim_curves_free(&curves[1]);
  mlim_field_free(field);
}

static int cancel(void* user, mlim_stage stage, double fraction)
{
  (void)user;
  (void)stage;
  return fraction > 0;
}

static void test_cancel_leaves_nothing(void)
{
  const scene_spec scene = { .dims = { 9, 9, 9 },
    .spacing = { 1, 1, 1 },
    .label_count = 4,
    .background = -1,
    .function = four_regions };
  mlim_field* field = scene_field(&scene);
  const mlim_options options = mlim_options_default(field);
  mlim_context context = { .progress = cancel };
  mlim_curves curves;
  CHECK(mlim_curves_extract(field, &options, &context, &curves) == MLIM_CANCELLED);
  CHECK(!curves.points && curves.curve_count == 0);
  mlim_field_free(field);
}

int main(void)
{
  test_three_half_spaces_meet_in_a_line();
  test_four_regions_meet_in_a_point();
  test_checkerboard_has_one_junction_and_six_curves();
  test_lattice_planes_meet_in_one_curve_of_four_labels();
  test_near_tie_at_a_grid_point_leaves_no_gap();
  test_two_spheres_meet_in_a_circle();
  test_region_that_fills_the_box_has_its_edges();
  test_background_has_nothing();
  test_two_halves_have_a_crease_round_the_box();
  test_sphere_cut_by_the_box_has_a_circle_on_it();
  test_order_of_labels_does_not_matter();
  test_plateaus_end();
  test_cancel_leaves_nothing();
  return check_result();
}
