#include "memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

static const size_t SMALL = (size_t)1 << 18; /* bytes */

/* Just above the size from which glibc always maps a block on its own, whatever was released before. */
static const size_t APART = ((size_t)1 << 25) + 4096;

void* mlim_allocate(size_t count, size_t size)
{
  if (size != 0 && count > (SIZE_MAX / 2) / size)
  {
    return NULL;
  }
  const size_t bytes = count * size;
  return malloc(bytes > 0 ? bytes : 1);
}

void* mlim_allocate_zeroed(size_t count, size_t size)
{
  if (size != 0 && count > (SIZE_MAX / 2) / size)
  {
    return NULL;
  }
  return calloc(count > 0 ? count : 1, size > 0 ? size : 1);
}

void mlim_release(void* memory)
{
  free(memory);
}

int mlim_grow(void* array, size_t* capacity, size_t needed, size_t size)
{
  size_t grown = *capacity < 16 ? 16 : *capacity;
  while (grown < needed)
  {
    if (grown > SIZE_MAX / 4)
    {
      return 1;
    }
    grown *= 2;
  }
  if (size != 0 && grown > (SIZE_MAX / 2) / size)
  {
    return 1;
  }
  /* Through memcpy: the caller's pointer has another type than void*. */
  void* old = NULL;
  memcpy(&old, array, sizeof old);
  void* moved = realloc(old, grown * size);
  if (moved == NULL)
  {
    return 1;
  }
  memcpy(array, &moved, sizeof moved);
  *capacity = grown;
  return 0;
}

int mlim_grow_apart(void* array, size_t* capacity, size_t needed, size_t size)
{
  const size_t least = APART / size + 1;
  const int has_space = SIZE_MAX > UINT32_MAX; /* of addresses */
  return mlim_grow(
    array, capacity, has_space && needed > SMALL / size && needed < least ? least : needed, size);
}
