#include "kernel.h"

#include <math.h>
#include <string.h>

/* Where the Gaussian is cut off, in sigmas. A level kernel is twice as long, and its negative lobes
   make up for what was cut off. */
static const double CUT = 3;
static const double LEVEL_CUT = 2;

static void make_level(const double* gauss, int32_t radius, double* out)
{
  for (int32_t k = 0; k <= 2 * radius; ++k)
  {
    double square = 0;
    for (int32_t j = k - radius; j <= radius; ++j)
    {
      square += gauss[j < 0 ? -j : j] * gauss[k - j < 0 ? j - k : k - j];
    }
    out[k] = (k <= radius ? 2 * gauss[k] : 0) - square;
  }
}

int mlim_kernel_gaussian(double sigma, int is_level, mlim_kernel* out)
{
  *out = (mlim_kernel){ .taps = { 1 } };
  const double reach = ceil((is_level ? LEVEL_CUT : CUT) * sigma);
  if (!(reach * (is_level ? 2 : 1) <= MLIM_MAX_RADIUS))
  {
    return 0;
  }
  if (!(sigma > 0))
  {
    return 1;
  }
  const int32_t radius = (int32_t)reach;
  double gauss[MLIM_MAX_RADIUS + 1];
  double total = 0;
  for (int32_t k = 0; k <= radius; ++k)
  {
    gauss[k] = exp(-0.5 * (k / sigma) * (k / sigma));
    total += (k > 0 ? 2 : 1) * gauss[k];
  }
  for (int32_t k = 0; k <= radius; ++k)
  {
    gauss[k] /= total;
  }
  double level[MLIM_MAX_RADIUS + 1];
  if (is_level)
  {
    make_level(gauss, radius, level);
  }
  out->radius = is_level ? 2 * radius : radius;
  for (int32_t k = 0; k <= out->radius; ++k)
  {
    out->taps[k] = (float)(is_level ? level[k] : gauss[k]);
  }
  return 1;
}

static void add_pair(
  float* restrict out, const float* restrict a, const float* restrict b, size_t count, float tap)
{
  for (size_t i = 0; i < count; ++i)
  {
    out[i] += tap * (a[i] + b[i]);
  }
}

static void scale(float* restrict out, const float* restrict in, size_t count, float tap)
{
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = tap * in[i];
  }
}

/* Lines along x: the row is copied between ends that go on. */
static void smooth_row(const mlim_kernel* kernel, size_t length, const float* in, float* out)
{
  enum
  {
    PART = 512
  };
  const size_t radius = (size_t)kernel->radius;
  float wide[PART + 2 * MLIM_MAX_RADIUS];
  for (size_t first = 0; first < length; first += PART)
  {
    const size_t count = length - first < PART ? length - first : PART;
    for (size_t i = 0; i < count + 2 * radius; ++i)
    {
      const size_t at = first + i < radius ? 0 : first + i - radius;
      wide[i] = in[at < length ? at : length - 1];
    }
    scale(out + first, wide + radius, count, kernel->taps[0]);
    for (size_t step = 1; step <= radius; ++step)
    {
      add_pair(out + first, wide + radius - step, wide + radius + step, count, kernel->taps[step]);
    }
  }
}

static void smooth_along(
  const mlim_kernel* kernel, size_t lines, size_t length, size_t row, const float* in, float* out)
{
  for (size_t line = 0; line < lines; ++line)
  {
    const float* from = in + line * length * row;
    for (size_t at = 0; at < length; ++at)
    {
      float* to = out + (line * length + at) * row;
      scale(to, from + at * row, row, kernel->taps[0]);
      for (size_t step = 1; step <= (size_t)kernel->radius; ++step)
      {
        const size_t before = at < step ? 0 : at - step;
        const size_t after = at + step < length ? at + step : length - 1;
        add_pair(to, from + before * row, from + after * row, row, kernel->taps[step]);
      }
    }
  }
}

void mlim_kernel_apply(
  const mlim_kernel* kernels, const int32_t size[3], float* values, float* scratch)
{
  const size_t n[3] = { (size_t)size[0], (size_t)size[1], (size_t)size[2] };
  for (size_t line = 0; line < n[1] * n[2]; ++line)
  {
    smooth_row(&kernels[0], n[0], values + line * n[0], scratch + line * n[0]);
  }
  smooth_along(&kernels[1], n[2], n[1], n[0], scratch, values);
  smooth_along(&kernels[2], 1, n[2], n[0] * n[1], values, scratch);
  memcpy(values, scratch, n[0] * n[1] * n[2] * sizeof *values);
}
