#include "tidy.h"

#include "memory.h"
#include "refine_disks.h"
#include "status.h"
#include "tidy_cell.h"
#include "tidy_disks.h"
#include "tidy_look.h"
#include "tidy_sides.h"
#include "tidy_trial.h"

#include <limits.h>

enum
{
  MAX_STACK = 256, /* cells that one change may lead to */
  MAX_PART = 24,   /* cells of a part of a star that may change together */
  MAX_SEEN = 512,  /* cells of a star; the rest may be tried twice */
  SHAPE_SWEEPS = 3,
  MAX_STEPS = 256, /* vertices that one failed vertex may lead to */
  MAX_TRIALS = 6   /* the first mends half of what changes lay open, the last hardly any */
};

typedef struct tidier
{
  mlim_refinement* refinement;
  mlim_context* context;
  double done; /* of the stage */
  tidy_looks looks;
  tidy_disks disks; /* once strays are mended */
  tidy_sides sides;
  mlim_status status; /* of what is deep inside */
  mlim_star star;     /* of the failed vertex */
  int32_t part[MAX_PART];
  size_t part_count;
  int32_t vertices[4 * MAX_PART];
  size_t vertex_count;
  int32_t seen[MAX_SEEN];
  size_t seen_count;
  int32_t pending[MAX_STEPS];
  int32_t* bad; /* cells with a bad triangle */
  size_t bad_count, bad_capacity;
  tidy_trial trial;
  int is_again; /* refinement has changed the cells listed on trial, all else is tidied */
} tidier;

static void set_label(tidier* t, int32_t id, int32_t label)
{
  mlim_complex* complex = &t->refinement->complex;
  mlim_cell* cell = &complex->cells[id];
  if (tidy_trial_note(&t->trial, id, cell->label, label))
  {
    t->status = mlim_fail_memory(t->context, "mending the topology");
    return;
  }
  cell->label = label;
  mlim_complex_touch_cell(complex, id);
  tidy_disks_update(&t->disks, id);
  tidy_look_again(&t->looks, id);
}

/* The cells to tidy: all, and once that is done those that refinement has changed. What was traded
   elsewhere, strays for shapes, would be traded back. */
static size_t cell_count(const tidier* t)
{
  return t->is_again ? t->trial.cell_count : t->refinement->complex.cell_count;
}

static int32_t cell_at(const tidier* t, size_t k)
{
  return t->is_again ? t->trial.cells[k] : (int32_t)k;
}

/* ---- strays ---- */

/* Mends one cell, then its neighbours as far as the change reaches. Each change lowers the number of
   strays, so this ends; what a full stack leaves out stays as it is. */
static void mend_strays_from(tidier* t, int32_t first)
{
  const mlim_complex* complex = &t->refinement->complex;
  int32_t stack[MAX_STACK];
  size_t count = 0;
  stack[count++] = first;
  while (count > 0 && t->status == MLIM_OK)
  {
    const int32_t id = stack[--count];
    const mlim_cell* cell = &complex->cells[id];
    if (!(t->looks.bits[id] & TIDY_STRAYS) || tidy_is_frozen(complex, cell))
    {
      continue;
    }
    const int32_t label = tidy_best_label(complex, id);
    if (label == cell->label)
    {
      continue;
    }
    set_label(t, id, label);
    for (int k = 0; k < 4 && count < MAX_STACK; ++k)
    {
      stack[count++] = cell->neighbors[k];
    }
  }
}

static mlim_status mend_strays(tidier* t)
{
  for (size_t k = 0; k < cell_count(t); ++k)
  {
    const int32_t c = cell_at(t, k);
    if (t->looks.bits[c] & TIDY_STRAYS)
    {
      mend_strays_from(t, c);
    }
  }
  return t->status;
}

/* ---- stars that are no disks ---- */

static int fails(tidier* t, int32_t vertex, int is_trial)
{
  int has_failed;
  const mlim_status status = is_trial ? tidy_disks_check(&t->disks, vertex, t->context, &has_failed)
                                      : tidy_disks_ask(&t->disks, vertex, t->context, &has_failed);
  t->status = t->status == MLIM_OK ? status : t->status;
  return has_failed;
}

static int contains(const int32_t* list, size_t count, int32_t value)
{
  for (size_t k = 0; k < count; ++k)
  {
    if (list[k] == value)
    {
      return 1;
    }
  }
  return 0;
}

/* The cells of the star that are connected with `first` through facets of the star and have its
   label. Returns 0 when they are too many or one is frozen. */
