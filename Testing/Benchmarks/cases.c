#include "cases.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum
{
  SCENE_POINTS = 81, /* along each axis */
  SPHERE_LABELS = 9, /* the background and eight spheres */
  GRAIN_LABELS = 31, /* the background and the grains */
  MAX_SCENE_LABELS = GRAIN_LABELS
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

/* Thrown at random into a ball, and kept if 10.5 from the others. */
static const double grain_seeds[GRAIN_LABELS - 1][3] = {
  { 28.4, 17.0, 50.0 },
  { 11.8, 42.4, 31.1 },
  { 60.9, 18.9, 45.4 },
  { 49.2, 31.6, 43.2 },
  { 51.9, 35.2, 27.7 },
  { 59.4, 53.1, 23.1 },
  { 44.9, 41.7, 64.8 },
  { 14.8, 34.6, 57.0 },
  { 51.1, 57.5, 44.8 },
  { 64.8, 27.7, 52.9 },
  { 46.2, 45.3, 37.1 },
  { 25.8, 32.5, 51.1 },
  { 15.5, 23.3, 32.8 },
  { 64.0, 25.4, 34.4 },
  { 52.6, 41.0, 47.8 },
  { 32.9, 33.3, 13.8 },
  { 23.6, 29.9, 31.0 },
  { 57.9, 42.2, 58.4 },
  { 28.8, 21.7, 60.6 },
  { 31.1, 21.6, 22.0 },
  { 56.5, 38.6, 18.8 },
  { 45.5, 66.7, 34.8 },
  { 67.6, 40.1, 42.1 },
  { 44.0, 23.4, 25.3 },
  { 17.2, 54.3, 50.6 },
  { 17.7, 35.5, 41.0 },
  { 48.2, 40.8, 11.2 },
  { 44.7, 53.2, 12.9 },
  { 29.4, 43.5, 68.2 },
  { 27.1, 57.1, 26.1 },
};

static double distance(const double a[3], const double b[3])
{
  const double d[3] = { a[0] - b[0], a[1] - b[1], a[2] - b[2] };
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* Grains fill a ball; each is what is nearest to its seed. */
static double grains(const double at[3], int label)
{
  const double middle[3] = { 40.1, 39.9, 40.2 };
  const double radius = 33;
  if (label > 0)
  {
    return -distance(at, grain_seeds[label - 1]);
  }
  double nearest = distance(at, grain_seeds[0]);
  for (int g = 1; g < GRAIN_LABELS - 1; ++g)
  {
    nearest = fmin(nearest, distance(at, grain_seeds[g]));
  }
  return distance(at, middle) - radius - nearest;
}

/* The facet sizes of the scenes give about 10,000, 50,000 and 200,000 vertices; those of the atlas
   as many as the paper had, 1.5 times finer and 3 times coarser. */
static const bench_case all_cases[] = {
  { "disjoint_balls", disjoint_balls, SPHERE_LABELS, 1.25 },
  { "disjoint_balls", disjoint_balls, SPHERE_LABELS, 0.56 },
  { "disjoint_balls", disjoint_balls, SPHERE_LABELS, 0.28 },
  { "overlapping_spheres", overlapping_spheres, SPHERE_LABELS, 1.6 },
  { "overlapping_spheres", overlapping_spheres, SPHERE_LABELS, 0.7 },
  { "overlapping_spheres", overlapping_spheres, SPHERE_LABELS, 0.35 },
  { "grains", grains, GRAIN_LABELS, 0.7 },
  { "brain_atlas_mni_prob", NULL, 0, 3 * 7.0 },
  { "brain_atlas_mni_prob", NULL, 0, 7.0 },
  { "brain_atlas_mni_prob", NULL, 0, 7.0 / 1.5 },
  { "spheres8_indicators", NULL, 0, 0 },
  { "cleaver_spheres_indicators", NULL, 0, 0 },
  { "soft_brain_ants19_prob", NULL, 0, 0 },
  { "torso_ct_indicators", NULL, 0, 0 },
  { "polycrystal_damask20_indicators", NULL, 0, 0 },
  { "thalamus_prob", NULL, 0, 0 },
  { "fluids3_synthetic_prob", NULL, 0, 0 },
};

const bench_case* bench_cases(size_t* count)
{
  *count = sizeof all_cases / sizeof all_cases[0];
  return all_cases;
}

const bench_case* bench_case_find(const char* name)
{
  size_t count;
  const bench_case* cases = bench_cases(&count);
  for (size_t c = 0; c < count; ++c)
  {
    if (strcmp(cases[c].name, name) == 0)
    {
      return cases + c;
    }
  }
  return NULL;
}

typedef struct scene_image
{
  mlim_array arrays[MAX_SCENE_LABELS];
  float values[MAX_SCENE_LABELS][SCENE_POINTS * SCENE_POINTS * SCENE_POINTS];
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

static int make_scene(const bench_case* one, char message[BENCH_MESSAGE_SIZE], bench_image* out)
{
  scene_image* image = malloc(sizeof *image);
  if (image == NULL)
  {
    snprintf(message, BENCH_MESSAGE_SIZE, "There is not enough memory for the scene.");
    return 1;
  }
  for (int label = 0; label < one->label_count; ++label)
  {
    sample(one->scene, label, image->values[label]);
    image->arrays[label] = (mlim_array){
      .values = image->values[label], .type = MLIM_FLOAT32, .stride = 1, .id = label
    };
  }
  out->grid = (mlim_grid){ .dims = { SCENE_POINTS, SCENE_POINTS, SCENE_POINTS },
    .spacing = { 1, 1, 1 },
    .array_count = (size_t)one->label_count,
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
    return make_scene(one, message, out);
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
