/* The labels that can be candidates in the cells of a brick, with their values at its 5 x 5 x 5 grid
   points: each value is read once for all cells, and labels that matter elsewhere are not read at all.
   Private to the files that build the field. */
#ifndef mlim_field_brick_h
#define mlim_field_brick_h

#include "field_index.h"
#include "peaks.h"
#include "plateau.h"

/* What the field is made from, once the winners at the grid points are known. */
typedef struct mlim_field_source
{
  const mlim_samples* samples;
  const mlim_field* field;
  const mlim_plateau* plateau;
  const mlim_peaks* peaks; /* empty with indicators */
} mlim_field_source;

enum
{
  BRICK_SIDE = BRICK + 1, /* grid points */
  BRICK_POINTS = BRICK_SIDE * BRICK_SIDE * BRICK_SIDE
};

typedef struct mlim_field_brick
{
  size_t count;
  uint16_t* labels; /* ascending */
  size_t* at;       /* a label: where its BRICK_POINTS values are, bonuses of ties included */
  double* values;
  /* While it is read. */
  mlim_point_box box;
  size_t read_count, capacity; /* labels that are in `values`, for which it has room */
  int32_t tied_count;
  int32_t tied[BRICK_POINTS]; /* points where several labels tie */
  double* complement;         /* of a row of bricks: its values, x fastest, BRICK_SIDE^2 rows */
  int32_t complement_of[2];   /* that row's y and z; -1: none yet */
} mlim_field_brick;

/* Room for any brick of the source. MLIM_OUT_OF_MEMORY says nothing to the context. */
mlim_status mlim_field_brick_create(const mlim_field_source* source, mlim_field_brick* out);
void mlim_field_brick_free(mlim_field_brick* brick);

/* Reads a brick. Bit s of `mixed` stands for the cell in slot s; one is mixed at least. Not 0: out of
   memory. */
int mlim_field_brick_read(
  const mlim_field_source* source, const int32_t at[3], uint64_t mixed, mlim_field_brick* brick);

/* Index of a label among the brick's; -1: it is not there. */
int32_t mlim_field_brick_find(const mlim_field_brick* brick, int32_t label);

/* Values of the n-th label at the corners of a cell. */
void mlim_field_brick_corners(
  const mlim_field_brick* brick, size_t n, uint32_t slot, double out[8]);

#endif
