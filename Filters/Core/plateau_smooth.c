/* The labels are independent of each other, and their ties lie sorted by label, so that sweeps find what
   they need in the cache. */
#include "plateau_smooth.h"

#include "memory.h"
#include "status.h"

enum
{
  /* Gauss-Seidel sweeps, forward and back: a plateau of 20 cells across is smooth after them;
     beyond, the middle is still split by the side that is nearer. */
  SWEEPS = 64,
  ROUND_STEPS = 1024 * 4096 /* between two looks at the host */
};

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

/* The ties label by label, each a knot: `order` has all of them, the rest those of the labels in work, from
   `base` on. `bonus` has one more, a 0 at `nowhere`: a sum over six neighbours is faster without asking which
   of them there are. */
typedef struct smoother
{
  const mlim_samples* samples; /* borrowed */
  const uint16_t* winners;     /* borrowed */
  mlim_plateau* plateau;       /* borrowed */
  size_t label_count;
  label_ties* labels;
  int32_t* order; /* index of the tie */
  size_t base;
  stencil* stencils;
  double* bonus;
  int32_t nowhere;
  int first_sweep, end_sweep; /* of a round */
} smoother;

static size_t point_of(const smoother* s, size_t knot)
{
  return s->plateau->tied[s->order[knot]].point;
}

/* Knot of the same label at a point; the search goes on from *at, points being asked for in ascending
   order. */
static int32_t find_knot(const smoother* s, const label_ties* label, size_t point, size_t* at)
{
  while (*at < label->end && point_of(s, *at) < point)
  {
    ++*at;
  }
  return *at < label->end && point_of(s, *at) == point ? (int32_t)(*at - s->base) : s->nowhere;
}

static stencil look_round(const smoother* s, const label_ties* label, size_t knot, size_t search[6])
{
  const mlim_grid* grid = s->samples->grid;
  const size_t nx = (size_t)grid->dims[0];
  const size_t ny = (size_t)grid->dims[1];
  const size_t steps[3] = { 1, nx, nx * ny };
  const mlim_tied* tied = &s->plateau->tied[s->order[knot]];
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
      out.fixed += mlim_samples_value(s->samples, tied->label, q) -
                   mlim_samples_value(s->samples, s->winners[q] & ~MLIM_TIED_FLAG, q);
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
      s->stencils[knot - s->base] = look_round(s, label, knot, search);
      s->bonus[knot - s->base] = 0;
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
  const size_t begin = label->begin - s->base;
  const size_t count = label->end - label->begin;
  int has_changed = 0;
  for (size_t n = 0; n < count; ++n)
  {
    const size_t knot = is_backward ? begin + count - 1 - n : begin + n;
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
  const mlim_plateau* plateau = s->plateau;
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
  s->base = s->labels[begin].begin;
  const size_t fitting = ROUND_STEPS / (knots > 0 ? knots : 1);
  const int sweeps = fitting < 1 ? 1 : fitting < SWEEPS ? (int)fitting : SWEEPS;
  mlim_parallel_for(context, end - begin, look_round_body, &job);
  mlim_status status = mlim_progress(context, MLIM_STAGE_FIELD, MLIM_PLATEAU_PROGRESS);
  for (int sweep = 0; sweep < SWEEPS && status == MLIM_OK; sweep += sweeps)
  {
    s->first_sweep = sweep;
    s->end_sweep = sweep + sweeps < SWEEPS ? sweep + sweeps : SWEEPS;
    mlim_parallel_for(context, end - begin, sweep_round_body, &job);
    status = mlim_progress(context, MLIM_STAGE_FIELD, MLIM_PLATEAU_PROGRESS);
  }
  for (size_t knot = 0; knot < knots; ++knot)
  {
    s->plateau->tied[s->order[s->base + knot]].bonus = s->bonus[knot];
  }
  return status;
}

/* Knots of the labels that are in work together, at most. */
static size_t most_knots(const smoother* s)
{
  size_t most = 0;
  size_t end;
  for (size_t begin = 0; begin < s->label_count; begin = end)
  {
    end = end_of_round(s, begin);
    const size_t knots = s->labels[end - 1].end - s->labels[begin].begin;
    most = knots > most ? knots : most;
  }
  return most;
}

static mlim_status sweep_all(smoother* s, mlim_context* context)
{
  part_labels(s);
  const size_t room = most_knots(s);
  s->stencils = mlim_allocate(room, sizeof *s->stencils);
  s->bonus = mlim_allocate(room + 1, sizeof *s->bonus);
  mlim_status status = MLIM_OK;
  if (s->stencils == NULL || s->bonus == NULL)
  {
    status = mlim_fail_memory(context, "the ties of the indicators");
    goto done;
  }
  s->nowhere = (int32_t)room;
  s->bonus[room] = 0;
  size_t end;
  for (size_t begin = 0; begin < s->label_count && status == MLIM_OK; begin = end)
  {
    end = end_of_round(s, begin);
    status = sweep_some(s, begin, end, context);
  }
done:
  mlim_release(s->stencils);
  mlim_release(s->bonus);
  return status;
}

mlim_status mlim_plateau_smooth(const mlim_samples* samples, mlim_context* context,
  const uint16_t* winners, mlim_plateau* plateau)
{
  if (plateau->count == 0)
  {
    return MLIM_OK;
  }
  /* One more for the outside of blanked points. */
  smoother s = { .samples = samples,
    .winners = winners,
    .plateau = plateau,
    .label_count = (size_t)samples->label_count + 1 };
  s.labels = mlim_allocate_zeroed(s.label_count, sizeof *s.labels);
  s.order = mlim_allocate(plateau->count, sizeof *s.order);
  const mlim_status status = s.labels != NULL && s.order != NULL
                               ? sweep_all(&s, context)
                               : mlim_fail_memory(context, "the ties of the indicators");
  mlim_release(s.labels);
  mlim_release(s.order);
  return status;
}
