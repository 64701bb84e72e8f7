/* Vertices whose restricted facets form one ring. */
#ifndef mlim_refine_rings_h
#define mlim_refine_rings_h

#include "refine.h"

/* Takes the vertices off the list of the dirty ones whose disk condition is seen to hold without a look at
   their stars: those on one sheet whose restricted facets form one ring, as nearly all do. In one pass over
   the facets, which pays when many are dirty; otherwise nothing is done. Only while every facet between two
   labels has its record. */
mlim_status mlim_rings_settle(mlim_refinement* refinement, mlim_context* context);

#endif
