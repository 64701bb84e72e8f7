#include "morphology.h"

#include <string.h>

static size_t clamp_index(ptrdiff_t at, size_t length)
{
  return at < 0 ? 0 : (size_t)at >= length ? length - 1 : (size_t)at;
}

static void sum_along(
  size_t lines, size_t length, size_t row, int32_t radius, const int32_t* in, int32_t* out)
{
  for (size_t line = 0; line < lines; ++line)
  {
    const int32_t* from = in + line * length * row;
    for (size_t at = 0; at < length; ++at)
    {
      int32_t* to = out + (line * length + at) * row;
      memset(to, 0, row * sizeof *to);
      for (int32_t step = -radius; step <= radius; ++step)
      {
        const int32_t* add = from + clamp_index((ptrdiff_t)at + step, length) * row;
        for (size_t i = 0; i < row; ++i)
        {
          to[i] += add[i];
        }
      }
    }
  }
}

void mlim_morphology_median(
  int32_t radius, const int32_t size[3], unsigned char* mask, int32_t* counts)
{
  const size_t n[3] = { (size_t)size[0], (size_t)size[1], (size_t)size[2] };
  const size_t count = n[0] * n[1] * n[2];
  int32_t* other = counts + count;
  for (size_t i = 0; i < count; ++i)
  {
    counts[i] = mask[i];
  }
  sum_along(n[1] * n[2], n[0], 1, radius, counts, other);
  sum_along(n[2], n[1], n[0], radius, other, counts);
  sum_along(1, n[2], n[0] * n[1], radius, counts, other);
  const int32_t side = 2 * radius + 1;
  for (size_t i = 0; i < count; ++i)
  {
    mask[i] = 2 * other[i] > side * side * side;
  }
}

/* ---- dilation ---- */

static void spread_row(
  const unsigned char* in, size_t length, int32_t shift, size_t from, unsigned char* out)
{
  /* out[x] |= in[x + shift] on one row of `length`, in starting at `from`. */
  const size_t begin = shift < 0 ? (size_t)-shift : 0;
  const size_t end = shift > 0 ? length - (size_t)shift : length;
  for (size_t x = begin; x < end; ++x)
  {
    out[x] |= in[from + (size_t)((ptrdiff_t)x + shift)];
  }
}

void mlim_morphology_dilate(
  int32_t radius, const int32_t size[3], unsigned char* mask, unsigned char* scratch)
{
  const size_t n[3] = { (size_t)size[0], (size_t)size[1], (size_t)size[2] };
  memcpy(scratch, mask, n[0] * n[1] * n[2]);
  for (int32_t dz = -radius; dz <= radius; ++dz)
  {
    for (int32_t dy = -radius; dy <= radius; ++dy)
    {
      int32_t reach = radius;
      while (reach >= 0 && reach * reach + dy * dy + dz * dz > radius * radius)
      {
        --reach;
      }
      for (int32_t z = 0; z < size[2]; ++z)
      {
        for (int32_t y = 0; y < size[1]; ++y)
        {
          if (z + dz < 0 || z + dz >= size[2] || y + dy < 0 || y + dy >= size[1])
          {
            continue;
          }
          unsigned char* out = mask + n[0] * ((size_t)y + n[1] * (size_t)z);
          const size_t from = n[0] * ((size_t)(y + dy) + n[1] * (size_t)(z + dz));
          for (int32_t shift = -reach; shift <= reach && reach < size[0]; ++shift)
          {
            spread_row(scratch, n[0], shift, from, out);
          }
        }
      }
    }
  }
}

/* ---- thin parts ---- */

/* out(p) = all (or, with is_any, any) of in(p + low .. p + high); beyond the block nothing is set. */
static void gather_along(size_t lines, size_t length, size_t row, const int32_t range[2],
  int is_any, const unsigned char* in, unsigned char* out)
{
  for (size_t line = 0; line < lines; ++line)
  {
    const unsigned char* from = in + line * length * row;
    for (size_t at = 0; at < length; ++at)
    {
      unsigned char* to = out + (line * length + at) * row;
      memset(to, !is_any, row);
      for (int32_t step = range[0]; step <= range[1]; ++step)
      {
        const ptrdiff_t other = (ptrdiff_t)at + step;
        if (other < 0 || other >= (ptrdiff_t)length)
        {
          if (!is_any)
          {
            memset(to, 0, row);
          }
          continue;
        }
        const unsigned char* add = from + (size_t)other * row;
        for (size_t i = 0; i < row; ++i)
        {
          to[i] = (unsigned char)(is_any ? to[i] | add[i] : to[i] & add[i]);
        }
      }
    }
  }
}

size_t mlim_morphology_thin(
  const int32_t size[3], const unsigned char* mask, unsigned char* scratch, unsigned char* out)
{
  static const int32_t pair[2] = { 0, 1 };
  static const int32_t round[2] = { -2, 1 };
  const size_t n[3] = { (size_t)size[0], (size_t)size[1], (size_t)size[2] };
  const size_t count = n[0] * n[1] * n[2];
  gather_along(n[1] * n[2], n[0], 1, pair, 0, mask, out);
  gather_along(n[2], n[1], n[0], pair, 0, out, scratch);
  gather_along(1, n[2], n[0] * n[1], pair, 0, scratch, out);
  gather_along(n[1] * n[2], n[0], 1, round, 1, out, scratch);
  gather_along(n[2], n[1], n[0], round, 1, scratch, out);
  gather_along(1, n[2], n[0] * n[1], round, 1, out, scratch);
  size_t thin = 0;
  for (size_t i = 0; i < count; ++i)
  {
    out[i] = mask[i] & !scratch[i];
    thin += out[i];
  }
  return thin;
}
