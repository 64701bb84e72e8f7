#include "pieces.h"

#include "memory.h"
#include "vector.h"

#include <math.h>
#include <string.h>

/* Cubes of the first level, of the mean length of pieces: a curve through one has about so many. */
static const double FINEST = 8;

void mlim_pieces_free(mlim_pieces* pieces)
{
  for (size_t l = 0; l < pieces->level_count; ++l)
  {
    mlim_point_grid_free(&pieces->levels[l].grid);
  }
  mlim_release(pieces->curves);
  *pieces = (mlim_pieces){ 0 };
}

static double mean_length(const mlim_piece_source* source)
{
  double sum = 0;
  size_t count = 0;
  for (size_t c = 0; c < source->curve_count; ++c)
  {
    for (size_t s = source->offsets[c]; s + 1 < source->offsets[c + 1]; ++s)
    {
      sum += mlim_distance(source->points + 3 * s, source->points + 3 * (s + 1));
      ++count;
    }
  }
  return count > 0 ? sum / (double)count : source->reach;
}

/* The last level reaches as far as the source says, from cubes half as large. */
static mlim_status create_levels(const mlim_piece_source* source, mlim_pieces* out)
{
  const double finest = FINEST * mean_length(source);
  size_t count = 1;
  while (count < MLIM_MAX_PIECE_LEVELS && ldexp(0.5 * source->reach, -(int)count) >= finest)
  {
    ++count;
  }
  mlim_status status = MLIM_OK;
  for (; out->level_count < count && status == MLIM_OK; ++out->level_count)
  {
    mlim_piece_level* level = &out->levels[out->level_count];
    level->reach = ldexp(source->reach, -(int)(count - 1 - out->level_count));
    status = mlim_point_grid_create(
      0.5 * level->reach, source->offsets[source->curve_count], &level->grid);
  }
  return status;
}

mlim_status mlim_pieces_create(const mlim_piece_source* source, mlim_pieces* out)
{
  const size_t samples = source->offsets[source->curve_count];
  *out = (mlim_pieces){ .points = source->points,
    .curves = mlim_allocate(samples, sizeof *out->curves),
    .step = source->step };
  if (out->curves == NULL || create_levels(source, out) != MLIM_OK)
  {
    mlim_pieces_free(out);
    return MLIM_OUT_OF_MEMORY;
  }
  for (size_t c = 0; c < source->curve_count; ++c)
  {
    for (size_t s = source->offsets[c]; s + 1 < source->offsets[c + 1]; ++s)
    {
      out->curves[s] = (int32_t)c;
      for (size_t l = 0; l < out->level_count; ++l)
      {
        mlim_point_grid_add(&out->levels[l].grid, source->points + 3 * s, (int32_t)s);
      }
    }
  }
  return MLIM_OK;
}

int mlim_pieces_list(const mlim_pieces* pieces, const double point[3], mlim_piece_list* list)
{
  const mlim_piece_level* first = &pieces->levels[0];
  mlim_point_range range;
  mlim_point_grid_range(&first->grid, point, first->reach, &range);
  if (list->is_listed && memcmp(&range, &list->range, sizeof range) == 0)
  {
    return list->count <= MLIM_MAX_NEAR_PIECES;
  }
  mlim_point_walk walk;
  int32_t s = mlim_point_grid_first(&first->grid, point, first->reach, &walk);
  size_t count = 0;
  for (; s >= 0 && count < MLIM_MAX_NEAR_PIECES; ++count)
  {
    list->pieces[count] = s;
    mlim_copy(pieces->points + 3 * (size_t)s, list->starts[count]);
    s = mlim_point_grid_next(&first->grid, &walk);
  }
  list->is_listed = 1;
  list->range = range;
  list->count = count + (s >= 0);
  return list->count <= MLIM_MAX_NEAR_PIECES;
}
