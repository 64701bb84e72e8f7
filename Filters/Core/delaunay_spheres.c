#include "delaunay_parts.h"

#include "predicates.h"

/* Where the program can choose as it starts: four cells at a time on processors that have the registers.
   The operations are the same ones in the same order, so the digits are too. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__has_attribute)
#if __has_attribute(target_clones)
#define WIDEST __attribute__((target_clones("avx2", "default")))
#endif
#endif
#ifndef WIDEST
#define WIDEST
#endif

enum
{
  LANES = 8 /* cells at a time */
};

/* Number k of a point, a centre with its level, or a bound: that of each cell side by side. */
typedef struct lanes
{
  double corners[4][4][LANES];
  double sphere[4][LANES];
  double base[LANES], slope[LANES];
  double is_flat[LANES];
} lanes;

static inline mlim_power_point point_of(double (*restrict at)[LANES], int lane)
{
  return (mlim_power_point){
    .x = at[0][lane], .y = at[1][lane], .z = at[2][lane], .weight = at[3][lane]
  };
}

WIDEST static void make_parts(lanes* restrict all)
{
  for (int k = 0; k < LANES; ++k)
  {
    const mlim_power_parts parts = mlim_power_sphere_parts(point_of(all->corners[0], k),
      point_of(all->corners[1], k), point_of(all->corners[2], k), point_of(all->corners[3], k));
    all->sphere[0][k] = parts.x;
    all->sphere[1][k] = parts.y;
    all->sphere[2][k] = parts.z;
    all->sphere[3][k] = parts.level;
    all->base[k] = parts.base;
    all->slope[k] = parts.slope;
    all->is_flat[k] = parts.is_flat ? 1 : 0;
  }
}

static void gather(const mlim_delaunay* d, int32_t cell, int lane, lanes* out)
{
  const double* corners[4];
  delaunay_corners(d, cell, corners);
  for (int k = 0; k < 4; ++k)
  {
    for (int j = 0; j < 4; ++j)
    {
      out->corners[k][j][lane] = corners[k][j];
    }
  }
}

/* The centre is exact where the plain formula is not good enough; then the sphere decides nothing. */
static mlim_status take(
  mlim_delaunay* d, int32_t cell, int lane, const lanes* all, mlim_context* context)
{
  const mlim_power_parts parts = { .x = all->sphere[0][lane],
    .y = all->sphere[1][lane],
    .z = all->sphere[2][lane],
    .level = all->sphere[3][lane],
    .base = all->base[lane],
    .slope = all->slope[lane],
    .is_flat = all->is_flat[lane] != 0 };
  mlim_power_sphere* sphere = &d->spheres[cell];
  if (mlim_power_sphere_take(&parts, sphere, &d->cells[cell].bound))
  {
    return MLIM_OK;
  }
  const double* corners[4];
  delaunay_corners(d, cell, corners);
  return mlim_predicates_center(corners, context, sphere->center);
}

mlim_status delaunay_make_spheres(
  mlim_delaunay* d, const int32_t* cells, size_t count, mlim_context* context)
{
  mlim_status status = MLIM_OK;
  lanes all;
  for (size_t first = 0; first < count; first += LANES)
  {
    const int used = count - first < LANES ? (int)(count - first) : LANES;
    for (int k = 0; k < LANES; ++k)
    {
      gather(d, cells[first + (size_t)(k < used ? k : 0)], k, &all);
    }
    make_parts(&all);
    for (int k = 0; k < used; ++k)
    {
      const mlim_status made = take(d, cells[first + (size_t)k], k, &all, context);
      status = status == MLIM_OK ? made : status;
    }
  }
  return status;
}
