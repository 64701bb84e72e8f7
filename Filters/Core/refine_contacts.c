#include "refine_contacts.h"

#include "ball_grid.h"
#include "criteria.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <string.h>

/* Radii round a contact within which no vertex stays. */
static const double ANEW = 3;

enum
{
  LOOK_EVERY = 16384 /* vertices between two looks at the host: about 10 ms */
};

/* What becomes of vertices and balls. */
typedef struct sifting
{
  const mlim_balls* balls;
  mlim_ball_grid grid;
  double reach;            /* the farthest that a ball drives out vertices */
  unsigned char* goes;     /* a vertex: it may not stay */
  unsigned char* is_there; /* a ball: it has its vertex already */
  size_t gone_count;
} sifting;

static void sifting_free(sifting* s)
{
  mlim_ball_grid_free(&s->grid);
  mlim_release(s->goes);
  mlim_release(s->is_there);
}

/* Squared radii round a ball within which no vertex stays. */
static double factor_of(const mlim_balls* balls, size_t ball)
{
  return balls->ball_curves[ball] == MLIM_CONTACT ? ANEW * ANEW : 1 + MLIM_NEAR_GUARD;
}

static mlim_status sifting_create(const mlim_complex* complex, mlim_context* context, sifting* out)
{
  const mlim_balls* balls = complex->balls;
  *out = (sifting){ .balls = balls,
    .goes = mlim_allocate_zeroed(complex->vertex_count, 1),
    .is_there = mlim_allocate_zeroed(balls->ball_count, 1) };
  if (out->goes == NULL || out->is_there == NULL ||
      mlim_ball_grid_fill(balls, &out->grid) != MLIM_OK)
  {
    return mlim_fail_memory(context, "the contacts");
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    out->reach = mlim_max(out->reach, sqrt(factor_of(balls, b)) * balls->radii[b]);
  }
  return MLIM_OK;
}

static int may_stay(const sifting* s, const double point[3])
{
  mlim_point_walk walk;
  for (int32_t b = mlim_point_grid_first(&s->grid.points, point, s->reach, &walk); b >= 0;
       b = mlim_point_grid_next(&s->grid.points, &walk))
  {
    const double radius = s->balls->radii[b];
    const double d = mlim_distance_squared(s->balls->centers + 3 * (size_t)b, point);
    if (d < factor_of(s->balls, (size_t)b) * radius * radius)
    {
      return 0;
    }
  }
  return 1;
}

/* The ball that stands at the vertex, -1: none. Balls are copied from cover to cover, digit by digit. */
static int32_t find_ball(const sifting* s, const mlim_vertex* vertex)
{
  mlim_point_walk walk;
  int32_t b = mlim_point_grid_first(&s->grid.points, vertex->point, 0, &walk);
  while (b >= 0 &&
         (memcmp(s->balls->centers + 3 * (size_t)b, vertex->point, sizeof vertex->point) != 0 ||
           s->balls->radii[b] * s->balls->radii[b] != vertex->weight))
  {
    b = mlim_point_grid_next(&s->grid.points, &walk);
  }
  return b;
}

/* Balls that stay get their new numbers. */
static void sift(sifting* s, mlim_vertex* vertex, size_t number)
{
  if (vertex->kind == MLIM_VERTEX_BALL)
  {
    vertex->ball = find_ball(s, vertex);
    s->goes[number] = vertex->ball < 0;
    if (vertex->ball >= 0)
    {
      s->is_there[vertex->ball] = 1;
    }
  }
  else if (vertex->kind == MLIM_VERTEX_SURFACE)
  {
    s->goes[number] = !may_stay(s, vertex->point);
  }
  s->gone_count += s->goes[number];
}

static mlim_status make_room(mlim_refinement* r, sifting* s, mlim_context* context)
{
  mlim_complex* complex = &r->complex;
  mlim_status status = MLIM_OK;
  for (size_t v = 0; v < complex->vertex_count && status == MLIM_OK; ++v)
  {
    sift(s, &complex->vertices[v], v);
    if (v % LOOK_EVERY == 0)
    {
      status = mlim_progress(context, MLIM_STAGE_SURFACE, r->progress);
    }
  }
  return status == MLIM_OK && s->gone_count > 0
           ? mlim_complex_remove(complex, s->goes, r->progress, context)
           : status;
}

/* The curves of the new balls' neighbours have changed. */
static mlim_status touch_neighbors(mlim_refinement* r, const sifting* s, mlim_context* context)
{
  mlim_complex* complex = &r->complex;
  unsigned char* is_beside = mlim_allocate_zeroed(s->balls->ball_count, 1);
  if (is_beside == NULL)
  {
    return mlim_fail_memory(context, "the contacts");
  }
  for (size_t e = 0; e < s->balls->edge_count; ++e)
  {
    const int32_t* ends = s->balls->edges + 2 * e;
    is_beside[ends[0]] |= !s->is_there[ends[1]];
    is_beside[ends[1]] |= !s->is_there[ends[0]];
  }
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
  {
    const mlim_vertex* vertex = &complex->vertices[v];
    if (vertex->kind == MLIM_VERTEX_BALL && (is_beside[vertex->ball] || !s->is_there[vertex->ball]))
    {
      mlim_complex_touch_vertex(complex, (int32_t)v);
    }
  }
  mlim_release(is_beside);
  return MLIM_OK;
}

mlim_status mlim_contacts_enter(mlim_refinement* refinement, mlim_context* context,
  unsigned char* is_hidden, size_t* hidden_count)
{
  mlim_refinement* r = refinement;
  *hidden_count = 0;
  sifting s;
  mlim_status status = sifting_create(&r->complex, context, &s);
  if (status == MLIM_OK)
  {
    mlim_ball_links_free(&r->links);
    status = mlim_ball_links_create(r->complex.balls, context, &r->links);
  }
  status = status == MLIM_OK ? make_room(r, &s, context) : status;
  status = status == MLIM_OK
             ? mlim_refine_insert_balls(r, s.is_there, context, is_hidden, hidden_count)
             : status;
  status = status == MLIM_OK ? touch_neighbors(r, &s, context) : status;
  if (status == MLIM_OK && *hidden_count == 0)
  {
    status = mlim_refine_update(r, context);
  }
  sifting_free(&s);
  return status;
}
