#include "plateau.h"

#include "memory.h"
#include "status.h"

#include <string.h>

/* Gauss-Seidel sweeps, forward and back: a plateau of 20 cells across is smooth after them; beyond,
   the middle is still split by the side that is nearer. */
enum
{
  SWEEPS = 64
};

/* A bonus is this part of a difference of indicators: the interface moves by less than 1/16 of a
   cell at the plateau's rim. */
static const double BONUS_PART = 0.0625;

typedef struct builder
{
  const mlim_samples* samples;
  const uint16_t* winners;
  mlim_plateau* out;
  size_t capacity;
} builder;

static void corner_points(const mlim_grid* grid, size_t first, size_t out[8])
{
  const size_t nx = (size_t)grid->dims[0];
  const size_t slice = nx * (size_t)grid->dims[1];
  for (size_t c = 0; c < 8; ++c)
  {
    out[c] = first + (c & 1) + nx * (c >> 1 & 1) + slice * (c >> 2 & 1);
  }
}

static double value_at(const mlim_samples* samples, int32_t label, size_t point)
{
  double value;
  mlim_samples_row(samples, label, point, 1, &value);
  return value;
}

/* Whether two labels have the largest value at all corners. */
static int is_plateau(const builder* b, const size_t corner[8])
{
  for (int c = 0; c < 8; ++c)
  {
    if (!(b->winners[corner[c]] & MLIM_TIED_FLAG))
    {
      return 0;
    }
  }
  int shared = 0;
  for (int32_t l = 0; l < b->samples->label_count && shared < 2; ++l)
  {
    int c = 0;
    while (c < 8 && value_at(b->samples, l, corner[c]) ==
                      value_at(b->samples, b->winners[corner[c]] & ~MLIM_TIED_FLAG, corner[c]))
    {
      ++c;
    }
    shared += c == 8;
  }
  return shared > 1;
}

static int add_point(builder* b, size_t point)
{
  const double best = value_at(b->samples, b->winners[point] & ~MLIM_TIED_FLAG, point);
  for (int32_t l = 0; l < b->samples->label_count; ++l)
  {
    if (value_at(b->samples, l, point) != best)
    {
      continue;
    }
    if (mlim_reserve(&b->out->tied, &b->capacity, b->out->count + 1, sizeof *b->out->tied))
    {
      return 1;
    }
    b->out->tied[b->out->count++] = (mlim_tied){ .point = point, .label = l };
  }
  return 0;
}

/* Marks the grid points of all plateau cells (one byte each). Returns whether there is one. */
static int mark_points(const builder* b, unsigned char* is_marked)
{
  const mlim_grid* grid = b->samples->grid;
  const size_t nx = (size_t)grid->dims[0];
  const size_t ny = (size_t)grid->dims[1];
  int has_one = 0;
  for (size_t z = 0; z + 1 < (size_t)grid->dims[2]; ++z)
  {
    for (size_t y = 0; y + 1 < ny; ++y)
    {
      for (size_t x = 0; x + 1 < nx; ++x)
      {
        const size_t first = x + nx * (y + ny * z);
        size_t corner[8];
        if (!(b->winners[first] & MLIM_TIED_FLAG))
        {
          continue;
        }
        corner_points(grid, first, corner);
        if (is_plateau(b, corner))
        {
          has_one = 1;
          for (int c = 0; c < 8; ++c)
          {
            is_marked[corner[c]] = 1;
          }
        }
      }
    }
  }
  return has_one;
}

static const mlim_tied* find_tied(const mlim_plateau* plateau, size_t point, int32_t label)
{
  size_t low = 0;
  size_t high = plateau->count;
  while (low < high)
  {
    const size_t middle = (low + high) / 2;
    const mlim_tied* t = &plateau->tied[middle];
    if (t->point < point || (t->point == point && t->label < label))
    {
      low = middle + 1;
    }
    else
    {
      high = middle;
    }
  }
  const int is_found =
    low < plateau->count && plateau->tied[low].point == point && plateau->tied[low].label == label;
  return is_found ? &plateau->tied[low] : NULL;
}

