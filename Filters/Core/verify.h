/* Looks from the image at a mesh that satisfies the facets' criteria, for what these cannot see:
   components without a cell, grid crossings far from the mesh, regions that lost volume. Each finding
   becomes a reason to go on refining. */
#ifndef mlim_verify_h
#define mlim_verify_h

#include "components.h"
#include "refine.h"

typedef struct mlim_verification
{
  mlim_refinement* refinement;       /* borrowed */
  const mlim_components* components; /* borrowed */
  const double* volumes;             /* borrowed; of the field, a label */
  const size_t* voxels;              /* borrowed; a label */
  int is_near;
  int round;                 /* from 0 on */
  struct mlim_far_list* far; /* owned: what was far at the last look; NULL at first */
} mlim_verification;

/* Adds seeds and tightens bounds; *count: how many findings led to a change. Once a round finds the
   crossings near enough, is_near is set and later ones do not look again: refinement only adds. */
mlim_status mlim_verify_round(
  mlim_verification* verification, mlim_context* context, size_t* count);

void mlim_verify_free(mlim_verification* verification);

#endif
