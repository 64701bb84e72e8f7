/* What is seen beside facets, asked again and again for other labels. Private to tidying. */
#ifndef mlim_tidy_sides_h
#define mlim_tidy_sides_h

#include "sides.h"
#include "tidy.h"

enum
{
  TIDY_VIEWS = 1 << 11 /* facets remembered; a cell that is tried asks for about 16 */
};

typedef struct tidy_view
{
  int32_t cell; /* -1: none */
  int32_t index;
  int32_t look_count; /* made so far */
  int32_t seen[2][MLIM_SIDE_LOOKS];
} tidy_view;

typedef struct tidy_sides
{
  const mlim_refinement* refinement; /* borrowed */
  tidy_view* views;
} tidy_sides;

mlim_status tidy_sides_create(
  const mlim_refinement* refinement, mlim_context* context, tidy_sides* out);
void tidy_sides_free(tidy_sides* sides);

/* Cells have come and gone. Labels alone change nothing. */
void tidy_sides_forget(tidy_sides* sides);

/* Facets of a cell whose two labels are not there on their two sides. */
int tidy_sides_unseen(tidy_sides* sides, int32_t cell);

#endif
