/* Pinches of noise become contacts, and the strays told afterwards are those that are there then. */
#include "boundary.h"
#include "check.h"
#include "pinch.h"
#include "random_field.h"
#include "refine.h"
#include "seeds.h"
#include "shapes.h"
#include "tidy.h"

#include <stdlib.h>

static const double SPACING[3] = { 1, 1, 1 };
static uint64_t noise_seed;

/* The same value for the same place and label. */
static double noise(const double at[3], int label)
{
  uint64_t state = noise_seed + (uint64_t)label * 1000003u + (uint64_t)at[0] * 8191u +
                   (uint64_t)at[1] * 131071u + (uint64_t)at[2] * 524287u;
  random_unit(&state);
  random_unit(&state);
  return random_unit(&state);
}

/* All facets, each from the cell of the lower id. */
static size_t count_strays(const mlim_complex* complex)
{
  size_t count = 0;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    for (int k = 0; k < 4 && cell->vertices[0] >= 0; ++k)
    {
      count += (int32_t)c < cell->neighbors[k] && mlim_tidy_is_stray(complex, (int32_t)c, k);
    }
  }
  return count;
}

static void refine(mlim_refinement* r, const mlim_components* components, const run* ran)
{
  size_t count;
  mlim_complex* complex = &r->complex;
  CHECK(mlim_seeds_on_components(complex, components, NULL, 1, NULL, &count) == MLIM_OK);
  CHECK(mlim_seeds_on_sheets(complex, 2 * ran->options.facet_size, 0, NULL, &count) == MLIM_OK);
  CHECK(mlim_refine_run(r, MLIM_GOAL_TOPOLOGY, NULL) == MLIM_OK);
}

/* How many strays pinches take away. */
static size_t settle(mlim_refinement* r, size_t* pinch_count)
{
  mlim_complex* complex = &r->complex;
  mlim_boundary boundary = { 0 };
  mlim_tidied tidied = { 0 };
  mlim_balls balls;
  CHECK(mlim_boundary_find(complex, 0, NULL, &boundary) == MLIM_OK);
  CHECK(mlim_tidy_run(r, &boundary, 0, NULL, &tidied) == MLIM_OK);
  const size_t before = tidied.stray_count;
  CHECK_COUNT(before, count_strays(complex));
  CHECK(mlim_pinch_run(r, 0, NULL, &balls, pinch_count, &tidied.stray_count) == MLIM_OK);
  if (*pinch_count > 0)
  {
    const mlim_balls* old = complex->balls;
    complex->balls = &balls;
    CHECK_COUNT(tidied.stray_count, count_strays(complex));
    complex->balls = old;
    mlim_balls_free(&balls);
  }
  mlim_boundary_free(&boundary);
  return before - tidied.stray_count;
}

int main(void)
{
  size_t pinches = 0;
  size_t gone = 0;
  for (noise_seed = 1; noise_seed <= 6; ++noise_seed)
  {
    image* im = image_sample((const int32_t[3]){ 7, 7, 7 }, SPACING, 3, 0, noise);
    const mlim_options options = run_options(0);
    run ran;
    CHECK(run_cover(&im->grid, &options, NULL, &ran) == MLIM_OK);
    const mlim_oracle oracle = { .field = ran.field,
      .tolerance = ran.options.crossing_tolerance,
      .mode = ran.options.oracle_mode };
    mlim_components components;
    mlim_refinement refinement = { 0 };
    size_t hidden;
    unsigned char* is_hidden = calloc(ran.balls.ball_count + 1, 1);
    CHECK(mlim_components_find(ran.field, NULL, &components) == MLIM_OK);
    CHECK(mlim_refine_start(&refinement, &oracle, &ran.balls, &ran.options, 0, NULL, is_hidden,
            &hidden) == MLIM_OK);
    if (hidden == 0)
    {
      size_t count = 0;
      refine(&refinement, &components, &ran);
      gone += settle(&refinement, &count);
      pinches += count;
    }
    free(is_hidden);
    mlim_refine_free(&refinement);
    mlim_components_free(&components);
    run_free(&ran);
    image_free(im);
  }
  CHECK(pinches > 0 && gone > 0);
  return check_result();
}
