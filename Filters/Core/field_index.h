/* What the field's index holds. Private to the files that build and query it.

   Cells lie in bricks of 4 x 4 x 4. A brick whose cells are all uniform with one label needs one
   word; any other has a word for each of its cells. A mixed cell's word leads into a pool with the
   corner values of its candidates. Pools and cell words belong to a layer of bricks (4 slices of
   cells), so that layers can be built in parallel and need not be moved afterwards. */
#ifndef mlim_field_index_h
#define mlim_field_index_h

#include "field.h"
#include "memory.h"

#include <string.h>

enum
{
  BRICK = 4,               /* cells along a brick's side */
  BRICK_CELLS = 64,        /* BRICK^3 */
  MAX_CLEARANCE = 255,     /* in cells */
  MIXED = (int)0x80000000, /* word: the low 30 bits lead to the detail */
  MANY = 0x40000000,       /* mixed cell word: more than two candidates */
  DETAIL = 0x3fffffff,     /* the low 30 bits */
  PAIR_WORDS = 1 + 8       /* two labels in one word, 8 differences */
};

typedef struct field_layer
{
  uint32_t* words; /* BRICK_CELLS for each brick that is not uniform */
  size_t brick_count, brick_capacity;
  uint32_t* pool; /* PAIR: first label | second label << 16, then 8 floats f_first - f_second.
                     MANY: count, labels (one a word), then 8 floats a label */
  size_t pool_count, pool_capacity;
  size_t max_candidates;
  uint16_t* list; /* while it is built: the labels at hand */
  int has_failed; /* out of memory, or the pool is too large for its index */
} field_layer;

struct mlim_field
{
  mlim_field_grid grid;
  int32_t label_count; /* with the outside */
  int32_t outside_label;
  int32_t* ids;      /* a label */
  uint16_t* winners; /* a grid point: its label */
  int32_t bricks[3];
  uint32_t*
    coarse; /* a brick: label | least clearance of its cells << 16, or MIXED | brick in its layer */
  uint8_t*
    clearances; /* a cell, brick after brick: in cells, how far it is to a mixed one along the farthest
                          axis; 0 if it is. What a walk needs of one brick is in one line of the cache */
  field_layer* layers;
  size_t layer_count;
  size_t max_candidates;
};

/* The brick that holds a cell. */
static inline size_t field_brick_of(const mlim_field* field, const int32_t cell[3])
{
  const int32_t* bricks = field->bricks;
  return (size_t)(cell[0] >> 2) +
         (size_t)bricks[0] * ((size_t)(cell[1] >> 2) + (size_t)bricks[1] * (size_t)(cell[2] >> 2));
}

/* A cell's place in its brick. */
static inline size_t field_slot_of(const int32_t cell[3])
{
  return (size_t)(cell[0] & 3) | (size_t)(cell[1] & 3) << 2 | (size_t)(cell[2] & 3) << 4;
}

/* All cells within so many in each direction, less one, are uniform with the label of this one or outside the
   box. 0 when it is mixed. */
static inline int field_clearance(const mlim_field* field, const int32_t cell[3])
{
  return field->clearances[BRICK_CELLS * field_brick_of(field, cell) + field_slot_of(cell)];
}

/* Word of a cell: its label when it is uniform. */
static inline uint32_t field_cell_word(const mlim_field* field, const int32_t cell[3])
{
  const uint32_t word = field->coarse[field_brick_of(field, cell)];
  return word & (uint32_t)MIXED
           ? field->layers[cell[2] >> 2].words[(word & DETAIL) * BRICK_CELLS + field_slot_of(cell)]
           : word;
}

/* Asks for the word, and once that is there for what it leads to, before they are read. */
static inline void field_word_ahead(const mlim_field* field, const int32_t cell[3])
{
  const uint32_t brick =
    field->coarse[(size_t)(cell[0] >> 2) +
                  (size_t)field->bricks[0] *
                    ((size_t)(cell[1] >> 2) + (size_t)field->bricks[1] * (size_t)(cell[2] >> 2))];
  if (brick & (uint32_t)MIXED)
  {
    const size_t slot =
      (size_t)(cell[0] & 3) | (size_t)(cell[1] & 3) << 2 | (size_t)(cell[2] & 3) << 4;
    mlim_prefetch(&field->layers[cell[2] >> 2].words[(brick & DETAIL) * BRICK_CELLS + slot]);
  }
}

/* The pool entry of a mixed cell. */
static inline const uint32_t* field_pool_entry(
  const mlim_field* field, const int32_t cell[3], uint32_t word)
{
  return field->layers[cell[2] >> 2].pool + (word & DETAIL);
}

static inline void field_entry_ahead(const mlim_field* field, const int32_t cell[3])
{
  const uint32_t word = field_cell_word(field, cell);
  if (word & (uint32_t)MIXED)
  {
    const uint32_t* entry = field_pool_entry(field, cell, word);
    mlim_prefetch(entry);
    mlim_prefetch(entry + PAIR_WORDS - 1);
  }
}

/* Label at a place in a mixed cell, in its own coordinates from 0 to 1. */
int32_t field_mixed_label(const uint32_t* entry, uint32_t word, const double at[3]);

static inline float field_float(uint32_t word)
{
  float value;
  memcpy(&value, &word, sizeof value);
  return value;
}

#endif
