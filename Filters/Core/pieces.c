#include "pieces.h"

#include "memory.h"
#include "vector.h"

#include <string.h>

void mlim_pieces_free(mlim_pieces* pieces)
{
  mlim_point_grid_free(&pieces->grid);
  mlim_release(pieces->curves);
  *pieces = (mlim_pieces){ 0 };
}

mlim_status mlim_pieces_create(const mlim_piece_source* source, mlim_pieces* out)
{
  const size_t samples = source->offsets[source->curve_count];
  *out = (mlim_pieces){ .points = source->points,
    .curves = mlim_allocate(samples, sizeof *out->curves),
    .step = source->step,
    .reach = source->reach };
  if (out->curves == NULL || mlim_point_grid_create(0.5 * source->reach, samples, &out->grid))
  {
    mlim_pieces_free(out);
    return MLIM_OUT_OF_MEMORY;
  }
  for (size_t c = 0; c < source->curve_count; ++c)
  {
    for (size_t s = source->offsets[c]; s + 1 < source->offsets[c + 1]; ++s)
    {
      out->curves[s] = (int32_t)c;
      mlim_point_grid_add(&out->grid, source->points + 3 * s, (int32_t)s);
    }
  }
  return MLIM_OK;
}

int mlim_pieces_list(const mlim_pieces* pieces, const double point[3], mlim_piece_list* list)
{
  mlim_point_range range;
  mlim_point_grid_range(&pieces->grid, point, pieces->reach, &range);
  if (list->is_listed && memcmp(&range, &list->range, sizeof range) == 0)
  {
    return list->count <= MLIM_MAX_NEAR_PIECES;
  }
  mlim_point_walk walk;
  int32_t s = mlim_point_grid_first(&pieces->grid, point, pieces->reach, &walk);
  size_t count = 0;
  for (; s >= 0 && count < MLIM_MAX_NEAR_PIECES; ++count)
  {
    list->pieces[count] = s;
    mlim_copy(pieces->points + 3 * (size_t)s, list->starts[count]);
    s = mlim_point_grid_next(&pieces->grid, &walk);
  }
  list->is_listed = 1;
  list->range = range;
  list->count = count + (s >= 0);
  return list->count <= MLIM_MAX_NEAR_PIECES;
}
