#include "clearance.h"

/* Two passes, exact for the Chebyshev distance. The outside does not count: who goes there knows. */
static void chamfer(uint8_t* distance, const int32_t dims[3])
{
  const int64_t nx = dims[0];
  const int64_t ny = dims[1];
  const int64_t nz = dims[2];
  for (int pass = 0; pass < 2; ++pass)
  {
    const int64_t step = pass == 0 ? -1 : 1;
    for (int64_t i = 0; i < ny * nz; ++i)
    {
      const int64_t row = pass == 0 ? i : ny * nz - 1 - i;
      const int64_t y = row % ny;
      const int64_t z = row / ny;
      uint8_t* here = distance + row * nx;
      const int64_t others[4][2] = { { -1, step }, { 0, step }, { 1, step }, { step, 0 } };
      for (int n = 0; n < 4; ++n)
      {
        const int64_t oy = y + others[n][0];
        const int64_t oz = z + others[n][1];
        const int is_in = oy >= 0 && oy < ny && oz >= 0 && oz < nz;
        const uint8_t* other = is_in ? distance + (oz * ny + oy) * nx : NULL;
        for (int64_t x = 0; other != NULL && x < nx; ++x)
        {
          const int left = x > 0 ? other[x - 1] : MAX_CLEARANCE;
          const int right = x + 1 < nx ? other[x + 1] : MAX_CLEARANCE;
          int least = other[x] < left ? other[x] : left;
          least = right < least ? right : least;
          here[x] = here[x] > least + 1 ? (uint8_t)(least + 1) : here[x];
        }
      }
      for (int64_t k = 0; k < nx; ++k)
      {
        const int64_t x = pass == 0 ? k : nx - 1 - k;
        const int64_t before = x + step;
        const int near = before >= 0 && before < nx ? here[before] : MAX_CLEARANCE;
        here[x] = here[x] > near + 1 ? (uint8_t)(near + 1) : here[x];
      }
    }
  }
}

/* The least distance of the cells of a brick, and that of each of them into its word if it has some. */
static int store_brick(
  mlim_field* field, const uint8_t* distance, const int32_t brick[3], uint32_t* words)
{
  const int32_t* cells = field->grid.cells;
  int32_t end[3];
  int least = MAX_CLEARANCE;
  for (int k = 0; k < 3; ++k)
  {
    end[k] = BRICK * (brick[k] + 1) < cells[k] ? BRICK * (brick[k] + 1) : cells[k];
  }
  for (int32_t z = BRICK * brick[2]; z < end[2]; ++z)
  {
    for (int32_t y = BRICK * brick[1]; y < end[1]; ++y)
    {
      const uint8_t* row = distance + (size_t)cells[0] * ((size_t)y + (size_t)cells[1] * (size_t)z);
      for (int32_t x = BRICK * brick[0]; x < end[0]; ++x)
      {
        least = row[x] < least ? row[x] : least;
        uint32_t* word = words == NULL ? NULL : words + ((x & 3) | (y & 3) << 2 | (z & 3) << 4);
        if (word != NULL && !(*word & (uint32_t)MIXED))
        {
          *word |= (uint32_t)row[x] << 16;
        }
      }
    }
  }
  return least;
}

void mlim_clearance_measure(mlim_field* field, uint8_t* distance)
{
  chamfer(distance, field->grid.cells);
  int32_t brick[3];
  uint32_t* coarse = field->coarse;
  for (brick[2] = 0; brick[2] < field->bricks[2]; ++brick[2])
  {
    for (brick[1] = 0; brick[1] < field->bricks[1]; ++brick[1])
    {
      for (brick[0] = 0; brick[0] < field->bricks[0]; ++brick[0], ++coarse)
      {
        const int is_mixed = (*coarse & (uint32_t)MIXED) != 0;
        uint32_t* words =
          is_mixed ? field->layers[brick[2]].words + (*coarse & DETAIL) * BRICK_CELLS : NULL;
        const int least = store_brick(field, distance, brick, words);
        /* Neighbouring uniform cells have one label: their common corners are grid points. */
        *coarse |= is_mixed ? 0 : (uint32_t)least << 16;
      }
    }
  }
}
