#include "label_sets.h"
#include "memory.h"

#include <assert.h>
#include <string.h>

enum
{
  FIRST_SLOT_COUNT = 64 /* power of two; small, since every layer of cells has a table */
};

void mlim_sets_free(mlim_sets* sets)
{
  mlim_release(sets->offsets);
  mlim_release(sets->labels);
  *sets = (mlim_sets){ 0 };
}

void mlim_set_table_free(mlim_set_table* table)
{
  mlim_sets_free(&table->sets);
  mlim_release(table->slots);
  *table = (mlim_set_table){ 0 };
}

const int32_t* mlim_set_labels(const mlim_sets* sets, int32_t set, size_t* count)
{
  assert(set >= 0 && (size_t)set < sets->count);
  *count = sets->offsets[set + 1] - sets->offsets[set];
  return sets->labels + sets->offsets[set];
}

/* FNV-1a over the codes. */
static size_t hash_labels(const int32_t* labels, size_t count)
{
  uint64_t hash = 14695981039346656037u;
  for (size_t i = 0; i < count; ++i)
  {
    hash = (hash ^ (uint64_t)(uint32_t)labels[i]) * 1099511628211u;
  }
  return (size_t)(hash ^ (hash >> 29));
}

/* The slot of a set: its own or the free one where it belongs. */
static size_t find_slot(const mlim_set_table* table, const int32_t* labels, size_t count)
{
  size_t slot = hash_labels(labels, count) & (table->slot_count - 1);
  for (; table->slots[slot] >= 0; slot = (slot + 1) & (table->slot_count - 1))
  {
    size_t other_count;
    const int32_t* other = mlim_set_labels(&table->sets, table->slots[slot], &other_count);
    if (other_count == count && (!count || !memcmp(other, labels, count * sizeof(*labels))))
    {
      break;
    }
  }
  return slot;
}

static mlim_status grow_slots(mlim_set_table* table)
{
  const size_t slot_count = table->slot_count ? 2 * table->slot_count : FIRST_SLOT_COUNT;
  int32_t* slots = mlim_allocate(slot_count, sizeof(*slots));
  if (!slots)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  mlim_release(table->slots);
  table->slots = slots;
  table->slot_count = slot_count;
  memset(slots, -1, slot_count * sizeof(*slots));
  for (size_t s = 0; s < table->sets.count; ++s)
  {
    size_t count;
    const int32_t* labels = mlim_set_labels(&table->sets, (int32_t)s, &count);
    slots[find_slot(table, labels, count)] = (int32_t)s;
  }
  return MLIM_OK;
}

