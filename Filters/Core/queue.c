#include "queue.h"

#include "memory.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>

enum
{
  RATIO_FIRST = 0, /* 16 bins: ratio up to 3 times its bound */
  RATIO_COUNT = 16,
  QUALITY_FIRST = 20, /* 32 bins, a factor of sqrt(2) each, for size and distance together */
  QUALITY_COUNT = 32,
  DISK_BIN = 60,
  SHEET_BIN = 61,
  CROSSINGS_BIN = 62,
  FAR_BIN = 63,
  MORTON_BITS = 20,
  DIGIT = 10, /* bits of a place that one pass sorts by */
  FEW = 2048  /* entries that are sorted sooner without passes */
};

void mlim_queue_start(mlim_queue* queue, const double size[3])
{
  *queue = (mlim_queue){ .scale = ((1 << MORTON_BITS) - 1) /
                                  mlim_max(size[0], mlim_max(size[1], size[2])) };
}

void mlim_queue_shrink(mlim_queue* queue)
{
  for (int b = 0; b < MLIM_QUEUE_BINS; ++b)
  {
    mlim_release(queue->bins[b].entries);
  }
  mlim_release(queue->batch.entries);
  *queue = (mlim_queue){ .scale = queue->scale };
}

void mlim_queue_free(mlim_queue* queue)
{
  mlim_queue_shrink(queue);
  queue->scale = 0;
}

static int clamp(double value, int count)
{
  return value < 0 ? 0 : value > count - 1 ? count - 1 : (int)value;
}

int mlim_queue_bin_of(mlim_badness badness, double excess)
{
  switch (badness)
  {
    case MLIM_BAD_FAR:
      return FAR_BIN;
    case MLIM_BAD_CROSSINGS:
      return CROSSINGS_BIN;
    case MLIM_BAD_SHEET:
      return SHEET_BIN;
    case MLIM_BAD_DISK:
      return DISK_BIN;
    case MLIM_BAD_SIZE:
    case MLIM_BAD_DISTANCE:
      return QUALITY_FIRST + clamp(2 * log2(excess), QUALITY_COUNT);
    case MLIM_BAD_RATIO:
      return RATIO_FIRST + clamp((excess - 1) * (RATIO_COUNT / 2), RATIO_COUNT);
    case MLIM_BAD_NONE:
      break;
  }
  return -1;
}

mlim_badness mlim_queue_badness_of(int bin)
{
  return bin == FAR_BIN         ? MLIM_BAD_FAR
         : bin == CROSSINGS_BIN ? MLIM_BAD_CROSSINGS
         : bin == SHEET_BIN     ? MLIM_BAD_SHEET
         : bin == DISK_BIN      ? MLIM_BAD_DISK
         : bin >= QUALITY_FIRST ? MLIM_BAD_SIZE
                                : MLIM_BAD_RATIO;
}

/* Spreads 20 bits to every third place. */
static uint64_t spread(uint64_t x)
{
  x = (x | x << 32) & 0x1f00000000ffffu;
  x = (x | x << 16) & 0x1f0000ff0000ffu;
  x = (x | x << 8) & 0x100f00f00f00f00fu;
  x = (x | x << 4) & 0x10c30c30c30c30c3u;
  return (x | x << 2) & 0x1249249249249249u;
}

uint64_t mlim_queue_place(const mlim_queue* queue, const double point[3])
{
  uint64_t place = 0;
  for (int k = 0; k < 3; ++k)
  {
    place |= spread((uint64_t)clamp(point[k] * queue->scale, 1 << MORTON_BITS)) << k;
  }
  return place;
}

static int compare_placed(const void* a, const void* b)
{
  const mlim_placed* x = (const mlim_placed*)a;
  const mlim_placed* y = (const mlim_placed*)b;
  if (x->place != y->place)
  {
    return x->place < y->place ? -1 : 1;
  }
  return (x->id > y->id) - (x->id < y->id);
}

void mlim_queue_sort(mlim_placed* things, size_t count)
{
  if (count > 1)
  {
    qsort(things, count, sizeof *things, compare_placed);
  }
}

int mlim_queue_push_at(
  mlim_queue* queue, int bin, const double point[3], int32_t record, uint32_t generation)
{
  mlim_queue_bin* b = &queue->bins[bin];
  if (mlim_reserve_apart(&b->entries, &b->capacity, b->count + 1, sizeof *b->entries))
  {
    return 1;
  }
  b->entries[b->count++] = (mlim_queue_entry){
    .place = mlim_queue_place(queue, point), .record = record, .generation = generation
  };
  return 0;
}

int mlim_queue_push(mlim_queue* queue, int bin, const mlim_complex* complex, int32_t record)
{
  const mlim_facet* facet = &complex->facets[record];
  return mlim_queue_push_at(queue, bin, facet->crossing, record, facet->generation);
}

static int compare_entries(const void* a, const void* b)
{
  const mlim_queue_entry* x = (const mlim_queue_entry*)a;
  const mlim_queue_entry* y = (const mlim_queue_entry*)b;
  if (x->place != y->place)
  {
    return x->place < y->place ? -1 : 1;
  }
  if (x->record != y->record)
  {
    return x->record < y->record ? -1 : 1;
  }
  return x->generation < y->generation ? -1 : x->generation > y->generation;
}

static size_t digit_of(const mlim_queue_entry* entry, int shift)
{
  return entry->place >> shift & ((1u << DIGIT) - 1);
}

static void sort_by_digit(
  const mlim_queue_entry* entries, size_t count, int shift, mlim_queue_entry* out)
{
  size_t places[(1 << DIGIT) + 1] = { 0 };
  for (size_t k = 0; k < count; ++k)
  {
    ++places[digit_of(&entries[k], shift) + 1];
  }
  for (size_t d = 0; d < 1 << DIGIT; ++d)
  {
    places[d + 1] += places[d];
  }
  for (size_t k = 0; k < count; ++k)
  {
    out[places[digit_of(&entries[k], shift)]++] = entries[k];
  }
}

/* Entries at the same place, which are few. */
static void sort_equals(mlim_queue_entry* entries, size_t count)
{
  for (size_t first = 0, end; first < count; first = end)
  {
    for (end = first + 1; end < count && entries[end].place == entries[first].place;)
    {
      ++end;
    }
    if (end - first > 1)
    {
      qsort(entries + first, end - first, sizeof *entries, compare_entries);
    }
  }
}

static void sort_entries(mlim_queue_entry* entries, size_t count)
{
  mlim_queue_entry* other = count > FEW ? mlim_allocate(count, sizeof *other) : NULL;
  if (other == NULL)
  {
    qsort(entries, count, sizeof *entries, compare_entries);
    return;
  }
  /* An even number of passes: what is sorted ends where it was. */
  for (int shift = 0; shift < 3 * MORTON_BITS; shift += 2 * DIGIT)
  {
    sort_by_digit(entries, count, shift, other);
    sort_by_digit(other, count, shift + DIGIT, entries);
  }
  mlim_release(other);
  sort_equals(entries, count);
}

int mlim_queue_next(mlim_queue* queue)
{
  for (int b = MLIM_QUEUE_BINS - 1; b >= 0; --b)
  {
    if (queue->bins[b].count > 0)
    {
      const mlim_queue_bin full = queue->bins[b];
      queue->bins[b] = queue->batch;
      queue->bins[b].count = 0;
      queue->batch = full;
      sort_entries(queue->batch.entries, queue->batch.count);
      return b;
    }
  }
  queue->batch.count = 0;
  return -1;
}
