#include "balls.h"

#include "ball_grid.h"
#include "ball_list.h"
#include "label_sets.h"
#include "memory.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A contact takes the place of a ball whose centre it holds, or misses by less than this part of the
   ball's radius: of two such balls one would be hidden, or have no room of its own. */
static const double CENTER_MARGIN = 0.05;
/* A ball between two that are apart overlaps both by this part of the smaller radius. */
static const double FILL_OVERLAP = 0.35;

enum
{
  NOBODY = -1
};

/* A curve's edge that ends at a contact. */
typedef struct loose_edge
{
  int32_t ends[2]; /* new balls, the lower first */
  int32_t curve;
  int32_t set;
} loose_edge;

typedef struct contraction
{
  const mlim_balls* old;
  const mlim_contact* contacts;
  size_t contact_count;
  int32_t* owners;  /* per old ball: the contact that takes its place, NOBODY */
  int32_t* numbers; /* per old ball: the new ball that stands for it */
  mlim_set_table table;
  int32_t* old_sets;     /* in the table, per old set */
  int32_t* contact_sets; /* in the table, per contact */
  loose_edge* loose;
  size_t loose_count;
  mlim_ball_list list;
} contraction;

static void contraction_free(contraction* work)
{
  mlim_release(work->owners);
  mlim_release(work->numbers);
  mlim_release(work->old_sets);
  mlim_release(work->contact_sets);
  mlim_release(work->loose);
  mlim_set_table_free(&work->table);
  mlim_ball_list_free(&work->list);
}

static mlim_status add_sets(contraction* work, const mlim_sets* sets)
{
  mlim_status status = MLIM_OK;
  for (size_t s = 0; s < work->old->sets.count && !status; ++s)
  {
    size_t count;
    const int32_t* labels = mlim_set_labels(&work->old->sets, (int32_t)s, &count);
    status = mlim_set_table_add(&work->table, labels, count, work->old_sets + s);
  }
  for (size_t c = 0; c < work->contact_count && !status; ++c)
  {
    size_t count;
    const int32_t* labels = mlim_set_labels(sets, work->contacts[c].set, &count);
    status = mlim_set_table_add(&work->table, labels, count, work->contact_sets + c);
  }
  return status;
}

static mlim_status create(contraction* work, const mlim_sets* sets)
{
  const size_t balls = work->old->ball_count;
  work->owners = mlim_allocate(balls, sizeof(int32_t));
  work->numbers = mlim_allocate(balls, sizeof(int32_t));
  work->old_sets = mlim_allocate(work->old->sets.count, sizeof(int32_t));
  work->contact_sets = mlim_allocate(work->contact_count, sizeof(int32_t));
  work->loose = mlim_allocate(work->old->edge_count, sizeof(loose_edge));
  return work->owners && work->numbers && work->old_sets && work->contact_sets && work->loose
           ? add_sets(work, sets)
           : MLIM_OUT_OF_MEMORY;
}

/* Gives each ball to the first contact that holds its centre; the contact has its labels too. */
static mlim_status find_owners(contraction* work)
{
  const mlim_balls* old = work->old;
  mlim_ball_grid grid;
  mlim_status status = mlim_ball_grid_fill(old, &grid);
  for (size_t b = 0; b < old->ball_count; ++b)
  {
    work->owners[b] = NOBODY;
  }
  for (size_t c = 0; c < work->contact_count && !status; ++c)
  {
    const mlim_contact* contact = work->contacts + c;
    mlim_point_walk walk;
    const double reach = contact->radius + CENTER_MARGIN * grid.largest;
    for (int32_t b = mlim_point_grid_first(&grid.points, contact->center, reach, &walk);
         b >= 0 && !status; b = mlim_point_grid_next(&grid.points, &walk))
    {
      const double d = mlim_distance(old->centers + 3 * (size_t)b, contact->center);
      if (work->owners[b] == NOBODY && d < contact->radius + CENTER_MARGIN * old->radii[b])
      {
        work->owners[b] = (int32_t)c;
        status = mlim_set_table_join(&work->table, work->contact_sets[c],
          work->old_sets[old->ball_sets[b]], work->contact_sets + c);
      }
    }
  }
  mlim_ball_grid_free(&grid);
  return status;
}

