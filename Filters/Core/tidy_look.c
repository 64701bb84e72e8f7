#include "tidy_look.h"

#include "ahead.h"
#include "memory.h"
#include "sides.h"
#include "status.h"
#include "tidy_cell.h"

#include <string.h>

enum
{
  AHEAD = 64,        /* cells: one in five has a facet between labels */
  LOOK_EVERY = 65536 /* cells between two looks at the host: some milliseconds */
};

static const mlim_facet* record_of(const mlim_complex* complex, const mlim_cell* cell, int index)
{
  return &complex->facets[cell->facets[index]];
}

/* Verification has looked at nearly all facets already, and from as far unless a bound is tighter. Not to
   be asked once labels have changed: they may have changed sides. */
static int is_known_to_be_seen(const mlim_refinement* r, const mlim_cell* cell, int index)
{
  const mlim_complex* complex = &r->complex;
  const int32_t other = complex->cells[cell->neighbors[index]].label;
  const mlim_facet* facet = record_of(complex, cell, index);
  return facet->is_alive && facet->is_settled &&
         facet->sheet.low == (cell->label < other ? cell->label : other) &&
         facet->sheet.high == (cell->label < other ? other : cell->label) &&
         !(mlim_criteria_distance(complex, r->options, &facet->sheet) < r->options->facet_distance);
}

/* As the bits of facet 0. is_first_look: no label has changed yet. */
static unsigned look_at_facet(const mlim_refinement* r, int32_t id, int index, int is_first_look)
{
  const mlim_complex* complex = &r->complex;
  const mlim_cell* cell = &complex->cells[id];
  const int32_t other = complex->cells[cell->neighbors[index]].label;
  const int is_seen = is_first_look && is_known_to_be_seen(r, cell, index);
  /* The record is of the sheet between these labels: a good one has no vertex off it. */
  if (is_seen && mlim_complex_is_good(record_of(complex, cell, index)))
  {
    return 0;
  }
  const int is_stray = tidy_stray_count(complex, cell, index, cell->label, other) > 0;
  const int is_bad = tidy_is_misshapen(r, cell, index) ||
                     (!is_seen && !mlim_sides_are_seen(complex, id, index, cell->label, other,
                                    r->options->facet_distance));
  return (unsigned)is_stray | (unsigned)is_bad << TIDY_BAD_SHIFT;
}

/* What look_body reads of a cell's facets: the records and the cells beyond, or the vertices where the
   records, which are there by then, do not say it all. */
static void ask_ahead(const tidy_looks* looks, size_t cell, int has_records)
{
  const mlim_complex* complex = &looks->refinement->complex;
  const unsigned sides = looks->boundary->sides[cell] >> MLIM_FIRST_SHIFT;
  for (int k = 0; sides >> k != 0; ++k)
  {
    if (!(sides >> k & 1u))
    {
      continue;
    }
    const mlim_facet* facet = record_of(complex, &complex->cells[cell], k);
    if (!has_records)
    {
      mlim_prefetch(facet);
      mlim_ahead_of_neighbor(complex, (int32_t)cell, k);
    }
    else if (!mlim_complex_is_good(facet))
    {
      mlim_ahead_of_vertices(complex, (int32_t)cell, k, 1);
    }
  }
}

static void ask_for_cell(const tidy_looks* looks, size_t cell)
{
  if (looks->boundary->sides[cell] >> MLIM_FIRST_SHIFT != 0)
  {
    mlim_prefetch(&looks->refinement->complex.cells[cell]);
    mlim_prefetch(&looks->refinement->complex.cells[cell].facets);
  }
}

/* Looks at each facet from its cell of the lower id. */
static void look_body(void* data, size_t begin, size_t end)
{
  const tidy_looks* looks = (const tidy_looks*)data;
  for (size_t c = begin; c < end; ++c)
  {
    const unsigned sides = looks->boundary->sides[c] >> MLIM_FIRST_SHIFT;
    unsigned bits = 0;
    if (c + 3 * AHEAD < end)
    {
      ask_for_cell(looks, c + 3 * AHEAD);
      ask_ahead(looks, c + 2 * AHEAD, 0);
      ask_ahead(looks, c + AHEAD, 1);
    }
    for (int k = 0; sides >> k != 0; ++k)
    {
      bits |= sides >> k & 1u ? look_at_facet(looks->refinement, (int32_t)c, k, 1) << k : 0;
    }
    looks->bits[c] = (unsigned char)bits;
  }
}

