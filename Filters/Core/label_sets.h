/* Sets of label codes, interned: equal sets have equal numbers, so that comparing is comparing
   numbers. Codes from the label count on name faces of the box (mlim.h). */
#ifndef mlim_label_sets_h
#define mlim_label_sets_h

#include "status.h"

/* All 0 is an empty table. */
typedef struct mlim_set_table
{
  mlim_sets sets; /* owned; offsets is NULL while there is no set */
  size_t offset_capacity;
  size_t label_capacity;
  int32_t* slots; /* hash table of set numbers; -1: free */
  size_t slot_count;
} mlim_set_table;

void mlim_set_table_free(mlim_set_table* table);

/* Number of the set of `count` codes, in any order and with repetitions; 0 codes are allowed. */
mlim_status mlim_set_table_add(
  mlim_set_table* table, const int32_t* labels, size_t count, int32_t* out);

/* Number of the union of two sets of the table, and of their intersection. */
mlim_status mlim_set_table_join(mlim_set_table* table, int32_t a, int32_t b, int32_t* out);
mlim_status mlim_set_table_common(mlim_set_table* table, int32_t a, int32_t b, int32_t* out);

/* The codes of a set, ascending. Borrowed until the next call that adds. */
const int32_t* mlim_set_labels(const mlim_sets* sets, int32_t set, size_t* count);

/* A copy that owns its memory; only the sets with use[s] not 0, renumbered in order: on return
   use[s] is the new number plus 1. */
mlim_status mlim_sets_compact(const mlim_sets* sets, int32_t* use, mlim_sets* out);

mlim_status mlim_sets_copy(const mlim_sets* sets, mlim_sets* out);

void mlim_sets_free(mlim_sets* sets);

#endif
