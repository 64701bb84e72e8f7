#include "spots.h"

#include "ahead.h"
#include "ball_grid.h"
#include "faces.h"
#include "label_sets.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <stdlib.h>

/* In units of the smallest distance. A spot gathers what is within REACH of its first point; its
   contact goes MARGIN beyond them and is not larger than LARGEST: larger ones swallow what could be
   meshed, smaller ones leave more to mending. */
static const double REACH = 1.6;
static const double MARGIN = 0.5;
static const double SMALLEST = 1;
static const double LARGEST = 1.5;

/* A contact misses the centres of others, and they its own, by this factor of the radius. */
static const double APART = 1.05;

enum
{
  LOOK_EVERY = 65536 /* facets between two looks at the host: about 20 ms */
};

/* Where a facet crosses an interface. */
typedef struct spot_point
{
  double point[3];
  mlim_sheet sheet;
  int is_taken;
} spot_point;

typedef struct spotting
{
  const mlim_refinement* refinement;
  const mlim_field_grid* grid;
  const mlim_balls* balls;
  double unit; /* the smallest distance */
  spot_point* points;
  size_t point_count, point_capacity;
  int32_t* members; /* of the spot at work */
  size_t member_count;
  mlim_contact* contacts;
  size_t contact_count;
  mlim_set_table table;
  mlim_point_grid point_grid;
  mlim_ball_grid ball_grid;
  mlim_point_grid contact_grid;
} spotting;

static void spotting_free(spotting* s)
{
  mlim_release(s->points);
  mlim_release(s->members);
  mlim_release(s->contacts);
  mlim_set_table_free(&s->table);
  mlim_point_grid_free(&s->point_grid);
  mlim_ball_grid_free(&s->ball_grid);
  mlim_point_grid_free(&s->contact_grid);
}

static int is_unresolved(const spotting* s, const mlim_facet* facet)
{
  const mlim_complex* complex = &s->refinement->complex;
  const mlim_options* options = s->refinement->options;
  if (!facet->is_alive || mlim_complex_is_good(facet))
  {
    return 0;
  }
  const mlim_badness badness = mlim_criteria_judge(complex, options, facet).badness;
  return (badness == MLIM_BAD_CROSSINGS || badness == MLIM_BAD_SHEET) &&
         !mlim_criteria_may_insert(complex, options, facet, badness);
}

static mlim_status gather_points(spotting* s, mlim_context* context)
{
  const mlim_complex* complex = &s->refinement->complex;
  for (size_t f = 1; f < complex->facet_count; ++f)
  {
    const mlim_facet* facet = &complex->facets[f];
    mlim_ahead_of_record(complex, f, complex->facet_count);
    if (f % LOOK_EVERY == 0 &&
        mlim_progress(context, MLIM_STAGE_SURFACE, s->refinement->progress) != MLIM_OK)
    {
      return MLIM_CANCELLED;
    }
    if (!is_unresolved(s, facet))
    {
      continue;
    }
    if (mlim_reserve(&s->points, &s->point_capacity, s->point_count + 1, sizeof *s->points))
    {
      return MLIM_OUT_OF_MEMORY;
    }
    spot_point* point = &s->points[s->point_count++];
    *point = (spot_point){ .sheet = facet->sheet };
    mlim_copy(facet->crossing, point->point);
  }
  return MLIM_OK;
}

/* Along z, then y, then x: spots are taken in the order of the points, and so do not depend on that of the
   records. */
static int compare_points(const void* a, const void* b)
{
  const spot_point* x = (const spot_point*)a;
  const spot_point* y = (const spot_point*)b;
  for (int k = 2; k >= 0; --k)
  {
    if (x->point[k] != y->point[k])
    {
      return x->point[k] < y->point[k] ? -1 : 1;
    }
  }
  return x->sheet.low != y->sheet.low     ? x->sheet.low - y->sheet.low
         : x->sheet.high != y->sheet.high ? x->sheet.high - y->sheet.high
                                          : x->sheet.face - y->sheet.face;
}

static mlim_status create_grids(spotting* s)
{
  if (s->point_count > 1)
  {
    qsort(s->points, s->point_count, sizeof *s->points, compare_points);
  }
  s->members = mlim_allocate(s->point_count, sizeof *s->members);
  s->contacts = mlim_allocate(s->point_count, sizeof *s->contacts);
  if (s->members == NULL || s->contacts == NULL ||
      mlim_point_grid_create(REACH * s->unit, s->point_count, &s->point_grid) != MLIM_OK ||
      mlim_point_grid_create(2 * LARGEST * s->unit, s->point_count, &s->contact_grid) != MLIM_OK ||
      mlim_ball_grid_fill(s->balls, &s->ball_grid) != MLIM_OK)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  for (size_t p = 0; p < s->point_count; ++p)
  {
    mlim_point_grid_add(&s->point_grid, s->points[p].point, (int32_t)p);
  }
  return MLIM_OK;
}

