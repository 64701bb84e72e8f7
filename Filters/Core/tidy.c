#include "tidy.h"

#include "memory.h"
#include "status.h"

#include <stdlib.h>
#include <string.h>

enum
{
  MAX_SWEEPS = 12, /* over all cells or vertices; each mends what the one before made mendable */
  MAX_PART = 24    /* cells of a part of a star that may change together */
};

/* ---- strays: facets with a vertex that is not on their sheet ---- */

static mlim_sheet sheet_between(int32_t a, int32_t b)
{
  return (mlim_sheet){ .low = a < b ? a : b, .high = a < b ? b : a, .face = -1 };
}

/* Caps and far vertices are left alone: their facets are judged by the faces of the box. */
static int touches_outside(const mlim_complex* complex, const mlim_cell* cell)
{
  const double* size = mlim_field_grid_of(complex->oracle.field)->size;
  for (int k = 0; k < 3; ++k)
  {
    if (!(cell->center[k] > 0 && cell->center[k] < size[k]))
    {
      return 1;
    }
  }
  for (int k = 0; k < 4; ++k)
  {
    if (complex->vertices[cell->vertices[k]].kind == MLIM_VERTEX_FAR ||
        cell->neighbors[k] == MLIM_NO_CELL ||
        (cell->facets[k] != 0 && complex->facets[cell->facets[k]].sheet.face >= 0))
    {
      return 1;
    }
  }
  return 0;
}

/* Number of vertices of a facet that are not on the sheet between two labels; 0 for equal ones. */
static int stray_count(
  const mlim_complex* complex, const mlim_cell* cell, int index, int32_t label, int32_t other)
{
  if (label == other)
  {
    return 0;
  }
  const mlim_sheet sheet = sheet_between(label, other);
  int count = 0;
  for (int k = 1; k < 4; ++k)
  {
    count += !mlim_complex_is_on_sheet(
      complex, &complex->vertices[cell->vertices[(index + k) & 3]], &sheet);
  }
  return count;
}

static int cell_strays(const mlim_complex* complex, int32_t id, int32_t label)
{
  const mlim_cell* cell = &complex->cells[id];
  int count = 0;
  for (int k = 0; k < 4; ++k)
  {
    count += stray_count(complex, cell, k, label, complex->cells[cell->neighbors[k]].label);
  }
  return count;
}

/* The label for a cell that leaves the fewest strays, among its neighbours' and its own. */
static int32_t best_label(const mlim_complex* complex, int32_t id)
{
  const mlim_cell* cell = &complex->cells[id];
  int32_t best = cell->label;
  int least = cell_strays(complex, id, best);
  for (int v = 0; v < 4 && least > 0; ++v)
  {
    const mlim_vertex* vertex = &complex->vertices[cell->vertices[v]];
    const int32_t tried[3] = { complex->cells[cell->neighbors[v]].label,
      vertex->kind == MLIM_VERTEX_SURFACE ? vertex->sheet.low : best,
      vertex->kind == MLIM_VERTEX_SURFACE ? vertex->sheet.high : best };
    for (int t = 0; t < 3; ++t)
    {
      const int count = cell_strays(complex, id, tried[t]);
      if (count < least)
      {
        least = count;
        best = tried[t];
      }
    }
  }
  return best;
}

/* Each change lowers the number of strays, so this ends; the sweeps bound the time. */
static size_t mend_strays(mlim_complex* complex)
{
  size_t changed = 0;
  size_t before = SIZE_MAX;
  for (int sweep = 0; sweep < MAX_SWEEPS && changed != before; ++sweep)
  {
    before = changed;
    for (size_t c = 0; c < complex->cell_count; ++c)
    {
      mlim_cell* cell = &complex->cells[c];
      if (cell->vertices[0] < 0 || touches_outside(complex, cell) ||
          cell_strays(complex, (int32_t)c, cell->label) == 0)
      {
        continue;
      }
      const int32_t label = best_label(complex, (int32_t)c);
      changed += label != cell->label;
      cell->label = label;
    }
  }
  return changed;
}

size_t mlim_tidy_count_strays(const mlim_complex* complex)
{
  size_t count = 0;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    for (int k = 0; k < 4 && cell->vertices[0] >= 0; ++k)
    {
      const int32_t other = cell->neighbors[k];
      if (other > (int32_t)c &&
          (cell->facets[k] == 0 || complex->facets[cell->facets[k]].sheet.face < 0))
      {
        count += stray_count(complex, cell, k, cell->label, complex->cells[other].label) > 0;
      }
    }
  }
  return count;
}

/* ---- stars that are no disks ---- */

typedef struct tidier
{
  mlim_refinement* refinement;
  mlim_context* context;
  mlim_star star;  /* of the failed vertex */
  mlim_star check; /* of its neighbours */
  int32_t part[MAX_PART];
  int32_t old_labels[MAX_PART];
  size_t part_count;
  int32_t vertices[4 * MAX_PART];
  size_t vertex_count;
} tidier;

static int fails(tidier* t, int32_t vertex)
{
  mlim_disk disk = MLIM_DISK_HOLDS;
  (void)mlim_disk_check(
    &t->refinement->complex, &t->refinement->links, vertex, &t->check, t->context, &disk);
  return disk == MLIM_DISK_FAILS;
}

