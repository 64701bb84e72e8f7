#include "indicators.h"

#include "memory.h"

#include <string.h>

void mlim_indicators_free(mlim_indicators* indicators)
{
  if (indicators == NULL)
  {
    return;
  }
  const size_t tiles =
    (size_t)indicators->tiles[0] * (size_t)indicators->tiles[1] * (size_t)indicators->tiles[2];
  for (size_t t = 0; indicators->tile != NULL && t < tiles; ++t)
  {
    mlim_release(indicators->tile[t].entries);
    mlim_release(indicators->tile[t].values);
    mlim_release(indicators->tile[t].voxels);
  }
  mlim_release(indicators->tile);
  mlim_release(indicators->has);
  mlim_release(indicators);
}

int mlim_indicators_has(const mlim_indicators* indicators, int32_t label)
{
  return label >= 0 && label < indicators->label_count && indicators->has[label];
}

mlim_brick_list mlim_indicators_brick(const mlim_indicators* indicators, const int32_t brick[3])
{
  size_t slot;
  const mlim_tile* tile = mlim_indicators_tile(indicators, brick, &slot);
  return (mlim_brick_list){ .entries = tile->entries + tile->first[slot],
    .count = tile->first[slot + 1] - tile->first[slot],
    .values = tile->values };
}

const mlim_brick_entry* mlim_brick_find(const mlim_brick_list* list, int32_t label)
{
  const size_t n = mlim_label_place(list->entries, sizeof *list->entries, list->count, label);
  return n < list->count && list->entries[n].label == label ? &list->entries[n] : NULL;
}

static void locate(const mlim_indicators* indicators, size_t point, int32_t at[3])
{
  const size_t nx = (size_t)indicators->dims[0];
  const size_t ny = (size_t)indicators->dims[1];
  at[0] = (int32_t)(point % nx);
  at[1] = (int32_t)(point / nx % ny);
  at[2] = (int32_t)(point / (nx * ny));
}

/* The part of a row that lies in one brick. */
static void read_run(const mlim_brick_list* list, float floor, int32_t label, const int32_t at[3],
  size_t count, double* out)
{
  const mlim_brick_entry* entry = mlim_brick_find(list, label);
  const size_t slot = (size_t)(at[0] & 7) | (size_t)(at[1] & 7) << 3 | (size_t)(at[2] & 7) << 6;
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = (double)(entry == NULL       ? floor
                      : entry->is_uniform ? list->values[entry->first]
                                          : list->values[entry->first + slot + i]);
  }
}

void mlim_indicators_row(
  const mlim_indicators* indicators, int32_t label, size_t first, size_t count, double* out)
{
  int32_t at[3];
  locate(indicators, first, at);
  while (count > 0)
  {
    const size_t room = (size_t)(MLIM_BRICK - (at[0] & 7));
    const size_t run = count < room ? count : room;
    const mlim_brick_list list =
      mlim_indicators_brick(indicators, (const int32_t[3]){ at[0] >> 3, at[1] >> 3, at[2] >> 3 });
    read_run(&list, indicators->floor, label, at, run, out);
    out += run;
    at[0] += (int32_t)run;
    count -= run;
  }
}

size_t mlim_indicators_list(
  const mlim_indicators* indicators, size_t point, uint16_t* out, size_t count)
{
  int32_t at[3];
  locate(indicators, point, at);
  const mlim_brick_list list =
    mlim_indicators_brick(indicators, (const int32_t[3]){ at[0] >> 3, at[1] >> 3, at[2] >> 3 });
  for (size_t n = 0; n < list.count; ++n)
  {
    const uint16_t label = list.entries[n].label;
    size_t k = count;
    while (k > 0 && out[k - 1] > label)
    {
      --k;
    }
    if (k > 0 && out[k - 1] == label)
    {
      continue;
    }
    memmove(out + k + 1, out + k, (count - k) * sizeof *out);
    out[k] = label;
    ++count;
  }
  return count;
}

static void write_brick(
  const mlim_indicators* indicators, const int32_t brick[3], int32_t label, float* out)
{
  const mlim_brick_list list = mlim_indicators_brick(indicators, brick);
  const mlim_brick_entry* entry = mlim_brick_find(&list, label);
  const int32_t* dims = indicators->dims;
  if (entry == NULL)
  {
    return;
  }
  for (int32_t slot = 0; slot < MLIM_BRICK_POINTS; ++slot)
  {
    const int32_t at[3] = { 8 * brick[0] + (slot & 7), 8 * brick[1] + (slot >> 3 & 7),
      8 * brick[2] + (slot >> 6) };
    if (at[0] < dims[0] && at[1] < dims[1] && at[2] < dims[2])
    {
      out[(size_t)at[0] + (size_t)dims[0] * ((size_t)at[1] + (size_t)dims[1] * (size_t)at[2])] =
        list.values[entry->first + (entry->is_uniform ? 0 : (size_t)slot)];
    }
  }
}

void mlim_indicators_write(const mlim_indicators* indicators, int32_t label, float* out)
{
  const size_t points =
    (size_t)indicators->dims[0] * (size_t)indicators->dims[1] * (size_t)indicators->dims[2];
  for (size_t p = 0; p < points; ++p)
  {
    out[p] = indicators->floor;
  }
  for (int32_t z = 0; z < indicators->bricks[2]; ++z)
  {
    for (int32_t y = 0; y < indicators->bricks[1]; ++y)
    {
      for (int32_t x = 0; x < indicators->bricks[0]; ++x)
      {
        write_brick(indicators, (const int32_t[3]){ x, y, z }, label, out);
      }
    }
  }
}