static int gather_part(tidier* t, int32_t first, int32_t vertex)
{
  const mlim_complex* complex = &t->refinement->complex;
  t->part_count = 0;
  t->part[t->part_count++] = first;
  for (size_t p = 0; p < t->part_count; ++p)
  {
    const mlim_cell* cell = &complex->cells[t->part[p]];
    if (tidy_is_frozen(complex, cell))
    {
      return 0;
    }
    for (int k = 0; k < 4; ++k)
    {
      const int32_t other = cell->neighbors[k];
      if (cell->vertices[k] == vertex || complex->cells[other].label != cell->label ||
          contains(t->part, t->part_count, other))
      {
        continue;
      }
      if (t->part_count == MAX_PART)
      {
        return 0;
      }
      t->part[t->part_count++] = other;
    }
  }
  return 1;
}

static void gather_vertices(tidier* t)
{
  const mlim_complex* complex = &t->refinement->complex;
  t->vertex_count = 0;
  for (size_t p = 0; p < t->part_count; ++p)
  {
    for (int k = 0; k < 4; ++k)
    {
      const int32_t v = complex->cells[t->part[p]].vertices[k];
      if (!contains(t->vertices, t->vertex_count, v))
      {
        t->vertices[t->vertex_count++] = v;
      }
    }
  }
}

/* Whether the part, once its label is none of its neighbours' round a vertex, is an island there: the rest of the
   star has triangles too, so that the link falls apart. Seen without gathering the star, so not always. */
static int is_island(const tidier* t, int32_t vertex)
{
  const mlim_complex* complex = &t->refinement->complex;
  int has_more = 0;
  for (size_t p = 0; p < t->part_count; ++p)
  {
    const mlim_cell* cell = &complex->cells[t->part[p]];
    const int is_there = contains(cell->vertices, 4, vertex);
    for (int k = 0; k < 4 && is_there; ++k)
    {
      const int32_t id = cell->neighbors[k];
      const mlim_cell* other = &complex->cells[id];
      if (cell->vertices[k] == vertex || contains(t->part, t->part_count, id))
      {
        continue;
      }
      if (other->label == cell->label)
      {
        return 0;
      }
      for (int i = 0; i < 4 && !has_more; ++i)
      {
        has_more = other->vertices[i] != vertex && t->looks.boundary->sides[id] >> i & 1 &&
                   !contains(t->part, t->part_count, other->neighbors[i]);
      }
    }
  }
  return has_more && complex->vertices[vertex].ball < 0;
}

/* A failed disk weighs more than bad triangles, these more than triangles with a wrong side, and all
   more than strays: the latter only lie a little off their sheet. */
enum
{
  DISK_COST = 40,
  SHAPE_COST = 26,
  SIDE_COST = 13
};

/* At least `enough`: it was not worth to count on. What costs most to look at comes last; the disks of
   the labels as they are, without a trial, are known. */
static long cost(tidier* t, long enough, int is_trial)
{
  const mlim_complex* complex = &t->refinement->complex;
  unsigned char is_counted[4 * MAX_PART] = { 0 };
  long sum = 0;
  for (size_t p = 0; p < t->part_count && sum < enough; ++p)
  {
    const int32_t id = t->part[p];
    sum += tidy_cell_strays(complex, id, complex->cells[id].label);
    sum += SHAPE_COST * tidy_cell_misshapen(t->refinement, id);
  }
  for (size_t k = 0; k < t->vertex_count && sum < enough && is_trial; ++k)
  {
    is_counted[k] = (unsigned char)is_island(t, t->vertices[k]);
    sum += DISK_COST * is_counted[k];
  }
  for (size_t p = 0; p < t->part_count && sum < enough; ++p)
  {
    sum += SIDE_COST * tidy_sides_unseen(&t->sides, t->part[p]);
  }
  for (size_t k = 0; k < t->vertex_count && sum < enough; ++k)
  {
    sum += is_counted[k] ? 0 : DISK_COST * fails(t, t->vertices[k], is_trial);
  }
  return sum;
}

static void relabel(tidier* t, int32_t label)
{
  for (size_t p = 0; p < t->part_count; ++p)
  {
    t->refinement->complex.cells[t->part[p]].label = label;
  }
}

