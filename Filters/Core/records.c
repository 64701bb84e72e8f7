#include "records.h"

#include "memory.h"
#include "records_parts.h"
#include "status.h"

enum
{
  BATCH = 4096, /* cells taken down at a time when all are brought up to date, about 3 ms */
  FEW = 256     /* cells that are not worth waking a thread for */
};

void mlim_records_free(mlim_records* records)
{
  mlim_release(records->cells);
  mlim_release(records->old_cells);
  mlim_release(records->duals);
  *records = (mlim_records){ 0 };
}

static void take_body(void* data, size_t begin, size_t end)
{
  for (size_t part = begin; part < end; ++part)
  {
    mlim_records_take_part(data, part);
  }
}

static void look_body(void* data, size_t begin, size_t end)
{
  mlim_records* records = (mlim_records*)data;
  mlim_records_label(records, begin, end);
  mlim_records_look(records, begin, end, end);
}

/* Returns 1 when out of memory. */
static int list_fresh(const mlim_records* records, mlim_complex* complex)
{
  for (size_t p = 0; p < records->part_count; ++p)
  {
    const mlim_duals duals = mlim_records_duals(records, p);
    if (mlim_reserve_apart(&complex->fresh, &complex->fresh_capacity,
          complex->fresh_count + duals.count, sizeof *complex->fresh))
    {
      return 1;
    }
    for (size_t k = 0; k < duals.count; ++k)
    {
      complex->fresh[complex->fresh_count] = duals.all[k].record;
      complex->fresh_count += duals.all[k].record > 0;
    }
  }
  return 0;
}

static mlim_status update_some(mlim_records* records, mlim_complex* complex, const int32_t* made,
  size_t count, mlim_context* context)
{
  mlim_context* host = count > FEW ? context : NULL;
  mlim_status status = mlim_records_take_down(records, complex, made, count, context);
  if (status != MLIM_OK)
  {
    return status;
  }
  records->part_count = host != NULL ? MLIM_RECORD_PARTS : 1;
  mlim_parallel_for(host, records->part_count, take_body, records);
  mlim_parallel_for(host, records->part_count, look_body, records);
  status = mlim_records_settle(records, complex, context);
  return status == MLIM_OK && list_fresh(records, complex)
           ? mlim_fail_memory(context, "the restricted facets")
           : status;
}

mlim_status mlim_records_update(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context)
{
  mlim_status status = mlim_progress(context, MLIM_STAGE_SURFACE, done);
  for (size_t k = 0; k < complex->made_count && status == MLIM_OK; k += BATCH)
  {
    const size_t left = complex->made_count - k;
    status = update_some(records, complex, complex->made + k, left < BATCH ? left : BATCH, context);
    status = status == MLIM_OK ? mlim_progress(context, MLIM_STAGE_SURFACE, done) : status;
  }
  complex->made_count = 0;
  return status;
}

int mlim_records_hold(const mlim_complex* complex, const mlim_facet* facet)
{
  const mlim_cell* cell = &complex->cells[facet->cell];
  const int32_t sides[2] = { facet->cell, cell->neighbors[facet->index] };
  int32_t labels[2];
  int is_new = 0;
  for (int k = 0; k < 2; ++k)
  {
    const int32_t known = complex->cells[sides[k]].label;
    is_new |= known < 0;
    labels[k] = known >= 0
                  ? known
                  : mlim_field_label(complex->oracle.field, mlim_complex_center(complex, sides[k]));
  }
  return !is_new || mlim_records_match(facet, labels[0], labels[1]);
}
