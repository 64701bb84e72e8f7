#include "tidy_trial.h"

#include "memory.h"
#include "refine_disks.h"
#include "status.h"

#include <stdlib.h>

enum
{
  LEVELS = 2, /* of neighbours with other labels, from the facet's cells on */
  MAX_CELLS = 64
};

void tidy_trial_free(tidy_trial* trial)
{
  mlim_release(trial->changes);
  mlim_release(trial->records);
  mlim_release(trial->cells);
  mlim_release(trial->is_near);
  *trial = (tidy_trial){ 0 };
}

int tidy_trial_note(tidy_trial* trial, int32_t cell, int32_t before, int32_t after)
{
  if (mlim_reserve(
        &trial->changes, &trial->change_capacity, trial->change_count + 1, sizeof *trial->changes))
  {
    return 1;
  }
  trial->changes[trial->change_count++] =
    (tidy_change){ .cell = cell, .before = before, .after = after };
  return 0;
}

/* ---- what to ask for ---- */

/* A facet's cells and changed cells round them, level by level. */
typedef struct surroundings
{
  int32_t cells[MAX_CELLS];
  size_t count;
} surroundings;

static void add(surroundings* s, int32_t cell)
{
  for (size_t k = 0; k < s->count; ++k)
  {
    if (s->cells[k] == cell)
    {
      return;
    }
  }
  if (cell != MLIM_NO_CELL && s->count < MAX_CELLS)
  {
    s->cells[s->count++] = cell;
  }
}

static int is_changed(const mlim_complex* complex, int32_t cell)
{
  return mlim_field_label(complex->oracle.field, mlim_complex_center(complex, cell)) !=
         complex->cells[cell].label;
}

/* The record of the cell whose crossing has most room, if that is more than *most. */
static void find_record(
  const mlim_refinement* r, const mlim_cell* cell, double* most, int32_t* best)
{
  for (int k = 0; k < 4; ++k)
  {
    const mlim_facet* facet = &r->complex.facets[cell->facets[k]];
    const double room = facet->is_alive ? mlim_criteria_room(&r->complex, r->options, facet) : 0;
    if (room > *most)
    {
      *most = room;
      *best = cell->facets[k];
    }
  }
}

int tidy_trial_ask(tidy_trial* trial, const mlim_refinement* refinement, int32_t cell, int index)
{
  const mlim_complex* complex = &refinement->complex;
  surroundings s = { 0 };
  add(&s, cell);
  add(&s, complex->cells[cell].neighbors[index]);
  int32_t best = 0;
  double most = 0;
  size_t begin = 0;
  for (int level = 0; level <= LEVELS && best == 0; ++level)
  {
    const size_t end = s.count;
    for (; begin < end; ++begin)
    {
      const mlim_cell* c = &complex->cells[s.cells[begin]];
      const int has_changed = is_changed(complex, s.cells[begin]);
      if (has_changed)
      {
        find_record(refinement, c, &most, &best);
      }
      for (int k = 0; k < 4 && (has_changed || level == 0); ++k)
      {
        add(&s, c->neighbors[k]);
      }
    }
  }
  if (best == 0)
  {
    return 0;
  }
  if (mlim_reserve(
        &trial->records, &trial->record_capacity, trial->record_count + 1, sizeof *trial->records))
  {
    return 1;
  }
  trial->records[trial->record_count++] = best;
  return 0;
}

/* ---- refinement in between ---- */

/* The host as refinement sees it: in the stage of tidying, at one place of it. */
typedef struct host
{
  mlim_context* context;
  double done;
} host;

static int report(void* user, mlim_stage stage, double fraction)
{
  const host* h = (const host*)user;
  (void)stage;
  (void)fraction;
  return mlim_progress(h->context, MLIM_STAGE_CERTIFICATE, h->done) != MLIM_OK;
}

static void share(void* user, size_t count, mlim_body body, void* job)
{
  mlim_parallel_for(((const host*)user)->context, count, body, job);
}

static mlim_status refine(const tidy_trial* trial, mlim_refinement* r, mlim_context* context)
{
  const int bin = mlim_queue_bin_of(MLIM_BAD_SHEET, 1);
  for (size_t k = 0; k < trial->record_count; ++k)
  {
    if (mlim_queue_push(&r->queue, bin, &r->complex, trial->records[k]))
    {
      return mlim_fail_memory(context, "the queue of facets");
    }
  }
  return mlim_refine_go_on(r, context);
}

/* ---- round what is new ---- */

static mlim_status find_star(mlim_refinement* r, int32_t vertex, mlim_context* context)
{
  mlim_disk disk;
  return mlim_disk_check(&r->complex, &r->links, vertex, &r->star, context, &disk);
}

