/* Protecting balls: the conditions they have to satisfy, stated and tested here, and splitting.
   Dey, Janoos, Levine, section 3.4. */
#ifndef mlim_balls_h
#define mlim_balls_h

#include "status.h"

/* How often a condition does not hold. */
typedef struct mlim_ball_counts
{
  size_t apart_count;    /* neighbours on a curve that overlap too little */
  size_t holding_count;  /* neighbours of which one holds the other's centre, or nearly */
  size_t touching_count; /* balls that are not neighbours and not disjoint */
  size_t long_count;     /* neighbours farther apart than edge_size */
  size_t stray_count;    /* edges whose piece of the curve leaves the union of the two balls, or
                            is farther than facet_distance from the chord */
  size_t short_count;    /* curves of fewer edges than tell them from others with the same ends */
} mlim_ball_counts;

typedef enum mlim_ball_fault
{
  MLIM_BALLS_APART,
  MLIM_BALL_HOLDS_CENTER, /* the first ball holds the second's centre */
  MLIM_BALLS_TOUCH,
  MLIM_BALLS_LONG,
  MLIM_BALLS_STRAY,
  MLIM_BALLS_SHORT /* both numbers are the curve's */
} mlim_ball_fault;

/* Called for each fault, in a fixed order. `distance` is that of the centres. */
typedef void (*mlim_ball_report)(
  void* user, mlim_ball_fault fault, int32_t a, int32_t b, double distance);

/* Tests all conditions. Without curves (NULL) the pieces of curves are not looked at. */
mlim_status mlim_balls_check(const mlim_curves* curves, const mlim_balls* balls,
  const mlim_options* options, mlim_ball_counts* out);

/* The same, with a report of each fault. */
mlim_status mlim_balls_examine(const mlim_curves* curves, const mlim_balls* balls,
  const mlim_options* options, mlim_ball_report report, void* user);

/* Moves a new centre onto the tie of the labels. */
typedef void (*mlim_ball_project)(
  void* user, const int32_t* labels, size_t label_count, double center[3]);

typedef struct mlim_ball_split
{
  const unsigned char* is_marked; /* borrowed; per ball: not 0 splits it */
  mlim_ball_project project;      /* NULL: new centres stay on the chords */
  void* user;
} mlim_ball_split;

/* Halves the radii of marked balls and covers the edges round them anew, along the chords. The
   balls that stay keep their centres; junctions keep their numbers. Radii end at half of
   smallest_distance. */
mlim_status mlim_balls_split(const mlim_balls* balls, const mlim_options* options,
  const mlim_ball_split* split, mlim_context* context, mlim_balls* out);

#endif
