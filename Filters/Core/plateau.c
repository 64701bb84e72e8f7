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
  /* Between two looks at the host: */
  LOOK_ROWS = 64,           /* rows of grid points */
  LOOK_TIES = 1024 * 1024,  /* or ties when they are collected, */
  ROUND_STEPS = 1024 * 8192 /* steps when they are smoothed */
};

static const double PROGRESS = 0.4;

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

/* ---- smoothing ---- */

/* The six neighbours of a tied label: the same label tied there too, or a value that stands fast. */
typedef struct stencil
{
  int32_t tied[6]; /* its knot, or the smoother's nowhere */
  double fixed;    /* sum over the others, relative to the largest value at each */
  int32_t count;
} stencil;

/* Ties of one label know nothing of another's. */
typedef struct label_ties
{
  size_t begin, end; /* knots, ascending by point */
  int is_settled;    /* a sweep has changed nothing, so none will */
} label_ties;

/* The ties label by label; all arrays but `labels` have one entry a tie, a knot. `bonus` has one more, a 0
   at `nowhere`: a sum over six neighbours is faster without asking which of them there are. */
typedef struct smoother
{
  const builder* from;
  size_t label_count;
  label_ties* labels;
  int32_t* order; /* index of the tie */
  stencil* stencils;
  double* bonus;
  int32_t nowhere;
  int first_sweep, end_sweep; /* of a round */
} smoother;

static size_t point_of(const smoother* s, size_t knot)
{
  return s->from->out->tied[s->order[knot]].point;
}

/* Knot of the same label at a point; the search goes on from *at, points being asked for in ascending
   order. */
static int32_t find_knot(const smoother* s, const label_ties* label, size_t point, size_t* at)
{
  while (*at < label->end && point_of(s, *at) < point)
  {
    ++*at;
  }
  return *at < label->end && point_of(s, *at) == point ? (int32_t)*at : s->nowhere;
}

static stencil look_round(const smoother* s, const label_ties* label, size_t knot, size_t search[6])
{
  const builder* b = s->from;
  const mlim_grid* grid = b->samples->grid;
  const size_t nx = (size_t)grid->dims[0];
  const size_t ny = (size_t)grid->dims[1];
  const size_t steps[3] = { 1, nx, nx * ny };
  const mlim_tied* tied = &b->out->tied[s->order[knot]];
  const size_t at[3] = { tied->point % nx, tied->point / nx % ny, tied->point / steps[2] };
  stencil out = { 0 };
  for (int side = 0; side < 6; ++side)
  {
    const int axis = side >> 1;
    out.tied[side] = s->nowhere;
    if (side & 1 ? at[axis] + 1 >= (size_t)grid->dims[axis] : at[axis] == 0)
    {
      continue;
    }
    const size_t q = side & 1 ? tied->point + steps[axis] : tied->point - steps[axis];
    ++out.count;
    out.tied[side] = find_knot(s, label, q, &search[side]);
    if (out.tied[side] == s->nowhere)
    {
      out.fixed += value_at(b->samples, tied->label, q) -
                   value_at(b->samples, b->winners[q] & ~MLIM_TIED_FLAG, q);
    }
  }
  return out;
}

static void look_labels(const smoother* s, size_t begin, size_t end)
{
  for (size_t l = begin; l < end; ++l)
  {
    const label_ties* label = &s->labels[l];
    size_t search[6];
    for (int side = 0; side < 6; ++side)
    {
      search[side] = label->begin;
    }
    for (size_t knot = label->begin; knot < label->end; ++knot)
    {
      s->stencils[knot] = look_round(s, label, knot, search);
      s->bonus[knot] = 0;
    }
  }
}

static double mean_round(const double* bonus, const stencil* round)
{
  double sum = round->fixed;
  for (int side = 0; side < 6; ++side)
  {
    sum += bonus[round->tied[side]];
  }
  return sum / round->count;
}

static void sweep_once(const smoother* s, label_ties* label, int is_backward)
{
  const size_t count = label->end - label->begin;
  int has_changed = 0;
  for (size_t n = 0; n < count; ++n)
  {
    const size_t knot = is_backward ? label->end - 1 - n : label->begin + n;
    const double mean = mean_round(s->bonus, &s->stencils[knot]);
    has_changed |= mean != s->bonus[knot];
    s->bonus[knot] = mean;
  }
  label->is_settled = !has_changed;
}