/* Gives the part the label of a neighbour that lowers the cost most. 1: it has changed. */
static int mend_part(tidier* t)
{
  const mlim_complex* complex = &t->refinement->complex;
  const int32_t own = complex->cells[t->part[0]].label;
  gather_vertices(t);
  long least = cost(t, LONG_MAX, 0);
  int32_t best = own;
  int32_t tried[4 * MAX_PART];
  size_t tried_count = 0;
  for (size_t p = 0; p < t->part_count; ++p)
  {
    for (int k = 0; k < 4; ++k)
    {
      const int32_t other = tidy_label_beyond(complex, t->part[p], k);
      if (other != own && !contains(tried, tried_count, other))
      {
        tried[tried_count++] = other;
      }
    }
  }
  for (size_t n = 0; n < tried_count; ++n)
  {
    relabel(t, tried[n]);
    const long sum = cost(t, least, 1);
    if (sum < least)
    {
      least = sum;
      best = tried[n];
    }
  }
  relabel(t, own);
  for (size_t p = 0; p < t->part_count && best != own; ++p)
  {
    set_label(t, t->part[p], best);
  }
  return best != own;
}

/* Tries the parts of the star of a failed vertex, then its single cells. */
static int mend_star(tidier* t, int32_t vertex)
{
  const mlim_complex* complex = &t->refinement->complex;
  t->seen_count = 0;
  for (size_t c = 0; c < t->star.cell_count; ++c)
  {
    const int32_t id = t->star.cells[c];
    if (contains(t->seen, t->seen_count, id))
    {
      continue;
    }
    const int is_part = gather_part(t, id, vertex);
    for (size_t p = 0; p < t->part_count && t->seen_count < MAX_SEEN; ++p)
    {
      t->seen[t->seen_count++] = t->part[p];
    }
    if (is_part && mend_part(t))
    {
      return 1;
    }
  }
  for (size_t c = 0; c < t->star.cell_count; ++c)
  {
    t->part[0] = t->star.cells[c];
    t->part_count = 1;
    if (!tidy_is_frozen(complex, &complex->cells[t->part[0]]) && mend_part(t))
    {
      return 1;
    }
  }
  return 0;
}

/* Mends one vertex and then, as the change reaches them, the vertices of the changed cells. Each
   change lowers the cost, so this ends; the limit bounds the time. */
static mlim_status mend_from(tidier* t, int32_t vertex)
{
  size_t count = 0;
  t->pending[count++] = vertex;
  for (int step = 0; count > 0 && step < MAX_STEPS; ++step)
  {
    const int32_t v = t->pending[--count];
    mlim_disk disk;
    const mlim_status status = mlim_disk_check(
      &t->refinement->complex, &t->refinement->links, v, &t->star, t->context, &disk);
    if (status != MLIM_OK)
    {
      return status;
    }
    const int has_changed = disk == MLIM_DISK_FAILS && mend_star(t, v);
    if (t->status != MLIM_OK)
    {
      return t->status;
    }
    for (size_t k = 0; has_changed && k < t->vertex_count && count < MAX_STEPS; ++k)
    {
      t->pending[count++] = t->vertices[k];
    }
  }
  return MLIM_OK;
}

static mlim_status mend_disks(tidier* t)
{
  const mlim_complex* complex = &t->refinement->complex;
  mlim_status status = mlim_disks_settle(t->refinement, t->done, t->context);
  status = status == MLIM_OK ? tidy_disks_create(t->refinement, t->context, &t->disks) : status;
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count && status == MLIM_OK; ++v)
  {
    if ((complex->vertices[v].is_broken || complex->vertices[v].is_dirty) &&
        !(t->is_again && !t->trial.is_near[v]))
    {
      status = mend_from(t, (int32_t)v);
    }
    if (status == MLIM_OK && v % 1024 == 0)
    {
      status = mlim_progress(t->context, MLIM_STAGE_CERTIFICATE, t->done);
    }
  }
  return status;
}

/* Tries another label for a cell, then for it and one neighbour of its label together. */
static void mend_shape(tidier* t, int32_t id)
{
  const mlim_complex* complex = &t->refinement->complex;
  t->part[0] = id;
  t->part_count = 1;
  int has_changed = mend_part(t);
  for (int k = 0; k < 4 && !has_changed; ++k)
  {
    const int32_t other = complex->cells[id].neighbors[k];
    if (complex->cells[other].label == complex->cells[id].label &&
        !tidy_is_frozen(complex, &complex->cells[other]))
    {
      t->part[0] = id;
      t->part[1] = other;
      t->part_count = 2;
      has_changed = mend_part(t);
    }
  }
}

static int is_bad(tidier* t, int32_t id)
{
  const mlim_cell* cell = &t->refinement->complex.cells[id];
  return !tidy_is_frozen(&t->refinement->complex, cell) &&
         (tidy_cell_misshapen(t->refinement, id) > 0 || tidy_sides_unseen(&t->sides, id) > 0);
}

