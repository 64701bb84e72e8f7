#include "cells.h"

#include "box.h"
#include "memory.h"
#include "queue.h"
#include "shape.h"
#include "status.h"
#include "vector.h"
#include "zone.h"

#include <math.h>

enum
{
  REPORT_EVERY = 1024,   /* insertions between two looks at the host: about 10 ms */
  JUDGE_EVERY = 1 << 18, /* cells judged between two looks: about 20 ms */
  TRIES = 2
};

/* Where a point is tried on the way from a cell's centroid to its power centre. The second place
   serves cells along an interface, whose centres would destroy facets of it. */
static const double PLACES[TRIES] = { 1, 0.5 };

/* A point off the centre has to keep this distance from all vertices, in shortest edges of its cell:
   nearer ones would make worse cells than they mend. */
static const double OFF_CENTER_DISTANCE = 0.8;

/* No point comes closer to a vertex than this part of the smallest distance, or of the cell size if
   that is less. */
static const double FLOOR_PART = 0.5;

typedef struct cells
{
  mlim_complex* complex;
  const mlim_options* options;
  mlim_context* context;
  mlim_queue queue;
  uint32_t* generations; /* per cell id: counts its uses */
  size_t generation_capacity, generation_count;
  double* sizes;  /* per label: bound on the circumradius */
  double* floors; /* per label: squared smallest distance of a new point from all vertices */
  double expected_insertions;
  double done;
  mlim_cells_result result;
} cells;

typedef struct verdict
{
  mlim_badness badness; /* MLIM_BAD_SIZE, MLIM_BAD_RATIO or MLIM_BAD_NONE */
  double excess;
  double shortest_squared;
} verdict;

int mlim_cells_is_inside(
  const mlim_complex* complex, const mlim_options* options, const mlim_cell* cell)
{
  if (cell->vertices[0] < 0 ||
      (!options->keep_background && cell->label == mlim_field_outside_label(complex->oracle.field)))
  {
    return 0;
  }
  for (int k = 0; k < 4; ++k)
  {
    if (cell->vertices[k] < MLIM_FAR_VERTICES)
    {
      return 0;
    }
  }
  return 1;
}

/* A cell with a ball vertex may have any ratio: beside small balls points for its sake leave more such
   cells than they mend. */
static verdict judge(const cells* c, const mlim_cell* cell)
{
  verdict out = { .badness = MLIM_BAD_NONE, .shortest_squared = INFINITY };
  if (!mlim_cells_is_inside(c->complex, c->options, cell))
  {
    return out;
  }
  const double* points[4];
  int has_ball = 0;
  for (int k = 0; k < 4; ++k)
  {
    const mlim_vertex* v = &c->complex->vertices[cell->vertices[k]];
    points[k] = v->point;
    has_ball |= v->kind == MLIM_VERTEX_BALL;
    for (int j = 0; j < k; ++j)
    {
      out.shortest_squared =
        mlim_min(out.shortest_squared, mlim_distance_squared(points[k], points[j]));
    }
  }
  const double squared = mlim_shape_radius_squared(points); /* whatever the weights */
  const double size = c->sizes[cell->label];
  if (squared > size * size)
  {
    out.badness = MLIM_BAD_SIZE;
    out.excess = sqrt(squared) / size;
    return out;
  }
  const double bound = c->options->cell_radius_edge_ratio;
  if (!has_ball && squared > bound * bound * out.shortest_squared)
  {
    out.badness = MLIM_BAD_RATIO;
    out.excess = sqrt(squared / out.shortest_squared) / bound;
  }
  return out;
}

static int enqueue(cells* c, int32_t id)
{
  const mlim_cell* cell = &c->complex->cells[id];
  const verdict v = judge(c, cell);
  return v.badness == MLIM_BAD_NONE
           ? 0
           : mlim_queue_push_at(&c->queue, mlim_queue_bin_of(v.badness, v.excess),
               mlim_complex_center(c->complex, id), id, c->generations[id]);
}

static mlim_status report(cells* c)
{
  const double share = (double)c->result.insertion_count / c->expected_insertions;
  return mlim_progress(c->context, MLIM_STAGE_VOLUME, c->done * (1 - exp(-1.5 * share)));
}