/* All sweeps of a round over one label before the next label, which may fit the cache. */
static void sweep_labels(const smoother* s, size_t begin, size_t end)
{
  for (size_t l = begin; l < end; ++l)
  {
    for (int n = s->first_sweep; n < s->end_sweep && !s->labels[l].is_settled; ++n)
    {
      sweep_once(s, &s->labels[l], n & 1);
    }
  }
}

/* Sorts the ties by label. */
static void part_labels(smoother* s)
{
  const mlim_plateau* plateau = s->from->out;
  for (size_t k = 0; k < plateau->count; ++k)
  {
    ++s->labels[plateau->tied[k].label].end;
  }
  size_t begin = 0;
  for (size_t l = 0; l < s->label_count; ++l)
  {
    const size_t count = s->labels[l].end;
    s->labels[l].begin = begin;
    s->labels[l].end = begin;
    begin += count;
  }
  for (size_t k = 0; k < plateau->count; ++k)
  {
    s->order[s->labels[plateau->tied[k].label].end++] = (int32_t)k;
  }
}

/* Labels from a first one on whose sweeps take no longer than a round; one at least. */
static size_t end_of_round(const smoother* s, size_t begin)
{
  size_t end = begin + 1;
  while (
    end < s->label_count && s->labels[end].end - s->labels[begin].begin <= ROUND_STEPS / SWEEPS)
  {
    ++end;
  }
  return end;
}

typedef struct round_job
{
  smoother* s;
  size_t first;
} round_job;

static void look_round_body(void* data, size_t begin, size_t end)
{
  const round_job* job = (const round_job*)data;
  look_labels(job->s, job->first + begin, job->first + end);
}

static void sweep_round_body(void* data, size_t begin, size_t end)
{
  const round_job* job = (const round_job*)data;
  sweep_labels(job->s, job->first + begin, job->first + end);
}

/* Some labels in one round, or one large label in several. */
static mlim_status sweep_some(smoother* s, size_t begin, size_t end, mlim_context* context)
{
  round_job job = { s, begin };
  const size_t knots = s->labels[end - 1].end - s->labels[begin].begin;
  const size_t fitting = ROUND_STEPS / (knots > 0 ? knots : 1);
  const int sweeps = fitting < 1 ? 1 : fitting < SWEEPS ? (int)fitting : SWEEPS;
  mlim_parallel_for(context, end - begin, look_round_body, &job);
  mlim_status status = mlim_progress(context, MLIM_STAGE_FIELD, PROGRESS);
  for (int sweep = 0; sweep < SWEEPS && status == MLIM_OK; sweep += sweeps)
  {
    s->first_sweep = sweep;
    s->end_sweep = sweep + sweeps < SWEEPS ? sweep + sweeps : SWEEPS;
    mlim_parallel_for(context, end - begin, sweep_round_body, &job);
    status = mlim_progress(context, MLIM_STAGE_FIELD, PROGRESS);
  }
  return status;
}

static mlim_status sweep_all(smoother* s, mlim_context* context)
{
  part_labels(s);
  s->bonus[s->nowhere] = 0;
  mlim_status status = MLIM_OK;
  size_t end;
  for (size_t begin = 0; begin < s->label_count && status == MLIM_OK; begin = end)
  {
    end = end_of_round(s, begin);
    status = sweep_some(s, begin, end, context);
  }
  for (size_t knot = 0; knot < s->from->out->count; ++knot)
  {
    s->from->out->tied[s->order[knot]].bonus = s->bonus[knot];
  }
  return status;
}

static mlim_status smooth(const builder* b, mlim_context* context)
{
  const size_t count = b->out->count;
  if (count == 0)
  {
    return MLIM_OK;
  }
  /* One more for the outside of blanked points. */
  smoother s = {
    .from = b, .label_count = (size_t)b->samples->label_count + 1, .nowhere = (int32_t)count
  };
  s.labels = mlim_allocate_zeroed(s.label_count, sizeof *s.labels);
  s.order = mlim_allocate(count, sizeof *s.order);
  s.stencils = mlim_allocate(count, sizeof *s.stencils);
  s.bonus = mlim_allocate(count + 1, sizeof *s.bonus);
  const int has_memory =
    s.labels != NULL && s.order != NULL && s.stencils != NULL && s.bonus != NULL;
  const mlim_status status =
    has_memory ? sweep_all(&s, context) : mlim_fail_memory(context, "the ties of the indicators");
  mlim_release(s.labels);
  mlim_release(s.order);
  mlim_release(s.stencils);
  mlim_release(s.bonus);
  return status;
}

/* ---- all of it ---- */

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
      status = mlim_progress(context, MLIM_STAGE_FIELD, PROGRESS);
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
