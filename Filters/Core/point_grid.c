#include "point_grid.h"
#include "memory.h"
#include "vector.h"

#include <assert.h>
#include <math.h>
#include <string.h>

/* Cubes beyond this are one: far above any grid's size over any cube's, below 2^63. */
static const double MAX_CUBE = 4e18;

static int64_t cube_of(const mlim_point_grid* grid, double coordinate)
{
  const double cube = floor(coordinate / grid->cube_size);
  return (int64_t)mlim_min(mlim_max(cube, -MAX_CUBE), MAX_CUBE);
}

static size_t slot_of(const mlim_point_grid* grid, const int64_t cube[3])
{
  uint64_t hash = (uint64_t)cube[0] * 0x9E3779B97F4A7C15u;
  hash = (hash ^ (hash >> 31)) + (uint64_t)cube[1] * 0xC2B2AE3D27D4EB4Fu;
  hash = (hash ^ (hash >> 29)) + (uint64_t)cube[2] * 0x165667B19E3779F9u;
  hash ^= hash >> 32;
  return (size_t)hash & (grid->slot_count - 1);
}

mlim_status mlim_point_grid_create(double cube_size, size_t capacity, mlim_point_grid* out)
{
  assert(cube_size > 0);
  mlim_point_grid grid = { .cube_size = cube_size, .slot_count = 16, .entry_capacity = capacity };
  while (grid.slot_count < 2 * capacity)
  {
    grid.slot_count *= 2;
  }
  grid.slots = mlim_allocate(grid.slot_count, sizeof(*grid.slots));
  grid.entries = mlim_allocate(capacity, sizeof(*grid.entries));
  if (!grid.slots || !grid.entries)
  {
    mlim_point_grid_free(&grid);
    return MLIM_OUT_OF_MEMORY;
  }
  memset(grid.slots, -1, grid.slot_count * sizeof(*grid.slots));
  *out = grid;
  return MLIM_OK;
}

void mlim_point_grid_free(mlim_point_grid* grid)
{
  mlim_release(grid->slots);
  mlim_release(grid->entries);
  *grid = (mlim_point_grid){ 0 };
}

void mlim_point_grid_add(mlim_point_grid* grid, const double point[3], int32_t item)
{
  assert(grid->entry_count < grid->entry_capacity);
  mlim_point_entry* entry = grid->entries + grid->entry_count;
  for (int k = 0; k < 3; ++k)
  {
    entry->cube[k] = cube_of(grid, point[k]);
  }
  const size_t slot = slot_of(grid, entry->cube);
  entry->item = item;
  entry->next = grid->slots[slot];
  grid->slots[slot] = (int32_t)grid->entry_count;
  ++grid->entry_count;
}

/* The first entry of a chain, from `entry` on, that lies in the walk's cube. */
static int32_t find_in_chain(
  const mlim_point_grid* grid, const mlim_point_walk* walk, int32_t entry)
{
  while (entry >= 0 && memcmp(grid->entries[entry].cube, walk->cube, sizeof walk->cube))
  {
    entry = grid->entries[entry].next;
  }
  return entry;
}

/* Moves to the next cube; 0 when there is none. */
static int advance(mlim_point_walk* walk)
{
  for (int k = 0; k < 3; ++k)
  {
    if (walk->cube[k] < walk->range.high[k])
    {
      ++walk->cube[k];
      return 1;
    }
    walk->cube[k] = walk->range.low[k];
  }
  return 0;
}

static int32_t settle(const mlim_point_grid* grid, mlim_point_walk* walk)
{
  while (walk->entry < 0)
  {
    if (!advance(walk))
    {
      return -1;
    }
    walk->entry = find_in_chain(grid, walk, grid->slots[slot_of(grid, walk->cube)]);
  }
  return grid->entries[walk->entry].item;
}

void mlim_point_grid_range(
  const mlim_point_grid* grid, const double center[3], double radius, mlim_point_range* out)
{
  for (int k = 0; k < 3; ++k)
  {
    out->low[k] = cube_of(grid, center[k] - radius);
    out->high[k] = cube_of(grid, center[k] + radius);
  }
}

int32_t mlim_point_grid_first(
  const mlim_point_grid* grid, const double center[3], double radius, mlim_point_walk* walk)
{
  mlim_point_grid_range(grid, center, radius, &walk->range);
  memcpy(walk->cube, walk->range.low, sizeof walk->cube);
  walk->entry = find_in_chain(grid, walk, grid->slots[slot_of(grid, walk->cube)]);
  return settle(grid, walk);
}

int32_t mlim_point_grid_next(const mlim_point_grid* grid, mlim_point_walk* walk)
{
  walk->entry = find_in_chain(grid, walk, grid->entries[walk->entry].next);
  return settle(grid, walk);
}
