#include "wedge.h"

#include "vector.h"

#include <math.h>

/* Half-way to the edge the other sheet has to be within these parts of the thickness across, the vertex's own
   within SLACK of its plane, and this part of the way ahead the region has to be gone. */
static const double HALF_LEAST = 0.25;
static const double HALF_MOST = 0.75;
static const double SLACK = 0.25;
static const double BEHIND = 1.25;

/* Tangents of the angle between the sheets. Below the first, 0.6 degrees, they count as parallel; above the
   second, 15 degrees, the wedge is thick again beside the ball that stands on its edge. */
static const double LEAST_TANGENT = 0.01;
static const double MOST_TANGENT = 0.27;

/* The region at a pair, seen from its vertex. */
typedef struct wedge
{
  double across[3]; /* of length 1, along the normal to the other sheet */
  double ahead[3];  /* of length 1, on the sheet towards the edge */
  double thickness;
  double way;        /* to the planes' edge */
  int32_t inside;    /* label between the sheets */
  int32_t near, far; /* labels beyond them, the vertex's first */
} wedge;

/* 0: the sheets have no label in common, or the same one beyond: no curve where they meet. */
static int find_labels(const mlim_sheet* a, const mlim_sheet* b, wedge* out)
{
  if (a->low == b->low || a->low == b->high)
  {
    out->inside = a->low;
    out->near = a->high;
  }
  else
  {
    out->inside = a->high;
    out->near = a->low;
  }
  out->far = b->low == out->inside ? b->high : b->low;
  return (b->low == out->inside || b->high == out->inside) && out->far != out->near;
}

/* Where the planes of the sheets meet. 0: nowhere, or too steeply. */
static int find_edge(
  const mlim_field* field, const mlim_vertex* vertex, const mlim_vertex* partner, wedge* out)
{
  double normal[3]; /* of the other sheet, outward */
  out->thickness = mlim_distance(vertex->point, partner->point);
  if (!find_labels(&vertex->sheet, &partner->sheet, out) || !(out->thickness > 0) ||
      !mlim_field_normal(field, partner->point, out->far, out->inside, normal))
  {
    return 0;
  }
  for (int k = 0; k < 3; ++k)
  {
    out->across[k] = (partner->point[k] - vertex->point[k]) / out->thickness;
  }
  const double cosine = mlim_dot(normal, out->across);
  double sine = 0;
  for (int k = 0; k < 3; ++k)
  {
    out->ahead[k] = normal[k] - cosine * out->across[k];
    sine += out->ahead[k] * out->ahead[k];
  }
  sine = sqrt(sine);
  if (!(sine > LEAST_TANGENT * cosine) || !(sine < MOST_TANGENT * cosine))
  {
    return 0;
  }
  for (int k = 0; k < 3; ++k)
  {
    out->ahead[k] /= sine;
  }
  out->way = out->thickness * cosine / sine;
  return 1;
}

/* A place at parts of the way ahead and of the thickness across. */
static void place_at(
  const mlim_vertex* vertex, const wedge* w, double ahead, double across, double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] = vertex->point[k] + ahead * w->way * w->ahead[k] + across * w->thickness * w->across[k];
  }
}

static int32_t label_at(
  const mlim_field* field, const mlim_vertex* vertex, const wedge* w, double ahead, double across)
{
  double at[3];
  place_at(vertex, w, ahead, across, at);
  return mlim_field_label(field, at);
}

/* Whether the regions beyond the sheets are face to face behind the edge. */
static int is_closed_behind(const mlim_oracle* oracle, const mlim_vertex* vertex, const wedge* w)
{
  double start[3];
  double end[3];
  mlim_crossing crossings[2];
  place_at(vertex, w, BEHIND, -0.5, start);
  place_at(vertex, w, BEHIND, 0.5, end);
  return mlim_oracle_crossings(oracle, start, end, 2, crossings) == 1 &&
         crossings[0].from == w->near && crossings[0].to == w->far;
}

int mlim_wedge_is_at(
  const mlim_oracle* oracle, const mlim_vertex* vertex, const mlim_vertex* partner)
{
  const mlim_field* field = oracle->field;
  wedge w;
  return find_edge(field, vertex, partner, &w) &&
         label_at(field, vertex, &w, 0.5, -SLACK) == w.near &&
         label_at(field, vertex, &w, 0.5, HALF_LEAST) == w.inside &&
         label_at(field, vertex, &w, 0.5, HALF_MOST) == w.far &&
         is_closed_behind(oracle, vertex, &w);
}
