#include "slivers.h"

#include "exchange.h"
#include "memory.h"
#include "status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
  STRICT_PASSES = 8,
  PASSES_WITHOUT_INSERTION = 2, /* flips and moves alone mend most */
  REPORT_EVERY = 256,           /* cells mended between two looks at the host: some 10 ms */
  MAX_STEPS = 6                 /* on one cell, in one pass */
};

/* What counts as a sliver: dihedral angles below 10 or above 170 degrees. */
static const double SLIVER_SINE = 0.17364817766693033;

/* Bounds as parts of the given ones. At first all is held against them, and a little more, since
   neighbours suffer when others are mended. Then less is good enough for what is left: it is locked in
   by neighbours that are only just good. So these are made better than they need to be, and then it
   is tried again. In the end only what must not be missed counts, the angle of a sliver and the
   ratio, with a pass before that gives the neighbours room in their ratios. What still misses its ratio
   lies in films, where the surface is sharp, and may get it at the cost of angles, down to 7 degrees. */
typedef struct aim
{
  double sine;
  double radius_edge_ratio;
} aim;

static const aim STRICT = { .sine = 1, .radius_edge_ratio = 0.97 };
static const aim MODEST = { .sine = 0.75, .radius_edge_ratio = 0.97 };
static const aim AMBITIOUS = { .sine = 1.6, .radius_edge_ratio = 0.73 };
static const aim ROOMY = { .sine = 0.75, .radius_edge_ratio = 0.85 };
static const aim LEAST = { .sine = 0.67, .radius_edge_ratio = 0.999 };
static const aim FLAT_ROOMY = { .sine = 0.5, .radius_edge_ratio = 0.85 };
static const aim FLAT = { .sine = 0.5, .radius_edge_ratio = 0.999 };

typedef struct bad_cell
{
  double shape;
  int32_t cell;
} bad_cell;

typedef struct remover
{
  mlim_solid* solid;
  mlim_solid_change* change;
  unsigned char* changed; /* per vertex: the last pass, counted from 1, that changed a cell of it */
  size_t changed_count, changed_capacity;
  bad_cell* bad;
  size_t bad_count, bad_capacity;
  size_t vertex_limit;
  mlim_shape_bound bound; /* the given one */
  const aim* part;        /* of it, in use */
  int pass;               /* below 256 */
  int may_insert;         /* vertices, in this pass */
  mlim_slivers_result result;
} remover;

static int compare_bad(const void* a, const void* b)
{
  const bad_cell* x = (const bad_cell*)a;
  const bad_cell* y = (const bad_cell*)b;
  if (x->shape < y->shape || x->shape > y->shape)
  {
    return x->shape < y->shape ? -1 : 1;
  }
  return (x->cell > y->cell) - (x->cell < y->cell);
}

/* Whether something round the cell is other than when it was tried last. */
static int is_worth_a_try(const remover* r, const mlim_solid_cell* cell)
{
  if (r->pass <= PASSES_WITHOUT_INSERTION + 1)
  {
    return 1;
  }
  for (int k = 0; k < 4; ++k)
  {
    if (r->changed[cell->vertices[k]] + 1 >= r->pass)
    {
      return 1;
    }
  }
  return 0;
}

/* Makes the cells round those that are bad count as changed. */
static size_t touch_bad(remover* r)
{
  size_t count = 0;
  for (size_t c = 0; c < r->solid->cell_count; ++c)
  {
    const mlim_solid_cell* cell = &r->solid->cells[c];
    if (cell->vertices[0] < 0 || cell->shape >= 1)
    {
      continue;
    }
    ++count;
    for (int k = 0; k < 4; ++k)
    {
      r->changed[cell->vertices[k]] = (unsigned char)r->pass;
    }
  }
  return count;
}

