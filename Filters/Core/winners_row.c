#include "winners_row.h"

#include "plateau.h"
#include "scalars.h"

#include <math.h>
#include <string.h>

static const int SHIFT = 32768;

mlim_width mlim_width_of(const mlim_array* arrays, size_t count)
{
  int is_narrow = 1;
  int is_shifted = 1;
  int is_single = 1;
  for (size_t a = 0; a < count; ++a)
  {
    const mlim_scalar type = arrays[a].type;
    is_narrow &= type == MLIM_INT8 || type == MLIM_UINT8 || type == MLIM_INT16;
    is_shifted &= type == MLIM_UINT16;
    is_single &= type == MLIM_FLOAT32;
  }
  return is_narrow    ? MLIM_WIDTH_16
         : is_shifted ? MLIM_WIDTH_16_SHIFTED
         : is_single  ? MLIM_WIDTH_FLOAT
                      : MLIM_WIDTH_DOUBLE;
}

/* ---- reading ---- */

static const int16_t* read_narrow(const mlim_row_work* work, int16_t* restrict buffer)
{
  const size_t stride = work->array->stride;
  const size_t start = work->first * stride;
  const void* values = work->array->values;
  switch (work->array->type)
  {
    case MLIM_INT8:
    {
      const int8_t* restrict v = (const int8_t*)values + start;
      for (size_t i = 0; i < work->count; ++i)
      {
        buffer[i] = v[i * stride];
      }
      return buffer;
    }
    case MLIM_UINT8:
    {
      const uint8_t* restrict v = (const uint8_t*)values + start;
      for (size_t i = 0; i < work->count; ++i)
      {
        buffer[i] = v[i * stride];
      }
      return buffer;
    }
    case MLIM_UINT16:
    {
      const uint16_t* restrict v = (const uint16_t*)values + start;
      for (size_t i = 0; i < work->count; ++i)
      {
        buffer[i] = (int16_t)(v[i * stride] - SHIFT);
      }
      return buffer;
    }
    default:
    {
      const int16_t* restrict v = (const int16_t*)values + start;
      for (size_t i = 0; stride != 1 && i < work->count; ++i)
      {
        buffer[i] = v[i * stride];
      }
      return stride == 1 ? v : buffer;
    }
  }
}

static const float* read_single(const mlim_row_work* work, float* restrict buffer)
{
  const size_t stride = work->array->stride;
  const float* restrict v = (const float*)work->array->values + work->first * stride;
  for (size_t i = 0; stride != 1 && i < work->count; ++i)
  {
    buffer[i] = v[i * stride];
  }
  return stride == 1 ? v : buffer;
}

/* ---- comparing ---- */

/* Most values win nowhere: whether one of a row does is told before the winners are touched. */

static void win_narrow(const mlim_row_work* work, const int16_t* restrict value,
  int16_t* restrict best, int16_t* restrict low, uint16_t* restrict winners, int16_t* restrict peak)
{
  const uint16_t label = work->label;
  uint16_t is_met = 0;
  for (size_t i = 0; i < work->count; ++i)
  {
    const int16_t v = value[i];
    is_met |= v >= best[i] ? 1 : 0;
    low[i] = v < low[i] ? v : low[i];
    peak[i] = v > peak[i] ? v : peak[i];
  }
  for (size_t i = 0; is_met && i < work->count; ++i)
  {
    const int16_t v = value[i];
    const int16_t b = best[i];
    const uint16_t w = winners[i];
    const uint16_t tied = w | MLIM_TIED_FLAG;
    const uint16_t held = v == b ? tied : w;
    winners[i] = v > b ? label : held;
    best[i] = v > b ? v : b;
  }
}

static int win_single(const mlim_row_work* work, const float* restrict value, float* restrict best,
  float* restrict low, uint16_t* restrict winners, float* restrict peak)
{
  const uint16_t label = work->label;
  int is_met = 0;
  int is_bad = 0;
  for (size_t i = 0; i < work->count; ++i)
  {
    const float v = value[i];
    is_met |= v >= best[i] ? 1 : 0;
    is_bad |= v - v == 0 ? 0 : 1;
    low[i] = v < low[i] ? v : low[i];
    peak[i] = v > peak[i] ? v : peak[i];
  }
  for (size_t i = 0; is_met && i < work->count; ++i)
  {
    const float v = value[i];
    const float b = best[i];
    const uint16_t w = winners[i];
    const uint16_t tied = w | MLIM_TIED_FLAG;
    const uint16_t held = v == b ? tied : w;
    winners[i] = v > b ? label : held;
    best[i] = v > b ? v : b;
  }
  return is_bad;
}

