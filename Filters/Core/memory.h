/* The only place that allocates. Counts are checked against overflow before they are multiplied. */
#ifndef mlim_memory_h
#define mlim_memory_h

#include <stddef.h>

/* count * size bytes, not initialised. NULL: out of memory or the product overflows. A count of 0
   gives a valid pointer. */
void* mlim_allocate(size_t count, size_t size);

/* The same, all bytes 0. */
void* mlim_allocate_zeroed(size_t count, size_t size);

void mlim_release(void* memory);

/* Tells the processor that an address will be read soon. The empty statement keeps compilers from leaving
   out calls of functions that do nothing else. */
static inline void mlim_prefetch(const void* memory)
{
#if defined(__GNUC__)
  __builtin_prefetch(memory);
  __asm__ volatile("");
#else
  (void)memory;
#endif
}

/* What mlim_reserve does when there is no room. */
int mlim_grow(void* array, size_t* capacity, size_t needed, size_t size);

/* Makes room for at least `needed` elements in an array that grows by doubling: *array holds
   *capacity elements before and after. Returns 0 on success; on failure nothing has changed. */
static inline int mlim_reserve(void* array, size_t* capacity, size_t needed, size_t size)
{
  /* Asked for at each element: nearly always there is room. */
  return needed <= *capacity ? 0 : mlim_grow(array, capacity, needed, size);
}

/* What mlim_reserve_apart does when there is no room. */
int mlim_grow_apart(void* array, size_t* capacity, size_t needed, size_t size);

/* The same for the few arrays that grow to tens of megabytes beside each other. Once they are not small they
   have so much room that the system maps them on their own: what is not in use takes no memory, they
   grow without a copy, and leave no holes when they are released. */
static inline int mlim_reserve_apart(void* array, size_t* capacity, size_t needed, size_t size)
{
  return needed <= *capacity ? 0 : mlim_grow_apart(array, capacity, needed, size);
}

#endif
