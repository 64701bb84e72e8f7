/* The pieces between samples along the curves, and which of them are near a place. */
#ifndef mlim_pieces_h
#define mlim_pieces_h

#include "point_grid.h"

enum
{
  MLIM_MAX_NEAR_PIECES = 2048,
  MLIM_MAX_PIECE_LEVELS = 6
};

/* Where the samples are: piece s goes from sample s to the next one of its curve. */
typedef struct mlim_piece_source
{
  const double* points;  /* 3 a sample */
  const size_t* offsets; /* a curve's first sample; one more at the end */
  size_t curve_count;
  double step;  /* longest piece */
  double reach; /* of a search */
} mlim_piece_source;

/* All of them, in a grid by their first samples. */
typedef struct mlim_piece_level
{
  mlim_point_grid grid;
  double reach; /* of a search in it */
} mlim_piece_level;

/* What is near is found in small cubes; those that reach farther have so many pieces where curves are dense that
   only who finds nothing near should look there. All 0 is a valid argument of _free. */
typedef struct mlim_pieces
{
  const double* points; /* borrowed */
  mlim_piece_level
    levels[MLIM_MAX_PIECE_LEVELS]; /* each reaches twice as far as the one before it */
  size_t level_count;
  int32_t* curves; /* of each piece */
  double step;
} mlim_pieces;

mlim_status mlim_pieces_create(const mlim_piece_source* source, mlim_pieces* out);
void mlim_pieces_free(mlim_pieces* pieces);

/* The pieces that a search from a place meets, in its order, with their first points. */
typedef struct mlim_piece_list
{
  int is_listed; /* 0 at first */
  mlim_point_range range;
  size_t count; /* one above the most: there are more */
  int32_t pieces[MLIM_MAX_NEAR_PIECES];
  double starts[MLIM_MAX_NEAR_PIECES][3];
} mlim_piece_list;

/* Brings the list of the first level, used before or not, to another place: mostly it stays what it was beside
   it. 0: the search meets more pieces than a list holds. */
int mlim_pieces_list(const mlim_pieces* pieces, const double point[3], mlim_piece_list* list);

#endif
