/* What makes a restricted facet bad, in the order in which it is mended: topology first, then size,
   distance and shape. Dey, Janoos, Levine, sections 3.3 and 4.2. */
#ifndef mlim_criteria_h
#define mlim_criteria_h

#include "complex.h"

/* For topology and distance a point keeps at least this power distance to a ball, in its squared radius:
   above 0 it is outside the ball. At 1/4 the new edge is not below half the ball's radius. */
static const double MLIM_NEAR_GUARD = 0.25;
/* The same for size and shape. At 1 the smallest angles near balls are about 24 degrees; at 1/16 there
   are three times as many vertices and angles of 8 degrees. */
static const double MLIM_QUALITY_GUARD = 1;

typedef enum mlim_badness
{
  MLIM_BAD_FAR,       /* has a vertex that stands for the outside */
  MLIM_BAD_CROSSINGS, /* its dual crosses more often than the labels of its cells tell */
  MLIM_BAD_SHEET,     /* a vertex is not on the sheet that it crosses */
  MLIM_BAD_DISK,      /* a vertex's restricted facets do not form a disk or half-disks */
  MLIM_BAD_SIZE,      /* from here on quality; before it topology */
  MLIM_BAD_DISTANCE,
  MLIM_BAD_RATIO,
  MLIM_BAD_NONE
} mlim_badness;

typedef struct mlim_verdict
{
  mlim_badness badness; /* the first criterion that fails, never MLIM_BAD_DISK */
  double excess;        /* measure / bound of that criterion; 1 for topology */
  int has_ball;         /* a vertex is a ball */
  double radius_edge_ratio;
} mlim_verdict;

mlim_verdict mlim_criteria_judge(
  const mlim_complex* complex, const mlim_options* options, const mlim_facet* facet);

/* The same for a facet that has no record yet, whose vertices are given in the order of
   mlim_complex_facet_vertices, and beside changes of the complex. *is_allowed: for badnesses before `end`
   mlim_criteria_may_insert, else 0. */
mlim_verdict mlim_criteria_judge_apart(const mlim_complex* complex, const mlim_options* options,
  const mlim_facet* facet, const mlim_vertex* const vertices[3], mlim_badness end, int* is_allowed);

/* The bound on a crossing's height above its facet: facet_distance, or the part of it that a region
   allows which would lose too much volume. */
double mlim_criteria_distance(
  const mlim_complex* complex, const mlim_options* options, const mlim_sheet* sheet);

/* Whether the facet's crossing may be inserted for that reason: outside the protecting balls and no
   closer to another vertex than the smallest distance. Quality gives way near balls. */
int mlim_criteria_may_insert(const mlim_complex* complex, const mlim_options* options,
  const mlim_facet* facet, mlim_badness badness);

/* Squared distance, in power, of the facet's crossing to all vertices if it is as far from them as it has to be
   in films, and outside the protecting balls; 0: it is too near. */
double mlim_criteria_room(
  const mlim_complex* complex, const mlim_options* options, const mlim_facet* facet);

#endif
