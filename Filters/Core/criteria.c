#include "criteria.h"

#include "vector.h"
#include "wedge.h"

#include <math.h>

/* MLIM_NEAR_GUARD where facet_distance itself is at stake: the sheet bends right beside the ball. At 1/4 half
   as many more triangles are off their sheet, at 0 no fewer, with more vertices. */
static const double DISTANCE_GUARD = 0.1;

/* In films thinner than FILM smallest distances a facet with a vertex of the other sheet is refined down to
   NEAREST of them: the labels that would hide it otherwise leave cells without any shape. Nearer, or in thicker
   films, vertices are spent that better nothing. */
static const double FILM = 0.75;
static const double NEAREST = 0.585;

/* Part of the reach at which the look across a film begins: off the sheet itself. */
static const double NEXT = 0.04;

typedef struct triangle
{
  double middle[3];
  double normal[3]; /* of length 1 */
  const mlim_vertex* vertex[3];
  double edge_squared[3];
  double height; /* of the crossing above the facet's plane */
  double radius_squared;
  double shortest_squared;
  double heaviest; /* largest weight */
} triangle;

/* The dual runs through the facet's power centre, perpendicular to its plane. So the paper's distance
   from circumcentre to crossing is the height of the crossing above the plane; said that way it
   holds for weighted vertices too, whose circumcentre is off the dual. */
static void measure_apart(
  const mlim_facet* facet, const mlim_vertex* const vertices[3], triangle* out)
{
  for (int k = 0; k < 3; ++k)
  {
    out->vertex[k] = vertices[k];
  }
  const double* a = out->vertex[0]->point;
  double u[3];
  double v[3];
  mlim_subtract(out->vertex[1]->point, a, u);
  mlim_subtract(out->vertex[2]->point, a, v);
  const double uu = mlim_dot(u, u);
  const double vv = mlim_dot(v, v);
  const double uv = mlim_dot(u, v);
  const double gram = uu * vv - uv * uv; /* squared twice the area */
  const double s = 0.5 * vv * (uu - uv) / gram;
  const double t = 0.5 * uu * (vv - uv) / gram;
  double r[3];
  for (int k = 0; k < 3; ++k)
  {
    r[k] = s * u[k] + t * v[k];
  }
  out->radius_squared = mlim_dot(r, r);
  double to[3];
  mlim_cross(u, v, out->normal);
  mlim_subtract(facet->crossing, a, to);
  const double length = sqrt(mlim_dot(out->normal, out->normal));
  for (int k = 0; k < 3; ++k)
  {
    out->normal[k] /= length;
    out->middle[k] = a[k] + (u[k] + v[k]) / 3;
  }
  out->height = fabs(mlim_dot(to, out->normal));
  out->edge_squared[0] = uu;
  out->edge_squared[1] = vv;
  out->edge_squared[2] = uu + vv - 2 * uv;
  out->shortest_squared = mlim_min(uu, mlim_min(vv, out->edge_squared[2]));
  out->heaviest =
    mlim_max(out->vertex[0]->weight, mlim_max(out->vertex[1]->weight, out->vertex[2]->weight));
}

static void measure(const mlim_complex* complex, const mlim_facet* facet, triangle* out)
{
  int32_t id[3];
  mlim_complex_facet_vertices(complex, facet->cell, facet->index, id);
  const mlim_vertex* v = complex->vertices;
  measure_apart(facet, (const mlim_vertex* const[3]){ &v[id[0]], &v[id[1]], &v[id[2]] }, out);
}

/* Radius of the surface Delaunay ball: the farthest vertex, since weights make them differ. */
static double ball_radius(const triangle* t, const double crossing[3])
{
  double most = 0;
  for (int k = 0; k < 3; ++k)
  {
    most = mlim_max(most, mlim_distance_squared(t->vertex[k]->point, crossing));
  }
  return sqrt(most);
}

