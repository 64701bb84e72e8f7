/* Indicator functions of a label map, kept sparsely.

   The grid points lie in bricks of 8 x 8 x 8, and the bricks in tiles of 4 x 4 x 4. A brick lists the
   labels whose indicators are not at the floor in all of it, in ascending order, with a value a point
   or one value for all. Everything else is at the floor: the smallest value, which no label that can
   win somewhere near has. A tile's lists and values have one owner, so that tiles are made in
   parallel. */
#ifndef mlim_indicators_h
#define mlim_indicators_h

#include "mlim.h"

enum
{
  MLIM_BRICK = 8, /* grid points along a brick's side */
  MLIM_BRICK_POINTS = 512,
  MLIM_TILE = 32, /* grid points along a tile's side */
  MLIM_TILE_BRICKS = 64,
  MLIM_TILE_POINTS = 32768
};

/* A label in a brick. */
typedef struct mlim_brick_entry
{
  uint16_t label;
  uint16_t brick;      /* in its tile */
  uint16_t is_uniform; /* one value for all points */
  size_t first;        /* into the tile's values */
} mlim_brick_entry;

/* Where a label is, or would be, in an ascending array of structs that begin with their label. */
static inline size_t mlim_label_place(const void* first, size_t stride, size_t count, int32_t label)
{
  size_t low = 0;
  size_t high = count;
  while (low < high)
  {
    const size_t middle = (low + high) / 2;
    if (*(const uint16_t*)((const char*)first + middle * stride) < label)
    {
      low = middle + 1;
    }
    else
    {
      high = middle;
    }
  }
  return low;
}

/* How many voxels of a tile a label has after cleaning; those on the image's faces, edges and corners
   count a half, a quarter, an eighth. */
typedef struct mlim_tile_voxels
{
  uint16_t label;
  double count;
} mlim_tile_voxels;

typedef struct mlim_tile
{
  size_t first[MLIM_TILE_BRICKS + 1]; /* entries of brick b: first[b] .. first[b + 1] */
  mlim_brick_entry* entries;
  float* values;
  size_t value_count;
  mlim_tile_voxels* voxels;
  size_t voxels_count;
} mlim_tile;

struct mlim_indicators
{
  int32_t dims[3];
  int32_t bricks[3];
  int32_t tiles[3];
  int32_t label_count;
  float floor;
  float unit;      /* by how much a voxel leads over its neighbour of another label, unsmoothed */
  double range[2]; /* smallest and largest value of all */
  mlim_tile* tile;
  unsigned char* has; /* a label: whether it wins somewhere */
};

/* The entries of the brick that holds a grid point. */
typedef struct mlim_brick_list
{
  const mlim_brick_entry* entries; /* borrowed; ascending by label */
  size_t count;
  const float* values; /* of the tile */
} mlim_brick_list;

/* The tile that holds a brick, and the brick's place in it. */
static inline mlim_tile* mlim_indicators_tile(
  const mlim_indicators* indicators, const int32_t brick[3], size_t* slot)
{
  *slot = (size_t)(brick[0] & 3) | (size_t)(brick[1] & 3) << 2 | (size_t)(brick[2] & 3) << 4;
  return &indicators->tile[(size_t)(brick[0] >> 2) +
                           (size_t)indicators->tiles[0] *
                             ((size_t)(brick[1] >> 2) +
                               (size_t)indicators->tiles[1] * (size_t)(brick[2] >> 2))];
}

mlim_brick_list mlim_indicators_brick(const mlim_indicators* indicators, const int32_t brick[3]);

/* The entry of a label; NULL: it is at the floor. */
const mlim_brick_entry* mlim_brick_find(const mlim_brick_list* list, int32_t label);

/* Values of a label at `count` points from grid point index `first` on, along x. */
void mlim_indicators_row(
  const mlim_indicators* indicators, int32_t label, size_t first, size_t count, double* out);

/* Adds the labels listed round a grid point to the ascending ones in `out`, which has room for all. */
size_t mlim_indicators_list(
  const mlim_indicators* indicators, size_t point, uint16_t* out, size_t count);

#endif
