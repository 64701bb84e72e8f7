#include "cases.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum
{
  SCENE_POINTS = 81, /* along each axis */
  SCENE_LABELS = 9   /* the background and eight spheres */
};

/* A sphere at each corner of a cube, none of them at a point of symmetry of the grid. */
static double eight_spheres(const double at[3], int label, double distance, double radius)
{
  if (label == 0)
  {
    return 0;
  }
  const double middle = 0.5 * (SCENE_POINTS - 1);
  double squared = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double side = (label - 1) >> k & 1 ? 0.5 : -0.5;
    const double off = 0.13 * sin(3 * label + k);
    const double d = at[k] - (middle + side * distance + off);
    squared += d * d;
  }
  return radius - sqrt(squared);
}

static double disjoint_balls(const double at[3], int label)
{
  return eight_spheres(at, label, 40, 15);
}

static double overlapping_spheres(const double at[3], int label)
{
  return eight_spheres(at, label, 31, 21);
}

/* The facet sizes of the scenes give about 10,000, 50,000 and 200,000 vertices; those of the atlas
   as many as the paper had, 1.5 times finer and 3 times coarser. */
static const bench_case all_cases[] = {
  { "disjoint_balls", disjoint_balls, 1.25 },
  { "disjoint_balls", disjoint_balls, 0.56 },
  { "disjoint_balls", disjoint_balls, 0.28 },
  { "overlapping_spheres", overlapping_spheres, 1.6 },
  { "overlapping_spheres", overlapping_spheres, 0.7 },
  { "overlapping_spheres", overlapping_spheres, 0.35 },
  { "brain_atlas_mni_prob", NULL, 3 * 7.0 },
  { "brain_atlas_mni_prob", NULL, 7.0 },
  { "brain_atlas_mni_prob", NULL, 7.0 / 1.5 },
  { "spheres8_indicators", NULL, 0 },
  { "cleaver_spheres_indicators", NULL, 0 },
  { "soft_brain_ants19_prob", NULL, 0 },
  { "torso_ct_indicators", NULL, 0 },
  { "polycrystal_damask20_indicators", NULL, 0 },
  { "thalamus_prob", NULL, 0 },
  { "fluids3_synthetic_prob", NULL, 0 },
};

const bench_case* bench_cases(size_t* count)
{
  *count = sizeof all_cases / sizeof all_cases[0];
  return all_cases;
}

typedef struct scene_image
{
  mlim_array arrays[SCENE_LABELS];
  float values[SCENE_LABELS][SCENE_POINTS * SCENE_POINTS * SCENE_POINTS];
} scene_image;

static void sample(bench_scene scene, int label, float* values)
{
  for (int k = 0; k < SCENE_POINTS; ++k)
  {
    for (int j = 0; j < SCENE_POINTS; ++j)
    {
      for (int i = 0; i < SCENE_POINTS; ++i)
      {
        const double at[3] = { i, j, k };
        *values++ = (float)scene(at, label);
      }
    }
  }
}

static int make_scene(bench_scene scene, char message[BENCH_MESSAGE_SIZE], bench_image* out)
{
  scene_image* image = malloc(sizeof *image);
  if (image == NULL)
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "There is not enough memory for the scene.");
    return 1;
  }
  for (int label = 0; label < SCENE_LABELS; ++label)
  {
    sample(scene, label, image->values[label]);
    image->arrays[label] = (mlim_array){
      .values = image->values[label], .type = MLIM_FLOAT32, .stride = 1, .id = label
    };
  }
  out->grid = (mlim_grid){ .dims = { SCENE_POINTS, SCENE_POINTS, SCENE_POINTS },
    .spacing = { 1, 1, 1 },
    .array_count = SCENE_LABELS,
    .arrays = image->arrays,
    .background = MLIM_BACKGROUND_ARRAY };
  out->owner = image;
  out->release = free;
  return 0;
}

int bench_case_load(
  const bench_case* one, const char* folder, char message[BENCH_MESSAGE_SIZE], bench_image* out)
{
  *out = (bench_image){ 0 };
  if (one->scene != NULL)
  {
    return make_scene(one->scene, message, out);
  }
  char path[4096];
  const int length = snprintf(path, sizeof path, "%s/%s.vti", folder, one->name);
  if (length < 0 || (size_t)length >= sizeof path)
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "The path of %s.vti is too long.", one->name);
    return 1;
  }
  return bench_image_read(path, message, out);
}