/* Every cell made since then has a vertex inserted since then. */
static mlim_status mark_vertices(
  tidy_trial* trial, mlim_refinement* r, size_t first, mlim_context* context)
{
  const mlim_complex* complex = &r->complex;
  mlim_release(trial->is_near);
  trial->is_near = mlim_allocate_zeroed(complex->vertex_count, 1);
  mlim_status status =
    trial->is_near == NULL ? mlim_fail_memory(context, "the vertices round new ones") : MLIM_OK;
  for (size_t v = first; v < complex->vertex_count && status == MLIM_OK; ++v)
  {
    status = find_star(r, (int32_t)v, context);
    for (size_t c = 0; c < r->star.cell_count && status == MLIM_OK; ++c)
    {
      for (int k = 0; k < 4; ++k)
      {
        trial->is_near[complex->cells[r->star.cells[c]].vertices[k]] = 1;
      }
    }
  }
  return status;
}

static int by_id(const void* a, const void* b)
{
  const int32_t x = *(const int32_t*)a;
  const int32_t y = *(const int32_t*)b;
  return (x > y) - (x < y);
}

/* The stars of the vertices marked, but for the far ones: their cells keep their labels. */
static mlim_status list_cells(tidy_trial* trial, mlim_refinement* r, mlim_context* context)
{
  mlim_status status = MLIM_OK;
  trial->cell_count = 0;
  for (size_t v = MLIM_FAR_VERTICES; v < r->complex.vertex_count && status == MLIM_OK; ++v)
  {
    if (!trial->is_near[v])
    {
      continue;
    }
    status = find_star(r, (int32_t)v, context);
    const size_t count = trial->cell_count + r->star.cell_count;
    if (status == MLIM_OK &&
        mlim_reserve(&trial->cells, &trial->cell_capacity, count, sizeof *trial->cells))
    {
      status = mlim_fail_memory(context, "the cells round new vertices");
    }
    for (size_t c = 0; c < r->star.cell_count && status == MLIM_OK; ++c)
    {
      trial->cells[trial->cell_count++] = r->star.cells[c];
    }
  }
  if (status != MLIM_OK || trial->cell_count == 0)
  {
    return status;
  }
  qsort(trial->cells, trial->cell_count, sizeof *trial->cells, by_id);
  size_t kept = 1;
  for (size_t c = 1; c < trial->cell_count; ++c)
  {
    if (trial->cells[c] != trial->cells[kept - 1])
    {
      trial->cells[kept++] = trial->cells[c];
    }
  }
  trial->cell_count = kept;
  return MLIM_OK;
}

/* The stars of all vertices of the cells listed have changed, of some by the labels alone. */
static void touch_cells(tidy_trial* trial, mlim_complex* complex)
{
  for (size_t c = 0; c < trial->cell_count; ++c)
  {
    mlim_complex_touch_cell(complex, trial->cells[c]);
    for (int k = 0; k < 4; ++k)
    {
      trial->is_near[complex->cells[trial->cells[c]].vertices[k]] = 1;
    }
  }
}

/* ---- the whole ---- */

static void take_back(const tidy_trial* trial, mlim_complex* complex)
{
  for (size_t k = trial->change_count; k-- > 0;)
  {
    complex->cells[trial->changes[k].cell].label = trial->changes[k].before;
  }
}

static int is_near(const tidy_trial* trial, const mlim_cell* cell)
{
  for (int k = 0; k < 4; ++k)
  {
    if (cell->vertices[0] < 0 || trial->is_near[cell->vertices[k]])
    {
      return 1;
    }
  }
  return 0;
}

static void make_again(tidy_trial* trial, mlim_complex* complex)
{
  size_t kept = 0;
  for (size_t k = 0; k < trial->change_count; ++k)
  {
    const tidy_change change = trial->changes[k];
    if (!is_near(trial, &complex->cells[change.cell]))
    {
      complex->cells[change.cell].label = change.after;
      trial->changes[kept++] = change;
    }
  }
  trial->change_count = kept;
}

mlim_status tidy_trial_refine(tidy_trial* trial, mlim_refinement* refinement, double done,
  mlim_context* context, int* is_refined)
{
  mlim_refinement* r = refinement;
  const size_t first = r->complex.vertex_count;
  host h = { .context = context, .done = done };
  mlim_context within = { .progress = report, .parallel_for = share, .user = &h };
  *is_refined = 0;
  /* As long as the changes are there: elsewhere this holds again afterwards. */
  mlim_status status = mlim_disks_settle(r, done, context);
  take_back(trial, &r->complex);
  if (status != MLIM_OK)
  {
    return status;
  }
  status = refine(trial, r, &within);
  trial->record_count = 0;
  if (status == MLIM_VERTEX_LIMIT)
  {
    trial->is_limited = 1;
    mlim_fail(context, status, "%s", within.message);
    status = mlim_refine_update(r, &within);
  }
  status = status == MLIM_OK ? mark_vertices(trial, r, first, &within) : status;
  if (status == MLIM_OK)
  {
    make_again(trial, &r->complex);
    status = list_cells(trial, r, &within);
    touch_cells(trial, &r->complex);
    *is_refined = r->complex.vertex_count > first;
  }
  return status == MLIM_OK || context == NULL ? status
                                              : mlim_fail(context, status, "%s", within.message);
}
