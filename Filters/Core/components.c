#include "components.h"

#include "memory.h"
#include "status.h"

#include <limits.h>

static int32_t root_of(int32_t* parent, int32_t p)
{
  while (parent[p] != p)
  {
    parent[p] = parent[parent[p]];
    p = parent[p];
  }
  return p;
}

static void join(int32_t* parent, int32_t a, int32_t b)
{
  a = root_of(parent, a);
  b = root_of(parent, b);
  parent[a < b ? b : a] = a < b ? a : b;
}

/* Provisional components, joined through the 13 earlier neighbours of each point. A point whose
   left neighbour has its label needs to look only at those that the left one does not touch. */
static int32_t scan(const mlim_field* field, int32_t* of_point, int32_t* parent)
{
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  const int64_t nx = dims[0];
  const int64_t ny = dims[1];
  const uint16_t* labels = mlim_field_point_labels(field);
  int32_t made = 0;
  int64_t at = 0;
  for (int32_t z = 0; z < dims[2]; ++z)
  {
    for (int32_t y = 0; y < dims[1]; ++y)
    {
      int32_t before = -1;
      for (int32_t x = 0; x < dims[0]; ++x, ++at)
      {
        const int32_t label = labels[at];
        const int is_run = x > 0 && label == before;
        int32_t mine = is_run ? of_point[at - 1] : -1;
        before = label;
        const int32_t rows[4][2] = { { -1, -1 }, { 0, -1 }, { 1, -1 }, { -1, 0 } };
        for (int r = 0; r < 4; ++r)
        {
          const int32_t oy = y + rows[r][0];
          const int32_t oz = z + rows[r][1];
          if (oy < 0 || oy >= dims[1] || oz < 0)
          {
            continue;
          }
          for (int32_t ox = is_run ? x + 1 : x > 0 ? x - 1 : x; ox <= x + 1 && ox < dims[0]; ++ox)
          {
            if (labels[ox + nx * (oy + ny * (int64_t)oz)] != label)
            {
              continue;
            }
            const int32_t other = of_point[ox + nx * (oy + ny * (int64_t)oz)];
            if (mine < 0)
            {
              mine = other;
            }
            else if (mine != other)
            {
              join(parent, mine, other);
            }
          }
        }
        if (mine < 0)
        {
          mine = made++;
          parent[mine] = mine;
        }
        of_point[at] = mine;
      }
    }
  }
  return made;
}

static void measure(const mlim_field* field, mlim_components* out)
{
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  int64_t at = 0;
  for (int32_t z = 0; z < dims[2]; ++z)
  {
    for (int32_t y = 0; y < dims[1]; ++y)
    {
      for (int32_t x = 0; x < dims[0]; ++x, ++at)
      {
        const int32_t point[3] = { x, y, z };
        mlim_component* c = &out->components[out->of_point[at]];
        const int is_first = c->voxel_count == 0;
        ++c->voxel_count;
        if (is_first)
        {
          c->label = mlim_field_point_label(field, point);
        }
        for (int side = 0; side < 6; ++side)
        {
          const int32_t here = point[side >> 1];
          const int32_t there = c->extremes[side][side >> 1];
          if (is_first || (side & 1 ? here > there : here < there))
          {
            for (int k = 0; k < 3; ++k)
            {
              c->extremes[side][k] = point[k];
            }
          }
        }
      }
    }
  }
}

mlim_status mlim_components_find(
  const mlim_field* field, mlim_context* context, mlim_components* out)
{
  *out = (mlim_components){ 0 };
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  const size_t points = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
  if (points > INT32_MAX)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The image has %zu points; components can be told apart in at most %d.", points, INT_MAX);
  }
  mlim_status status = MLIM_OK;
  int32_t* parent = mlim_allocate(points, sizeof *parent);
  out->of_point = mlim_allocate(points, sizeof *out->of_point);
  if (parent == NULL || out->of_point == NULL)
  {
    status = mlim_fail_memory(context, "the components of the labels");
    goto done;
  }
  const int32_t made = scan(field, out->of_point, parent);
  status = mlim_progress(context, MLIM_STAGE_SURFACE, 0);
  if (status != MLIM_OK)
  {
    goto done;
  }
  int32_t count = 0;
  /* A root is the lowest of its tree, so it has its number, stored as -1 - number, before any other
     member asks for it. */
  for (int32_t p = 0; p < made; ++p)
  {
    int32_t root = p;
    while (parent[root] >= 0 && parent[root] != root)
    {
      root = parent[root];
    }
    parent[p] = parent[root] < 0 ? parent[root] : -1 - count++;
  }
  for (size_t i = 0; i < points; ++i)
  {
    out->of_point[i] = -1 - parent[out->of_point[i]];
  }
  out->count = (size_t)count;
  out->components = mlim_allocate_zeroed(out->count, sizeof *out->components);
  if (out->components == NULL)
  {
    status = mlim_fail_memory(context, "the components of the labels");
    goto done;
  }
  measure(field, out);
done:
  mlim_release(parent);
  if (status != MLIM_OK)
  {
    mlim_components_free(out);
  }
  return status;
}

void mlim_components_free(mlim_components* components)
{
  mlim_release(components->components);
  mlim_release(components->of_point);
  *components = (mlim_components){ 0 };
}