static int win_wide(const mlim_row_work* work, const double* restrict value, double* restrict best,
  double* restrict low, uint16_t* restrict winners, double* restrict peak)
{
  const uint16_t label = work->label;
  int64_t is_met = 0;
  int64_t is_bad = 0;
  for (size_t i = 0; i < work->count; ++i)
  {
    const double v = value[i];
    is_met |= v >= best[i] ? 1 : 0;
    is_bad |= v - v == 0 ? 0 : 1;
    low[i] = v < low[i] ? v : low[i];
    peak[i] = v > peak[i] ? v : peak[i];
  }
  for (size_t i = 0; is_met && i < work->count; ++i)
  {
    const double v = value[i];
    const double b = best[i];
    const uint16_t w = winners[i];
    const uint16_t tied = w | MLIM_TIED_FLAG;
    const uint16_t held = v == b ? tied : w;
    winners[i] = v > b ? label : held;
    best[i] = v > b ? v : b;
  }
  return is_bad != 0;
}

/* ---- a row ---- */

static void name_all(const mlim_row_work* work, uint16_t* winners)
{
  for (size_t i = 0; i < work->count; ++i)
  {
    winners[i] = work->label;
  }
}

size_t mlim_width_size(mlim_width width)
{
  return width == MLIM_WIDTH_FLOAT    ? sizeof(float)
         : width == MLIM_WIDTH_DOUBLE ? sizeof(double)
                                      : sizeof(int16_t);
}

int mlim_row_win(const mlim_row_work* work, const mlim_row_state* state)
{
  mlim_row buffer;
  const void* values = &buffer;
  switch (work->width)
  {
    case MLIM_WIDTH_FLOAT:
      values = read_single(work, buffer.single);
      break;
    case MLIM_WIDTH_DOUBLE:
      mlim_scalars_read(work->array, work->first, work->count, buffer.wide);
      break;
    default:
      values = read_narrow(work, buffer.narrow);
      break;
  }
  if (work->is_first)
  {
    memcpy(state->best, values, work->count * mlim_width_size(work->width));
    name_all(work, state->winners);
  }
  int is_bad = 0;
  switch (work->width)
  {
    case MLIM_WIDTH_FLOAT:
      is_bad = win_single(
        work, values, state->best, state->low->single, state->winners, state->peak->single);
      break;
    case MLIM_WIDTH_DOUBLE:
      is_bad =
        win_wide(work, values, state->best, state->low->wide, state->winners, state->peak->wide);
      break;
    default:
      win_narrow(
        work, values, state->best, state->low->narrow, state->winners, state->peak->narrow);
      break;
  }
  if (work->is_first)
  {
    /* It was compared with itself. */
    name_all(work, state->winners);
  }
  return is_bad;
}

static void fill(mlim_width width, int16_t narrow, double wide, mlim_row* out)
{
  for (size_t i = 0; i < MLIM_ROW; ++i)
  {
    if (width == MLIM_WIDTH_FLOAT)
    {
      out->single[i] = (float)wide;
    }
    else if (width == MLIM_WIDTH_DOUBLE)
    {
      out->wide[i] = wide;
    }
    else
    {
      out->narrow[i] = narrow;
    }
  }
}

void mlim_row_fill_least(mlim_width width, mlim_row* out)
{
  fill(width, INT16_MIN, -INFINITY, out);
}

void mlim_row_fill_largest(mlim_width width, mlim_row* out)
{
  fill(width, INT16_MAX, INFINITY, out);
}

double mlim_row_value(mlim_width width, const void* value)
{
  switch (width)
  {
    case MLIM_WIDTH_FLOAT:
      return (double)*(const float*)value;
    case MLIM_WIDTH_DOUBLE:
      return *(const double*)value;
    case MLIM_WIDTH_16_SHIFTED:
      return *(const int16_t*)value + SHIFT;
    default:
      return *(const int16_t*)value;
  }
}
