#include "tidy_sides.h"

#include "memory.h"
#include "status.h"

mlim_status tidy_sides_create(
  const mlim_refinement* refinement, mlim_context* context, tidy_sides* out)
{
  *out = (tidy_sides){ .refinement = refinement,
    .views = mlim_allocate(TIDY_VIEWS, sizeof *out->views) };
  if (out->views == NULL)
  {
    return mlim_fail_memory(context, "mending the topology");
  }
  tidy_sides_forget(out);
  return MLIM_OK;
}

void tidy_sides_free(tidy_sides* sides)
{
  mlim_release(sides->views);
  *sides = (tidy_sides){ 0 };
}

void tidy_sides_forget(tidy_sides* sides)
{
  for (int k = 0; k < TIDY_VIEWS; ++k)
  {
    sides->views[k].cell = -1;
  }
}

static int has_seen(const tidy_view* view, int32_t inner, int32_t outer)
{
  int is_inner = 0;
  int is_outer = 0;
  for (int32_t look = 0; look < view->look_count; ++look)
  {
    is_inner |= view->seen[0][look] == inner;
    is_outer |= view->seen[1][look] == outer;
  }
  return is_inner && is_outer;
}

/* As mlim_sides_are_seen. The first look is nearly always enough; where it is not, the others are wanted
   for the next labels too. */
static int are_seen(tidy_sides* sides, int32_t cell, int index, int32_t inner, int32_t outer)
{
  const mlim_refinement* r = sides->refinement;
  const uint32_t key = (uint32_t)cell * 4 + (uint32_t)index;
  tidy_view* view = &sides->views[key * 2654435769u % TIDY_VIEWS];
  if (view->cell != cell || view->index != index)
  {
    *view = (tidy_view){ .cell = cell, .index = index };
  }
  int is_seen = has_seen(view, inner, outer);
  while (!is_seen && view->look_count < MLIM_SIDE_LOOKS)
  {
    const int end = view->look_count == 0 ? 1 : MLIM_SIDE_LOOKS;
    mlim_sides_look(
      &r->complex, cell, index, r->options->facet_distance, view->look_count, end, view->seen);
    view->look_count = end;
    is_seen = has_seen(view, inner, outer);
  }
  return is_seen;
}

int tidy_sides_unseen(tidy_sides* sides, int32_t cell)
{
  const mlim_complex* complex = &sides->refinement->complex;
  const mlim_cell* own = &complex->cells[cell];
  int count = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int32_t other = complex->cells[own->neighbors[k]].label;
    count += own->label != other && !are_seen(sides, cell, k, own->label, other);
  }
  return count;
}
