#include "bends.h"

#include "ball_list.h"
#include "criteria.h"
#include "label_sets.h"
#include "memory.h"
#include "sides.h"
#include "vector.h"

/* Balls that are made smaller overlap by this part of the smaller radius: twice what a cover needs. With
   less the triangles beside the curve become narrow, with more fewer of them come near enough. */
static const double OVERLAP = 0.2;

/* Sheets that are nearer to each other than this many smallest distances leave no room for vertices on each
   of them: smaller balls would only bring them to light. */
static const double GAP = 2;

enum
{
  RIM_STEPS = 24, /* labels looked at round an edge: every 15 degrees. Even, for mirrored data */
  HALVINGS = 8    /* of a step, to find the sheet in it: to 0.001 of the rim's radius */
};

static const double STEP_ANGLE = 6.283185307179586 / RIM_STEPS;

typedef struct trimming
{
  const mlim_field* field;
  const mlim_balls* balls;
  double distance;                /* of triangles from their sheet */
  double gap;                     /* of sheets from each other */
  double steps[RIM_STEPS + 1][2]; /* cosine and sine of the angles round the rim */
  unsigned char* is_bent;         /* an edge */
  double* parts;                  /* a ball: the part of its radius that it keeps */
  mlim_ball_list list;
} trimming;

static void trimming_free(trimming* work)
{
  mlim_release(work->is_bent);
  mlim_release(work->parts);
  mlim_ball_list_free(&work->list);
}

/* An edge of a curve between two balls, and the circle on which the nearest third vertices of its
   triangles stand that refinement may insert for their size. */
typedef struct rim
{
  double base[3]; /* middle of the edge */
  double center[3];
  double axes[2][3]; /* of length 1, across the edge */
  double radius;
} rim;

/* Across the edge, and not nearly along it. */
static void find_axes(const double along[3], rim* out)
{
  int least = 0;
  for (int k = 1; k < 3; ++k)
  {
    least = fabs(along[k]) < fabs(along[least]) ? k : least;
  }
  const double unit[3] = { least == 0, least == 1, least == 2 };
  mlim_cross(along, unit, out->axes[0]);
  const double length = sqrt(mlim_dot(out->axes[0], out->axes[0]));
  for (int k = 0; k < 3; ++k)
  {
    out->axes[0][k] /= length;
  }
  mlim_cross(along, out->axes[0], out->axes[1]);
}

/* 0: the balls do not overlap, or the triangles are too small to be far from a sheet. */
static int find_rim(const trimming* work, size_t edge, rim* out)
{
  const int32_t* ends = work->balls->edges + 2 * edge;
  const double* a = work->balls->centers + 3 * (size_t)ends[0];
  const double* b = work->balls->centers + 3 * (size_t)ends[1];
  const double radii[2] = { work->balls->radii[ends[0]], work->balls->radii[ends[1]] };
  const double squared[2] = { radii[0] * radii[0], radii[1] * radii[1] };
  const double d = mlim_distance(a, b);
  if (!(d > 0 && d < radii[0] + radii[1]))
  {
    return 0;
  }
  /* Equally far in power from both balls, by what the larger one asks for. */
  const double foot = 0.5 * (d * d + squared[0] - squared[1]) / d;
  const double power = MLIM_QUALITY_GUARD * mlim_max(squared[0], squared[1]);
  const double height_squared = squared[0] + power - foot * foot;
  if (!(height_squared > 0) || !isfinite(height_squared))
  {
    return 0;
  }
  out->radius = sqrt(height_squared);
  double along[3];
  for (int k = 0; k < 3; ++k)
  {
    along[k] = (b[k] - a[k]) / d;
    out->base[k] = 0.5 * (a[k] + b[k]);
  }
  mlim_interpolate(a, b, foot / d, out->center);
  find_axes(along, out);
  return hypot(0.5 * d, out->radius / 3) > work->distance;
}

static void find_point(const rim* r, const double direction[2], double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] =
      r->center[k] + r->radius * (direction[0] * r->axes[0][k] + direction[1] * r->axes[1][k]);
  }
}

/* Where the rim goes over from one label to another. */
typedef struct rim_sheet
{
  double direction[2]; /* of length 1, in the rim's axes */
  const int32_t* labels;
} rim_sheet;

static void find_sheet(const trimming* work, const rim* r, size_t step, rim_sheet* out)
{
  double ends[2][2] = { { work->steps[step][0], work->steps[step][1] },
    { work->steps[step + 1][0], work->steps[step + 1][1] } };
  for (int k = 0; k < HALVINGS; ++k)
  {
    double middle[2] = { ends[0][0] + ends[1][0], ends[0][1] + ends[1][1] };
    const double length = sqrt(middle[0] * middle[0] + middle[1] * middle[1]);
    middle[0] /= length;
    middle[1] /= length;
    double at[3];
    find_point(r, middle, at);
    double* side = ends[mlim_field_label(work->field, at) != out->labels[0]];
    side[0] = middle[0];
    side[1] = middle[1];
  }
  out->direction[0] = ends[0][0];
  out->direction[1] = ends[0][1];
}

/* Whether the triangle of the edge and the sheet's point of the rim lies between the sheet's labels. */
static int is_on_sheet(const trimming* work, const rim* r, const rim_sheet* sheet)
{
  double at[3];
  double middle[3];
  double normal[3];
  find_point(r, sheet->direction, at);
  for (int k = 0; k < 3; ++k)
  {
    middle[k] = r->base[k] + (at[k] - r->base[k]) / 3;
    normal[k] = sheet->direction[0] * r->axes[1][k] - sheet->direction[1] * r->axes[0][k];
  }
  return mlim_sides_are_seen_from(work->field, middle, normal, sheet->labels, work->distance);
}

