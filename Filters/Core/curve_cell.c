#include "curve_cell.h"
#include "memory.h"
#include "vector.h"

#include <math.h>

enum
{
  MAX_SPLIT_DEPTH = 3, /* an eighth of a cell: below what a mesh of the data can show */
  MAX_REFINE_DEPTH = 4 /* 16 pieces a segment: a bend of a whole cell to within 0.002 */
};

/* A segment is refined while its middle is farther than this from the tie, in spacings. A tenth of
   the accuracy asked for; smaller: more points, larger: chords that show. */
static const double REFINE_DISTANCE = 0.004;
/* A refined point may leave the cell by this much, in cells: the neighbour's interpolant differs
   there, but only by the step in slope. */
static const double REFINE_MARGIN = 0.02;

mlim_status mlim_cell_work_create(
  const mlim_field* field, mlim_network* network, mlim_cell_work* out)
{
  const size_t count = mlim_field_max_candidates(field);
  mlim_cell_work work = { .field = field,
    .grid = mlim_field_grid_of(field),
    .network = network,
    .label_count = mlim_field_label_count(field),
    .buffer = { .labels = mlim_allocate(count, sizeof(uint16_t)),
      .values = mlim_allocate(count, 8 * sizeof(float)) },
    .labels = mlim_allocate(count + 1, sizeof(int32_t)),
    .values = mlim_allocate(count + 1, 8 * sizeof(double)),
    .corners = mlim_allocate(count + 1, 4 * sizeof(double)) };
  if (!work.buffer.labels || !work.buffer.values || !work.labels || !work.values || !work.corners)
  {
    mlim_cell_work_free(&work);
    return MLIM_OUT_OF_MEMORY;
  }
  *out = work;
  return MLIM_OK;
}

void mlim_cell_work_free(mlim_cell_work* work)
{
  mlim_release(work->buffer.labels);
  mlim_release(work->buffer.values);
  mlim_release(work->labels);
  mlim_release(work->values);
  mlim_release(work->corners);
  mlim_face_work_free(&work->face);
  mlim_release(work->points);
  mlim_release(work->stack);
  *work = (mlim_cell_work){ 0 };
}

void mlim_cell_load(mlim_cell_work* work, const int32_t cell[3])
{
  const mlim_candidates candidates = mlim_field_cell(work->field, cell, &work->buffer);
  work->count = (size_t)candidates.count;
  work->point_count = 0;
  work->stack_count = 0;
  for (int k = 0; k < 3; ++k)
  {
    work->cell[k] = cell[k];
  }
  for (size_t l = 0; l < work->count; ++l)
  {
    work->labels[l] = candidates.labels[l];
    for (size_t c = 0; c < 8; ++c)
    {
      work->values[8 * l + c] = candidates.values ? (double)candidates.values[8 * l + c] : 0;
    }
  }
}

/* Values of all labels at one place into column `corner` of the corner values. */
static void sample(mlim_cell_work* work, const double at[3], size_t corner, size_t corner_count)
{
  for (size_t l = 0; l < work->count; ++l)
  {
    work->corners[corner_count * l + corner] = mlim_tie_value(work->values + 8 * l, at);
  }
}

mlim_status mlim_cell_find_square(
  mlim_cell_work* work, int axis, const double low[3], double size, double offset)
{
  const int u = axis == 0 ? 1 : 0;
  const int v = axis == 2 ? 1 : 2;
  for (int c = 0; c < 4; ++c)
  {
    double at[3];
    at[axis] = offset;
    at[u] = low[u] + (c & 1 ? size : 0);
    at[v] = low[v] + (c & 2 ? size : 0);
    sample(work, at, (size_t)c, 4);
  }
  const mlim_corners square = {
    .count = work->count, .labels = work->labels, .values = work->corners
  };
  return mlim_face_find(&square, &work->network->table, &work->face);
}

mlim_status mlim_cell_find_edge(mlim_cell_work* work, int axis, const double low[3], double size)
{
  double at[3];
  mlim_copy(low, at);
  sample(work, at, 0, 2);
  at[axis] += size;
  sample(work, at, 1, 2);
  const mlim_corners edge = {
    .count = work->count, .labels = work->labels, .values = work->corners
  };
  return mlim_edge_find(&edge, &work->face);
}

