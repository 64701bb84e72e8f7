#include "crease.h"
#include "vector.h"

enum
{
  MAX_SPLIT_DEPTH = 3 /* as inside cells */
};

/* The square of a cell on a face of the box. */
typedef struct crease_square
{
  int axis; /* across the face */
  int u;    /* the two axes in it, ascending */
  int v;
  int32_t code;  /* the face's code in label sets */
  double offset; /* 0 or 1: the face's place in the cell */
} crease_square;

/* Two labels or more and the codes of faces, of which there is at least one. */
static mlim_status make_set(mlim_cell_work* work, const int32_t* codes, size_t count, int32_t* out)
{
  return mlim_set_table_add(&work->network->table, codes, count, out);
}

/* Pushes the points along an edge of the square: where the winner changes. */
static mlim_status push_edge(
  mlim_cell_work* work, const crease_square* square, int axis, const double low[3], double size)
{
  mlim_status status = mlim_cell_find_edge(work, axis, low, size);
  for (size_t p = 0; p < work->face.edge_point_count && !status; ++p)
  {
    const mlim_edge_point* found = work->face.edge_points + p;
    const int32_t codes[3] = { found->before, found->after, square->code };
    mlim_cell_point point = { .number = -1, .axis = square->u + square->v - axis };
    mlim_copy(low, point.at);
    point.at[axis] += size * found->at;
    status = make_set(work, codes, 3, &point.set);
    if (!status)
    {
      status = mlim_cell_push_point(work, &point);
    }
  }
  return status;
}

/* Pushes the points inside the square where three labels tie: an inner curve ends there. */
static mlim_status push_inner(mlim_cell_work* work, const crease_square* square)
{
  const double low[3] = { 0, 0, 0 };
  mlim_status status = mlim_cell_find_square(work, square->axis, low, 1, square->offset);
  for (size_t p = 0; p < work->face.point_count && !status; ++p)
  {
    mlim_cell_point point = { .number = -1, .axis = -1, .is_inner = 1 };
    point.at[square->axis] = square->offset;
    point.at[square->u] = work->face.points[p].at[0];
    point.at[square->v] = work->face.points[p].at[1];
    int32_t set;
    status = make_set(work, &square->code, 1, &set);
    if (!status)
    {
      status =
        mlim_set_table_join(&work->network->table, set, work->face.points[p].set, &point.set);
    }
    if (!status)
    {
      status = mlim_cell_push_point(work, &point);
    }
  }
  return status;
}

/* Two points on the edges with two labels in common are joined. */
static mlim_status join_two(mlim_cell_work* work, size_t begin, int* is_done)
{
  const int32_t a = work->stack[begin];
  const int32_t b = work->stack[begin + 1];
  mlim_set_table* table = &work->network->table;
  int32_t set;
  const mlim_status status =
    mlim_set_table_common(table, work->points[a].set, work->points[b].set, &set);
  if (status || (work->points[a].is_inner && work->points[b].is_inner))
  {
    return status;
  }
  size_t count;
  mlim_set_labels(&table->sets, set, &count);
  *is_done = count >= 3;
  return *is_done ? mlim_cell_emit(work, a, b, set) : MLIM_OK;
}

/* Without an inner point curves cross the square in pairs of labels. With one, and as many points on
   the edges as it has labels, each pair once, the inner point is joined to all. */