/* The mean of a label over the neighbours of a point, relative to the largest value there. */
static double neighbor_mean(const builder* b, const mlim_tied* tied)
{
  const mlim_grid* grid = b->samples->grid;
  size_t at[3];
  const size_t nx = (size_t)grid->dims[0];
  const size_t steps[3] = { 1, nx, nx * (size_t)grid->dims[1] };
  at[0] = tied->point % nx;
  at[1] = tied->point / nx % (size_t)grid->dims[1];
  at[2] = tied->point / steps[2];
  double sum = 0;
  int count = 0;
  for (int side = 0; side < 6; ++side)
  {
    const int axis = side >> 1;
    if (side & 1 ? at[axis] + 1 >= (size_t)grid->dims[axis] : at[axis] == 0)
    {
      continue;
    }
    const size_t q = side & 1 ? tied->point + steps[axis] : tied->point - steps[axis];
    const mlim_tied* other = find_tied(b->out, q, tied->label);
    sum += other != NULL ? other->bonus
                         : value_at(b->samples, tied->label, q) -
                             value_at(b->samples, b->winners[q] & ~MLIM_TIED_FLAG, q);
    ++count;
  }
  return sum / count;
}

static void smooth(const builder* b)
{
  const size_t count = b->out->count;
  for (int sweep = 0; sweep < SWEEPS; ++sweep)
  {
    for (size_t k = 0; k < count; ++k)
    {
      mlim_tied* tied = &b->out->tied[sweep & 1 ? count - 1 - k : k];
      tied->bonus = neighbor_mean(b, tied);
    }
  }
}

/* Shifts the bonuses of each point so that the best is 0, scales them, and names the winner. */
static void settle(mlim_plateau* plateau, uint16_t* winners)
{
  size_t end;
  for (size_t first = 0; first < plateau->count; first = end)
  {
    size_t best = first;
    for (end = first;
         end < plateau->count && plateau->tied[end].point == plateau->tied[first].point; ++end)
    {
      best = plateau->tied[end].bonus > plateau->tied[best].bonus ? end : best;
    }
    const double most = plateau->tied[best].bonus;
    winners[plateau->tied[best].point] = (uint16_t)plateau->tied[best].label;
    for (size_t k = first; k < end; ++k)
    {
      plateau->tied[k].bonus = BONUS_PART * (plateau->tied[k].bonus - most);
    }
  }
}

static mlim_status collect(builder* b, size_t points, mlim_context* context)
{
  unsigned char* is_marked = mlim_allocate_zeroed(points, 1);
  if (is_marked == NULL)
  {
    return mlim_fail_memory(context, "the plateaus");
  }
  int has_failed = 0;
  if (mark_points(b, is_marked))
  {
    for (size_t p = 0; p < points && !has_failed; ++p)
    {
      has_failed = is_marked[p] && add_point(b, p);
    }
  }
  mlim_release(is_marked);
  return has_failed ? mlim_fail_memory(context, "the plateaus") : MLIM_OK;
}

mlim_status mlim_plateau_find(
  const mlim_samples* samples, mlim_context* context, uint16_t* winners, mlim_plateau* out)
{
  *out = (mlim_plateau){ 0 };
  const int32_t* dims = samples->grid->dims;
  const size_t points = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
  mlim_status status = MLIM_OK;
  if (samples->grid->tie_breaking == MLIM_TIE_SMOOTH)
  {
    builder b = { .samples = samples, .winners = winners, .out = out };
    status = collect(&b, points, context);
    if (status == MLIM_OK)
    {
      smooth(&b);
    }
  }
  for (size_t p = 0; p < points; ++p)
  {
    winners[p] = (uint16_t)(winners[p] & ~MLIM_TIED_FLAG);
  }
  settle(out, winners);
  if (status != MLIM_OK)
  {
    mlim_plateau_free(out);
  }
  return status;
}

void mlim_plateau_free(mlim_plateau* plateau)
{
  mlim_release(plateau->tied);
  *plateau = (mlim_plateau){ 0 };
}

void mlim_plateau_correct(
  const mlim_plateau* plateau, const mlim_grid* grid, int32_t label, size_t first, double out[8])
{
  if (plateau->count == 0)
  {
    return;
  }
  size_t corner[8];
  corner_points(grid, first, corner);
  for (int c = 0; c < 8; ++c)
  {
    const mlim_tied* tied = find_tied(plateau, corner[c], label);
    out[c] += tied != NULL ? tied->bonus : 0;
  }
}