/* ---- insertion ---- */

static int reserve_generations(cells* c)
{
  const size_t needed = c->complex->cell_count;
  if (mlim_reserve(&c->generations, &c->generation_capacity, needed, sizeof *c->generations))
  {
    return 1;
  }
  for (; c->generation_count < needed; ++c->generation_count)
  {
    c->generations[c->generation_count] = 0;
  }
  return 0;
}

static mlim_status fill(cells* c, const mlim_delaunay_zone* zone, int32_t label)
{
  mlim_delaunay_zone made;
  for (size_t k = 0; k < zone->count; ++k)
  {
    ++c->generations[zone->cells[k]];
  }
  const mlim_status status = mlim_zone_fill(c->complex, label, c->context, &made);
  if (status != MLIM_OK)
  {
    return status;
  }
  ++c->result.insertion_count;
  int failed = reserve_generations(c);
  for (size_t k = 0; k < made.count && !failed; ++k)
  {
    failed = enqueue(c, made.cells[k]);
  }
  return failed ? mlim_fail_memory(c->context, "the queue of cells") : MLIM_OK;
}

/* Points of the box's faces are the caps' alone. */
static int is_in_box(const cells* c, const double point[3])
{
  const double* size = mlim_field_grid_of(c->complex->oracle.field)->size;
  return point[0] > 0 && point[0] < size[0] && point[1] > 0 && point[1] < size[1] && point[2] > 0 &&
         point[2] < size[2];
}

static void place_of(const cells* c, int32_t id, double part, double out[3])
{
  const mlim_cell* cell = &c->complex->cells[id];
  const double* center = mlim_complex_center(c->complex, id);
  for (int k = 0; k < 3; ++k)
  {
    double centroid = 0;
    for (int v = 0; v < 4; ++v)
    {
      centroid += 0.25 * c->complex->vertices[cell->vertices[v]].point[k];
    }
    out[k] = part < 1 ? centroid + part * (center[k] - centroid) : center[k];
  }
}

/* Inserts a point that kills the cell, if there is a place for one. */
static mlim_status mend(cells* c, int32_t id, const verdict* v)
{
  const mlim_cell cell = c->complex->cells[id];
  const double floor = c->floors[cell.label];
  for (int k = 0; k < TRIES; ++k)
  {
    const double off = OFF_CENTER_DISTANCE * OFF_CENTER_DISTANCE * v->shortest_squared;
    double point[3];
    place_of(c, id, PLACES[k], point);
    if (!is_in_box(c, point))
    {
      continue;
    }
    mlim_delaunay_zone zone;
    const mlim_status status = mlim_delaunay_find(
      c->complex->delaunay, point, 0, id, MLIM_START_IN_CONFLICT, c->context, &zone);
    if (status != MLIM_OK)
    {
      return status;
    }
    const mlim_zone_demand demand = { .label = cell.label,
      .least_squared = k == 0 ? floor : mlim_max(floor, off) };
    if (mlim_zone_is_free(c->complex, &zone, point, &demand))
    {
      return fill(c, &zone, cell.label);
    }
  }
  return MLIM_OK;
}

/* ---- the loop ---- */

static mlim_status work_batch(cells* c)
{
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < c->queue.batch.count && status == MLIM_OK; ++k)
  {
    const mlim_queue_entry entry = c->queue.batch.entries[k];
    const mlim_cell* cell = &c->complex->cells[entry.record];
    if (cell->vertices[0] < 0 || c->generations[entry.record] != entry.generation)
    {
      continue;
    }
    const verdict v = judge(c, cell);
    status = mend(c, entry.record, &v);
    if (status == MLIM_OK && k % REPORT_EVERY == REPORT_EVERY - 1)
    {
      status = report(c);
    }
  }
  return status;
}

