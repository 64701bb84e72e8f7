#include "clearance.h"

#include "memory.h"
#include "status.h"

enum
{
  LOOK_CELLS = 1024 * 4096 /* between two looks at the host */
};

static const double PROGRESS = 0.9;

/* One row's distances from those of the rows before it: `least` becomes their smallest one along the row,
   0 where one of them is outside. */
static void take_rows(const uint8_t* const others[4], size_t count, uint8_t* restrict least)
{
  for (size_t x = 0; x < count; ++x)
  {
    least[x] = MAX_CLEARANCE;
  }
  for (int n = 0; n < 4; ++n)
  {
    const uint8_t* restrict other = others[n];
    for (size_t x = 0; x < count; ++x)
    {
      const uint8_t value = other != NULL ? other[x] : 0;
      least[x] = value < least[x] ? value : least[x];
    }
  }
}

static uint8_t one_more(uint8_t distance)
{
  return (uint8_t)(distance + (distance < MAX_CLEARANCE));
}

/* `least` has a 0 before its first number and one after its last. */
static void lower_row(
  const uint8_t* restrict least, size_t count, int is_backward, uint8_t* restrict here)
{
  for (size_t x = 0; x < count; ++x)
  {
    const uint8_t left = least[x];
    const uint8_t right = least[x + 2];
    const uint8_t sides = left < right ? left : right;
    const uint8_t most = one_more(least[x + 1] < sides ? least[x + 1] : sides);
    here[x] = most < here[x] ? most : here[x];
  }
  uint8_t near = 0;
  for (size_t n = 0; n < count; ++n)
  {
    const size_t x = is_backward ? count - 1 - n : n;
    const uint8_t most = one_more(near);
    near = most < here[x] ? most : here[x];
    here[x] = near;
  }
}

/* Two passes, exact for the Chebyshev distance. The outside counts as mixed, so that a clearance
   never leaves the box. `least` has room for a row and two more. */
static mlim_status chamfer(
  uint8_t* distance, const int32_t dims[3], uint8_t* least, mlim_context* context)
{
  const size_t nx = (size_t)dims[0];
  const int64_t ny = dims[1];
  const int64_t nz = dims[2];
  const int64_t rows = ny * nz;
  const int64_t look = LOOK_CELLS / dims[0] + 1;
  mlim_status status = MLIM_OK;
  least[0] = 0;
  least[nx + 1] = 0;
  for (int64_t i = 0; i < 2 * rows && status == MLIM_OK; ++i)
  {
    const int is_backward = i >= rows;
    const int64_t row = is_backward ? 2 * rows - 1 - i : i;
    const int64_t step = is_backward ? 1 : -1;
    const int64_t y = row % ny;
    const int64_t z = row / ny;
    const int64_t before[4][2] = { { -1, step }, { 0, step }, { 1, step }, { step, 0 } };
    const uint8_t* others[4];
    for (int n = 0; n < 4; ++n)
    {
      const int64_t oy = y + before[n][0];
      const int64_t oz = z + before[n][1];
      const int is_in = oy >= 0 && oy < ny && oz >= 0 && oz < nz;
      others[n] = is_in ? distance + (size_t)(oz * ny + oy) * nx : NULL;
    }
    take_rows(others, nx, least + 1);
    lower_row(least, nx, is_backward, distance + (size_t)row * nx);
    if (i % look == 0)
    {
      status = mlim_progress(context, MLIM_STAGE_FIELD, PROGRESS);
    }
  }
  return status;
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
  const size_t bricks =
    (size_t)field->bricks[0] * (size_t)field->bricks[1] * (size_t)field->bricks[2];
  uint8_t* coarse = mlim_allocate(bricks, 1);
  uint8_t* least = mlim_allocate((size_t)field->grid.cells[0] + 2, 1);
  mlim_status status = coarse != NULL && least != NULL
                         ? chamfer(distance, field->grid.cells, least, context)
                         : mlim_fail_memory(context, "the field's index");
  if (status != MLIM_OK)
  {
    goto done;
  }
  store_cell_clearances(field, distance);
  for (size_t b = 0; b < bricks; ++b)
  {
    coarse[b] = field->coarse[b] & (uint32_t)MIXED ? 0 : MAX_CLEARANCE;
  }
  /* Neighbouring uniform bricks have one label: their common corners are grid points. */
  status = chamfer(coarse, field->bricks, least, context);
  for (size_t b = 0; b < bricks; ++b)
  {
    field->coarse[b] |= coarse[b] > 0 ? (uint32_t)coarse[b] << 16 : 0;
  }
done:
  mlim_release(coarse);
  mlim_release(least);
  return status;
}
