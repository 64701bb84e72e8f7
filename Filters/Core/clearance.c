#include "clearance.h"

#include "memory.h"
#include "status.h"

enum
{
  LOOK_CELLS = 1024 * 4096 /* between two looks at the host */
};

static const double PROGRESS = 0.9;

/* One row's distances from those of the rows before it: `least` becomes their smallest one along the row. */
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
      const uint8_t value = other != NULL ? other[x] : MAX_CLEARANCE;
      least[x] = value < least[x] ? value : least[x];
    }
  }
}

static uint8_t one_more(uint8_t distance)
{
  return (uint8_t)(distance + (distance < MAX_CLEARANCE));
}

/* `least` has a MAX_CLEARANCE before its first number and one after its last. */
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
  uint8_t near = MAX_CLEARANCE;
  for (size_t n = 0; n < count; ++n)
  {
    const size_t x = is_backward ? count - 1 - n : n;
    const uint8_t most = one_more(near);
    near = most < here[x] ? most : here[x];
    here[x] = near;
  }
}

/* Two passes, exact for the Chebyshev distance. The outside does not count: who goes there knows. `least` has
   room for a row and two more. */
static mlim_status chamfer(
  uint8_t* distance, const int32_t dims[3], uint8_t* least, mlim_context* context)
{
  const size_t nx = (size_t)dims[0];
  const int64_t ny = dims[1];
  const int64_t nz = dims[2];
  const int64_t rows = ny * nz;
  const int64_t look = LOOK_CELLS / dims[0] + 1;
  mlim_status status = MLIM_OK;
  least[0] = MAX_CLEARANCE;
  least[nx + 1] = MAX_CLEARANCE;
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

typedef struct bricking
{
  const mlim_field* field;
  uint8_t* out;
} bricking;

/* Layers of bricks. What a brick has beyond the cells is never asked for. */
static void brick_body(void* data, size_t begin, size_t end)
{
  const bricking* job = (const bricking*)data;
  const mlim_field* field = job->field;
  const int32_t* cells = field->grid.cells;
  const int32_t last = (int32_t)end * BRICK < cells[2] ? (int32_t)end * BRICK : cells[2];
  for (int32_t z = (int32_t)begin * BRICK; z < last; ++z)
  {
    for (int32_t y = 0; y < cells[1]; ++y)
    {
      const uint8_t* row =
        field->clearances + (size_t)cells[0] * ((size_t)z * (size_t)cells[1] + (size_t)y);
      const int32_t start[3] = { 0, y, z };
      uint8_t* out = job->out + BRICK_CELLS * field_brick_of(field, start) + field_slot_of(start);
      for (int32_t x = 0; x < cells[0]; ++x)
      {
        out[BRICK_CELLS * (size_t)(x >> 2) + (size_t)(x & 3)] = row[x];
      }
    }
  }
}

/* Brick after brick, as they are asked for. */
static mlim_status order(mlim_field* field, mlim_context* context)
{
  const size_t count =
    (size_t)field->bricks[0] * (size_t)field->bricks[1] * (size_t)field->bricks[2];
  bricking job = { .field = field, .out = mlim_allocate(count, BRICK_CELLS) };
  if (job.out == NULL)
  {
    return mlim_fail_memory(context, "the field's index");
  }
  const mlim_status status =
    mlim_parallel_stage(context, &(mlim_stage_work){ .count = (size_t)field->bricks[2],
                                   .body = brick_body,
                                   .job = &job,
                                   .stage = MLIM_STAGE_FIELD,
                                   .from = PROGRESS,
                                   .to = PROGRESS });
  mlim_release(field->clearances);
  field->clearances = job.out;
  return status;
}

mlim_status mlim_clearance_measure(mlim_field* field, mlim_context* context)
{
  uint8_t* least = mlim_allocate((size_t)field->grid.cells[0] + 2, 1);
  const mlim_status status = least != NULL
                               ? chamfer(field->clearances, field->grid.cells, least, context)
                               : mlim_fail_memory(context, "the field's index");
  mlim_release(least);
  return status == MLIM_OK ? order(field, context) : status;
}
