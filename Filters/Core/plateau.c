#include "plateau.h"

#include "memory.h"
#include "status.h"

#include <limits.h>

enum
{
  /* Gauss-Seidel sweeps, forward and back: a plateau of 20 cells across is smooth after them;
     beyond, the middle is still split by the side that is nearer. */
  SWEEPS = 64,
  /* With more ties than one grid point in this many, the indicators say nothing: the lowest index
     wins after all. */
  SPARSE = 2,
  NO_TIE = -1
};

/* A bonus is this part of a difference of indicators: next to a tied point the interface moves by
   less than this part of a cell. */
static const double BONUS_PART = 0.0009765625;

/* The six neighbours of a tied label: another tied one, or a value that stands fast. */
typedef struct stencil
{
  int32_t tied[6];
  double fixed; /* sum over the others, relative to the largest value at each */
  int32_t count;
} stencil;

typedef struct builder
{
  const mlim_samples* samples;
  const mlim_peaks* peaks;
  const uint16_t* winners;
  mlim_plateau* out;
  stencil* stencils;
  uint16_t* list; /* the labels at a point */
  size_t capacity;
} builder;

static double value_at(const mlim_samples* samples, int32_t label, size_t point)
{
  double value;
  mlim_samples_row(samples, label, point, 1, &value);
  return value;
}

/* Labels among which are all that have the value at a point. */
static size_t list_labels(const builder* b, size_t point, double value)
{
  const mlim_grid* grid = b->samples->grid;
  const size_t nx = (size_t)grid->dims[0];
  const size_t ny = (size_t)grid->dims[1];
  if (grid->indicators != NULL)
  {
    return mlim_samples_list(b->samples, &point, 1, b->list);
  }
  const int32_t x = (int32_t)(point % nx);
  const int32_t y = (int32_t)(point / nx % ny);
  const int32_t z = (int32_t)(point / (nx * ny));
  const mlim_point_box box = { { x, y, z }, { x, y, z } };
  return mlim_peaks_list(b->peaks, &box, value, b->list);
}

static int add_point(builder* b, size_t point)
{
  const double best = value_at(b->samples, b->winners[point] & ~MLIM_TIED_FLAG, point);
  const size_t labels = list_labels(b, point, best);
  for (size_t n = 0; n < labels; ++n)
  {
    if (value_at(b->samples, b->list[n], point) != best)
    {
      continue;
    }
    if (mlim_reserve(&b->out->tied, &b->capacity, b->out->count + 1, sizeof *b->out->tied))
    {
      return 1;
    }
    b->out->tied[b->out->count++] = (mlim_tied){ .point = point, .label = b->list[n] };
  }
  return 0;
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

static stencil look_round(const builder* b, const mlim_tied* tied)
{
  const mlim_grid* grid = b->samples->grid;
  const size_t nx = (size_t)grid->dims[0];
  const size_t ny = (size_t)grid->dims[1];
  const size_t steps[3] = { 1, nx, nx * ny };
  const size_t at[3] = { tied->point % nx, tied->point / nx % ny, tied->point / steps[2] };
  stencil out = { 0 };
  for (int side = 0; side < 6; ++side)
  {
    const int axis = side >> 1;
    out.tied[side] = NO_TIE;
    if (side & 1 ? at[axis] + 1 >= (size_t)grid->dims[axis] : at[axis] == 0)
    {
      continue;
    }
    const size_t q = side & 1 ? tied->point + steps[axis] : tied->point - steps[axis];
    const mlim_tied* other = find_tied(b->out, q, tied->label);
    ++out.count;
    if (other != NULL)
    {
      out.tied[side] = (int32_t)(other - b->out->tied);
      continue;
    }
    out.fixed += value_at(b->samples, tied->label, q) -
                 value_at(b->samples, b->winners[q] & ~MLIM_TIED_FLAG, q);
  }
  return out;
}

static double mean_round(const mlim_plateau* plateau, const stencil* s)
{
  double sum = s->fixed;
  for (int side = 0; side < 6; ++side)
  {
    sum += s->tied[side] != NO_TIE ? plateau->tied[s->tied[side]].bonus : 0;
  }
  return sum / s->count;
}

static mlim_status smooth(builder* b, mlim_context* context)
{
  const size_t count = b->out->count;
  b->stencils = mlim_allocate(count, sizeof *b->stencils);
  if (b->stencils == NULL)
  {
    return mlim_fail_memory(context, "the ties of the indicators");
  }
  for (size_t k = 0; k < count; ++k)
  {
    b->stencils[k] = look_round(b, &b->out->tied[k]);
  }
  for (int sweep = 0; sweep < SWEEPS; ++sweep)
  {
    for (size_t k = 0; k < count; ++k)
    {
      const size_t n = sweep & 1 ? count - 1 - k : k;
      b->out->tied[n].bonus = mean_round(b->out, &b->stencils[n]);
    }
  }
  mlim_release(b->stencils);
  return MLIM_OK;
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
    winners[plateau->tied[best].point] = (uint16_t)(plateau->tied[best].label | MLIM_TIED_FLAG);
    for (size_t k = first; k < end; ++k)
    {
      plateau->tied[k].bonus = BONUS_PART * (plateau->tied[k].bonus - most);
    }
  }
}

static mlim_status collect(builder* b, size_t points, mlim_context* context)
{
  size_t tied_points = 0;
  for (size_t p = 0; p < points; ++p)
  {
    tied_points += (b->winners[p] & MLIM_TIED_FLAG) != 0;
  }
  if (tied_points > points / SPARSE)
  {
    return MLIM_OK;
  }
  b->list = mlim_allocate((size_t)b->samples->label_count + 1, sizeof *b->list);
  int has_failed = b->list == NULL;
  for (size_t p = 0; p < points && !has_failed; ++p)
  {
    has_failed = (b->winners[p] & MLIM_TIED_FLAG) && add_point(b, p);
  }
  mlim_release(b->list);
  if (has_failed)
  {
    return mlim_fail_memory(context, "the ties of the indicators");
  }
  return b->out->count < INT32_MAX ? MLIM_OK
                                   : mlim_fail(context, MLIM_INVALID_ARGUMENT,
                                       "There are %zu ties of indicators; at most %d can "
                                       "be broken smoothly.",
                                       b->out->count, INT32_MAX);
}

mlim_status mlim_plateau_find(const mlim_samples* samples, const mlim_peaks* peaks,
  mlim_context* context, uint16_t* winners, mlim_plateau* out)
{
  *out = (mlim_plateau){ 0 };
  const int32_t* dims = samples->grid->dims;
  const size_t points = (size_t)dims[0] * (size_t)dims[1] * (size_t)dims[2];
  mlim_status status = MLIM_OK;
  if (samples->grid->tie_breaking == MLIM_TIE_SMOOTH)
  {
    builder b = { .samples = samples, .peaks = peaks, .winners = winners, .out = out };
    status = collect(&b, points, context);
    if (status == MLIM_OK)
    {
      status = smooth(&b, context);
    }
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

double mlim_plateau_bonus(const mlim_plateau* plateau, size_t point, int32_t label)
{
  const mlim_tied* tied = find_tied(plateau, point, label);
  return tied != NULL ? tied->bonus : 0;
}
