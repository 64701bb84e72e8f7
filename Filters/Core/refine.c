#include "refine.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
  LOOK_EVERY_BALLS = 256, /* balls inserted between two looks at the host: about 5 ms */
  REPORT_EVERY = 256,     /* insertions between two looks at the host: about 5 ms */
  JUDGE_EVERY = 65536     /* facets judged between two looks: about 20 ms */
};

/* ---- start ---- */

typedef struct ordered_ball
{
  uint64_t place;
  int32_t ball;
} ordered_ball;

static int compare_balls(const void* a, const void* b)
{
  const ordered_ball* x = (const ordered_ball*)a;
  const ordered_ball* y = (const ordered_ball*)b;
  if (x->place != y->place)
  {
    return x->place < y->place ? -1 : 1;
  }
  return (x->ball > y->ball) - (x->ball < y->ball);
}

/* Along the Morton curve, so that each ball is located from the one before in a few steps. */
static mlim_status insert_balls(mlim_refinement* r, const mlim_balls* balls, mlim_context* context,
  unsigned char* is_hidden, size_t* hidden_count)
{
  ordered_ball* order = mlim_allocate(balls->ball_count, sizeof *order);
  if (order == NULL)
  {
    return mlim_fail_memory(context, "the protecting balls");
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    order[b] = (ordered_ball){ .place = mlim_queue_place(&r->queue, balls->centers + 3 * b),
      .ball = (int32_t)b };
  }
  qsort(order, balls->ball_count, sizeof *order, compare_balls);
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < balls->ball_count && status == MLIM_OK; ++k)
  {
    const int32_t b = order[k].ball;
    mlim_vertex vertex = {
      .kind = MLIM_VERTEX_BALL, .ball = b, .weight = balls->radii[b] * balls->radii[b]
    };
    mlim_copy(balls->centers + 3 * (size_t)b, vertex.point);
    double power;
    status =
      mlim_complex_probe(&r->complex, &vertex, MLIM_NO_CELL, MLIM_START_NEAR, context, &power);
    if (status == MLIM_OK && power < 0)
    {
      is_hidden[b] = 1;
      ++*hidden_count;
    }
    else if (status == MLIM_OK)
    {
      status = mlim_complex_commit(&r->complex, context);
    }
    if (status == MLIM_OK && k % LOOK_EVERY_BALLS == 0)
    {
      status = mlim_progress(context, MLIM_STAGE_SURFACE, 0);
    }
  }
  mlim_release(order);
  return status;
}

/* A ball whose centre is nearer in power to another one owns no part of space round it, and the next
   point could hide it. The other one is a neighbour then: power cells are convex. */
static void mark_held(const mlim_complex* complex, unsigned char* is_hidden, size_t* count)
{
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    for (int pair = 0; pair < 16 && cell->vertices[0] >= 0; ++pair)
    {
      const mlim_vertex* held = &complex->vertices[cell->vertices[pair & 3]];
      const mlim_vertex* by = &complex->vertices[cell->vertices[pair >> 2]];
      if (held->kind == MLIM_VERTEX_BALL && by->kind == MLIM_VERTEX_BALL && held != by &&
          !is_hidden[held->ball] && !is_hidden[by->ball] &&
          mlim_distance_squared(held->point, by->point) - by->weight <= -held->weight)
      {
        is_hidden[held->ball] = 1;
        ++*count;
      }
    }
  }
}

mlim_status mlim_refine_start(mlim_refinement* refinement, const mlim_oracle* oracle,
  const mlim_balls* balls, const mlim_options* options, mlim_context* context,
  unsigned char* is_hidden, size_t* hidden_count)
{
  mlim_refinement* r = refinement;
  *r = (mlim_refinement){ .options = options };
  mlim_queue_start(&r->queue, mlim_field_grid_of(oracle->field)->size);
  mlim_status status = mlim_complex_create(oracle, balls, context, &r->complex);
  r->complex.vertex_limit = options->vertex_limit + MLIM_FAR_VERTICES;
  if (status == MLIM_OK)
  {
    status = mlim_ball_links_create(balls, context, &r->links);
  }
  if (status == MLIM_OK)
  {
    memset(is_hidden, 0, balls->ball_count);
    *hidden_count = 0;
    status = insert_balls(r, balls, context, is_hidden, hidden_count);
  }
  if (status == MLIM_OK && *hidden_count == 0)
  {
    status = mlim_complex_record_all(&r->complex, context);
    mark_held(&r->complex, is_hidden, hidden_count);
  }
  if (status != MLIM_OK)
  {
    mlim_refine_free(r);
  }
  return status;
}