mlim_status mlim_cell_push_index(mlim_cell_work* work, int32_t point)
{
  if (mlim_reserve(
        &work->stack, &work->stack_capacity, work->stack_count + 1, sizeof(*work->stack)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  work->stack[work->stack_count] = point;
  ++work->stack_count;
  return MLIM_OK;
}

mlim_status mlim_cell_push_point(mlim_cell_work* work, const mlim_cell_point* point)
{
  if (mlim_reserve(&work->points, &work->point_capacity, work->point_count + 1, sizeof(*point)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  work->points[work->point_count] = *point;
  ++work->point_count;
  return mlim_cell_push_index(work, (int32_t)work->point_count - 1);
}

mlim_status mlim_cell_weld(mlim_cell_work* work, size_t begin)
{
  size_t kept = begin;
  for (size_t i = begin; i < work->stack_count; ++i)
  {
    const mlim_cell_point* point = work->points + work->stack[i];
    size_t j = begin;
    while (j < kept && mlim_distance_squared(work->points[work->stack[j]].at, point->at) >
                         MLIM_WELD_DISTANCE * MLIM_WELD_DISTANCE)
    {
      ++j;
    }
    if (j == kept)
    {
      work->stack[kept] = work->stack[i];
      ++kept;
      continue;
    }
    mlim_cell_point* first = work->points + work->stack[j];
    const mlim_status status =
      mlim_set_table_join(&work->network->table, first->set, point->set, &first->set);
    if (status)
    {
      return status;
    }
    first->is_inner = first->is_inner && point->is_inner;
  }
  work->stack_count = kept;
  return MLIM_OK;
}

static mlim_status add_point(mlim_cell_work* work, const double at[3], int32_t set, int32_t* number)
{
  double point[3];
  for (int k = 0; k < 3; ++k)
  {
    point[k] = (work->cell[k] + at[k]) * work->grid->spacing[k];
  }
  return mlim_network_add_point(work->network, point, set, number);
}

static mlim_status number_point(mlim_cell_work* work, int32_t point)
{
  mlim_cell_point* p = work->points + point;
  return p->number >= 0 ? MLIM_OK : add_point(work, p->at, p->set, &p->number);
}

/* The end of a piece while a segment is refined. */
typedef struct piece_end
{
  double at[3];
  int32_t number;
} piece_end;

/* Moves the middle of a piece onto the tie. 0 when the piece is good or the tie is not there. */
static int find_middle(
  mlim_cell_work* work, const piece_end* a, const piece_end* b, int32_t set, double at[3])
{
  const mlim_tie_cell cell = { .count = work->count,
    .labels = work->labels,
    .values = work->values,
    .spacing = { work->grid->spacing[0], work->grid->spacing[1], work->grid->spacing[2] } };
  double length = 0;
  unsigned char is_fixed[3];
  for (int k = 0; k < 3; ++k)
  {
    /* Equal coordinates on a face of the cell: the segment lies in the face and stays there. */
    const double c = a->at[k];
    is_fixed[k] = !(c > 0 && c < 1) && !(b->at[k] > c) && !(b->at[k] < c);
    const double d = (b->at[k] - a->at[k]) * cell.spacing[k];
    length += d * d;
  }
  length = sqrt(length);
  size_t label_count;
  const int32_t* labels = mlim_set_labels(&work->network->table.sets, set, &label_count);
  double middle[3];
  mlim_interpolate(a->at, b->at, 0.5, middle);
  mlim_copy(middle, at);
  mlim_tie_project(&cell, labels, label_count, is_fixed, at);
  double moved = 0;
  for (int k = 0; k < 3; ++k)
  {
    if (!(at[k] >= -REFINE_MARGIN && at[k] <= 1 + REFINE_MARGIN))
    {
      return 0;
    }
    at[k] = fmin(fmax(at[k], 0), 1);
    const double d = (at[k] - middle[k]) * cell.spacing[k];
    moved += d * d;
  }
  moved = sqrt(moved);
  return moved > REFINE_DISTANCE * work->grid->min_spacing && moved < 0.5 * length;
}

static mlim_status refine(
  mlim_cell_work* work, const piece_end* a, const piece_end* b, int32_t set, int depth)
{
  piece_end middle;
  if (depth == MAX_REFINE_DEPTH || !find_middle(work, a, b, set, middle.at))
  {
    return mlim_network_add_segment(work->network, a->number, b->number, set);
  }
  mlim_status status = add_point(work, middle.at, set, &middle.number);
  if (!status)
  {
    status = refine(work, a, &middle, set, depth + 1);
  }
  return status ? status : refine(work, &middle, b, set, depth + 1);
}

mlim_status mlim_cell_emit(mlim_cell_work* work, int32_t a, int32_t b, int32_t set)
{
  mlim_status status = number_point(work, a);
  if (!status)
  {
    status = number_point(work, b);
  }
  if (status)
  {
    return status;
  }
  piece_end ends[2];
  const int32_t points[2] = { a, b };
  for (int e = 0; e < 2; ++e)
  {
    mlim_copy(work->points[points[e]].at, ends[e].at);
    ends[e].number = work->points[points[e]].number;
  }
  return refine(work, &ends[0], &ends[1], set, 0);
}

/* The middle of the points, moved to the tie of all their labels if that is close. */
static void find_center(mlim_cell_work* work, size_t begin, int32_t set, double size, double at[3])
{
  const double share = 1.0 / (double)(work->stack_count - begin);
  double middle[3] = { 0, 0, 0 };
  unsigned char is_fixed[3] = { 1, 1, 1 };
  const double* first = work->points[work->stack[begin]].at;
  for (size_t i = begin; i < work->stack_count; ++i)
  {
    const double* point = work->points[work->stack[i]].at;
    for (int k = 0; k < 3; ++k)
    {
      middle[k] += share * point[k];
      is_fixed[k] = is_fixed[k] && !(point[k] < first[k]) && !(point[k] > first[k]);
    }
  }
  for (int k = 0; k < 3; ++k)
  {
    middle[k] = is_fixed[k] ? first[k] : middle[k];
  }
  const mlim_tie_cell cell = { .count = work->count,
    .labels = work->labels,
    .values = work->values,
    .spacing = { work->grid->spacing[0], work->grid->spacing[1], work->grid->spacing[2] } };
  size_t label_count;
  const int32_t* labels = mlim_set_labels(&work->network->table.sets, set, &label_count);
  mlim_copy(middle, at);
  mlim_tie_project(&cell, labels, label_count, is_fixed, at);
  for (int k = 0; k < 3; ++k)
  {
    if (!(fabs(at[k] - middle[k]) < size && at[k] >= 0 && at[k] <= 1))
    {
      mlim_copy(middle, at);
      return;
    }
  }
}

mlim_status mlim_cell_emit_star(mlim_cell_work* work, size_t begin, double size)
{
  mlim_set_table* table = &work->network->table;
  int32_t set = work->points[work->stack[begin]].set;
  mlim_status status = MLIM_OK;
  for (size_t i = begin + 1; i < work->stack_count && !status; ++i)
  {
    status = mlim_set_table_join(table, set, work->points[work->stack[i]].set, &set);
  }
  double at[3];
  int32_t center = -1;
  if (!status)
  {
    find_center(work, begin, set, size, at);
    status = add_point(work, at, set, &center);
  }
  for (size_t i = begin; i < work->stack_count && !status; ++i)
  {
    const int32_t point = work->stack[i];
    status = number_point(work, point);
    if (!status)
    {
      status = mlim_network_add_segment(
        work->network, work->points[point].number, center, work->points[point].set);
    }
  }
  return status;
}

/* Two points whose sets have a curve's labels in common are joined; *is_done tells. */
static mlim_status join_two(mlim_cell_work* work, size_t begin, int* is_done)
{
  const int32_t a = work->stack[begin];
  const int32_t b = work->stack[begin + 1];
  mlim_set_table* table = &work->network->table;
  int32_t set;
  const mlim_status status =
    mlim_set_table_common(table, work->points[a].set, work->points[b].set, &set);
  if (status)
  {
    return status;
  }
  size_t count;
  mlim_set_labels(&table->sets, set, &count);
  *is_done = count >= 3;
  return *is_done ? mlim_cell_emit(work, a, b, set) : MLIM_OK;
}

mlim_status mlim_cell_join_pairs(mlim_cell_work* work, size_t begin, int* is_done)
{
  for (size_t i = begin; i < work->stack_count; ++i)
  {
    int same = 0;
    for (size_t j = begin; j < work->stack_count; ++j)
    {
      same += work->points[work->stack[i]].set == work->points[work->stack[j]].set;
    }
    if (same != 2)
    {
      return MLIM_OK;
    }
  }
  *is_done = 1;
  for (size_t i = begin; i < work->stack_count; ++i)
  {
    for (size_t j = i + 1; j < work->stack_count; ++j)
    {
      const int32_t set = work->points[work->stack[i]].set;
      if (work->points[work->stack[j]].set == set)
      {
        const mlim_status status = mlim_cell_emit(work, work->stack[i], work->stack[j], set);
        if (status)
        {
          return status;
        }
      }
    }
  }
  return MLIM_OK;
}

/* Pushes what is found on one square. */
static mlim_status push_square(
  mlim_cell_work* work, int axis, const double low[3], double size, double offset)
{
  mlim_status status = mlim_cell_find_square(work, axis, low, size, offset);
  for (size_t p = 0; p < work->face.point_count && !status; ++p)
  {
    const int u = axis == 0 ? 1 : 0;
    const int v = axis == 2 ? 1 : 2;
    mlim_cell_point point = { .set = work->face.points[p].set, .number = -1, .axis = axis };
    point.at[axis] = offset;
    point.at[u] = low[u] + size * work->face.points[p].at[0];
    point.at[v] = low[v] + size * work->face.points[p].at[1];
    status = mlim_cell_push_point(work, &point);
  }
  return status;
}

/* Pushes those points of the list that lie on the boundary of a child. A point of the plane of the
   split belongs to the children on both sides of it, any other to one: half-open intervals. */
static mlim_status push_child_list(
  mlim_cell_work* work, size_t begin, size_t end, const double middle[3], int child)
{
  mlim_status status = MLIM_OK;
  for (size_t i = begin; i < end && !status; ++i)
  {
    const int32_t index = work->stack[i];
    const mlim_cell_point* point = work->points + index;
    int is_here = 1;
    for (int k = 0; k < 3; ++k)
    {
      const int is_on_plane =
        k == point->axis && !(point->at[k] < middle[k]) && !(point->at[k] > middle[k]);
      is_here = is_here && (is_on_plane || (point->at[k] >= middle[k]) == (child >> k & 1));
    }
    status = is_here ? mlim_cell_push_index(work, index) : MLIM_OK;
  }
  return status;
}

/* The list of the points on the boundary of a subcell is on top of the stack from `begin` on.
   Curves enter and leave through points; a subcell in which it is plain how they go on is done,
   any other is split at its middle. */
static mlim_status trace(
  mlim_cell_work* work, const double low[3], double size, int depth, size_t begin)
{
  int is_done = 0;
  mlim_status status = mlim_cell_weld(work, begin);
  const size_t count = work->stack_count - begin;
  if (status || count < 2)
  {
    return status;
  }
  if (count == 2)
  {
    status = join_two(work, begin, &is_done);
  }
  else if (depth == MAX_SPLIT_DEPTH)
  {
    status = mlim_cell_join_pairs(work, begin, &is_done);
  }
  if (status || is_done)
  {
    return status;
  }
  if (depth == MAX_SPLIT_DEPTH)
  {
    return mlim_cell_emit_star(work, begin, size);
  }
  const double half = 0.5 * size;
  const double middle[3] = { low[0] + half, low[1] + half, low[2] + half };
  for (int axis = 0; axis < 3 && !status; ++axis)
  {
    status = push_square(work, axis, low, size, middle[axis]);
  }
  const size_t end = work->stack_count;
  for (int child = 0; child < 8 && !status; ++child)
  {
    double child_low[3];
    for (int k = 0; k < 3; ++k)
    {
      child_low[k] = child >> k & 1 ? middle[k] : low[k];
    }
    status = push_child_list(work, begin, end, middle, child);
    if (!status)
    {
      status = trace(work, child_low, half, depth + 1, end);
    }
    work->stack_count = end;
  }
  return status;
}

mlim_status mlim_cell_trace(mlim_cell_work* work, const int32_t cell[3])
{
  mlim_cell_load(work, cell);
  if (work->count < 3)
  {
    return MLIM_OK;
  }
  const double low[3] = { 0, 0, 0 };
  mlim_status status = MLIM_OK;
  for (int face = 0; face < 6 && !status; ++face)
  {
    status = push_square(work, face / 2, low, 1, face % 2);
  }
  return status ? status : trace(work, low, 1, 0, 0);
}
