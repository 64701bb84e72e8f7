#include "clearance.h"

#include "memory.h"
#include "status.h"

/* Two passes, exact for the Chebyshev distance. The outside counts as mixed, so that a clearance
   never leaves the box. */
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
        for (int64_t x = 0; x < nx; ++x)
        {
          int least = 0;
          if (other != NULL)
          {
            const int left = x > 0 ? other[x - 1] : 0;
            const int right = x + 1 < nx ? other[x + 1] : 0;
            least = other[x] < left ? other[x] : left;
            least = right < least ? right : least;
          }
          here[x] = here[x] > least + 1 ? (uint8_t)(least + 1) : here[x];
        }
      }
      for (int64_t k = 0; k < nx; ++k)
      {
        const int64_t x = pass == 0 ? k : nx - 1 - k;
        const int64_t before = x + step;
        const int near = before >= 0 && before < nx ? here[before] : 0;
        here[x] = here[x] > near + 1 ? (uint8_t)(near + 1) : here[x];
      }
    }
  }
}

static void store_cell_clearances(mlim_field* field, const uint8_t* distance)
{
  const int32_t* cells = field->grid.cells;
  for (int32_t z = 0; z < cells[2]; ++z)
  {
    for (int32_t y = 0; y < cells[1]; ++y)
    {
      for (int32_t bx = 0; bx < field->bricks[0]; ++bx)
      {
        const uint32_t coarse =
          field->coarse[(size_t)bx +
                        (size_t)field->bricks[0] *
                          ((size_t)(y >> 2) + (size_t)field->bricks[1] * (size_t)(z >> 2))];
        if (!(coarse & (uint32_t)MIXED))
        {
          continue;
        }
        uint32_t* words = field->layers[z >> 2].words + (coarse & DETAIL) * BRICK_CELLS +
                          ((size_t)(y & 3) << 2 | (size_t)(z & 3) << 4);
        const int32_t end = 4 * bx + 4 < cells[0] ? 4 * bx + 4 : cells[0];
        for (int32_t x = 4 * bx; x < end; ++x)
        {
          if (!(words[x & 3] & (uint32_t)MIXED))
          {
            const size_t at =
              (size_t)x + (size_t)cells[0] * ((size_t)y + (size_t)cells[1] * (size_t)z);
            words[x & 3] |= (uint32_t)distance[at] << 16;
          }
        }
      }
    }
  }
}

mlim_status mlim_clearance_measure(mlim_field* field, uint8_t* distance, mlim_context* context)
{
  chamfer(distance, field->grid.cells);
  store_cell_clearances(field, distance);
  const size_t bricks =
    (size_t)field->bricks[0] * (size_t)field->bricks[1] * (size_t)field->bricks[2];
  uint8_t* coarse = mlim_allocate(bricks, 1);
  if (coarse == NULL)
  {
    return mlim_fail_memory(context, "the field's index");
  }
  for (size_t b = 0; b < bricks; ++b)
  {
    coarse[b] = field->coarse[b] & (uint32_t)MIXED ? 0 : MAX_CLEARANCE;
  }
  /* Neighbouring uniform bricks have one label: their common corners are grid points. */
  chamfer(coarse, field->bricks);
  for (size_t b = 0; b < bricks; ++b)
  {
    field->coarse[b] |= coarse[b] > 0 ? (uint32_t)coarse[b] << 16 : 0;
  }
  mlim_release(coarse);
  return MLIM_OK;
}