static void find_members(spotting* s, const double first[3])
{
  const double reach = REACH * s->unit;
  mlim_point_walk walk;
  s->member_count = 0;
  for (int32_t p = mlim_point_grid_first(&s->point_grid, first, reach, &walk); p >= 0;
       p = mlim_point_grid_next(&s->point_grid, &walk))
  {
    if (!s->points[p].is_taken && mlim_distance(s->points[p].point, first) <= reach)
    {
      s->members[s->member_count++] = p;
    }
  }
}

static unsigned faces_at(const spotting* s, const double point[3])
{
  return mlim_faces_at(s->grid->size, point);
}

/* The members' mean would be on no sheet, and off the box's faces: the member nearest to it, of those
   on most faces. */
static void choose_member(const spotting* s, double center[3])
{
  double mean[3] = { 0, 0, 0 };
  for (size_t m = 0; m < s->member_count; ++m)
  {
    for (int k = 0; k < 3; ++k)
    {
      mean[k] += s->points[s->members[m]].point[k] / (double)s->member_count;
    }
  }
  int most = -1;
  double least = HUGE_VAL;
  for (size_t m = 0; m < s->member_count; ++m)
  {
    const double* point = s->points[s->members[m]].point;
    const int faces = mlim_faces_count(faces_at(s, point));
    const double d = mlim_distance_squared(point, mean);
    if (faces > most || (faces == most && d < least))
    {
      most = faces;
      least = d;
      mlim_copy(point, center);
    }
  }
}

static double radius_at(const spotting* s, const double center[3])
{
  double far = 0;
  for (size_t m = 0; m < s->member_count; ++m)
  {
    far = fmax(far, mlim_distance(s->points[s->members[m]].point, center));
  }
  return fmax(far + MARGIN * s->unit, SMALLEST * s->unit);
}

/* The ball in whose place the contact would stand: one that it touches deeply, on no fewer faces of the
   box, the nearest of those on most. -1: none. */
static int32_t find_ball(const spotting* s, const double center[3], double radius)
{
  int32_t found = -1;
  int most = mlim_faces_count(faces_at(s, center));
  double least = HUGE_VAL;
  mlim_point_walk walk;
  for (int32_t b =
         mlim_point_grid_first(&s->ball_grid.points, center, radius + s->ball_grid.largest, &walk);
       b >= 0; b = mlim_point_grid_next(&s->ball_grid.points, &walk))
  {
    const double* at = s->balls->centers + 3 * (size_t)b;
    const double d = mlim_distance(at, center);
    const int faces = mlim_faces_count(faces_at(s, at));
    if (d <= fmax(radius, s->balls->radii[b] + 0.5 * radius) &&
        (faces > most || (faces == most && d < least)))
    {
      most = faces;
      least = d;
      found = b;
    }
  }
  return found;
}

static int is_in_ball(const spotting* s, const double center[3], double radius)
{
  mlim_point_walk walk;
  for (int32_t b = mlim_point_grid_first(&s->ball_grid.points, center, s->ball_grid.largest, &walk);
       b >= 0; b = mlim_point_grid_next(&s->ball_grid.points, &walk))
  {
    const double d = mlim_distance(s->balls->centers + 3 * (size_t)b, center);
    if (d >= radius && d < APART * s->balls->radii[b])
    {
      return 1;
    }
  }
  return 0;
}

/* At a distance from a face: small enough for vertices on the face, which keep the smallest distance from
   the ball in power, and MLIM_NEAR_GUARD. */
static double radius_below(const spotting* s, double distance)
{
  const double squared = distance * distance;
  return sqrt(fmax(0, fmin(squared - s->unit * s->unit, squared / (1 + 1.5 * MLIM_NEAR_GUARD))));
}

/* Caps stay flat and the box keeps its edges: the contact does not reach a face on which it is not, nor
   take the place of a ball on such a face. */
