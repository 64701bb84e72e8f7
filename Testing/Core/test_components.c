/* Components against a flood fill. */
#include "check.h"
#include "components.h"
#include "random_field.h"

#include <string.h>

static random_field f;

static size_t index_of(const int32_t p[3])
{
  return (size_t)p[0] + (size_t)f.dims[0] * ((size_t)p[1] + (size_t)f.dims[1] * (size_t)p[2]);
}

static int is_inside(const int32_t p[3])
{
  return p[0] >= 0 && p[1] >= 0 && p[2] >= 0 && p[0] < f.dims[0] && p[1] < f.dims[1] &&
         p[2] < f.dims[2];
}

/* Gives all that hangs together with a point its number. */
static size_t flood(const mlim_field* field, const int32_t start[3], int32_t number, int32_t* found)
{
  static int32_t stack[RANDOM_MAX_POINTS][3];
  size_t depth = 1;
  size_t size = 0;
  const int32_t label = mlim_field_point_label(field, start);
  memcpy(stack[0], start, sizeof stack[0]);
  found[index_of(start)] = number;
  while (depth > 0)
  {
    int32_t p[3];
    memcpy(p, stack[--depth], sizeof p);
    ++size;
    for (int k = 0; k < 27; ++k)
    {
      const int32_t q[3] = { p[0] + k % 3 - 1, p[1] + k / 3 % 3 - 1, p[2] + k / 9 - 1 };
      if (is_inside(q) && found[index_of(q)] < 0 && mlim_field_point_label(field, q) == label)
      {
        found[index_of(q)] = number;
        memcpy(stack[depth++], q, sizeof q);
      }
    }
  }
  return size;
}

/* Every extreme is a point of the component, and no point lies beyond it. */
static void check_extremes(const mlim_components* components, const int32_t* found)
{
  size_t bad = 0;
  for (size_t c = 0; c < components->count; ++c)
  {
    for (int side = 0; side < 6; ++side)
    {
      const int32_t* e = components->components[c].extremes[side];
      bad += !is_inside(e) || found[index_of(e)] != (int32_t)c;
    }
  }
  int32_t p[3];
  for (p[2] = 0; p[2] < f.dims[2]; ++p[2])
  {
    for (p[1] = 0; p[1] < f.dims[1]; ++p[1])
    {
      for (p[0] = 0; p[0] < f.dims[0]; ++p[0])
      {
        const mlim_component* c = &components->components[found[index_of(p)]];
        for (int axis = 0; axis < 3; ++axis)
        {
          bad += p[axis] < c->extremes[2 * axis][axis] || p[axis] > c->extremes[2 * axis + 1][axis];
        }
      }
    }
  }
  CHECK_COUNT(bad, 0);
}

static void test_field(const mlim_field* field)
{
  static int32_t found[RANDOM_MAX_POINTS];
  static size_t sizes[RANDOM_MAX_POINTS];
  memset(found, -1, sizeof found);
  int32_t count = 0;
  int32_t p[3];
  for (p[2] = 0; p[2] < f.dims[2]; ++p[2])
  {
    for (p[1] = 0; p[1] < f.dims[1]; ++p[1])
    {
      for (p[0] = 0; p[0] < f.dims[0]; ++p[0])
      {
        if (found[index_of(p)] < 0)
        {
          sizes[count] = flood(field, p, count, found);
          ++count;
        }
      }
    }
  }
  /* Both number components by their first points, so the numbers are the same. */
  mlim_components components;
  CHECK(mlim_components_find(field, NULL, &components) == MLIM_OK);
  CHECK_COUNT(components.count, (size_t)count);
  size_t bad = 0;
  for (p[2] = 0; p[2] < f.dims[2]; ++p[2])
  {
    for (p[1] = 0; p[1] < f.dims[1]; ++p[1])
    {
      for (p[0] = 0; p[0] < f.dims[0]; ++p[0])
      {
        bad += mlim_components_at(&components, field, p) != found[index_of(p)];
      }
    }
  }
  for (size_t c = 0; c < components.count && c < (size_t)count; ++c)
  {
    bad += components.components[c].voxel_count != sizes[c];
    bad += components.components[c].label !=
           mlim_field_point_label(field, components.components[c].extremes[0]);
  }
  CHECK_COUNT(bad, 0);
  if (components.count == (size_t)count)
  {
    check_extremes(&components, found);
  }
  mlim_components_free(&components);
}

int main(void)
{
  /* Many labels make many small components, two make a few tangled ones. */
  for (int32_t labels = 2; labels <= RANDOM_MAX_LABELS; ++labels)
  {
    for (int32_t side = 2; side <= 8; side += 2)
    {
      random_field_make(&f, labels, side, side % 4, (uint64_t)(100 * labels + side));
      mlim_field* field = NULL;
      CHECK(mlim_field_create(&f.grid, NULL, &field) == MLIM_OK);
      test_field(field);
      mlim_field_free(field);
    }
  }
  return check_result();
}
