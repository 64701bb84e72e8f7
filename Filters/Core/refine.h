/* The refinement loop: the worst restricted facets are mended by inserting the points where their
   duals cross the interface. Dey, Janoos, Levine, section 3.3. */
#ifndef mlim_refine_h
#define mlim_refine_h

#include "disk.h"
#include "queue.h"
#include "records.h"

typedef enum mlim_goal
{
  MLIM_GOAL_TOPOLOGY, /* only what makes the complex right */
  MLIM_GOAL_QUALITY   /* also size, distance and shape */
} mlim_goal;

typedef struct mlim_refinement
{
  mlim_complex complex;
  mlim_records records; /* on their way within a batch */
  mlim_ball_links links;
  mlim_queue queue;
  mlim_star star;
  const mlim_options* options; /* borrowed */
  mlim_goal goal;
  size_t insertion_count;
  double expected_vertices; /* a guess, for progress */
  double progress;          /* last reported */
} mlim_refinement;

/* Inserts the balls and records the complex; the caller seeds it. `progress` has been reported before: none
   below it will be. Balls that lie inside others or hold the centre of one are marked (one byte each) and
   counted; if there are any, they have to be taken out and the start made again: nothing is recorded then. */
mlim_status mlim_refine_start(mlim_refinement* refinement, const mlim_oracle* oracle,
  const mlim_balls* balls, const mlim_options* options, double progress, mlim_context* context,
  unsigned char* is_hidden, size_t* hidden_count);
/* Inserts the complex's balls, but those that are there (one byte each; NULL: none), in the order of their
   places. Marks and counts are as above; the others are inserted all the same. */
mlim_status mlim_refine_insert_balls(mlim_refinement* refinement, const unsigned char* is_there,
  mlim_context* context, unsigned char* is_hidden, size_t* hidden_count);
void mlim_refine_free(mlim_refinement* refinement);

/* Refines until nothing that is bad by the goal can be mended. MLIM_VERTEX_LIMIT: stopped early,
   all is valid. */
mlim_status mlim_refine_run(mlim_refinement* refinement, mlim_goal goal, mlim_context* context);

/* The same for the goal of the last run, with the facets queued since: no other is judged that was there. */
mlim_status mlim_refine_go_on(mlim_refinement* refinement, mlim_context* context);

/* Asks for the crossing of a facet that satisfies the criteria, at the next run. *is_taken: whether it
   may be inserted at all. */
mlim_status mlim_refine_ask(
  mlim_refinement* refinement, int32_t record, mlim_context* context, int* is_taken);

/* Labels the cells and records the facets that insertions since the last time have made: before anything
   but the triangulation is looked at. */
mlim_status mlim_refine_update(mlim_refinement* refinement, mlim_context* context);

/* Tells the host how far refinement is. */
mlim_status mlim_refine_report(mlim_refinement* refinement, mlim_context* context);

/* The bound on the distance has become tighter at the labels marked (one byte each): their facets are
   judged again at the next run. */
void mlim_refine_tighten(mlim_refinement* refinement, const unsigned char* is_tightened);

#endif