/* Lists the cells with a bad triangle, also those that have to keep their label. */
static mlim_status list_bad(tidier* t)
{
  t->bad_count = 0;
  for (size_t k = 0; k < cell_count(t); ++k)
  {
    const int32_t c = cell_at(t, k);
    if (t->looks.bits[c] >> TIDY_BAD_SHIFT != 0)
    {
      if (mlim_reserve(&t->bad, &t->bad_capacity, t->bad_count + 1, sizeof *t->bad))
      {
        return mlim_fail_memory(t->context, "mending the topology");
      }
      t->bad[t->bad_count++] = c;
    }
  }
  return mlim_progress(t->context, MLIM_STAGE_CERTIFICATE, t->done);
}

/* Bad triangles, some of which the changes above have brought to light: other labels may hide them. What
   has been tried in vain is tried again only if labels near it have changed since. */
static mlim_status mend_shapes(tidier* t)
{
  mlim_status status = list_bad(t);
  for (int sweep = 0; sweep < SHAPE_SWEEPS && status == MLIM_OK; ++sweep)
  {
    ++t->disks.sweep;
    for (size_t k = 0; k < t->bad_count && status == MLIM_OK; ++k)
    {
      const int is_tried = sweep == 0 || tidy_disks_are_new(&t->disks, t->bad[k]);
      if (is_tried && is_bad(t, t->bad[k]))
      {
        mend_shape(t, t->bad[k]);
      }
      status = t->status;
    }
  }
  return status;
}

static mlim_status mend(tidier* t)
{
  tidy_disks_free(&t->disks);
  tidy_sides_forget(&t->sides);
  mlim_status status = mend_strays(t);
  status = status == MLIM_OK ? mend_disks(t) : status;
  return status == MLIM_OK ? mend_shapes(t) : status;
}

/* ---- trials ---- */

/* Asks for points where triangles are misshapen. */
static mlim_status ask(tidier* t)
{
  const mlim_complex* complex = &t->refinement->complex;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const unsigned bits =
      t->looks.bits[c] >> TIDY_BAD_SHIFT & t->looks.boundary->sides[c] >> MLIM_FIRST_SHIFT;
    for (int k = 0; bits >> k != 0; ++k)
    {
      if (bits >> k & 1u && tidy_is_misshapen(t->refinement, &complex->cells[c], k) &&
          tidy_trial_ask(&t->trial, t->refinement, (int32_t)c, k))
      {
        return mlim_fail_memory(t->context, "mending the topology");
      }
    }
  }
  return MLIM_OK;
}

/* Each trial inserts points or is the last. */
static mlim_status mend_on_trial(tidier* t)
{
  mlim_status status = mend(t);
  for (int k = 0; k < MAX_TRIALS && status == MLIM_OK && !t->trial.is_limited; ++k)
  {
    status = ask(t);
    if (status != MLIM_OK || t->trial.record_count == 0)
    {
      return status;
    }
    status = tidy_trial_refine(&t->trial, t->refinement, t->done, t->context, &t->is_again);
    if (status != MLIM_OK || !t->is_again)
    {
      return status;
    }
    status = tidy_look_at_cells(&t->looks, t->trial.cells, t->trial.cell_count, t->context);
    status = status == MLIM_OK ? mend(t) : status;
  }
  return status;
}

mlim_status mlim_tidy_run(mlim_refinement* refinement, mlim_boundary* boundary, double done,
  mlim_context* context, mlim_tidied* out)
{
  tidier* t = mlim_allocate_zeroed(1, sizeof *t);
  if (t == NULL)
  {
    return mlim_fail_memory(context, "mending the topology");
  }
  *t = (tidier){ .refinement = refinement,
    .context = context,
    .done = done,
    .looks = { .refinement = refinement, .boundary = boundary } };
  mlim_status status = tidy_sides_create(refinement, context, &t->sides);
  status = status == MLIM_OK ? tidy_look_at_all(&t->looks, done, context) : status;
  status = status == MLIM_OK ? mend_on_trial(t) : status;
  if (status == MLIM_OK)
  {
    *out = (mlim_tidied){ .change_count = t->trial.change_count,
      .stray_count = tidy_count_looked_strays(&t->looks),
      .is_limited = t->trial.is_limited };
  }
  tidy_trial_free(&t->trial);
  mlim_star_free(&t->star);
  tidy_disks_free(&t->disks);
  tidy_sides_free(&t->sides);
  mlim_release(t->looks.bits);
  mlim_release(t->bad);
  mlim_release(t);
  return status;
}
