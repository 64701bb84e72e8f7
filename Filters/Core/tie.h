/* The tie of labels inside one cell: values, gradients, and the nearest point of the tie. */
#ifndef mlim_tie_h
#define mlim_tie_h

#include <stddef.h>
#include <stdint.h>

/* A cell's labels and their values at its 8 corners; borrowed. Points are in the unit cube. */
typedef struct mlim_tie_cell
{
  size_t count;
  const int32_t* labels; /* ascending */
  const double* values;  /* 8 per label */
  double spacing[3];
} mlim_tie_cell;

double mlim_tie_value(const double values[8], const double at[3]);

/* Moves the point towards the tie of those of the set's labels that the cell has, on the shortest
   way in space; where they do not all tie, to the least squares of their differences. An axis with
   is_fixed keeps its coordinate. Returns the length of the first step, in units of length: about
   the distance from the tie. */
double mlim_tie_project(const mlim_tie_cell* cell, const int32_t* labels, size_t label_count,
  const unsigned char is_fixed[3], double at[3]);

#endif
