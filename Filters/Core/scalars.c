#include "scalars.h"

void mlim_scalars_read(const mlim_array* array, size_t first, size_t count, double* out)
{
  const size_t stride = array->stride;
  const size_t start = first * stride;
  switch (array->type)
  {
    case MLIM_INT8:
    {
      const int8_t* v = (const int8_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = v[i * stride];
      }
      break;
    }
    case MLIM_UINT8:
    {
      const uint8_t* v = (const uint8_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = v[i * stride];
      }
      break;
    }
    case MLIM_INT16:
    {
      const int16_t* v = (const int16_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = v[i * stride];
      }
      break;
    }
    case MLIM_UINT16:
    {
      const uint16_t* v = (const uint16_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = v[i * stride];
      }
      break;
    }
    case MLIM_INT32:
    {
      const int32_t* v = (const int32_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = v[i * stride];
      }
      break;
    }
    case MLIM_UINT32:
    {
      const uint32_t* v = (const uint32_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = v[i * stride];
      }
      break;
    }
    case MLIM_INT64:
    {
      const int64_t* v = (const int64_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = (double)v[i * stride];
      }
      break;
    }
    case MLIM_UINT64:
    {
      const uint64_t* v = (const uint64_t*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = (double)v[i * stride];
      }
      break;
    }
    case MLIM_FLOAT32:
    {
      const float* v = (const float*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = (double)v[i * stride];
      }
      break;
    }
    case MLIM_FLOAT64:
    {
      const double* v = (const double*)array->values + start;
      for (size_t i = 0; i < count; ++i)
      {
        out[i] = v[i * stride];
      }
      break;
    }
    case MLIM_SCALAR_END:
      break;
  }
}
