/* A copy of the new cells and of what is round them. */
#include "memory.h"
#include "records_parts.h"
#include "status.h"
#include "vector.h"

#include <string.h>

enum
{
  PARTS = 12, /* of what threads that are awake look at, */
  PART = 32   /* and cells of such a part at least */
};

/* Room for all of `made` is there. A cell that was made since has MLIM_NO_LABEL once: what is dead, or there
   twice, is passed over. */
static void take_cells(
  mlim_records* records, mlim_complex* complex, const int32_t* made, size_t count)
{
  size_t taken = 0;
  for (size_t k = 0; k < count; ++k)
  {
    mlim_cell* cell = &complex->cells[made[k]];
    if (cell->vertices[0] >= 0 && cell->label == MLIM_NO_LABEL)
    {
      cell->label = MLIM_RECORD_TAKEN - (int32_t)taken;
      records->cells[taken++].id = made[k];
    }
  }
  records->cell_count = taken;
}

/* Its place among the old cells is that of the facet, so that many can be taken down beside each other. */
static int32_t take_beyond(
  mlim_records* records, const mlim_complex* complex, int32_t id, size_t k, int index)
{
  if (id == MLIM_NO_CELL)
  {
    return INT32_MAX;
  }
  const mlim_cell* cell = &complex->cells[id];
  if (cell->label <= MLIM_RECORD_TAKEN)
  {
    const int32_t place = MLIM_RECORD_TAKEN - cell->label;
    return place > (int32_t)k ? place : INT32_MAX;
  }
  const size_t at = MLIM_RECORD_FACETS * k + (size_t)index;
  mlim_old_cell* out = &records->old_cells[at];
  mlim_copy(mlim_complex_center(complex, id), out->center);
  out->id = id;
  out->label = cell->label;
  out->clearance = cell->clearance;
  return -1 - (int32_t)at;
}

static void take_around(mlim_records* records, const mlim_complex* complex, size_t k)
{
  mlim_new_cell* out = &records->cells[k];
  const mlim_cell* cell = &complex->cells[out->id];
  mlim_copy(mlim_complex_center(complex, out->id), out->center);
  memcpy(out->vertices, cell->vertices, sizeof out->vertices);
  memcpy(out->facets, cell->facets, sizeof out->facets);
  for (int i = 0; i < MLIM_RECORD_FACETS; ++i)
  {
    out->beyond[i] = take_beyond(records, complex, cell->neighbors[i], k, i);
  }
}

static int reserve(mlim_records* records, size_t count)
{
  return mlim_reserve(&records->duals, &records->dual_capacity, MLIM_RECORD_FACETS * count,
           sizeof *records->duals) ||
         mlim_reserve(&records->old_cells, &records->old_capacity, MLIM_RECORD_FACETS * count,
           sizeof *records->old_cells);
}

void mlim_records_take_part(void* data, size_t part)
{
  mlim_records* records = (mlim_records*)data;
  for (size_t k = mlim_records_begin_of(records, part);
       k < mlim_records_begin_of(records, part + 1); ++k)
  {
    take_around(records, records->complex, k);
  }
}

mlim_status mlim_records_take_down(mlim_records* records, mlim_complex* complex,
  const int32_t* made, size_t count, mlim_context* context)
{
  int has_failed =
    mlim_reserve(&records->cells, &records->cell_capacity, count, sizeof *records->cells);
  if (!has_failed)
  {
    take_cells(records, complex, made, count);
    has_failed = reserve(records, records->cell_count);
  }
  records->is_pending = !has_failed && records->cell_count > 0;
  records->complex = complex;
  records->oracle = &complex->oracle;
  records->vertices = complex->vertices;
  records->facets = complex->facets;
  return has_failed ? mlim_fail_memory(context, "the restricted facets") : MLIM_OK;
}

mlim_status mlim_records_take(
  mlim_records* records, mlim_complex* complex, mlim_team* team, mlim_context* context)
{
  const mlim_status status =
    mlim_records_take_down(records, complex, complex->made, complex->made_count, context);
  const size_t most = mlim_team_is_alone(team) ? 1 : PARTS;
  const size_t parts = 1 + records->cell_count / PART;
  complex->made_count = 0;
  if (status == MLIM_OK)
  {
    records->part_count = parts < most ? parts : most;
    mlim_team_offer(team, &(mlim_team_work){ .body = mlim_records_take_part,
                            .job = records,
                            .count = records->part_count,
                            .second = records->part_count });
    mlim_team_finish(team);
  }
  return status;
}
