#include "pinch.h"

#include "ball_list.h"
#include "label_sets.h"
#include "memory.h"
#include "refine_disks.h"
#include "status.h"
#include "tidy.h"
#include "vector.h"

/* Radius of a contact in units of the smallest distance. Nothing is inserted any more: it is only said. */
static const double RADIUS = 0.5;

enum
{
  MAX_LABELS = 16, /* of a star; one with more is left as it is */
  MAX_PINCHES = 4096,
  LOOKS = 5, /* at twice the smallest distance, at it, its half, and so on */
  LOOK_EVERY = 4096
};

typedef struct pinching
{
  mlim_refinement* refinement;
  mlim_context* context;
  mlim_ball_list list;
  mlim_set_table table;
  int32_t labels[MAX_LABELS]; /* of the star at work */
  size_t label_count;
  int32_t* pinches; /* vertices, ascending */
  size_t count, capacity;
  const mlim_balls* old;
  size_t stray_count; /* before, of the facets round pinches */
} pinching;

static mlim_status copy_balls(pinching* p)
{
  const mlim_balls* old = p->refinement->complex.balls;
  mlim_status status = MLIM_OK;
  for (size_t b = 0; b < old->ball_count && !status; ++b)
  {
    size_t count;
    int32_t set;
    const int32_t* labels = mlim_set_labels(&old->sets, old->ball_sets[b], &count);
    status = mlim_set_table_add(&p->table, labels, count, &set);
    status = status ? status
                    : mlim_ball_list_add(
                        &p->list, old->centers + 3 * b, old->radii[b], old->ball_curves[b], set);
  }
  for (size_t e = 0; e < old->edge_count && !status; ++e)
  {
    status =
      mlim_ball_list_join(&p->list, old->edges[2 * e], old->edges[2 * e + 1], old->edge_curves[e]);
  }
  return status;
}

/* 0: there are too many. */
static int list_labels(pinching* p)
{
  const mlim_star* star = &p->refinement->star;
  p->label_count = 0;
  for (size_t c = 0; c < star->cell_count; ++c)
  {
    const int32_t label = p->refinement->complex.cells[star->cells[c]].label;
    size_t k = 0;
    while (k < p->label_count && p->labels[k] != label)
    {
      ++k;
    }
    if (k == MAX_LABELS)
    {
      return 0;
    }
    p->labels[k] = label;
    p->label_count += k == p->label_count;
  }
  return 1;
}

/* Looks to the 26 sides of the vertex for each label of its star. */
static int is_pinched(const pinching* p, const double point[3])
{
  const mlim_field* field = p->refinement->complex.oracle.field;
  unsigned seen = 0;
  double distance = 2 * p->refinement->options->smallest_distance;
  for (int look = 0; look < LOOKS; ++look, distance *= 0.5)
  {
    for (int side = 0; side < 27; ++side)
    {
      const double way[3] = { side % 3 - 1, side / 3 % 3 - 1, side / 9 - 1 };
      const double length = sqrt(mlim_dot(way, way));
      double at[3];
      for (int k = 0; k < 3; ++k)
      {
        at[k] = point[k] + (length > 0 ? distance * way[k] / length : 0);
      }
      const int32_t label = mlim_field_label(field, at);
      for (size_t k = 0; k < p->label_count; ++k)
      {
        seen |= p->labels[k] == label ? 1u << k : 0;
      }
    }
  }
  return seen == (1u << p->label_count) - 1;
}

static int is_pinch(const pinching* p, int32_t vertex)
{
  size_t low = 0;
  size_t high = p->count;
  while (low < high)
  {
    const size_t middle = low + (high - low) / 2;
    low = p->pinches[middle] < vertex ? middle + 1 : low;
    high = p->pinches[middle] < vertex ? high : middle;
  }
  return low < p->count && p->pinches[low] == vertex;
}

/* Whether a facet round a vertex has a pinch of a lower number: there it is counted already. */
static int has_lower_pinch(const pinching* p, const mlim_cell* cell, int index, int32_t vertex)
{
  int has = 0;
  for (int k = 1; k < 4; ++k)
  {
    const int32_t other = cell->vertices[(index + k) & 3];
    has = has || (other < vertex && is_pinch(p, other));
  }
  return has;
}

/* Of the facets round a vertex, whose star has been gathered, but not round lower pinches. A facet is a stray by
   its own vertices, so none other becomes one or ceases to be one. */
static size_t count_strays(const pinching* p, int32_t vertex)
{
  const mlim_complex* complex = &p->refinement->complex;
  const mlim_star* star = &p->refinement->star;
  size_t count = 0;
  for (size_t c = 0; c < star->cell_count; ++c)
  {
    const int32_t id = star->cells[c];
    const mlim_cell* cell = &complex->cells[id];
    for (int k = 0; k < 4; ++k)
    {
      const int is_first = cell->vertices[k] != vertex && id < cell->neighbors[k];
      count +=
        is_first && !has_lower_pinch(p, cell, k, vertex) && mlim_tidy_is_stray(complex, id, k);
    }
  }
  return count;
}