static int are_apart(const trimming* work, const rim* r, const rim_sheet* a, const rim_sheet* b)
{
  const double x = a->direction[0] - b->direction[0];
  const double y = a->direction[1] - b->direction[1];
  return r->radius * sqrt(x * x + y * y) >= work->gap;
}

static int is_bent(const trimming* work, size_t edge)
{
  rim r;
  if (!find_rim(work, edge, &r))
  {
    return 0;
  }
  int32_t labels[RIM_STEPS + 1];
  for (int k = 0; k < RIM_STEPS; ++k)
  {
    double at[3];
    find_point(&r, work->steps[k], at);
    labels[k] = mlim_field_label(work->field, at);
  }
  labels[RIM_STEPS] = labels[0];
  rim_sheet sheets[RIM_STEPS];
  size_t count = 0;
  int is_any_off = 0;
  for (size_t k = 0; k < RIM_STEPS; ++k)
  {
    if (labels[k] != labels[k + 1])
    {
      sheets[count].labels = labels + k;
      find_sheet(work, &r, k, &sheets[count]);
      is_any_off = is_any_off || !is_on_sheet(work, &r, &sheets[count]);
      ++count;
    }
  }
  int is_clear = 1;
  for (size_t s = 0; s < count && is_any_off; ++s)
  {
    is_clear = is_clear && are_apart(work, &r, &sheets[s], &sheets[s + 1 < count ? s + 1 : 0]);
  }
  return is_any_off && is_clear;
}

static void bends_body(void* data, size_t begin, size_t end)
{
  const trimming* work = data;
  for (size_t e = begin; e < end; ++e)
  {
    work->is_bent[e] = (unsigned char)is_bent(work, e);
  }
}

/* The part of both radii of an edge's balls with which they still overlap; 1 at most. */
static double part_of_edge(const mlim_balls* balls, const int32_t ends[2])
{
  const double ra = balls->radii[ends[0]];
  const double rb = balls->radii[ends[1]];
  const double d =
    mlim_distance(balls->centers + 3 * (size_t)ends[0], balls->centers + 3 * (size_t)ends[1]);
  return mlim_min(1, (d + OVERLAP * mlim_min(ra, rb)) / (ra + rb));
}

/* A ball of a bent edge keeps what each of its edges needs, others all. */
static void find_parts(trimming* work)
{
  const mlim_balls* balls = work->balls;
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    work->parts[b] = 1;
  }
  for (size_t e = 0; e < balls->edge_count; ++e)
  {
    for (int k = 0; work->is_bent[e] && k < 2; ++k)
    {
      work->parts[balls->edges[2 * e + (size_t)k]] = 0;
    }
  }
  for (size_t e = 0; e < balls->edge_count; ++e)
  {
    const int32_t* ends = balls->edges + 2 * e;
    const double part = part_of_edge(balls, ends);
    for (int k = 0; k < 2; ++k)
    {
      work->parts[ends[k]] = mlim_max(work->parts[ends[k]], part);
    }
  }
}

static mlim_status copy_balls(trimming* work)
{
  const mlim_balls* old = work->balls;
  mlim_status status = MLIM_OK;
  for (size_t b = 0; b < old->ball_count && !status; ++b)
  {
    status = mlim_ball_list_add(&work->list, old->centers + 3 * b, work->parts[b] * old->radii[b],
      old->ball_curves[b], old->ball_sets[b]);
  }
  for (size_t e = 0; e < old->edge_count && !status; ++e)
  {
    status = mlim_ball_list_join(
      &work->list, old->edges[2 * e], old->edges[2 * e + 1], old->edge_curves[e]);
  }
  return status ? status : mlim_sets_copy(&old->sets, &work->list.balls.sets);
}

mlim_status mlim_bends_trim(const mlim_field* field, const mlim_balls* balls,
  const mlim_options* options, mlim_context* context, mlim_balls* out)
{
  *out = (mlim_balls){ 0 };
  trimming work = { .field = field,
    .balls = balls,
    .distance = options->facet_distance,
    .gap = GAP * options->smallest_distance,
    .is_bent = mlim_allocate(balls->edge_count, sizeof *work.is_bent),
    .parts = mlim_allocate(balls->ball_count, sizeof *work.parts) };
  for (int k = 0; k <= RIM_STEPS; ++k)
  {
    work.steps[k][0] = cos(STEP_ANGLE * k);
    work.steps[k][1] = sin(STEP_ANGLE * k);
  }
  const mlim_stage_work stage = {
    .count = balls->edge_count, .body = bends_body, .job = &work, .stage = MLIM_STAGE_SURFACE
  };
  mlim_status status = work.is_bent && work.parts ? MLIM_OK : MLIM_OUT_OF_MEMORY;
  status = status ? status : mlim_parallel_stage(context, &stage);
  if (!status)
  {
    find_parts(&work);
    status = copy_balls(&work);
  }
  if (!status)
  {
    mlim_ball_list_take(&work.list, out);
  }
  trimming_free(&work);
  return status == MLIM_OUT_OF_MEMORY ? mlim_fail_memory(context, "the protecting balls") : status;
}