static int contains(const int32_t* list, size_t count, int32_t value)
{
  for (size_t k = 0; k < count; ++k)
  {
    if (list[k] == value)
    {
      return 1;
    }
  }
  return 0;
}

/* The cells of the star that are connected with `first` through facets of the star and have its
   label. Returns 0 when they are too many or touch the outside. */
static int gather_part(tidier* t, int32_t first, int32_t vertex)
{
  const mlim_complex* complex = &t->refinement->complex;
  t->part_count = 0;
  t->part[t->part_count++] = first;
  for (size_t p = 0; p < t->part_count; ++p)
  {
    const mlim_cell* cell = &complex->cells[t->part[p]];
    if (touches_outside(complex, cell))
    {
      return 0;
    }
    for (int k = 0; k < 4; ++k)
    {
      const int32_t other = cell->neighbors[k];
      if (cell->vertices[k] == vertex || complex->cells[other].label != cell->label ||
          contains(t->part, t->part_count, other))
      {
        continue;
      }
      if (t->part_count == MAX_PART)
      {
        return 0;
      }
      t->part[t->part_count++] = other;
    }
  }
  return 1;
}

static void gather_vertices(tidier* t)
{
  const mlim_complex* complex = &t->refinement->complex;
  t->vertex_count = 0;
  for (size_t p = 0; p < t->part_count; ++p)
  {
    for (int k = 0; k < 4; ++k)
    {
      const int32_t v = complex->cells[t->part[p]].vertices[k];
      if (!contains(t->vertices, t->vertex_count, v))
      {
        t->vertices[t->vertex_count++] = v;
      }
    }
  }
}

/* Failed disks weigh more than strays: the latter only lie a little off their sheet. */
static long cost(tidier* t)
{
  enum
  {
    DISK_COST = 8
  };
  long sum = 0;
  for (size_t k = 0; k < t->vertex_count; ++k)
  {
    sum += DISK_COST * fails(t, t->vertices[k]);
  }
  for (size_t p = 0; p < t->part_count; ++p)
  {
    const int32_t id = t->part[p];
    sum += cell_strays(&t->refinement->complex, id, t->refinement->complex.cells[id].label);
  }
  return sum;
}

static void relabel(tidier* t, int32_t label)
{
  for (size_t p = 0; p < t->part_count; ++p)
  {
    t->refinement->complex.cells[t->part[p]].label = label;
  }
}

/* Gives the part the label of a neighbour that lowers the cost most. Returns the cells changed. */
static size_t mend_part(tidier* t)
{
  mlim_complex* complex = &t->refinement->complex;
  const int32_t own = complex->cells[t->part[0]].label;
  gather_vertices(t);
  long least = cost(t);
  int32_t best = own;
  int32_t tried[4 * MAX_PART];
  size_t tried_count = 0;
  for (size_t p = 0; p < t->part_count; ++p)
  {
    for (int k = 0; k < 4; ++k)
    {
      const int32_t other = complex->cells[complex->cells[t->part[p]].neighbors[k]].label;
      if (other != own && !contains(tried, tried_count, other))
      {
        tried[tried_count++] = other;
      }
    }
  }
  for (size_t n = 0; n < tried_count; ++n)
  {
    relabel(t, tried[n]);
    const long sum = cost(t);
    if (sum < least)
    {
      least = sum;
      best = tried[n];
    }
  }
  relabel(t, best);
  return best != own ? t->part_count : 0;
}

/* Tries the parts of the star of a failed vertex, then its single cells. */
static size_t mend_star(tidier* t, int32_t vertex)
{
  for (int is_single = 0; is_single < 2; ++is_single)
  {
    for (size_t c = 0; c < t->star.cell_count; ++c)
    {
      if (is_single)
      {
        t->part[0] = t->star.cells[c];
        t->part_count = 1;
        if (touches_outside(&t->refinement->complex, &t->refinement->complex.cells[t->part[0]]))
        {
          continue;
        }
      }
      else if (!gather_part(t, t->star.cells[c], vertex))
      {
        continue;
      }
      const size_t changed = mend_part(t);
      if (changed > 0)
      {
        return changed;
      }
    }
  }
  return 0;
}

static mlim_status mend_disks(tidier* t, size_t* changed)
{
  mlim_complex* complex = &t->refinement->complex;
  size_t before = SIZE_MAX;
  *changed = 0;
  for (int sweep = 0; sweep < MAX_SWEEPS && *changed != before; ++sweep)
  {
    before = *changed;
    for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
    {
      mlim_disk disk;
      mlim_status status =
        mlim_disk_check(complex, &t->refinement->links, (int32_t)v, &t->star, t->context, &disk);
      if (status != MLIM_OK)
      {
        return status;
      }
      if (disk == MLIM_DISK_FAILS)
      {
        *changed += mend_star(t, (int32_t)v);
      }
    }
  }
  return MLIM_OK;
}

mlim_status mlim_tidy_run(mlim_refinement* refinement, mlim_context* context, size_t* count)
{
  *count = mend_strays(&refinement->complex);
  tidier* t = mlim_allocate_zeroed(1, sizeof *t);
  if (t == NULL)
  {
    return mlim_fail_memory(context, "mending the topology");
  }
  t->refinement = refinement;
  t->context = context;
  size_t changed = 0;
  const mlim_status status = mend_disks(t, &changed);
  *count += changed;
  mlim_star_free(&t->star);
  mlim_star_free(&t->check);
  mlim_release(t);
  return status;
}