/* While the vertex is none yet. */
static mlim_status note_pinch(pinching* p, int32_t vertex)
{
  mlim_complex* complex = &p->refinement->complex;
  const mlim_balls* balls = complex->balls;
  if (mlim_reserve(&p->pinches, &p->capacity, p->count + 1, sizeof *p->pinches))
  {
    return mlim_fail_memory(p->context, "the contacts");
  }
  complex->balls = p->old;
  p->stray_count += count_strays(p, vertex);
  complex->balls = balls;
  p->pinches[p->count++] = vertex;
  return MLIM_OK;
}

/* Once the balls have their sets. */
static mlim_status update_strays(pinching* p, size_t* stray_count)
{
  mlim_refinement* r = p->refinement;
  size_t after = 0;
  mlim_status status = MLIM_OK;
  for (size_t n = 0; n < p->count && status == MLIM_OK; ++n)
  {
    mlim_disk disk;
    status = mlim_disk_check(&r->complex, &r->links, p->pinches[n], &r->star, p->context, &disk);
    after += status == MLIM_OK ? count_strays(p, p->pinches[n]) : 0;
  }
  *stray_count += after - p->stray_count;
  return status;
}

static mlim_status make_contact(pinching* p, int32_t vertex)
{
  mlim_complex* complex = &p->refinement->complex;
  mlim_vertex* v = &complex->vertices[vertex];
  mlim_balls* balls = &p->list.balls;
  int32_t set;
  mlim_status status = mlim_set_table_add(&p->table, p->labels, p->label_count, &set);
  if (!status && v->ball >= 0)
  {
    balls->ball_curves[v->ball] = MLIM_CONTACT;
    status = mlim_set_table_join(&p->table, balls->ball_sets[v->ball], set, &set);
    balls->ball_sets[v->ball] = set;
  }
  else if (!status)
  {
    const double radius = RADIUS * p->refinement->options->smallest_distance;
    status = mlim_ball_list_add(&p->list, v->point, radius, MLIM_CONTACT, set);
    v->kind = MLIM_VERTEX_BALL;
    v->ball = (int32_t)balls->ball_count - 1;
  }
  if (status)
  {
    return mlim_fail_memory(p->context, "the contacts");
  }
  for (size_t c = 0; c < p->refinement->star.cell_count; ++c)
  {
    mlim_complex_touch_cell(complex, p->refinement->star.cells[c]);
  }
  mlim_ball_links_free(&p->refinement->links);
  return mlim_ball_links_create(balls, p->context, &p->refinement->links);
}

static mlim_status look_at_vertex(pinching* p, int32_t vertex)
{
  mlim_refinement* r = p->refinement;
  if (!r->complex.vertices[vertex].is_broken)
  {
    return MLIM_OK;
  }
  mlim_disk disk;
  mlim_status status = mlim_disk_check(&r->complex, &r->links, vertex, &r->star, p->context, &disk);
  if (status == MLIM_OK && disk == MLIM_DISK_FAILS && p->count < MAX_PINCHES && list_labels(p) &&
      is_pinched(p, r->complex.vertices[vertex].point))
  {
    status = note_pinch(p, vertex);
    status = status == MLIM_OK ? make_contact(p, vertex) : status;
  }
  return status;
}

mlim_status mlim_pinch_run(mlim_refinement* refinement, double done, mlim_context* context,
  mlim_balls* out, size_t* count, size_t* stray_count)
{
  mlim_complex* complex = &refinement->complex;
  const mlim_balls* old = complex->balls;
  pinching p = { .refinement = refinement, .context = context, .old = old };
  *out = (mlim_balls){ 0 };
  mlim_status status = mlim_disks_settle(refinement, done, context);
  if (status != MLIM_OK)
  {
    return status;
  }
  status = copy_balls(&p);
  if (status == MLIM_OUT_OF_MEMORY)
  {
    mlim_fail_memory(context, "the contacts");
  }
  complex->balls = &p.list.balls;
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count && !status; ++v)
  {
    status = look_at_vertex(&p, (int32_t)v);
    if (v % LOOK_EVERY == 0 && !status)
    {
      status = mlim_progress(context, MLIM_STAGE_CERTIFICATE, done);
    }
  }
  if (!status && p.count > 0)
  {
    status = mlim_sets_copy(&p.table.sets, &p.list.balls.sets);
    status = status ? status : update_strays(&p, stray_count);
  }
  complex->balls = old;
  *count = p.count;
  if (!status && p.count > 0)
  {
    mlim_ball_list_take(&p.list, out);
  }
  mlim_ball_list_free(&p.list);
  mlim_set_table_free(&p.table);
  mlim_release(p.pinches);
  return status == MLIM_OUT_OF_MEMORY ? mlim_fail_memory(context, "the contacts") : status;
}
