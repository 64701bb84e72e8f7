#include "indicators_brick.h"

#include "memory.h"

#include <string.h>

int mlim_brick_add(
  mlim_brick_writer* writer, uint16_t label, size_t brick, const float* values, int is_uniform)
{
  const size_t count = is_uniform ? 1 : MLIM_BRICK_POINTS;
  mlim_tile* tile = writer->out;
  if (mlim_reserve(&writer->entries, &writer->entry_capacity, writer->entry_count + 1,
        sizeof *writer->entries) ||
      mlim_reserve(
        &tile->values, &writer->value_capacity, tile->value_count + count, sizeof *tile->values))
  {
    return 0;
  }
  writer->entries[writer->entry_count++] = (mlim_brick_entry){ .label = label,
    .brick = (uint16_t)brick,
    .is_uniform = (uint16_t)is_uniform,
    .first = tile->value_count };
  memcpy(tile->values + tile->value_count, values, count * sizeof *values);
  tile->value_count += count;
  return 1;
}

int mlim_brick_finish(mlim_brick_writer* writer)
{
  mlim_tile* tile = writer->out;
  size_t at[MLIM_TILE_BRICKS + 1] = { 0 };
  float* values = mlim_allocate(tile->value_count, sizeof *values);
  tile->entries = mlim_allocate(writer->entry_count, sizeof *tile->entries);
  if (tile->entries == NULL || values == NULL)
  {
    mlim_release(values);
    return 0;
  }
  for (size_t n = 0; n < writer->entry_count; ++n)
  {
    ++at[writer->entries[n].brick + 1];
  }
  for (size_t b = 0; b < MLIM_TILE_BRICKS; ++b)
  {
    at[b + 1] += at[b];
  }
  memcpy(tile->first, at, sizeof at);
  for (size_t n = 0; n < writer->entry_count; ++n)
  {
    tile->entries[at[writer->entries[n].brick]++] = writer->entries[n];
  }
  memcpy(values, tile->values, tile->value_count * sizeof *values);
  mlim_release(tile->values);
  tile->values = values;
  return 1;
}

void mlim_brick_lead(mlim_tile* tile, size_t brick, size_t slot, uint16_t label, float lead)
{
  float best = 0;
  float* own = NULL;
  int has_other = 0;
  for (size_t n = tile->first[brick]; n < tile->first[brick + 1]; ++n)
  {
    const mlim_brick_entry* entry = &tile->entries[n];
    float* value = &tile->values[entry->first + (entry->is_uniform ? 0 : slot)];
    if (entry->label == label)
    {
      own = entry->is_uniform ? NULL : value;
    }
    else if (!has_other || *value > best)
    {
      best = *value;
      has_other = 1;
    }
  }
  if (own != NULL && has_other && *own < best + lead)
  {
    *own = best + lead;
  }
}
