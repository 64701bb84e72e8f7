/* Segments that are told to be clear meet uniform cells of one label alone. */
#include "check.h"
#include "clear.h"
#include "random_field.h"
#include "scenes.h"
#include "vector.h"

#include <math.h>

static const double SPACING[3] = { 0.5, 0.75, 1 };
static const double SIZE[3] = { 16, 18, 20 }; /* of the box */

/* Regions some cells across, bounded by bent sheets. */
static double wave(const double at[3], int label)
{
  return cos(0.9 * at[0] + label) + cos(0.7 * at[1] - 2 * label) + cos(0.6 * at[2] + 3 * label);
}

static void random_place(uint64_t* seed, double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] = SIZE[k] * (1.4 * random_unit(seed) - 0.2);
  }
}

/* As cells keep it. */
static uint16_t narrow(float clearance)
{
  return (uint16_t)mlim_min((double)clearance * MLIM_CLEARANCE_PARTS, UINT16_MAX);
}

/* Whether all cells that it meets are uniform with this label: in mixed ones there is no clearance. */
static int is_uniform(const mlim_field* field, const double a[3], const double b[3], int32_t label)
{
  enum
  {
    SAMPLES = 64
  };
  int is_one = 1;
  for (int s = 0; s <= SAMPLES; ++s)
  {
    const double t = (double)s / SAMPLES;
    const double at[3] = { a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]),
      a[2] + t * (b[2] - a[2]) };
    mlim_field_look look = { .point = at };
    mlim_field_look_at(field, &look, 1);
    is_one &= look.label == label && look.clearance > 0;
  }
  return is_one;
}

/* Whether cubes of the clearances' size do it already. */
static int are_cubes_enough(const double a[3], const double b[3], const uint16_t clearances[2])
{
  double longest = 0;
  for (int k = 0; k < 3; ++k)
  {
    longest = mlim_max(longest, fabs(a[k] - b[k]) / SPACING[k]);
  }
  return longest * MLIM_CLEARANCE_PARTS <= clearances[0] + clearances[1];
}

int main(void)
{
  enum
  {
    COUNT = 200000,
    LEAST = COUNT / 1000 /* segments to be found clear that cubes do not cover */
  };
  const scene_spec scene = { .dims = { 33, 25, 21 },
    .spacing = { 0.5, 0.75, 1 },
    .label_count = 3,
    .background = -1,
    .function = wave };
  mlim_field* field = scene_field(&scene);
  uint64_t seed = 7;
  int found = 0;
  for (int n = 0; n < COUNT; ++n)
  {
    double ends[2][3];
    mlim_field_look looks[2] = { { .point = ends[0] }, { .point = ends[1] } };
    random_place(&seed, ends[0]);
    random_place(&seed, ends[1]);
    const double part = random_unit(&seed);
    for (int k = 0; k < 3; ++k)
    {
      ends[1][k] = ends[0][k] + part * part * (ends[1][k] - ends[0][k]);
    }
    mlim_field_look_at(field, looks, 2);
    const uint16_t clearances[2] = { narrow(looks[0].clearance), narrow(looks[1].clearance) };
    if (looks[0].label == looks[1].label &&
        mlim_clear_between(field, (const double* const[2]){ ends[0], ends[1] }, clearances))
    {
      CHECK(is_uniform(field, ends[0], ends[1], looks[0].label));
      found += !are_cubes_enough(ends[0], ends[1], clearances);
    }
  }
  CHECK(found >= LEAST);
  mlim_field_free(field);
  return check_result();
}
