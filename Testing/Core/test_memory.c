/* Fails each allocation in turn, of the core (malloc and its kin are wrapped by the linker) and of
   the triangulation (operator new, test_memory_new.cxx): the right status, empty products, no leak. */
#include "shapes.h"

#include <time.h>

/* ---- the allocator ---- */

static size_t allocation_count;
static size_t failing_allocation; /* from 1; 0: none */

int test_memory_fails(void);
void* __real_malloc(size_t size);
void* __real_calloc(size_t count, size_t size);
void* __real_realloc(void* memory, size_t size);
void* __wrap_malloc(size_t size);
void* __wrap_calloc(size_t count, size_t size);
void* __wrap_realloc(void* memory, size_t size);

/* Also called by operator new. */
int test_memory_fails(void)
{
  return ++allocation_count == failing_allocation;
}

void* __wrap_malloc(size_t size)
{
  return test_memory_fails() ? NULL : __real_malloc(size);
}

void* __wrap_calloc(size_t count, size_t size)
{
  return test_memory_fails() ? NULL : __real_calloc(count, size);
}

void* __wrap_realloc(void* memory, size_t size)
{
  return test_memory_fails() ? NULL : __real_realloc(memory, size);
}

/* ---- the scene ---- */

enum
{
  SIDE = 5
};

/* Two regions and background; the island touches the box, so there are caps and junctions. */
static double indicator(const double at[3], int label)
{
  const double r = shape_distance(at, 1.6, 2.1, 2.2);
  return label == 0 ? 0 : label == 1 ? fmin(1.7 - r, at[0] - 1.4) : fmin(1.7 - r, 1.4 - at[0]);
}

static const double SPACING[3] = { 1, 1, 1 };
static const int32_t DIMS[3] = { SIDE, SIDE, SIDE };

static mlim_status run_failing(const image* im, size_t failing)
{
  const mlim_options options = run_options(0);
  mlim_context context = { 0 };
  run r;
  allocation_count = 0;
  failing_allocation = failing;
  const mlim_status status = run_volume(&im->grid, &options, &context, &r);
  failing_allocation = 0;
  CHECK(r.mesh.vertices == NULL || status == MLIM_OK);
  CHECK(r.volume.vertices == NULL || status == MLIM_OK);
  if (status == MLIM_OUT_OF_MEMORY)
  {
    CHECK(strlen(context.message) > 10);
    CHECK(run_is_empty_from(&r, r.field == NULL ? MLIM_STAGE_FIELD : MLIM_STAGE_SURFACE));
    CHECK(r.field != NULL || run_is_empty_from(&r, MLIM_STAGE_FIELD));
  }
  run_free(&r);
  return status;
}

/* Seconds of processor time: sanitizers are slow, so they try fewer allocations. Runs that
   fail take half as long as the one that is measured. */
static const double TIME_LIMIT = 30;

int main(void)
{
  image* im = image_sample(DIMS, SPACING, 3, 0, indicator);
  CHECK(run_failing(im, 0) == MLIM_OK); /* also makes what is made once in a process */
  const clock_t begin = clock();
  CHECK(run_failing(im, 0) == MLIM_OK);
  const double seconds = (double)(clock() - begin) / CLOCKS_PER_SEC;
  const size_t count = allocation_count;
  CHECK(count > 100);
  const size_t affordable = (size_t)(TIME_LIMIT / fmax(seconds, 1e-6)) + 1;
  const size_t step = count / affordable + 1;
  size_t unexpected = 0;
  for (size_t k = 1; k <= count; k += step)
  {
    const mlim_status status = run_failing(im, k);
    if (status != MLIM_OUT_OF_MEMORY)
    {
      fprintf(stderr, "allocation %zu of %zu failed: %s\n", k, count, mlim_status_text(status));
      ++unexpected;
    }
  }
  CHECK_COUNT(unexpected, 0);
  CHECK(run_failing(im, 0) == MLIM_OK);
  image_free(im);
  return check_result();
}