static int collect(remover* r)
{
  r->bad_count = 0;
  for (size_t c = 0; c < r->solid->cell_count; ++c)
  {
    const mlim_solid_cell* cell = &r->solid->cells[c];
    if (cell->vertices[0] < 0 || cell->shape >= 1 || !is_worth_a_try(r, cell))
    {
      continue;
    }
    if (mlim_reserve(&r->bad, &r->bad_capacity, r->bad_count + 1, sizeof *r->bad))
    {
      return 1;
    }
    r->bad[r->bad_count++] = (bad_cell){ .shape = cell->shape, .cell = (int32_t)c };
  }
  if (r->bad_count > 0) /* without an entry there is no array */
  {
    qsort(r->bad, r->bad_count, sizeof *r->bad, compare_bad);
  }
  return 0;
}

static int note_changes(remover* r)
{
  const size_t vertices = r->solid->vertex_count;
  if (mlim_reserve(&r->changed, &r->changed_capacity, vertices, sizeof *r->changed))
  {
    return 1;
  }
  for (; r->changed_count < vertices; ++r->changed_count)
  {
    r->changed[r->changed_count] = 0;
  }
  for (size_t c = 0; c < r->change->new_count; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      r->changed[r->change->new_cells[c][k]] = (unsigned char)r->pass;
    }
  }
  return 0;
}

/* The first step that betters the cell, the cheap ones first. */
static int better(remover* r, int32_t cell)
{
  int done = 0;
  for (int e = 0; e < 6 && done == 0; ++e)
  {
    done = mlim_exchange_edge(r->solid, r->change, cell, e);
  }
  for (int k = 0; k < 4 && done == 0; ++k)
  {
    done = mlim_exchange_face(r->solid, r->change, cell, k);
  }
  for (int k = 0; k < 4 && done == 0; ++k)
  {
    done = mlim_exchange_move(r->solid, r->change, cell, k);
  }
  for (int k = 0; k < 4 && done == 0; ++k)
  {
    done = mlim_exchange_vertex(r->solid, r->change, cell, k);
  }
  for (int k = 0; k < 4 && done == 0 && r->may_insert; ++k)
  {
    done = mlim_exchange_star(r->solid, r->change, cell, k);
  }
  if (done == 0 && r->may_insert && r->solid->vertex_count < r->vertex_limit)
  {
    const size_t before = r->solid->vertex_count;
    done = mlim_exchange_insert(r->solid, r->change, cell);
    r->result.added_count += r->solid->vertex_count - before;
  }
  return done;
}

static mlim_status mend(remover* r, const bad_cell* bad, mlim_context* context)
{
  int32_t id = bad->cell;
  double shape = bad->shape;
  for (int step = 0; step < MAX_STEPS && id >= 0; ++step)
  {
    const mlim_solid_cell* cell = &r->solid->cells[id];
    if (cell->vertices[0] < 0 || cell->shape < shape || cell->shape > shape || shape >= 1)
    {
      return MLIM_OK; /* mended meanwhile; its id may be in use again */
    }
    const int done = better(r, id);
    if (done < 0 || (done > 0 && note_changes(r)))
    {
      return mlim_fail_memory(context, "the removal of slivers");
    }
    if (done == 0)
    {
      return MLIM_OK;
    }
    ++r->result.exchange_count;
    /* On with the worst of the new cells. */
    id = -1;
    shape = 1;
    for (size_t c = 0; c < r->change->new_count; ++c)
    {
      if (r->change->new_shapes[c] < shape)
      {
        shape = r->change->new_shapes[c];
        id = r->change->new_ids[c];
      }
    }
  }
  return MLIM_OK;
}

static size_t count_slivers(mlim_solid* solid)
{
  const mlim_shape_bound bound = solid->bound;
  size_t count = 0;
  solid->bound = (mlim_shape_bound){ .sine = SLIVER_SINE, .radius_edge_ratio = INFINITY };
  for (size_t c = 0; c < solid->cell_count; ++c)
  {
    const int32_t* vertices = solid->cells[c].vertices;
    count += vertices[0] >= 0 && mlim_solid_shape(solid, vertices) < 1;
  }
  solid->bound = bound;
  return count;
}

static void set_aim(remover* r, const aim* part)
{
  if (r->part == part)
  {
    return;
  }
  r->part = part;
  mlim_solid* solid = r->solid;
  solid->bound = (mlim_shape_bound){ .sine = part->sine * r->bound.sine,
    .radius_edge_ratio = part->radius_edge_ratio * r->bound.radius_edge_ratio };
  for (size_t c = 0; c < solid->cell_count; ++c)
  {
    if (solid->cells[c].vertices[0] >= 0)
    {
      solid->cells[c].shape = mlim_solid_shape(solid, solid->cells[c].vertices);
    }
  }
}

