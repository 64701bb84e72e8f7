/* Curvature anisotropic diffusion: level sets move with their curvature, the slower the steeper the
   function is, so edges stay. Dey, Janoos, Levine, section 4.1. */
#ifndef mlim_diffusion_h
#define mlim_diffusion_h

#include <stdint.h>

typedef struct mlim_diffusion
{
  int32_t iterations;
  float step;       /* of time, in squares of the smallest spacing; stable up to 0.125 */
  float slope;      /* the steepness at which the speed is half of that on flat ground */
  float inverse[3]; /* 1 / spacing */
  float min_spacing;
} mlim_diffusion;

/* Each iteration reaches one point farther; beyond the block its outermost values go on. The result is
   in `values`; `scratch` is as large. */
void mlim_diffusion_run(
  const mlim_diffusion* diffusion, const int32_t size[3], float* values, float* scratch);

#endif