/* What is wrong with a facet, told to one of its cells. */
static void note(tidy_looks* looks, int32_t cell, int index, unsigned look)
{
  const unsigned mask = (1u | 1u << TIDY_BAD_SHIFT) << index;
  looks->bits[cell] = (unsigned char)((looks->bits[cell] & ~mask) | look << index);
}

static int index_of(const mlim_cell* cell, int32_t neighbor)
{
  int k = 0;
  while (k < 3 && cell->neighbors[k] != neighbor)
  {
    ++k;
  }
  return k;
}

/* The facets' cells of the higher ids are told too: there are few with something wrong. */
static void spread(tidy_looks* looks)
{
  const mlim_complex* complex = &looks->refinement->complex;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    for (int k = 0; k < 4 && looks->bits[c] != 0; ++k)
    {
      const unsigned look = looks->bits[c] >> k & (1u | 1u << TIDY_BAD_SHIFT);
      if (look != 0 && looks->boundary->sides[c] >> (MLIM_FIRST_SHIFT + k) & 1u)
      {
        const int32_t other = complex->cells[c].neighbors[k];
        note(looks, other, index_of(&complex->cells[other], (int32_t)c), look);
      }
    }
  }
}

mlim_status tidy_look_at_all(tidy_looks* looks, double done, mlim_context* context)
{
  const size_t count = looks->refinement->complex.cell_count;
  looks->bits = mlim_allocate(count, 1);
  if (looks->bits == NULL)
  {
    return mlim_fail_memory(context, "mending the topology");
  }
  const mlim_status status = mlim_parallel_stage(context, &(mlim_stage_work){ .count = count,
                                                            .body = look_body,
                                                            .job = looks,
                                                            .stage = MLIM_STAGE_CERTIFICATE,
                                                            .from = done,
                                                            .to = done,
                                                            .step = LOOK_EVERY });
  if (status == MLIM_OK)
  {
    spread(looks);
  }
  return status;
}

void tidy_look_again(tidy_looks* looks, int32_t id)
{
  const mlim_complex* complex = &looks->refinement->complex;
  const mlim_cell* cell = &complex->cells[id];
  mlim_boundary_update(looks->boundary, complex, id);
  for (int k = 0; k < 4; ++k)
  {
    const int32_t other = cell->neighbors[k];
    if (other == MLIM_NO_CELL)
    {
      continue;
    }
    const int back = index_of(&complex->cells[other], id);
    const unsigned look = cell->label == complex->cells[other].label ? 0
                          : id < other ? look_at_facet(looks->refinement, id, k, 0)
                                       : look_at_facet(looks->refinement, other, back, 0);
    note(looks, id, k, look);
    note(looks, other, back, look);
  }
}

/* Of cells that are between no labels any more. Byte by byte, so that compilers take many at a time. */
static void forget_inner(tidy_looks* looks, size_t count)
{
  unsigned char* restrict bits = looks->bits;
  const unsigned char* restrict sides = looks->boundary->sides;
  for (size_t c = 0; c < count; ++c)
  {
    bits[c] &= (unsigned char)-(sides[c] != 0);
  }
}

mlim_status tidy_look_at_cells(
  tidy_looks* looks, const int32_t* cells, size_t count, mlim_context* context)
{
  const mlim_complex* complex = &looks->refinement->complex;
  const size_t old = looks->boundary->cell_count;
  size_t capacity = old;
  if (mlim_reserve(&looks->bits, &capacity, complex->cell_count, 1))
  {
    return mlim_fail_memory(context, "mending the topology");
  }
  memset(looks->bits + old, 0, complex->cell_count - old);
  const mlim_status status = mlim_boundary_follow(looks->boundary, complex, context);
  forget_inner(looks, old);
  for (size_t k = 0; k < count && status == MLIM_OK; ++k)
  {
    tidy_look_again(looks, cells[k]);
  }
  return status;
}

size_t tidy_count_looked_strays(const tidy_looks* looks)
{
  size_t count = 0;
  for (size_t c = 0; c < looks->refinement->complex.cell_count; ++c)
  {
    unsigned bits = looks->bits[c] & TIDY_STRAYS & looks->boundary->sides[c] >> MLIM_FIRST_SHIFT;
    for (; bits != 0; bits &= bits - 1)
    {
      ++count;
    }
  }
  return count;
}