static mlim_status enqueue_all(cells* c)
{
  for (size_t id = 0; id < c->complex->cell_count; ++id)
  {
    if (enqueue(c, (int32_t)id))
    {
      return mlim_fail_memory(c->context, "the queue of cells");
    }
    const mlim_status status = id % JUDGE_EVERY == 0 ? report(c) : MLIM_OK;
    if (status != MLIM_OK)
    {
      return status;
    }
  }
  return MLIM_OK;
}

static mlim_status count_unresolved(cells* c)
{
  for (size_t id = 0; id < c->complex->cell_count; ++id)
  {
    const verdict v = judge(c, &c->complex->cells[id]);
    c->result.unresolved_size_count += v.badness == MLIM_BAD_SIZE;
    c->result.unresolved_ratio_count += v.badness == MLIM_BAD_RATIO;
    const mlim_status status =
      id % JUDGE_EVERY == 0 ? mlim_progress(c->context, MLIM_STAGE_VOLUME, c->done) : MLIM_OK;
    if (status != MLIM_OK)
    {
      return status;
    }
  }
  return MLIM_OK;
}

/* A guess, for progress: cells of their size have about this part of its cube as volume. */
static double guess_insertions(const cells* c)
{
  static const double cell_volume = 0.15;
  static const double cells_per_vertex = 6;
  const double* size = mlim_field_grid_of(c->complex->oracle.field)->size;
  const double bound = c->options->cell_size;
  return 1000 +
         size[0] * size[1] * size[2] / (cells_per_vertex * cell_volume * bound * bound * bound);
}

static mlim_status start(cells* c)
{
  const mlim_field* field = c->complex->oracle.field;
  const size_t labels = (size_t)mlim_field_label_count(field);
  c->sizes = mlim_allocate(labels, sizeof *c->sizes);
  c->floors = mlim_allocate(labels, sizeof *c->floors);
  if (c->sizes == NULL || c->floors == NULL || reserve_generations(c))
  {
    return mlim_fail_memory(c->context, "the refinement of cells");
  }
  for (size_t l = 0; l < labels; ++l)
  {
    c->sizes[l] = c->options->cell_size;
    for (size_t k = 0; k < c->options->label_size_count; ++k)
    {
      if (c->options->label_sizes[k].id == mlim_field_label_id(field, (int32_t)l))
      {
        c->sizes[l] = c->options->label_sizes[k].size;
      }
    }
    const double floor = FLOOR_PART * mlim_min(c->options->smallest_distance, c->sizes[l]);
    c->floors[l] = floor * floor;
  }
  mlim_queue_start(&c->queue, mlim_field_grid_of(field)->size);
  c->expected_insertions = guess_insertions(c);
  return MLIM_OK;
}

static mlim_status fill_box(cells* c)
{
  const size_t before = c->complex->vertex_count;
  const double size = c->sizes[mlim_field_outside_label(c->complex->oracle.field)];
  const mlim_status status =
    mlim_box_fill(c->complex, size, c->context, &c->result.unresolved_box_count);
  c->result.insertion_count += c->complex->vertex_count - before;
  return status == MLIM_OK && reserve_generations(c)
           ? mlim_fail_memory(c->context, "the refinement of cells")
           : status;
}

mlim_status mlim_cells_refine(mlim_complex* complex, const mlim_options* options, double done,
  mlim_context* context, mlim_cells_result* out)
{
  *out = (mlim_cells_result){ 0 };
  cells c = { .complex = complex, .options = options, .context = context, .done = done };
  mlim_status status = start(&c);
  if (status == MLIM_OK && options->keep_background)
  {
    status = fill_box(&c);
  }
  if (status == MLIM_OK)
  {
    status = enqueue_all(&c);
  }
  /* Each batch inserts points or empties a bin, and the vertex limit bounds the points. */
  while (status == MLIM_OK && mlim_queue_next(&c.queue) >= 0)
  {
    status = work_batch(&c);
  }
  if (status == MLIM_OK || status == MLIM_VERTEX_LIMIT)
  {
    const mlim_status counted = count_unresolved(&c);
    status = counted == MLIM_OK ? status : counted;
    *out = c.result;
  }
  mlim_queue_free(&c.queue);
  mlim_release(c.generations);
  mlim_release(c.sizes);
  mlim_release(c.floors);
  return status;
}
