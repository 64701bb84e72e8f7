/* What was found, given to the cells and facets that are still there. */
#include "memory.h"
#include "records_parts.h"
#include "status.h"
#include "vector.h"

enum
{
  AHEAD = 8 /* things from the one at work to the one that is sent for */
};

/* Cells that died meanwhile have no use for a label. */
static void give_labels(const mlim_records* records, mlim_complex* complex)
{
  for (size_t k = 0; k < records->cell_count; ++k)
  {
    const mlim_new_cell* from = &records->cells[k];
    mlim_cell* cell = &complex->cells[from->id];
    if (k + AHEAD < records->cell_count)
    {
      mlim_prefetch(&complex->cells[from[AHEAD].id]);
    }
    if (cell->label == MLIM_RECORD_TAKEN - (int32_t)k)
    {
      cell->label = from->label;
      cell->clearance = from->clearance;
    }
  }
}

static int32_t new_record(mlim_complex* complex)
{
  if (complex->free_count > 0)
  {
    return complex->free_facets[--complex->free_count];
  }
  if (complex->facet_count >= INT32_MAX - 1 ||
      mlim_reserve_apart(&complex->facets, &complex->facet_capacity, complex->facet_count + 1,
        sizeof *complex->facets) ||
      mlim_reserve_apart(&complex->free_facets, &complex->free_capacity, complex->facet_capacity,
        sizeof *complex->free_facets))
  {
    return 0;
  }
  complex->facets[complex->facet_count] = (mlim_facet){ 0 };
  return (int32_t)complex->facet_count++;
}

/* A facet as its side tells it that is there. */
typedef struct place
{
  mlim_cell *cell, *other;
  int32_t id;
  int index, index_beyond;
} place;

/* From a cell of a dual that is still the one that it was: what was made since has no label. Its other one may be
   gone, the dual shorter. 0: both are gone. */
static int find_place(const mlim_complex* complex, const mlim_dual* dual, place* out)
{
  for (int end = 0; end < 2; ++end)
  {
    const int32_t id = dual->cells[end];
    mlim_cell* cell = &complex->cells[id];
    if (cell->vertices[0] < 0 || cell->label < 0)
    {
      continue;
    }
    int index = dual->index;
    if (end == 1)
    {
      const int32_t* v = dual->vertices;
      for (index = 0; index < 3; ++index)
      {
        const int32_t at = cell->vertices[index];
        if (at != v[0] && at != v[1] && at != v[2])
        {
          break;
        }
      }
    }
    mlim_cell* other = &complex->cells[cell->neighbors[index]];
    *out = (place){ .cell = cell,
      .other = other,
      .id = id,
      .index = index,
      .index_beyond = mlim_complex_index_apart(other, cell) };
    return 1;
  }
  return 0;
}

static void set_record(const place* at, int32_t record)
{
  at->cell->facets[at->index] = record;
  at->other->facets[at->index_beyond] = record;
}

/* Returns 1 when out of memory. */
static int add_record(mlim_complex* complex, mlim_dual* dual, const place* at)
{
  const int32_t record = new_record(complex);
  if (record == 0)
  {
    return 1;
  }
  mlim_facet* facet = &complex->facets[record];
  const uint32_t generation = facet->generation;
  *facet = (mlim_facet){ .sheet = dual->sheet,
    .cell = at->id,
    .generation = generation,
    .index = (unsigned)at->index & 3,
    .is_alive = 1,
    .is_multiple = dual->is_multiple };
  mlim_copy(dual->crossing, facet->crossing);
  set_record(at, record);
  dual->record = record;
  return 0;
}

/* Returns 1 when out of memory. */
static int settle_dual(mlim_complex* complex, mlim_dual* dual)
{
  place at;
  if (!find_place(complex, dual, &at))
  {
    return 0;
  }
  mlim_complex_touch_facet(complex, at.id, at.index);
  if (dual->stale > 0)
  {
    set_record(&at, 0);
    mlim_complex_kill_record(complex, dual->stale);
  }
  return dual->crosses && add_record(complex, dual, &at);
}

mlim_status mlim_records_settle(mlim_records* records, mlim_complex* complex, mlim_context* context)
{
  int has_failed = 0;
  if (!records->is_pending)
  {
    return MLIM_OK;
  }
  give_labels(records, complex);
  for (size_t p = 0; p < records->part_count && !has_failed; ++p)
  {
    const mlim_duals duals = mlim_records_duals(records, p);
    for (size_t k = 0; k < duals.count && !has_failed; ++k)
    {
      if (k + AHEAD < duals.count)
      {
        mlim_prefetch(&complex->cells[duals.all[k + AHEAD].cells[0]]);
        mlim_prefetch(&complex->cells[duals.all[k + AHEAD].cells[1]]);
      }
      has_failed = settle_dual(complex, &duals.all[k]);
    }
  }
  records->is_pending = 0;
  return has_failed ? mlim_fail_memory(context, "the restricted facets") : MLIM_OK;
}