/* The balls that stay keep their order; the contacts come last. */
static mlim_status place_balls(contraction* work)
{
  const mlim_balls* old = work->old;
  mlim_status status = MLIM_OK;
  for (size_t b = 0; b < old->ball_count && !status; ++b)
  {
    work->numbers[b] = (int32_t)work->list.balls.ball_count;
    if (work->owners[b] == NOBODY)
    {
      status = mlim_ball_list_add(&work->list, old->centers + 3 * b, old->radii[b],
        old->ball_curves[b], work->old_sets[old->ball_sets[b]]);
    }
  }
  const int32_t first = (int32_t)work->list.balls.ball_count;
  for (size_t b = 0; b < old->ball_count; ++b)
  {
    work->numbers[b] = work->owners[b] == NOBODY ? work->numbers[b] : first + work->owners[b];
  }
  for (size_t c = 0; c < work->contact_count && !status; ++c)
  {
    const mlim_contact* contact = work->contacts + c;
    status = mlim_ball_list_add(
      &work->list, contact->center, contact->radius, MLIM_CONTACT, work->contact_sets[c]);
  }
  return status;
}

static mlim_status sort_out_edges(contraction* work)
{
  const mlim_balls* old = work->old;
  mlim_status status = MLIM_OK;
  for (size_t e = 0; e < old->edge_count && !status; ++e)
  {
    const int32_t a = old->edges[2 * e];
    const int32_t b = old->edges[2 * e + 1];
    const int32_t ends[2] = { work->numbers[a], work->numbers[b] };
    if (work->owners[a] == NOBODY && work->owners[b] == NOBODY)
    {
      status = mlim_ball_list_join(&work->list, ends[0], ends[1], old->edge_curves[e]);
    }
    else if (ends[0] != ends[1])
    {
      const int32_t of = old->ball_curves[a] >= 0 ? a : b;
      work->loose[work->loose_count++] = (loose_edge){
        .ends = { ends[0] < ends[1] ? ends[0] : ends[1], ends[0] < ends[1] ? ends[1] : ends[0] },
        .curve = old->edge_curves[e],
        .set = work->old_sets[old->ball_sets[of]]
      };
    }
  }
  return status;
}

static int compare_loose(const void* a, const void* b)
{
  const loose_edge* x = a;
  const loose_edge* y = b;
  for (int k = 0; k < 2; ++k)
  {
    if (x->ends[k] != y->ends[k])
    {
      return x->ends[k] < y->ends[k] ? -1 : 1;
    }
  }
  return x->curve < y->curve ? -1 : x->curve > y->curve;
}

/* Joins two balls, with one more between them where they are apart. */
static mlim_status join(contraction* work, const loose_edge* edge)
{
  const int32_t a = edge->ends[0];
  const int32_t b = edge->ends[1];
  const double* from = work->list.balls.centers + 3 * (size_t)a;
  const double* to = work->list.balls.centers + 3 * (size_t)b;
  const double radius = work->list.balls.radii[a];
  const double smaller = mlim_min(radius, work->list.balls.radii[b]);
  const double d = mlim_distance(from, to);
  const double gap = d - radius - work->list.balls.radii[b];
  if (gap < 0)
  {
    return mlim_ball_list_join(&work->list, a, b, edge->curve);
  }
  double center[3];
  mlim_interpolate(from, to, (radius + 0.5 * gap) / d, center);
  const int32_t between = (int32_t)work->list.balls.ball_count;
  mlim_status status = mlim_ball_list_add(
    &work->list, center, 0.5 * gap + FILL_OVERLAP * smaller, edge->curve, edge->set);
  status = status ? status : mlim_ball_list_join(&work->list, a, between, edge->curve);
  return status ? status : mlim_ball_list_join(&work->list, between, b, edge->curve);
}

/* Two curves that both lead from one ball to the same contact are one there. */
static mlim_status join_loose(contraction* work)
{
  mlim_status status = MLIM_OK;
  if (work->loose_count > 0)
  {
    qsort(work->loose, work->loose_count, sizeof(loose_edge), compare_loose);
  }
  for (size_t e = 0; e < work->loose_count && !status; ++e)
  {
    const loose_edge* edge = work->loose + e;
    if (e == 0 || edge[-1].ends[0] != edge->ends[0] || edge[-1].ends[1] != edge->ends[1])
    {
      status = join(work, edge);
    }
  }
  return status;
}

mlim_status mlim_balls_contract(const mlim_balls* balls, const mlim_contact* contacts, size_t count,
  const mlim_sets* sets, mlim_context* context, mlim_balls* out)
{
  *out = (mlim_balls){ 0 };
  contraction work = { .old = balls, .contacts = contacts, .contact_count = count };
  mlim_status status = create(&work, sets);
  status = status ? status : find_owners(&work);
  status = status ? status : place_balls(&work);
  status = status ? status : sort_out_edges(&work);
  status = status ? status : join_loose(&work);
  status = status ? status : mlim_sets_copy(&work.table.sets, &work.list.balls.sets);
  if (status == MLIM_OUT_OF_MEMORY)
  {
    mlim_fail_memory(context, "the protecting balls");
  }
  if (!status)
  {
    mlim_ball_list_take(&work.list, out);
  }
  contraction_free(&work);
  return status;
}