void mlim_refine_free(mlim_refinement* refinement)
{
  mlim_complex_free(&refinement->complex);
  mlim_ball_links_free(&refinement->links);
  mlim_queue_free(&refinement->queue);
  mlim_star_free(&refinement->star);
}

/* ---- the loop ---- */

static int is_wanted(const mlim_refinement* r, mlim_badness badness)
{
  return badness < (r->goal == MLIM_GOAL_TOPOLOGY ? MLIM_BAD_SIZE : MLIM_BAD_NONE);
}

/* Queues a record if it is bad and can be mended. */
static int enqueue(mlim_refinement* r, int32_t record)
{
  const mlim_facet* facet = &r->complex.facets[record];
  if (!facet->is_alive)
  {
    return 0;
  }
  const mlim_verdict verdict = mlim_criteria_judge(&r->complex, r->options, facet);
  if (!is_wanted(r, verdict.badness) ||
      !mlim_criteria_may_insert(&r->complex, r->options, facet, verdict.badness))
  {
    return 0;
  }
  return mlim_queue_push(
    &r->queue, mlim_queue_bin_of(verdict.badness, verdict.excess), &r->complex, record);
}

mlim_status mlim_refine_ask(
  mlim_refinement* refinement, int32_t record, mlim_context* context, int* is_taken)
{
  const mlim_complex* complex = &refinement->complex;
  *is_taken = mlim_criteria_may_insert(
    complex, refinement->options, &complex->facets[record], MLIM_BAD_DISTANCE);
  return *is_taken && mlim_queue_push(&refinement->queue, mlim_queue_bin_of(MLIM_BAD_DISTANCE, 1),
                        complex, record)
           ? mlim_fail_memory(context, "the queue of facets")
           : MLIM_OK;
}

static mlim_status enqueue_all(mlim_refinement* r, mlim_context* context)
{
  for (size_t record = 1; record < r->complex.facet_count; ++record)
  {
    if (enqueue(r, (int32_t)record))
    {
      return mlim_fail_memory(context, "the queue of facets");
    }
    const mlim_status status = record % JUDGE_EVERY == 0 ? mlim_refine_report(r, context) : MLIM_OK;
    if (status != MLIM_OK)
    {
      return status;
    }
  }
  return MLIM_OK;
}

static mlim_status insert_crossing(mlim_refinement* r, int32_t record, mlim_context* context)
{
  mlim_complex* complex = &r->complex;
  const mlim_facet* facet = &complex->facets[record];
  mlim_vertex vertex = { .kind = MLIM_VERTEX_SURFACE, .ball = -1, .sheet = facet->sheet };
  mlim_copy(facet->crossing, vertex.point);
  const int32_t sides[2] = { facet->cell, complex->cells[facet->cell].neighbors[facet->index] };
  double power = -1;
  mlim_status status = MLIM_OK;
  /* The crossing lies on the dual, between the two power centres: both cells are in conflict but
     for rounding. */
  for (int k = 0; k < 2 && status == MLIM_OK && power < 0; ++k)
  {
    status =
      mlim_complex_probe(complex, &vertex, sides[k], MLIM_START_IN_CONFLICT, context, &power);
  }
  const double least = 0.25 * r->options->smallest_distance * r->options->smallest_distance;
  if (status != MLIM_OK || power < least)
  {
    return status;
  }
  status = mlim_complex_commit(complex, context);
  r->insertion_count += status == MLIM_OK;
  for (size_t k = 0; k < complex->fresh_count && status == MLIM_OK; ++k)
  {
    if (enqueue(r, complex->fresh[k]))
    {
      status = mlim_fail_memory(context, "the queue of facets");
    }
  }
  return status;
}

mlim_status mlim_refine_report(mlim_refinement* refinement, mlim_context* context)
{
  mlim_refinement* r = refinement;
  const double share = (double)r->complex.vertex_count / r->expected_vertices;
  const double fraction = 1 - exp(-1.5 * share);
  r->progress = fraction > r->progress ? fraction : r->progress;
  return mlim_progress(context, MLIM_STAGE_SURFACE, r->progress);
}

