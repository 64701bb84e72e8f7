#include "skin.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

/* No more blocks than this along an axis: they are there to save time, not to be fine. */
static const double MAX_BLOCKS = 128;

mlim_status mlim_skin_blocks_create(
  const double size[3], double distance, mlim_context* context, mlim_skin_blocks* out)
{
  const double largest = mlim_max(size[0], mlim_max(size[1], size[2]));
  *out = (mlim_skin_blocks){ .distance = distance,
    .side = mlim_max(4 * distance, largest / MAX_BLOCKS) };
  size_t count = 1;
  for (int k = 0; k < 3; ++k)
  {
    out->counts[k] = (int32_t)(size[k] / out->side) + 1;
    count *= (size_t)out->counts[k];
  }
  out->is_near = mlim_allocate_zeroed(count, 1);
  return out->is_near != NULL ? MLIM_OK
                              : mlim_fail_memory(context, "the crossings far from the mesh");
}

void mlim_skin_blocks_free(mlim_skin_blocks* blocks)
{
  mlim_release(blocks->is_near);
  *blocks = (mlim_skin_blocks){ 0 };
}

typedef struct block_range
{
  int32_t low[3];
  int32_t high[3];
} block_range;

static int32_t block_of(const mlim_skin_blocks* blocks, double value, int axis)
{
  const double b = value / blocks->side;
  return b < 0 ? 0 : b >= blocks->counts[axis] ? blocks->counts[axis] - 1 : (int32_t)b;
}

static unsigned char* block_at(const mlim_skin_blocks* blocks, int32_t x, int32_t y, int32_t z)
{
  return &blocks->is_near[(size_t)x + (size_t)blocks->counts[0] *
                                        ((size_t)y + (size_t)blocks->counts[1] * (size_t)z)];
}

void mlim_skin_blocks_add(mlim_skin_blocks* blocks, const double point[3])
{
  block_range r;
  for (int k = 0; k < 3; ++k)
  {
    r.low[k] = block_of(blocks, point[k] - blocks->distance, k);
    r.high[k] = block_of(blocks, point[k] + blocks->distance, k);
  }
  for (int32_t z = r.low[2]; z <= r.high[2]; ++z)
  {
    for (int32_t y = r.low[1]; y <= r.high[1]; ++y)
    {
      for (int32_t x = r.low[0]; x <= r.high[0]; ++x)
      {
        *block_at(blocks, x, y, z) = 1;
      }
    }
  }
}

/* Whether the box round a triangle touches a block that is near. */
static int reaches(
  const mlim_skin_blocks* blocks, const mlim_complex* complex, const int32_t vertices[3])
{
  block_range r;
  for (int k = 0; k < 3; ++k)
  {
    const double a = complex->vertices[vertices[0]].point[k];
    const double b = complex->vertices[vertices[1]].point[k];
    const double c = complex->vertices[vertices[2]].point[k];
    r.low[k] = block_of(blocks, mlim_min(a, mlim_min(b, c)), k);
    r.high[k] = block_of(blocks, mlim_max(a, mlim_max(b, c)), k);
  }
  for (int32_t z = r.low[2]; z <= r.high[2]; ++z)
  {
    for (int32_t y = r.low[1]; y <= r.high[1]; ++y)
    {
      for (int32_t x = r.low[0]; x <= r.high[0]; ++x)
      {
        if (*block_at(blocks, x, y, z))
        {
          return 1;
        }
      }
    }
  }
  return 0;
}

/* Every facet between two labels has a record. */
static int is_boundary(const mlim_complex* complex, const mlim_facet* facet)
{
  if (!facet->is_alive)
  {
    return 0;
  }
  const mlim_cell* cell = &complex->cells[facet->cell];
  return cell->label != complex->cells[cell->neighbors[facet->index]].label;
}

mlim_status mlim_skin_read(const mlim_complex* complex, const mlim_skin_blocks* blocks,
  mlim_context* context, mlim_mesh* out)
{
  *out = (mlim_mesh){ .vertex_count = complex->vertex_count };
  out->vertices = mlim_allocate(3 * complex->vertex_count, sizeof *out->vertices);
  out->triangles = mlim_allocate(3 * complex->facet_count, sizeof *out->triangles);
  if (out->vertices == NULL || out->triangles == NULL)
  {
    mlim_mesh_free(out);
    return mlim_fail_memory(context, "the triangles near the grid's crossings");
  }
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    mlim_copy(complex->vertices[v].point, out->vertices + 3 * v);
  }
  for (size_t f = 1; f < complex->facet_count; ++f)
  {
    const mlim_facet* facet = &complex->facets[f];
    int32_t* triangle = out->triangles + 3 * out->triangle_count;
    if (is_boundary(complex, facet))
    {
      mlim_complex_facet_vertices(complex, facet->cell, facet->index, triangle);
      out->triangle_count += blocks->is_near == NULL || reaches(blocks, complex, triangle);
    }
  }
  return MLIM_OK;
}