static mlim_status join_fan(mlim_cell_work* work, size_t begin, int* is_done)
{
  int32_t inner = -1;
  for (size_t i = begin; i < work->stack_count; ++i)
  {
    if (work->points[work->stack[i]].is_inner)
    {
      if (inner >= 0)
      {
        return MLIM_OK;
      }
      inner = work->stack[i];
    }
  }
  if (inner < 0)
  {
    return mlim_cell_join_pairs(work, begin, is_done);
  }
  size_t label_count = 0;
  mlim_set_labels(&work->network->table.sets, work->points[inner].set, &label_count);
  if (work->stack_count - begin != label_count)
  {
    return MLIM_OK;
  }
  for (size_t i = begin; i < work->stack_count; ++i)
  {
    for (size_t j = begin; j < i; ++j)
    {
      if (work->points[work->stack[i]].set == work->points[work->stack[j]].set)
      {
        return MLIM_OK;
      }
    }
    int32_t set;
    const mlim_status status = mlim_set_table_common(
      &work->network->table, work->points[work->stack[i]].set, work->points[inner].set, &set);
    if (status || set != work->points[work->stack[i]].set)
    {
      return status;
    }
  }
  *is_done = 1;
  mlim_status status = MLIM_OK;
  for (size_t i = begin; i < work->stack_count && !status; ++i)
  {
    const int32_t point = work->stack[i];
    status = point == inner ? MLIM_OK : mlim_cell_emit(work, point, inner, work->points[point].set);
  }
  return status;
}

/* Pushes those points of the list that belong to a quarter: see mlim_cell_trace. */
static mlim_status push_quarter(mlim_cell_work* work, const crease_square* square, size_t begin,
  size_t end, const double middle[3], int quarter)
{
  mlim_status status = MLIM_OK;
  for (size_t i = begin; i < end && !status; ++i)
  {
    const int32_t index = work->stack[i];
    const mlim_cell_point* point = work->points + index;
    int is_here = 1;
    for (int side = 0; side < 2; ++side)
    {
      const int k = side ? square->v : square->u;
      const int is_on_line =
        k == point->axis && !(point->at[k] < middle[k]) && !(point->at[k] > middle[k]);
      is_here = is_here && (is_on_line || (point->at[k] >= middle[k]) == (quarter >> side & 1));
    }
    status = is_here ? mlim_cell_push_index(work, index) : MLIM_OK;
  }
  return status;
}

/* As inside cells, one dimension lower: points on the square's edges, and inner points. */
static mlim_status trace(mlim_cell_work* work, const crease_square* square, const double low[3],
  double size, int depth, size_t begin)
{
  int is_done = 0;
  mlim_status status = mlim_cell_weld(work, begin);
  const size_t count = work->stack_count - begin;
  if (status || count < 2)
  {
    return status;
  }
  status = count == 2 ? join_two(work, begin, &is_done) : join_fan(work, begin, &is_done);
  if (status || is_done)
  {
    return status;
  }
  if (depth == MAX_SPLIT_DEPTH)
  {
    return mlim_cell_emit_star(work, begin, size);
  }
  const double half = 0.5 * size;
  double middle[3];
  mlim_copy(low, middle);
  middle[square->u] += half;
  middle[square->v] += half;
  const int axes[2] = { square->u, square->v };
  for (int side = 0; side < 2 && !status; ++side)
  {
    double from[3];
    mlim_copy(low, from);
    from[axes[1 - side]] = middle[axes[1 - side]];
    status = push_edge(work, square, axes[side], from, size);
  }
  const size_t end = work->stack_count;
  for (int quarter = 0; quarter < 4 && !status; ++quarter)
  {
    double from[3];
    mlim_copy(low, from);
    from[square->u] = quarter & 1 ? middle[square->u] : low[square->u];
    from[square->v] = quarter & 2 ? middle[square->v] : low[square->v];
    status = push_quarter(work, square, begin, end, middle, quarter);
    if (!status)
    {
      status = trace(work, square, from, half, depth + 1, end);
    }
    work->stack_count = end;
  }
  return status;
}

static mlim_status trace_square(mlim_cell_work* work, const crease_square* square)
{
  double low[3] = { 0, 0, 0 };
  low[square->axis] = square->offset;
  mlim_status status = MLIM_OK;
  for (int edge = 0; edge < 4 && !status; ++edge)
  {
    const int axis = edge & 1 ? square->v : square->u;
    double from[3];
    mlim_copy(low, from);
    from[edge & 1 ? square->u : square->v] = edge >> 1;
    status = push_edge(work, square, axis, from, 1);
  }
  if (!status)
  {
    status = push_inner(work, square);
  }
  return status ? status : trace(work, square, low, 1, 0, 0);
}

