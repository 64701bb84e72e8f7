/* One of several segments on their way through the grid. Private to the files of the exact oracle. */
#ifndef mlim_oracle_walk_h
#define mlim_oracle_walk_h

#include "field_index.h"
#include "oracle.h"

typedef struct mlim_walk
{
  const mlim_field* field;
  double start[3];     /* in cells */
  double direction[3]; /* from start to end, in cells */
  double inverse[3];   /* of the direction; infinite where that is 0 */
  double nudge;        /* 1e-9 of a cell, as part of the segment */
  double begin[3];     /* in lengths, for the result */
  double extent[3];
  double squared; /* of the length, in lengths */
  double tolerance;
  double t, last; /* where it is, and where nothing new comes any more */
  int32_t cell[3];
  int32_t label;         /* where the walk is; -1 before the first cell */
  int32_t last_label;    /* of a uniform cell at the end; -1: not known */
  int is_uniform;        /* the cell before this one was, or what is known of the start */
  int steps;             /* to go at most */
  const uint32_t* word;  /* of a mixed cell */
  const uint32_t* entry; /* of it */
  int32_t leaves;        /* through this face of the box, at `leave`; -1: it ends inside */
  double leave;
  size_t count, capacity;
  mlim_crossing* out;
} mlim_walk;

/* The label is `to` from t on; face: of the box, -1 inside. */
void mlim_walk_emit(mlim_walk* walk, double t, int32_t to, int32_t face);

/* Crosses the part from t to `exit`, all of it in one mixed cell, whose word and entry are at hand. */
void mlim_walk_cross(mlim_walk* walk, const int32_t cell[3], double t, double exit);

#endif