static void keep_off_faces(const spotting* s, mlim_contact* contact)
{
  const unsigned faces = faces_at(s, contact->center);
  for (int k = 0; k < 3; ++k)
  {
    const double low = contact->center[k];
    const double high = s->grid->size[k] - contact->center[k];
    contact->radius = low > 0 ? fmin(contact->radius, radius_below(s, low)) : contact->radius;
    contact->radius = high > 0 ? fmin(contact->radius, radius_below(s, high)) : contact->radius;
  }
  mlim_point_walk walk;
  const double reach = contact->radius + s->ball_grid.largest;
  for (int32_t b = mlim_point_grid_first(&s->ball_grid.points, contact->center, reach, &walk);
       b >= 0; b = mlim_point_grid_next(&s->ball_grid.points, &walk))
  {
    const double* at = s->balls->centers + 3 * (size_t)b;
    if (faces_at(s, at) & ~faces)
    {
      const double d = mlim_distance(at, contact->center) - (APART - 1) * s->balls->radii[b];
      contact->radius = fmin(contact->radius, d / APART);
    }
  }
}

/* Makes the radius small enough for what is there. 0: there is no room. */
static int fit(const spotting* s, mlim_contact* contact)
{
  keep_off_faces(s, contact);
  const double reach = APART * LARGEST * s->unit;
  mlim_point_walk walk;
  for (int32_t c = mlim_point_grid_first(&s->contact_grid, contact->center, reach, &walk); c >= 0;
       c = mlim_point_grid_next(&s->contact_grid, &walk))
  {
    const double d = mlim_distance(s->contacts[c].center, contact->center);
    if (d < APART * s->contacts[c].radius)
    {
      return 0;
    }
    contact->radius = fmin(contact->radius, d / APART);
  }
  return contact->radius >= MARGIN * s->unit && contact->radius <= LARGEST * s->unit &&
         !is_in_ball(s, contact->center, contact->radius);
}

/* In the place of a ball if that is possible: curves stay where they are. */
static int place_contact(const spotting* s, mlim_contact* contact)
{
  double center[3];
  choose_member(s, center);
  const double radius = radius_at(s, center);
  const int32_t ball = find_ball(s, center, radius);
  if (ball >= 0)
  {
    mlim_copy(s->balls->centers + 3 * (size_t)ball, contact->center);
    contact->radius = radius_at(s, contact->center);
    if (fit(s, contact))
    {
      return 1;
    }
  }
  mlim_copy(center, contact->center);
  contact->radius = radius;
  return fit(s, contact);
}

static mlim_status join_sheets(spotting* s, int32_t* set)
{
  const mlim_field* field = s->refinement->complex.oracle.field;
  mlim_status status = mlim_set_table_add(&s->table, NULL, 0, set);
  for (size_t m = 0; m < s->member_count && status == MLIM_OK; ++m)
  {
    const mlim_sheet* sheet = &s->points[s->members[m]].sheet;
    const int32_t labels[3] = { sheet->low, sheet->high,
      mlim_field_label_count(field) + sheet->face };
    int32_t one;
    status = mlim_set_table_add(&s->table, labels, sheet->face < 0 ? 2 : 3, &one);
    status = status != MLIM_OK ? status : mlim_set_table_join(&s->table, *set, one, set);
  }
  return status;
}

static mlim_status make_contact(spotting* s, size_t first)
{
  mlim_contact contact;
  find_members(s, s->points[first].point);
  s->points[first].is_taken = 1;
  if (!place_contact(s, &contact))
  {
    return MLIM_OK;
  }
  for (size_t m = 0; m < s->member_count; ++m)
  {
    s->points[s->members[m]].is_taken = 1;
  }
  mlim_point_grid_add(&s->contact_grid, contact.center, (int32_t)s->contact_count);
  s->contacts[s->contact_count] = contact;
  return join_sheets(s, &s->contacts[s->contact_count++].set);
}

mlim_status mlim_spots_cover(const mlim_refinement* refinement, const mlim_balls* balls,
  mlim_context* context, mlim_balls* out, size_t* count)
{
  *out = (mlim_balls){ 0 };
  *count = 0;
  spotting s = { .refinement = refinement,
    .grid = mlim_field_grid_of(refinement->complex.oracle.field),
    .balls = balls,
    .unit = refinement->options->smallest_distance };
  mlim_status status = gather_points(&s, context);
  if (status == MLIM_OK && s.point_count > 0)
  {
    status = create_grids(&s);
  }
  for (size_t p = 0; p < s.point_count && status == MLIM_OK; ++p)
  {
    status = s.points[p].is_taken ? MLIM_OK : make_contact(&s, p);
  }
  if (status == MLIM_OUT_OF_MEMORY)
  {
    mlim_fail_memory(context, "spots that cannot be resolved");
  }
  if (status == MLIM_OK && s.contact_count > 0)
  {
    status = mlim_balls_contract(balls, s.contacts, s.contact_count, &s.table.sets, context, out);
    *count = s.contact_count;
  }
  spotting_free(&s);
  return status;
}
