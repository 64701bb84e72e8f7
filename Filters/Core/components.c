#include "components.h"

#include "memory.h"
#include "status.h"

#include <limits.h>
#include <string.h>

enum
{
  LOOK_EVERY_SLICES = 16 /* slices of grid points between two looks at the host */
};

/* Grid points of one label next to each other in a row along x: there are far fewer of them than of
   points. */
typedef struct run
{
  int32_t begin, end; /* x of the first point, and past the last */
  int32_t label;
  int32_t parent; /* a run of the same component, itself at the root; later -1 - component */
} run;

typedef struct run_list
{
  run* runs;
  size_t count, capacity;
  size_t* rows; /* first run of each row, and past the last */
} run_list;

static int32_t root_of(run* runs, int32_t r)
{
  while (runs[r].parent != r)
  {
    runs[r].parent = runs[runs[r].parent].parent;
    r = runs[r].parent;
  }
  return r;
}

/* The lower one becomes the root. */
static void join(run* runs, int32_t a, int32_t b)
{
  a = root_of(runs, a);
  b = root_of(runs, b);
  runs[a < b ? b : a].parent = a < b ? a : b;
}

/* Not 0: out of memory. */
static int add_row(run_list* list, const uint16_t* labels, int32_t count)
{
  for (int32_t x = 0; x < count;)
  {
    int32_t end = x + 1;
    while (end < count && labels[end] == labels[x])
    {
      ++end;
    }
    if (mlim_reserve_apart(&list->runs, &list->capacity, list->count + 1, sizeof *list->runs))
    {
      return 1;
    }
    list->runs[list->count] =
      (run){ .begin = x, .end = end, .label = labels[x], .parent = (int32_t)list->count };
    ++list->count;
    x = end;
  }
  return 0;
}

static void join_if_alike(run* runs, size_t a, size_t b)
{
  if (runs[a].label == runs[b].label)
  {
    join(runs, (int32_t)a, (int32_t)b);
  }
}

/* Joins the runs of two rows that touch each other, also by a corner. Both rows are full, so a run that
   ends first touches no later one, except at equal ends, where it touches the next one by a corner. */
static void join_rows(run_list* list, size_t row, size_t other)
{
  run* runs = list->runs;
  size_t a = list->rows[row];
  size_t b = list->rows[other];
  while (a < list->rows[row + 1] && b < list->rows[other + 1])
  {
    join_if_alike(runs, a, b);
    if (runs[a].end > runs[b].end)
    {
      ++b;
      continue;
    }
    if (runs[a].end == runs[b].end && b + 1 < list->rows[other + 1])
    {
      join_if_alike(runs, a, b + 1);
    }
    ++a;
  }
}

/* The rows of a slice, each joined with the four earlier ones beside it. Not 0: out of memory. */
static int scan_slice(const mlim_field* field, int32_t z, run_list* list)
{
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  const uint16_t* labels = mlim_field_point_labels(field);
  for (int32_t y = 0; y < dims[1]; ++y)
  {
    const size_t row = (size_t)y + (size_t)dims[1] * (size_t)z;
    if (add_row(list, labels + row * (size_t)dims[0], dims[0]))
    {
      return 1;
    }
    list->rows[row + 1] = list->count;
    for (int32_t k = -1; k <= 1 && z > 0; ++k)
    {
      if (y + k >= 0 && y + k < dims[1])
      {
        join_rows(list, row, (size_t)((int64_t)row - dims[1] + k));
      }
    }
    if (y > 0)
    {
      join_rows(list, row, row - 1);
    }
  }
  return 0;
}

/* Numbers the components in the order of their first runs: a root comes before the rest of its tree. */
static size_t number_runs(run_list* list)
{
  int32_t count = 0;
  for (size_t r = 0; r < list->count; ++r)
  {
    int32_t root = (int32_t)r;
    while (list->runs[root].parent >= 0 && list->runs[root].parent != root)
    {
      root = list->runs[root].parent;
    }
    const int32_t number = list->runs[root].parent;
    list->runs[r].parent = number < 0 ? number : -1 - count++;
  }
  return (size_t)count;
}

/* Lets a component reach as far as a run does; the first of equals stays. */
static void extend(mlim_component* c, const run* r, int32_t y, int32_t z)
{
  for (int side = 0; side < 6; ++side)
  {
    const int32_t point[3] = { side == 1 ? r->end - 1 : r->begin, y, z };
    const int32_t here = point[side >> 1];
    const int32_t there = c->extremes[side][side >> 1];
    if (c->voxel_count == 0 || (side & 1 ? here > there : here < there))
    {
      memcpy(c->extremes[side], point, sizeof point);
    }
  }
  c->label = r->label;
  c->voxel_count += (size_t)(r->end - r->begin);
}

/* The first of equals is the largest. */
static void find_largest(size_t label_count, mlim_components* out)
{
  for (size_t l = 0; l < label_count; ++l)
  {
    out->largest[l] = -1;
  }
  for (size_t c = 0; c < out->count; ++c)
  {
    int32_t* largest = &out->largest[out->components[c].label];
    if (*largest < 0 || out->components[c].voxel_count > out->components[*largest].voxel_count)
    {
      *largest = (int32_t)c;
    }
  }
}

