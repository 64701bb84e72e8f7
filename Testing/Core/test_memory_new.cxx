// operator new as the tests of failing allocations need it: with a say for test_memory.c.
#include <cstdlib>
#include <new>

extern "C" {
int test_memory_fails(void);
void* __real_malloc(std::size_t size);
/* The sanitizer's library looks it up: the build hides symbols otherwise. */
__attribute__((visibility("default"))) const char* __lsan_default_suppressions();
}

// CGAL loses a new block of its containers when there is no memory to list it. A triangulation that
// is lost as a whole is still reported: it is no block.
const char* __lsan_default_suppressions()
{
  return "leak:CGAL/Compact_container.h\n";
}

void* operator new(std::size_t size)
{
  void* memory = test_memory_fails() ? nullptr : __real_malloc(size > 0 ? size : 1);
  if (memory == nullptr)
  {
    throw std::bad_alloc();
  }
  return memory;
}

void* operator new(std::size_t size, const std::nothrow_t&) noexcept
{
  return test_memory_fails() ? nullptr : __real_malloc(size > 0 ? size : 1);
}

void* operator new[](std::size_t size)
{
  return operator new(size);
}

void operator delete(void* memory) noexcept
{
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept
{
  std::free(memory);
}

void operator delete(void* memory, const std::nothrow_t&) noexcept
{
  std::free(memory);
}

void operator delete[](void* memory) noexcept
{
  std::free(memory);
}

void operator delete[](void* memory, std::size_t) noexcept
{
  std::free(memory);
}
