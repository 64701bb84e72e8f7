#include "plateau_smooth.h"

#include "memory.h"
#include "status.h"

#include <limits.h>

enum
{
  /* With more ties than one grid point in this many, the indicators say nothing: the lowest index
     wins after all. */
  SPARSE = 2,
  LOOK_ROWS = 64,        /* rows of grid points between two looks at the host, */
  LOOK_TIES = 256 * 1024 /* or ties */
};

/* A bonus is this part of a difference of indicators: next to a tied point the interface moves by
   less than this part of a cell. */
static const double BONUS_PART = 0.0009765625;

typedef struct builder
{
  const mlim_samples* samples;
  const mlim_peaks* peaks;
  const uint16_t* winners;
  mlim_plateau* out;
  uint16_t* list; /* the labels at a point */
  size_t capacity;
} builder;

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
  const double best = mlim_samples_value(b->samples, b->winners[point] & ~MLIM_TIED_FLAG, point);
  const size_t labels = list_labels(b, point, best);
  for (size_t n = 0; n < labels; ++n)
  {
    if (mlim_samples_value(b->samples, b->list[n], point) != best)
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
  mlim_status status =
    b->list != NULL ? MLIM_OK : mlim_fail_memory(context, "the ties of the indicators");
  const size_t row = (size_t)b->samples->grid->dims[0];
  size_t looked_at = 0;
  for (size_t first = 0; first < points && status == MLIM_OK; first += row)
  {
    int has_failed = 0;
    for (size_t p = first; p < first + row && !has_failed; ++p)
    {
      has_failed = (b->winners[p] & MLIM_TIED_FLAG) && add_point(b, p);
    }
    if (has_failed)
    {
      status = mlim_fail_memory(context, "the ties of the indicators");
    }
    else if (first / row % LOOK_ROWS == 0 || b->out->count >= looked_at + LOOK_TIES)
    {
      looked_at = b->out->count;
      status = mlim_progress(context, MLIM_STAGE_FIELD, MLIM_PLATEAU_PROGRESS);
    }
  }
  mlim_release(b->list);
  if (status != MLIM_OK)
  {
    return status;
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
      status = mlim_plateau_smooth(samples, context, winners, out);
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
