#include "refine.h"

#include "memory.h"
#include "refine_batch.h"
#include "refine_disks.h"
#include "refine_judge.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum
{
  LOOK_EVERY_BALLS = 256 /* balls inserted between two looks at the host: about 5 ms */
};

/* ---- start ---- */

/* NULL: out of memory. */
static mlim_placed* order_points(const mlim_refinement* r, const double* points, size_t count)
{
  mlim_placed* order = mlim_allocate(count, sizeof *order);
  for (size_t v = 0; order != NULL && v < count; ++v)
  {
    order[v] =
      (mlim_placed){ .place = mlim_queue_place(&r->queue, points + 3 * v), .id = (int32_t)v };
  }
  if (order != NULL)
  {
    mlim_queue_sort(order, count);
  }
  return order;
}

static double expect_vertices(const mlim_refinement* r)
{
  const double* size = mlim_field_grid_of(r->complex.oracle.field)->size;
  const double area = size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  return 1000 + area / (r->options->facet_size * r->options->facet_size);
}

/* *is_hidden: it has no room among the vertices that are there, or would take that of another. */
static mlim_status insert_first(mlim_refinement* r, const mlim_vertex* vertex, size_t number,
  mlim_context* context, int* is_hidden)
{
  int is_found;
  mlim_status status =
    mlim_complex_probe(&r->complex, vertex, MLIM_NO_CELL, MLIM_START_NEAR, context, &is_found);
  *is_hidden = status == MLIM_OK && !is_found;
  if (is_found)
  {
    status = mlim_complex_commit(&r->complex, context);
  }
  return status == MLIM_OK && number % LOOK_EVERY_BALLS == 0 ? mlim_refine_report(r, context)
                                                             : status;
}

static mlim_status insert_balls(mlim_refinement* r, const mlim_balls* balls, mlim_context* context,
  unsigned char* is_hidden, size_t* hidden_count)
{
  mlim_placed* order = order_points(r, balls->centers, balls->ball_count);
  mlim_status status = order == NULL ? mlim_fail_memory(context, "the protecting balls") : MLIM_OK;
  for (size_t k = 0; k < balls->ball_count && status == MLIM_OK; ++k)
  {
    const int32_t b = order[k].id;
    mlim_vertex vertex = {
      .kind = MLIM_VERTEX_BALL, .ball = b, .weight = balls->radii[b] * balls->radii[b]
    };
    int hides;
    mlim_copy(balls->centers + 3 * (size_t)b, vertex.point);
    status = insert_first(r, &vertex, k, context, &hides);
    if (status == MLIM_OK && hides)
    {
      is_hidden[b] = 1;
      ++*hidden_count;
    }
  }
  mlim_release(order);
  return status;
}

static mlim_status insert_known(mlim_refinement* r, const mlim_known* known, mlim_context* context)
{
  mlim_placed* order = order_points(r, known->points, known->count);
  mlim_status status = order == NULL ? mlim_fail_memory(context, "the triangulation") : MLIM_OK;
  for (size_t k = 0; k < known->count && status == MLIM_OK; ++k)
  {
    const size_t v = (size_t)order[k].id;
    mlim_vertex vertex = { .kind = MLIM_VERTEX_SURFACE, .ball = -1, .sheet = known->sheets[v] };
    int is_hidden;
    mlim_copy(known->points + 3 * v, vertex.point);
    status = insert_first(r, &vertex, k, context, &is_hidden);
  }
  mlim_release(order);
  return status;
}

mlim_status mlim_refine_start(mlim_refinement* refinement, const mlim_oracle* oracle,
  const mlim_balls* balls, const mlim_known* known, const mlim_options* options,
  mlim_context* context, unsigned char* is_hidden, size_t* hidden_count)
{
  mlim_refinement* r = refinement;
  *r = (mlim_refinement){ .options = options, .progress = known->progress };
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
    r->expected_vertices = expect_vertices(r);
    status = insert_balls(r, balls, context, is_hidden, hidden_count);
  }
  if (status == MLIM_OK && *hidden_count == 0)
  {
    status = insert_known(r, known, context);
    status = status == MLIM_OK ? mlim_complex_take_all(&r->complex, context) : status;
    status = status == MLIM_OK ? mlim_refine_update(r, context) : status;
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
  mlim_records_free(&refinement->records);
}

/* ---- the loop ---- */

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

mlim_status mlim_refine_update(mlim_refinement* refinement, mlim_context* context)
{
  return mlim_records_update(
    &refinement->records, &refinement->complex, refinement->progress, context);
}

mlim_status mlim_refine_report(mlim_refinement* refinement, mlim_context* context)
{
  mlim_refinement* r = refinement;
  const double share = (double)r->complex.vertex_count / r->expected_vertices;
  const double fraction = 1 - exp(-1.5 * share);
  r->progress = fraction > r->progress ? fraction : r->progress;
  return mlim_progress(context, MLIM_STAGE_SURFACE, r->progress);
}

/* Another goal judges other things. */
static void set_goal(mlim_refinement* r, mlim_goal goal)
{
  for (size_t f = 1; r->goal != goal && f < r->complex.facet_count; ++f)
  {
    r->complex.facets[f].is_judged = 0;
  }
  r->goal = goal;
}

mlim_status mlim_refine_run(mlim_refinement* refinement, mlim_goal goal, mlim_context* context)
{
  mlim_refinement* r = refinement;
  set_goal(r, goal);
  mlim_status status = mlim_refine_update(r, context);
  status = status == MLIM_OK ? mlim_judge_all(r, context) : status;
  return status == MLIM_OK ? mlim_refine_go_on(r, context) : status;
}

mlim_status mlim_refine_go_on(mlim_refinement* refinement, mlim_context* context)
{
  mlim_refinement* r = refinement;
  mlim_status status = MLIM_OK;
  /* Each round inserts at least one point or is the last, and the vertex limit bounds the points. */
  while (status == MLIM_OK)
  {
    const int bin = mlim_queue_next(&r->queue);
    if (bin >= 0)
    {
      status = mlim_batch_work(r, mlim_queue_badness_of(bin), context);
    }
    else if (r->complex.dirty_count > 0)
    {
      status = mlim_disks_check(r, context);
    }
    else
    {
      mlim_queue_shrink(&r->queue);
      break;
    }
  }
  return status == MLIM_OK ? mlim_refine_report(r, context) : status;
}

void mlim_refine_tighten(mlim_refinement* refinement, const unsigned char* is_tightened)
{
  mlim_complex* complex = &refinement->complex;
  for (size_t f = 1; f < complex->facet_count; ++f)
  {
    mlim_facet* facet = &complex->facets[f];
    if (is_tightened[facet->sheet.low] || is_tightened[facet->sheet.high])
    {
      facet->is_judged = 0;
    }
  }
}