static int is_lesser(const run* r, const mlim_components* components)
{
  return -1 - r->parent != components->largest[r->label];
}

/* Keeps the runs of lesser components. Not 0: out of memory. */
static int keep_lesser(const run_list* list, size_t row_count, mlim_components* out)
{
  size_t count = 0;
  for (size_t k = 0; k < list->count; ++k)
  {
    count += (size_t)is_lesser(&list->runs[k], out);
  }
  out->runs = mlim_allocate(count, sizeof *out->runs);
  if (out->runs == NULL)
  {
    return 1;
  }
  count = 0;
  for (size_t row = 0; row < row_count; ++row)
  {
    out->rows[row] = (int32_t)count;
    for (size_t k = list->rows[row]; k < list->rows[row + 1]; ++k)
    {
      const run* r = &list->runs[k];
      if (is_lesser(r, out))
      {
        out->runs[count++] =
          (mlim_component_run){ .begin = r->begin, .end = r->end, .component = -1 - r->parent };
      }
    }
  }
  out->rows[row_count] = (int32_t)count;
  return 0;
}

static void measure(const mlim_field_grid* grid, const run_list* list, mlim_components* out)
{
  const size_t ny = (size_t)grid->dims[1];
  for (size_t row = 0; row < ny * (size_t)grid->dims[2]; ++row)
  {
    for (size_t k = list->rows[row]; k < list->rows[row + 1]; ++k)
    {
      const run* r = &list->runs[k];
      const int32_t number = -1 - r->parent;
      extend(&out->components[number], r, (int32_t)(row % ny), (int32_t)(row / ny));
    }
  }
}

static mlim_status scan(const mlim_field* field, mlim_context* context, run_list* list)
{
  const int32_t* dims = mlim_field_grid_of(field)->dims;
  mlim_status status = MLIM_OK;
  for (int32_t z = 0; z < dims[2] && status == MLIM_OK; ++z)
  {
    if (scan_slice(field, z, list))
    {
      return mlim_fail_memory(context, "the components of the labels");
    }
    status = z % LOOK_EVERY_SLICES == 0 ? mlim_progress(context, MLIM_STAGE_SURFACE, 0) : MLIM_OK;
  }
  return status;
}

mlim_status mlim_components_find(
  const mlim_field* field, mlim_context* context, mlim_components* out)
{
  *out = (mlim_components){ 0 };
  const mlim_field_grid* grid = mlim_field_grid_of(field);
  const size_t rows = (size_t)grid->dims[1] * (size_t)grid->dims[2];
  const size_t points = rows * (size_t)grid->dims[0];
  if (points > INT32_MAX)
  {
    return mlim_fail(context, MLIM_INVALID_ARGUMENT,
      "The image has %zu points; components can be told apart in at most %d.", points, INT_MAX);
  }
  const size_t labels = (size_t)mlim_field_label_count(field);
  run_list list = { .rows = mlim_allocate_zeroed(rows + 1, sizeof *list.rows) };
  out->rows = mlim_allocate(rows + 1, sizeof *out->rows);
  out->largest = mlim_allocate(labels, sizeof *out->largest);
  mlim_status status = list.rows == NULL || out->rows == NULL || out->largest == NULL
                         ? mlim_fail_memory(context, "the components of the labels")
                         : scan(field, context, &list);
  if (status == MLIM_OK)
  {
    out->count = number_runs(&list);
    out->components = mlim_allocate_zeroed(out->count, sizeof *out->components);
    status =
      out->components == NULL ? mlim_fail_memory(context, "the components of the labels") : MLIM_OK;
  }
  if (status == MLIM_OK)
  {
    measure(grid, &list, out);
    find_largest(labels, out);
    status = keep_lesser(&list, rows, out)
               ? mlim_fail_memory(context, "the components of the labels")
               : mlim_progress(context, MLIM_STAGE_SURFACE, 0);
  }
  if (status != MLIM_OK)
  {
    mlim_components_free(out);
  }
  mlim_release(list.rows);
  mlim_release(list.runs);
  return status;
}

int32_t mlim_components_at(
  const mlim_components* components, const mlim_field* field, const int32_t point[3])
{
  const size_t row =
    (size_t)point[1] + (size_t)mlim_field_grid_of(field)->dims[1] * (size_t)point[2];
  int32_t low = components->rows[row];
  int32_t high = components->rows[row + 1];
  const int32_t last = high;
  /* The first run that ends beyond the point. */
  while (low < high)
  {
    const int32_t middle = low + (high - low) / 2;
    if (components->runs[middle].end <= point[0])
    {
      low = middle + 1;
    }
    else
    {
      high = middle;
    }
  }
  return low < last && components->runs[low].begin <= point[0]
           ? components->runs[low].component
           : components->largest[mlim_field_point_label(field, point)];
}

void mlim_components_count_voxels(
  const mlim_components* components, size_t label_count, size_t* voxels)
{
  memset(voxels, 0, label_count * sizeof *voxels);
  for (size_t c = 0; c < components->count; ++c)
  {
    voxels[components->components[c].label] += components->components[c].voxel_count;
  }
}

void mlim_components_free(mlim_components* components)
{
  mlim_release(components->components);
  mlim_release(components->largest);
  mlim_release(components->rows);
  mlim_release(components->runs);
  *components = (mlim_components){ 0 };
}