/* Room for one more set of at most `count` codes behind the last one. */
static mlim_status make_room(mlim_set_table* table, size_t count)
{
  mlim_sets* sets = &table->sets;
  const int is_first = !sets->offsets;
  if (mlim_reserve(&sets->offsets, &table->offset_capacity, sets->count + 2, sizeof(size_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  if (is_first)
  {
    sets->offsets[0] = 0;
  }
  const size_t end = sets->offsets[sets->count] + count + 1;
  if (mlim_reserve(&sets->labels, &table->label_capacity, end, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  return 2 * (sets->count + 1) > table->slot_count ? grow_slots(table) : MLIM_OK;
}

/* Interns the `count` ascending codes that stand behind the last set. */
static int32_t intern(mlim_set_table* table, size_t count)
{
  mlim_sets* sets = &table->sets;
  const size_t begin = sets->offsets[sets->count];
  const size_t slot = find_slot(table, sets->labels + begin, count);
  if (table->slots[slot] < 0)
  {
    table->slots[slot] = (int32_t)sets->count;
    ++sets->count;
    sets->offsets[sets->count] = begin + count;
  }
  return table->slots[slot];
}

mlim_status mlim_set_table_add(
  mlim_set_table* table, const int32_t* labels, size_t count, int32_t* out)
{
  const mlim_status status = make_room(table, count);
  if (status)
  {
    return status;
  }
  int32_t* set = table->sets.labels + table->sets.offsets[table->sets.count];
  size_t size = 0;
  for (size_t i = 0; i < count; ++i)
  {
    size_t at = size;
    while (at > 0 && set[at - 1] >= labels[i])
    {
      --at;
    }
    if (at == size || set[at] != labels[i])
    {
      memmove(set + at + 1, set + at, (size - at) * sizeof(*set));
      set[at] = labels[i];
      ++size;
    }
  }
  *out = intern(table, size);
  return MLIM_OK;
}

typedef enum combination
{
  UNION,
  INTERSECTION
} combination;

static mlim_status combine(
  mlim_set_table* table, int32_t a, int32_t b, combination how, int32_t* out)
{
  if (a == b)
  {
    *out = a;
    return MLIM_OK;
  }
  size_t counts[2];
  mlim_set_labels(&table->sets, a, &counts[0]);
  mlim_set_labels(&table->sets, b, &counts[1]);
  const mlim_status status = make_room(table, counts[0] + counts[1]);
  if (status)
  {
    return status;
  }
  const int32_t* from[2] = { mlim_set_labels(&table->sets, a, &counts[0]),
    mlim_set_labels(&table->sets, b, &counts[1]) };
  int32_t* set = table->sets.labels + table->sets.offsets[table->sets.count];
  size_t size = 0;
  for (size_t i = 0, j = 0; i < counts[0] || j < counts[1];)
  {
    const int has_a = i < counts[0] && (j == counts[1] || from[0][i] <= from[1][j]);
    const int has_b = j < counts[1] && (i == counts[0] || from[1][j] <= from[0][i]);
    if (how == UNION || (has_a && has_b))
    {
      set[size] = has_a ? from[0][i] : from[1][j];
      ++size;
    }
    i += has_a ? 1 : 0;
    j += has_b ? 1 : 0;
  }
  *out = intern(table, size);
  return MLIM_OK;
}

mlim_status mlim_set_table_join(mlim_set_table* table, int32_t a, int32_t b, int32_t* out)
{
  return combine(table, a, b, UNION, out);
}

mlim_status mlim_set_table_common(mlim_set_table* table, int32_t a, int32_t b, int32_t* out)
{
  return combine(table, a, b, INTERSECTION, out);
}

mlim_status mlim_sets_compact(const mlim_sets* sets, int32_t* use, mlim_sets* out)
{
  size_t set_count = 0;
  size_t label_count = 0;
  for (size_t s = 0; s < sets->count; ++s)
  {
    if (use[s])
    {
      ++set_count;
      label_count += sets->offsets[s + 1] - sets->offsets[s];
    }
  }
  mlim_sets copy = { .offsets = mlim_allocate(set_count + 1, sizeof(size_t)),
    .labels = mlim_allocate(label_count, sizeof(int32_t)) };
  if (!copy.offsets || !copy.labels)
  {
    mlim_sets_free(&copy);
    return MLIM_OUT_OF_MEMORY;
  }
  copy.offsets[0] = 0;
  for (size_t s = 0; s < sets->count; ++s)
  {
    if (use[s])
    {
      const size_t count = sets->offsets[s + 1] - sets->offsets[s];
      const size_t begin = copy.offsets[copy.count];
      memcpy(copy.labels + begin, sets->labels + sets->offsets[s], count * sizeof(int32_t));
      ++copy.count;
      copy.offsets[copy.count] = begin + count;
      use[s] = (int32_t)copy.count;
    }
  }
  *out = copy;
  return MLIM_OK;
}

mlim_status mlim_sets_copy(const mlim_sets* sets, mlim_sets* out)
{
  int32_t* use = mlim_allocate(sets->count, sizeof(int32_t));
  mlim_status status = MLIM_OUT_OF_MEMORY;
  if (use)
  {
    for (size_t s = 0; s < sets->count; ++s)
    {
      use[s] = 1;
    }
    status = mlim_sets_compact(sets, use, out);
  }
  mlim_release(use);
  return status;
}