static mlim_status run_pass(remover* r, double from, double to, mlim_context* context)
{
  if (collect(r))
  {
    return mlim_fail_memory(context, "the removal of slivers");
  }
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < r->bad_count && status == MLIM_OK; ++k)
  {
    if (k % REPORT_EVERY == 0)
    {
      const double share = (double)k / (double)r->bad_count;
      status = mlim_progress(context, MLIM_STAGE_VOLUME, from + share * (to - from));
    }
    status = status == MLIM_OK ? mend(r, &r->bad[k], context) : status;
  }
  return status;
}

static mlim_status run_strict(remover* r, double from, double to, mlim_context* context)
{
  mlim_status status = MLIM_OK;
  double at = from;
  set_aim(r, &STRICT);
  for (r->pass = 1; r->pass <= STRICT_PASSES && status == MLIM_OK; ++r->pass)
  {
    const double next = at + 0.5 * (to - at);
    r->may_insert = r->pass > PASSES_WITHOUT_INSERTION;
    status = run_pass(r, at, next, context);
    at = next;
  }
  return status;
}

/* Passes over what misses the last aim, and over what has changed round it; and again. */
typedef struct series
{
  const aim* aims[3];
  size_t count;
  int round_count;
} series;

static mlim_status run_series(remover* r, const series* s, double at, mlim_context* context)
{
  mlim_status status = MLIM_OK;
  for (int round = 0; round < s->round_count && status == MLIM_OK; ++round)
  {
    set_aim(r, s->aims[s->count - 1]);
    if (touch_bad(r) == 0)
    {
      return MLIM_OK;
    }
    for (size_t k = 0; k < s->count && status == MLIM_OK; ++k, ++r->pass)
    {
      set_aim(r, s->aims[k]);
      /* The ambitious pass of every second round: new vertices shake more loose, but are many. */
      r->may_insert = s->aims[k] != &AMBITIOUS || round % 2 == 1;
      status = run_pass(r, at, at, context);
    }
  }
  return status;
}

static mlim_status run_passes(remover* r, double from, double to, mlim_context* context)
{
  static const series locked = { { &AMBITIOUS, &MODEST, &MODEST }, 3, 3 };
  static const series last = { { &ROOMY, &LEAST }, 2, 3 };
  static const series flat = { { &FLAT_ROOMY, &FLAT }, 2, 3 };
  static const series* const all[] = { &locked, &last, &flat };
  mlim_status status = run_strict(r, from, to, context);
  for (size_t k = 0; k < sizeof all / sizeof *all && status == MLIM_OK; ++k)
  {
    status = run_series(r, all[k], to, context);
  }
  return status;
}

mlim_status mlim_slivers_remove(mlim_solid* solid, size_t vertex_limit, double from, double to,
  mlim_context* context, mlim_slivers_result* out)
{
  *out = (mlim_slivers_result){ 0 };
  remover r = { .solid = solid,
    .change = mlim_allocate(1, sizeof *r.change),
    .changed = mlim_allocate_zeroed(solid->vertex_count, sizeof *r.changed),
    .changed_count = solid->vertex_count,
    .changed_capacity = solid->vertex_count,
    .bound = solid->bound,
    .vertex_limit = vertex_limit };
  mlim_status status = MLIM_OK;
  if (r.change == NULL || r.changed == NULL)
  {
    status = mlim_fail_memory(context, "the removal of slivers");
  }
  r.result.sliver_count = count_slivers(solid);
  if (status == MLIM_OK)
  {
    status = run_passes(&r, from, to, context);
  }
  r.result.left_count = count_slivers(solid);
  *out = r.result;
  mlim_release(r.change);
  mlim_release(r.changed);
  mlim_release(r.bad);
  return status == MLIM_OK ? mlim_progress(context, MLIM_STAGE_VOLUME, to) : status;
}