static mlim_status work_batch(mlim_refinement* r, mlim_badness badness, mlim_context* context)
{
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < r->queue.batch.count && status == MLIM_OK; ++k)
  {
    const mlim_queue_entry entry = r->queue.batch.entries[k];
    const mlim_facet* facet = &r->complex.facets[entry.record];
    if (!facet->is_alive || facet->generation != entry.generation ||
        (badness == MLIM_BAD_DISK &&
          !mlim_criteria_may_insert(&r->complex, r->options, facet, badness)))
    {
      continue;
    }
    status = insert_crossing(r, entry.record, context);
    if (status == MLIM_OK && r->insertion_count % REPORT_EVERY == 0)
    {
      status = mlim_refine_report(r, context);
    }
  }
  return status;
}

/* Queues the facet of a failed star whose crossing is farthest from the vertex. */
static int enqueue_star(mlim_refinement* r, int32_t vertex)
{
  const mlim_complex* complex = &r->complex;
  int32_t best = 0;
  double most = -1;
  for (size_t k = 0; k < r->star.facet_count; ++k)
  {
    const mlim_facet* facet = &complex->facets[r->star.facets[k]];
    const double d = mlim_distance_squared(facet->crossing, complex->vertices[vertex].point);
    if (d > most && mlim_criteria_may_insert(complex, r->options, facet, MLIM_BAD_DISK))
    {
      most = d;
      best = r->star.facets[k];
    }
  }
  return best == 0 ? 0
                   : mlim_queue_push(&r->queue, mlim_queue_bin_of(MLIM_BAD_DISK, 1), complex, best);
}

static int compare_ids(const void* a, const void* b)
{
  const int32_t x = *(const int32_t*)a;
  const int32_t y = *(const int32_t*)b;
  return (x > y) - (x < y);
}

/* Checks the vertices whose stars have changed. */
static mlim_status check_disks(mlim_refinement* r, mlim_context* context)
{
  mlim_complex* complex = &r->complex;
  qsort(complex->dirty, complex->dirty_count, sizeof *complex->dirty, compare_ids);
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < complex->dirty_count && status == MLIM_OK; ++k)
  {
    const int32_t vertex = complex->dirty[k];
    complex->vertices[vertex].is_dirty = 0;
    mlim_disk disk;
    status = mlim_disk_check(complex, &r->links, vertex, &r->star, context, &disk);
    if (status == MLIM_OK && disk == MLIM_DISK_FAILS && enqueue_star(r, vertex))
    {
      status = mlim_fail_memory(context, "the queue of facets");
    }
    if (status == MLIM_OK && k % 4096 == 4095)
    {
      status = mlim_refine_report(r, context);
    }
  }
  complex->dirty_count = 0;
  return status;
}

mlim_status mlim_refine_run(mlim_refinement* refinement, mlim_goal goal, mlim_context* context)
{
  mlim_refinement* r = refinement;
  r->goal = goal;
  const mlim_field_grid* grid = mlim_field_grid_of(r->complex.oracle.field);
  if (!(r->expected_vertices > 0))
  {
    const double area =
      grid->size[0] * grid->size[1] + grid->size[1] * grid->size[2] + grid->size[2] * grid->size[0];
    r->expected_vertices = 1000 + area / (r->options->facet_size * r->options->facet_size);
  }
  mlim_status status = enqueue_all(r, context);
  /* Each round inserts at least one point or is the last, and the vertex limit bounds the points. */
  while (status == MLIM_OK)
  {
    const int bin = mlim_queue_next(&r->queue);
    if (bin >= 0)
    {
      status = work_batch(r, mlim_queue_badness_of(bin), context);
    }
    else if (r->complex.dirty_count > 0)
    {
      status = check_disks(r, context);
    }
    else
    {
      break;
    }
  }
  return status == MLIM_OK ? mlim_refine_report(r, context) : status;
}

/* ---- what is left ---- */

mlim_status mlim_refine_count_disks(
  mlim_refinement* refinement, double done, mlim_context* context, size_t* count)
{
  mlim_complex* complex = &refinement->complex;
  *count = 0;
  mlim_status status = MLIM_OK;
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count && status == MLIM_OK; ++v)
  {
    mlim_disk disk;
    status =
      mlim_disk_check(complex, &refinement->links, (int32_t)v, &refinement->star, context, &disk);
    *count += disk == MLIM_DISK_FAILS;
    if (status == MLIM_OK && v % 4096 == 0)
    {
      status = mlim_progress(context, MLIM_STAGE_CERTIFICATE, done);
    }
  }
  return status;
}
