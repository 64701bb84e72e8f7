#include "partner.h"

#include "vector.h"
#include "wedge.h"

#include <math.h>

/* In units of the smallest distance: films up to THICKEST get pairs of vertices, thinner ones than
   THINNEST no vertex at all. Thicker: more vertices, where triangles would have been right without;
   thinner: cells so flat that nothing is won. */
static const double THICKEST = 1.35;
static const double THINNEST = 0.03;

/* A partner keeps this distance from other vertices of its sheet, in units of the smallest distance: nearer
   ones leave triangles above the radius-edge bound. In films thinner than THIN it may be nearer, since
   they need pairs more, and so near as its own vertex is to others, but for its part AS_APART. */
static const double APART = 1;
static const double APART_IF_THIN = 0.75;
static const double AS_APART = 0.8;
static const double THIN = 0.55;

/* A pair closer than this part of the room round its vertex gives cells too flat for a volume mesh: a cell
   between triangles of radius R, with an edge of length h across, has a radius-edge ratio of R / h at
   least. Such films wait for denser vertices, or for contacts. Sharp wedges may be flatter: they are so
   at every density, and without pairs lose their angle. */
static const double FLATTEST_FILM = 0.25;
static const double FLATTEST_WEDGE = 0.13;

/* Smallest power distance of a partner to a ball, in the ball's squared radius. Lower than for other
   vertices, since its vertex keeps the distance that they do. */
static const double GUARD = 0.1;

static void step(const double from[3], const double normal[3], double length, double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] = from[k] + length * normal[k];
  }
}

/* Whether a label ends between two points that a line to the other sheet of its film runs through. */
static int find_across(
  const mlim_complex* complex, const double start[3], const double end[3], mlim_vertex* out)
{
  mlim_crossing crossing;
  if (mlim_oracle_crossings(&complex->oracle, start, end, 1, &crossing) == 0 || crossing.face >= 0)
  {
    return 0;
  }
  const int is_up = crossing.from < crossing.to;
  *out = (mlim_vertex){ .kind = MLIM_VERTEX_SURFACE,
    .ball = -1,
    .sheet = { .low = is_up ? crossing.from : crossing.to,
      .high = is_up ? crossing.to : crossing.from,
      .face = -1 } };
  mlim_copy(crossing.point, out->point);
  return 1;
}

/* Whether a pair would not be too flat for the room round the vertex, which was probed last. */
static int is_wide_enough(
  const mlim_complex* complex, const mlim_vertex* vertex, const mlim_vertex* partner)
{
  const double room = mlim_complex_power(complex);
  const double width = mlim_distance_squared(partner->point, vertex->point);
  return width >= FLATTEST_FILM * FLATTEST_FILM * room ||
         (width >= FLATTEST_WEDGE * FLATTEST_WEDGE * room &&
           mlim_wedge_is_at(&complex->oracle, vertex, partner));
}

int mlim_partners_find(const mlim_complex* complex, const mlim_options* options,
  const mlim_vertex* vertex, mlim_partners* out)
{
  const mlim_field* field = complex->oracle.field;
  const mlim_sheet* sheet = &vertex->sheet;
  double normal[3]; /* towards the lower label */
  out->count = 0;
  if (sheet->face >= 0 || !mlim_field_normal(field, vertex->point, sheet->low, sheet->high, normal))
  {
    return 1;
  }
  for (int side = 0; side < 2; ++side)
  {
    const double sign = (side == 0 ? 1 : -1) * options->smallest_distance;
    const int32_t label = side == 0 ? sheet->low : sheet->high;
    double near[3];
    double far[3];
    step(vertex->point, normal, sign * THICKEST, far);
    if (mlim_field_label(field, far) == label)
    {
      continue;
    }
    step(vertex->point, normal, sign * THINNEST, near);
    if (mlim_field_label(field, near) != label)
    {
      return 0;
    }
    mlim_vertex* found = &out->vertices[out->count];
    out->count += find_across(complex, near, far, found) && is_wide_enough(complex, vertex, found);
  }
  return 1;
}

/* Distance of a vertex to those round the zone of the last probe: in power, so balls count by their rims. */
static double find_room(const mlim_complex* complex, int32_t vertex)
{
  const double* point = complex->vertices[vertex].point;
  double least = INFINITY;
  for (size_t c = 0; c < complex->zone.count; ++c)
  {
    const int32_t* v = complex->cells[complex->zone.cells[c]].vertices;
    for (int k = 0; k < 4; ++k)
    {
      const mlim_vertex* other = &complex->vertices[v[k]];
      const double power = mlim_distance_squared(other->point, point) - other->weight;
      least = v[k] == vertex ? least : mlim_min(least, power);
    }
  }
  return sqrt(mlim_max(0, least));
}

/* Looks at the vertices round the zone of the last probe. */
static int has_room(
  const mlim_complex* complex, const mlim_vertex* partner, double apart, double least)
{
  for (size_t c = 0; c < complex->zone.count; ++c)
  {
    const mlim_cell* cell = &complex->cells[complex->zone.cells[c]];
    for (int k = 0; k < 4; ++k)
    {
      const mlim_vertex* v = &complex->vertices[cell->vertices[k]];
      const double squared = mlim_distance_squared(v->point, partner->point);
      const double power = squared - v->weight;
      const int is_beside = v->kind == MLIM_VERTEX_SURFACE && squared < apart * apart &&
                            mlim_complex_is_on_sheet(complex, v, &partner->sheet);
      if (is_beside || power < least * least || power < GUARD * v->weight)
      {
        return 0;
      }
    }
  }
  return 1;
}

mlim_status mlim_partner_insert(mlim_complex* complex, const mlim_options* options,
  const mlim_vertex* partner, int32_t vertex, mlim_context* context, int* is_there)
{
  const double unit = options->smallest_distance;
  const mlim_vertex* own = &complex->vertices[vertex];
  const int is_thin = mlim_distance(own->point, partner->point) < THIN * unit;
  int is_found;
  *is_there = 0;
  mlim_status status =
    mlim_complex_probe(complex, partner, own->cell, MLIM_START_NEAR, context, &is_found);
  if (!is_found)
  {
    return status;
  }
  const double apart =
    is_thin ? mlim_min(APART_IF_THIN * unit, AS_APART * find_room(complex, vertex)) : APART * unit;
  if (has_room(complex, partner, apart, THINNEST * unit))
  {
    status = mlim_complex_commit(complex, context);
    *is_there = status == MLIM_OK;
  }
  return status;
}