static mlim_badness judge_topology(
  const mlim_complex* complex, const mlim_facet* facet, const triangle* t)
{
  int is_foreign = 0;
  for (int k = 0; k < 3; ++k)
  {
    if (t->vertex[k]->kind == MLIM_VERTEX_FAR)
    {
      return MLIM_BAD_FAR;
    }
    is_foreign |= !mlim_complex_is_on_sheet(complex, t->vertex[k], &facet->sheet);
  }
  return facet->is_multiple ? MLIM_BAD_CROSSINGS : is_foreign ? MLIM_BAD_SHEET : MLIM_BAD_NONE;
}

double mlim_criteria_distance(
  const mlim_complex* complex, const mlim_options* options, const mlim_sheet* sheet)
{
  const double low = complex->distance_shares[sheet->low];
  const double high = complex->distance_shares[sheet->high];
  return options->facet_distance * mlim_min(low, high);
}

/* Whether the sheet does not pass within a distance of the triangle's middle, along its normal. The
   height of the crossing says little about it when weights put the crossing aside. */
static int is_off_sheet(
  const mlim_complex* complex, const mlim_facet* facet, const triangle* t, double distance)
{
  int32_t labels[2];
  for (int side = 0; side < 2; ++side)
  {
    double at[3];
    for (int k = 0; k < 3; ++k)
    {
      at[k] = t->middle[k] + (side == 0 ? -distance : distance) * t->normal[k];
    }
    labels[side] = mlim_field_label(complex->oracle.field, at);
  }
  return labels[0] == labels[1] &&
         (labels[0] == facet->sheet.low || labels[0] == facet->sheet.high);
}

static mlim_verdict judge(const mlim_complex* complex, const mlim_options* options,
  const mlim_facet* facet, const triangle* t)
{
  mlim_verdict verdict = { .badness = judge_topology(complex, facet, t),
    .excess = 1,
    .has_ball = t->heaviest > 0,
    .radius_edge_ratio = sqrt(t->radius_squared / t->shortest_squared) };
  if (verdict.badness != MLIM_BAD_NONE)
  {
    return verdict;
  }
  const struct
  {
    mlim_badness badness;
    double measure;
    double bound;
  } rows[] = {
    { MLIM_BAD_SIZE, ball_radius(t, facet->crossing), options->facet_size },
    { MLIM_BAD_DISTANCE, t->height, mlim_criteria_distance(complex, options, &facet->sheet) },
    { MLIM_BAD_RATIO, verdict.radius_edge_ratio, options->facet_radius_edge_ratio },
  };
  for (size_t k = 0; k < sizeof rows / sizeof *rows; ++k)
  {
    if (!(rows[k].measure <= rows[k].bound))
    {
      verdict.badness = rows[k].badness;
      verdict.excess = rows[k].measure / rows[k].bound;
      break;
    }
  }
  if ((verdict.badness == MLIM_BAD_NONE || verdict.badness == MLIM_BAD_RATIO) && t->heaviest > 0 &&
      is_off_sheet(complex, facet, t, mlim_criteria_distance(complex, options, &facet->sheet)))
  {
    verdict.badness = MLIM_BAD_DISTANCE;
    verdict.excess = 1;
  }
  return verdict;
}

/* What a region asks for to keep its volume is worth less than the triangles' shape. */
static double guard_of(const mlim_complex* complex, const mlim_options* options,
  const mlim_facet* facet, const triangle* t, mlim_badness badness)
{
  const double distance = options->facet_distance;
  if (badness == MLIM_BAD_DISTANCE && t->heaviest > 0 &&
      (t->height > distance || is_off_sheet(complex, facet, t, distance)))
  {
    return DISTANCE_GUARD;
  }
  return badness < MLIM_BAD_SIZE || badness == MLIM_BAD_DISTANCE ? MLIM_NEAR_GUARD
                                                                 : MLIM_QUALITY_GUARD;
}

/* Whether the facet's crossing is on a film, whose other sheet is within `reach`. Sharp wedges are none: they lose
   volume where vertices stand nearer to their edge. */
