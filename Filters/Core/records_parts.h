/* What the files of mlim_records share. */
#ifndef mlim_records_parts_h
#define mlim_records_parts_h

#include "records.h"

enum
{
  MLIM_RECORD_FACETS = 4, /* of a cell */
  MLIM_RECORD_TAKEN = -2  /* label of the first cell taken down; those of others follow below */
};

static inline size_t mlim_records_begin_of(const mlim_records* records, size_t part)
{
  return records->cell_count * part / records->part_count;
}

/* A single crossing of the sheet between the two labels is on the dual as long as its ends have them. */
static inline int mlim_records_match(const mlim_facet* facet, int32_t a, int32_t b)
{
  const int32_t low = a < b ? a : b;
  const int32_t high = a < b ? b : a;
  return (!facet->is_multiple) & (low != high) & (facet->sheet.low == low) &
         (facet->sheet.high == high);
}

/* Takes down those of `made` that are still there, and makes room for what is round them; then parts of them, once
   their number is set, by any threads. */
mlim_status mlim_records_take_down(mlim_records* records, mlim_complex* complex,
  const int32_t* made, size_t count, mlim_context* context);
void mlim_records_take_part(void* records, size_t part);

#endif
