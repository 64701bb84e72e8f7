/* The facets between two labels of a complex to which nothing is added any more. To find them is to look
   at every cell and its neighbours, which costs more than what is then done with them. */
#ifndef mlim_boundary_h
#define mlim_boundary_h

#include "complex.h"

enum
{
  MLIM_SIDES = 15,     /* bit k: facet k of the cell lies between two labels */
  MLIM_FIRST_SHIFT = 4 /* bit 4 + k: it does, and this is its cell of the lower id */
};

typedef struct mlim_boundary
{
  unsigned char* sides; /* a byte a cell id; 0: none, or no cell */
  size_t cell_count;
} mlim_boundary;

/* `done` is reported as the share of the certificate's stage. */
mlim_status mlim_boundary_find(
  const mlim_complex* complex, double done, mlim_context* context, mlim_boundary* out);
void mlim_boundary_free(mlim_boundary* boundary);

/* A cell's label has changed. */
void mlim_boundary_update(mlim_boundary* boundary, const mlim_complex* complex, int32_t cell);

/* Cells have come and gone: there is room for the new ones, and none that is dead has sides. Those of the new
   ones are for mlim_boundary_update to find. */
mlim_status mlim_boundary_follow(
  mlim_boundary* boundary, const mlim_complex* complex, mlim_context* context);

/* How many facets there are. */
size_t mlim_boundary_count(const mlim_boundary* boundary);

/* A facet: `index` of a cell, that of the lower id. */
typedef struct mlim_boundary_facet
{
  int32_t cell;
  int32_t index;
} mlim_boundary_facet;

/* Lists them all, ascending by cell and index. */
void mlim_boundary_list(const mlim_boundary* boundary, mlim_boundary_facet* out);

#endif
