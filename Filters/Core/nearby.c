#include "nearby.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <string.h>

enum
{
  MIN_BLOCKS = 4096,
  BLOCKS_A_VERTEX = 2
};

void mlim_nearby_free(mlim_nearby* nearby)
{
  mlim_release(nearby->vertices);
  *nearby = (mlim_nearby){ 0 };
}

/* Sets the counts for a side; their product is at most `most`, which is above 0. */
static size_t count_blocks(const double size[3], double side, size_t most, mlim_nearby* out)
{
  const double fair = cbrt(size[0] * size[1] * size[2] / (double)most);
  double total = 1;
  for (int k = 0; k < 3; ++k)
  {
    const double left = (double)most / total; /* for a box that is thin along an axis */
    const double blocks = floor(size[k] / mlim_max(side, fair));
    const double count = mlim_max(1, mlim_min(blocks, left));
    out->counts[k] = (int32_t)count;
    out->inverse_side[k] = count / size[k];
    total *= count;
  }
  return (size_t)total;
}

mlim_status mlim_nearby_create(
  const mlim_complex* complex, double side, mlim_context* context, mlim_nearby* out)
{
  *out = (mlim_nearby){ 0 };
  const size_t vertices = complex->vertex_count;
  const size_t most = BLOCKS_A_VERTEX * vertices + MIN_BLOCKS;
  const size_t count =
    count_blocks(mlim_field_grid_of(complex->oracle.field)->size, side, most, out);
  out->vertices = mlim_allocate(count, sizeof *out->vertices);
  if (out->vertices == NULL)
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  memset(out->vertices, -1, count * sizeof *out->vertices);
  for (size_t v = MLIM_FAR_VERTICES; v < vertices; ++v)
  {
    *mlim_nearby_at(out, complex->vertices[v].point) = (int32_t)v;
  }
  return MLIM_OK;
}

int32_t* mlim_nearby_at(const mlim_nearby* nearby, const double point[3])
{
  size_t place = 0;
  for (int k = 2; k >= 0; --k)
  {
    const double at = point[k] * nearby->inverse_side[k];
    const int32_t last = nearby->counts[k] - 1;
    const int32_t block = at > 0 ? (at < (double)last ? (int32_t)at : last) : 0;
    place = place * (size_t)nearby->counts[k] + (size_t)block;
  }
  return &nearby->vertices[place];
}
