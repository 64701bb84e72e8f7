/* Symmetric kernels of a few taps, the same arithmetic at every point of a block. */
#ifndef mlim_kernel_h
#define mlim_kernel_h

#include "distance.h"

typedef struct mlim_kernel
{
  int32_t radius;                  /* 0: leaves a block as it is */
  float taps[MLIM_MAX_RADIUS + 1]; /* from the middle outwards; they add up to 1 */
} mlim_kernel;

/* A Gaussian; sigma in grid points. With is_level the kernel is 2 G - G * G, whose second moment is
   0: it smooths as well, but does not move a curved boundary to the side on which it curves (up to
   the fourth power of sigma / radius of curvature). 0: too wide. */
int mlim_kernel_gaussian(double sigma, int is_level, mlim_kernel* out);

/* Applies three kernels, one an axis; beyond the block its outermost values go on. The result is in `values`;
   `scratch` is as large. */
void mlim_kernel_apply(
  const mlim_kernel* kernels, const int32_t size[3], float* values, float* scratch);

#endif
