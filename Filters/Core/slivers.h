/* Removal of slivers: the volume's cells are bettered one by one until none is below the bound, or
   none can be bettered. The surface's vertices and faces stay as they are. */
#ifndef mlim_slivers_h
#define mlim_slivers_h

#include "solid.h"

typedef struct mlim_slivers_result
{
  size_t sliver_count;   /* at first: cells with a dihedral angle below 10 or above 170 degrees */
  size_t exchange_count; /* steps that bettered one */
  size_t added_count;    /* vertices added */
  size_t left_count;     /* slivers that are left */
} mlim_slivers_result;

/* Reports progress of the volume's stage from `from` to `to`. */
mlim_status mlim_slivers_remove(mlim_solid* solid, size_t vertex_limit, double from, double to,
  mlim_context* context, mlim_slivers_result* out);

#endif