mlim_status mlim_crease_trace_face(mlim_cell_work* work, int face)
{
  const int axis = face / 2;
  const crease_square square = { .axis = axis,
    .u = axis == 0 ? 1 : 0,
    .v = axis == 2 ? 1 : 2,
    .code = work->label_count + face,
    .offset = face % 2 };
  int32_t cell[3];
  cell[axis] = face % 2 ? work->grid->cells[axis] - 1 : 0;
  mlim_status status = MLIM_OK;
  for (int32_t j = 0; j < work->grid->cells[square.v] && !status; ++j)
  {
    for (int32_t i = 0; i < work->grid->cells[square.u] && !status; ++i)
    {
      cell[square.u] = i;
      cell[square.v] = j;
      mlim_cell_load(work, cell);
      status = work->count > 1 ? trace_square(work, &square) : MLIM_OK;
    }
  }
  return status;
}

/* A point of a box edge with the labels around it and the faces that meet there. */
static mlim_status push_edge_point(mlim_cell_work* work, const double at[3],
  const int32_t labels[2], const int32_t faces[2], int32_t third_face)
{
  const int32_t codes[5] = { labels[0], labels[1], faces[0], faces[1], third_face };
  mlim_cell_point point = { .number = -1, .axis = -1 };
  mlim_copy(at, point.at);
  const mlim_status status = make_set(work, codes, third_face < 0 ? 4 : 5, &point.set);
  return status ? status : mlim_cell_push_point(work, &point);
}

/* The part of a box edge in one cell: points at its ends and where the winner changes, joined where
   the winner is a region. */
static mlim_status trace_edge_cell(
  mlim_cell_work* work, int axis, const int32_t faces[2], const double low[3])
{
  const int32_t outside = mlim_field_outside_label(work->field);
  const int32_t first_code = work->label_count + 2 * axis;
  const int is_first = work->cell[axis] == 0;
  const int is_last = work->cell[axis] == work->grid->cells[axis] - 1;
  mlim_status status = mlim_cell_find_edge(work, axis, low, 1);
  const size_t count = work->face.edge_point_count;
  int32_t label = work->face.first_label;
  double at[3];
  mlim_copy(low, at);
  const int32_t same[2] = { label, label };
  if (!status)
  {
    status = push_edge_point(work, at, same, faces, is_first ? first_code : -1);
  }
  for (size_t p = 0; p <= count && !status; ++p)
  {
    const int is_end = p == count;
    const int32_t next = is_end ? label : work->face.edge_points[p].after;
    const int32_t labels[2] = { label, next };
    at[axis] = is_end ? 1 : work->face.edge_points[p].at;
    status = push_edge_point(work, at, labels, faces, is_end && is_last ? first_code + 1 : -1);
    if (!status && label != outside)
    {
      const int32_t codes[3] = { label, faces[0], faces[1] };
      const int32_t top = (int32_t)work->point_count - 1;
      int32_t set;
      status = make_set(work, codes, 3, &set);
      if (!status)
      {
        status = mlim_cell_emit(work, top - 1, top, set);
      }
    }
    label = next;
  }
  return status;
}

mlim_status mlim_crease_trace_edges(mlim_cell_work* work, int axis)
{
  const int u = axis == 0 ? 1 : 0;
  const int v = axis == 2 ? 1 : 2;
  mlim_status status = MLIM_OK;
  for (int edge = 0; edge < 4 && !status; ++edge)
  {
    const int sides[2] = { edge & 1, edge >> 1 };
    const int32_t faces[2] = { work->label_count + 2 * u + sides[0],
      work->label_count + 2 * v + sides[1] };
    int32_t cell[3];
    cell[u] = sides[0] ? work->grid->cells[u] - 1 : 0;
    cell[v] = sides[1] ? work->grid->cells[v] - 1 : 0;
    double low[3] = { 0, 0, 0 };
    low[u] = sides[0];
    low[v] = sides[1];
    for (int32_t i = 0; i < work->grid->cells[axis] && !status; ++i)
    {
      cell[axis] = i;
      mlim_cell_load(work, cell);
      status = trace_edge_cell(work, axis, faces, low);
    }
  }
  return status;
}