static int is_in_film(const mlim_complex* complex, const mlim_facet* facet, double reach)
{
  const mlim_oracle* oracle = &complex->oracle;
  const mlim_vertex vertex = { .kind = MLIM_VERTEX_SURFACE,
    .sheet = facet->sheet,
    .point = { facet->crossing[0], facet->crossing[1], facet->crossing[2] } };
  double normal[3]; /* towards the lower label */
  int is_found = 0;
  if (facet->sheet.face >= 0 ||
      !mlim_field_normal(oracle->field, vertex.point, facet->sheet.low, facet->sheet.high, normal))
  {
    return 0;
  }
  for (int side = 0; side < 2; ++side)
  {
    const int32_t label = side == 0 ? facet->sheet.low : facet->sheet.high;
    const double length = side == 0 ? reach : -reach;
    double near[3];
    double far[3];
    for (int k = 0; k < 3; ++k)
    {
      near[k] = vertex.point[k] + NEXT * length * normal[k];
      far[k] = vertex.point[k] + length * normal[k];
    }
    mlim_crossing crossing;
    if (mlim_field_label(oracle->field, far) == label ||
        mlim_oracle_crossings(oracle, near, far, 1, &crossing) == 0 || crossing.face >= 0)
    {
      continue;
    }
    const int is_up = crossing.from < crossing.to;
    mlim_vertex across = { .kind = MLIM_VERTEX_SURFACE,
      .sheet = { .low = is_up ? crossing.from : crossing.to,
        .high = is_up ? crossing.to : crossing.from,
        .face = -1 } };
    mlim_copy(crossing.point, across.point);
    if (mlim_wedge_is_at(oracle, &vertex, &across))
    {
      return 0;
    }
    is_found = 1;
  }
  return is_found;
}

static int may_insert(const mlim_complex* complex, const mlim_options* options,
  const mlim_facet* facet, const triangle* t, mlim_badness badness)
{
  /* The crossing is on the facet's dual, so no vertex is nearer in power than these three. */
  const double power =
    mlim_distance_squared(t->vertex[0]->point, facet->crossing) - t->vertex[0]->weight;
  const double least = options->smallest_distance * options->smallest_distance;
  /* A partner across a film may have come nearer to a vertex of its own sheet. Shape alone makes no edge
     shorter than the facet has, so the triangles there can be bettered without an end to fear. */
  const int is_graded =
    badness == MLIM_BAD_RATIO && t->heaviest == 0 && power >= t->shortest_squared;
  const int is_film = badness == MLIM_BAD_SHEET && t->heaviest == 0 && power < least &&
                      power >= NEAREST * NEAREST * least &&
                      is_in_film(complex, facet, FILM * options->smallest_distance);
  if (power < least && !is_graded && !is_film)
  {
    return 0;
  }
  if (power < guard_of(complex, options, facet, t, badness) * t->heaviest)
  {
    return 0;
  }
  /* Near a ball shape alone never makes an edge shorter than the facet has. */
  return badness != MLIM_BAD_RATIO || t->heaviest == 0 || power >= t->shortest_squared;
}

mlim_verdict mlim_criteria_judge(
  const mlim_complex* complex, const mlim_options* options, const mlim_facet* facet)
{
  triangle t;
  measure(complex, facet, &t);
  return judge(complex, options, facet, &t);
}

int mlim_criteria_may_insert(const mlim_complex* complex, const mlim_options* options,
  const mlim_facet* facet, mlim_badness badness)
{
  triangle t;
  measure(complex, facet, &t);
  return may_insert(complex, options, facet, &t, badness);
}

mlim_verdict mlim_criteria_judge_apart(const mlim_complex* complex, const mlim_options* options,
  const mlim_facet* facet, const mlim_vertex* const vertices[3], mlim_badness end, int* is_allowed)
{
  triangle t;
  measure_apart(facet, vertices, &t);
  const mlim_verdict verdict = judge(complex, options, facet, &t);
  *is_allowed = verdict.badness < end && may_insert(complex, options, facet, &t, verdict.badness);
  return verdict;
}

double mlim_criteria_room(
  const mlim_complex* complex, const mlim_options* options, const mlim_facet* facet)
{
  triangle t;
  measure(complex, facet, &t);
  const double power =
    mlim_distance_squared(t.vertex[0]->point, facet->crossing) - t.vertex[0]->weight;
  const double least = NEAREST * options->smallest_distance;
  return power >= least * least && power >= MLIM_NEAR_GUARD * t.heaviest ? power : 0;
}
