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

static double expect_vertices(const mlim_refinement* r)
{
  const double* size = mlim_field_grid_of(r->complex.oracle.field)->size;
  const double area = size[0] * size[1] + size[1] * size[2] + size[2] * size[0];
  return 1000 + area / (r->options->facet_size * r->options->facet_size);
}

/* *is_found: it has room among the vertices that are there, and does not take that of another. */
static mlim_status insert_ball(
  mlim_refinement* r, int32_t ball, mlim_context* context, int* is_found)
{
  const mlim_balls* balls = r->complex.balls;
  mlim_vertex vertex = {
    .kind = MLIM_VERTEX_BALL, .ball = ball, .weight = balls->radii[ball] * balls->radii[ball]
  };
  mlim_copy(balls->centers + 3 * (size_t)ball, vertex.point);
  const mlim_status status =
    mlim_complex_probe(&r->complex, &vertex, MLIM_NO_CELL, MLIM_START_NEAR, context, is_found);
  return *is_found ? mlim_complex_commit(&r->complex, context) : status;
}

mlim_status mlim_refine_insert_balls(mlim_refinement* refinement, const unsigned char* is_there,
  mlim_context* context, unsigned char* is_hidden, size_t* hidden_count)
{
  mlim_refinement* r = refinement;
  const mlim_balls* balls = r->complex.balls;
  mlim_placed* order = mlim_allocate(balls->ball_count, sizeof *order);
  size_t count = 0;
  for (size_t b = 0; b < balls->ball_count && order != NULL; ++b)
  {
    order[count] = (mlim_placed){ .place = mlim_queue_place(&r->queue, balls->centers + 3 * b),
      .id = (int32_t)b };
    count += is_there == NULL || !is_there[b];
  }
  mlim_status status = order == NULL ? mlim_fail_memory(context, "the protecting balls") : MLIM_OK;
  if (count > 1)
  {
    mlim_queue_sort(order, count);
  }
  *hidden_count = 0;
  memset(is_hidden, 0, balls->ball_count);
  for (size_t k = 0; k < count && status == MLIM_OK; ++k)
  {
    int is_found = 0;
    status = insert_ball(r, order[k].id, context, &is_found);
    is_hidden[order[k].id] = !is_found;
    *hidden_count += !is_found;
    status =
      status == MLIM_OK && k % LOOK_EVERY_BALLS == 0 ? mlim_refine_report(r, context) : status;
  }
  mlim_release(order);
  return status;
}

mlim_status mlim_refine_start(mlim_refinement* refinement, const mlim_oracle* oracle,
  const mlim_balls* balls, const mlim_options* options, double progress, mlim_context* context,
  unsigned char* is_hidden, size_t* hidden_count)
{
  mlim_refinement* r = refinement;
  *r = (mlim_refinement){ .options = options, .progress = progress };
  mlim_queue_start(&r->queue, mlim_field_grid_of(oracle->field)->size);
  mlim_status status = mlim_complex_create(oracle, balls, context, &r->complex);
  r->complex.vertex_limit = options->vertex_limit + MLIM_FAR_VERTICES;
  if (status == MLIM_OK)
  {
    status = mlim_ball_links_create(balls, context, &r->links);
  }
  if (status == MLIM_OK)
  {
    r->expected_vertices = expect_vertices(r);
    status = mlim_refine_insert_balls(r, NULL, context, is_hidden, hidden_count);
  }
  if (status == MLIM_OK && *hidden_count == 0)
  {
    status = mlim_complex_take_all(&r->complex, context);
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

/* Another goal judges other things; what is good is so by all criteria. */
static void set_goal(mlim_refinement* r, mlim_goal goal)
{
  for (size_t f = 1; r->goal != goal && f < r->complex.facet_count; ++f)
  {
    r->complex.facets[f].is_judged &= r->complex.facets[f].is_good;
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
    status = mlim_batches_work(r, context);
    if (status == MLIM_OK && r->complex.dirty_count == 0)
    {
      /* What follows needs the room. */
      mlim_queue_shrink(&r->queue);
      mlim_records_free(&r->records);
      break;
    }
    status = status == MLIM_OK ? mlim_disks_check(r, context) : status;
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
