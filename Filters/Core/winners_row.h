/* The inner loops over the arrays' values: a row of grid points, one array, numbers as narrow as they
   come. Private to the files that find the winners.

   Numbers of up to 16 bits are compared as int16_t, unsigned ones of 16 bits after a shift by 2^15, floats
   as floats, and all others as double. */
#ifndef mlim_winners_row_h
#define mlim_winners_row_h

#include "mlim.h"

typedef enum mlim_width
{
  MLIM_WIDTH_16,
  MLIM_WIDTH_16_SHIFTED,
  MLIM_WIDTH_FLOAT,
  MLIM_WIDTH_DOUBLE
} mlim_width;

/* The narrowest width that tells all values of all arrays apart. */
mlim_width mlim_width_of(const mlim_array* arrays, size_t count);

enum
{
  MLIM_ROW = 256 /* points at most */
};

/* Values of one width. */
typedef union mlim_row
{
  int16_t narrow[MLIM_ROW];
  float single[MLIM_ROW];
  double wide[MLIM_ROW];
} mlim_row;

/* One array at `count` points from `first` on. */
typedef struct mlim_row_work
{
  const mlim_array* array;
  mlim_width width;
  size_t first, count;
  uint16_t label;
  int is_first; /* of the arrays: there are no best values and no winners yet */
} mlim_row_work;

/* Where it goes; all of the work's width. */
typedef struct mlim_row_state
{
  void* best;        /* a point: the largest value so far */
  uint16_t* winners; /* a point: whose it is */
  mlim_row* low;     /* lowered to the values */
  mlim_row* peak;    /* raised to the values */
} mlim_row_state;

/* Not 0: a value is not finite. */
int mlim_row_win(const mlim_row_work* work, const mlim_row_state* state);

/* Bytes of a value. */
size_t mlim_width_size(mlim_width width);

/* All values of a row become the least there is, or the largest. */
void mlim_row_fill_least(mlim_width width, mlim_row* out);
void mlim_row_fill_largest(mlim_width width, mlim_row* out);

/* What `value` points to, a number of the width. */
double mlim_row_value(mlim_width width, const void* value);

#endif
