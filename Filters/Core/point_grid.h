/* Points in a hashed grid of cubes, for finding those near a place. */
#ifndef mlim_point_grid_h
#define mlim_point_grid_h

#include "status.h"

/* All 0 is a valid argument of _free. */
typedef struct mlim_point_grid
{
  double cube_size;
  size_t slot_count; /* power of two */
  int32_t* slots;    /* first entry of each chain; -1: none */
  size_t entry_count;
  size_t entry_capacity;
  struct mlim_point_entry* entries;
} mlim_point_grid;

typedef struct mlim_point_entry
{
  int64_t cube[3];
  int32_t item;
  int32_t next;
} mlim_point_entry;

/* The cubes that a ball touches, from a lowest to a highest one. */
typedef struct mlim_point_range
{
  int64_t low[3];
  int64_t high[3];
} mlim_point_range;

/* A walk over them. */
typedef struct mlim_point_walk
{
  mlim_point_range range;
  int64_t cube[3];
  int32_t entry;
} mlim_point_walk;

/* For at most `capacity` points. */
mlim_status mlim_point_grid_create(double cube_size, size_t capacity, mlim_point_grid* out);
void mlim_point_grid_free(mlim_point_grid* grid);

void mlim_point_grid_add(mlim_point_grid* grid, const double point[3], int32_t item);

/* Walks of equal ranges meet the same items in the same order. */
void mlim_point_grid_range(
  const mlim_point_grid* grid, const double center[3], double radius, mlim_point_range* out);

/* Items in all cubes that the ball touches, -1 at the end; some are farther than the radius. The
   order depends on positions and the order of adding only. */
int32_t mlim_point_grid_first(
  const mlim_point_grid* grid, const double center[3], double radius, mlim_point_walk* walk);
int32_t mlim_point_grid_next(const mlim_point_grid* grid, mlim_point_walk* walk);

#endif
