/* Protecting balls: the conditions they have to satisfy, stated and tested here, and contacts.
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

/* The same, with a report of each fault. is_known, unless it is NULL: balls that were there at the last
   examination; what is among them alone, and was reported then, need not be reported again. */
mlim_status mlim_balls_examine(const mlim_curves* curves, const mlim_balls* balls,
  const unsigned char* is_known, const mlim_options* options, mlim_ball_report report, void* user);

/* A ball over a spot where sheets touch, or are nearer than can be resolved. */
typedef struct mlim_contact
{
  double center[3];
  double radius;
  int32_t set; /* labels that meet there */
} mlim_contact;

/* Puts contacts into a cover. A contact takes the place of the balls whose centres it holds: it has
   their labels, and their curves go on to it, with a ball between where there is a gap. Contacts may
   overlap balls that are not their neighbours. `sets`: of the contacts. */
mlim_status mlim_balls_contract(const mlim_balls* balls, const mlim_contact* contacts, size_t count,
  const mlim_sets* sets, mlim_context* context, mlim_balls* out);

#endif
