/* From segments to curves: growing them from junctions, and taking away what is too small. */
#ifndef mlim_grow_h
#define mlim_grow_h

#include "network.h"

/* Curves as sequences of a network's points. Owns its arrays; all 0 is empty. */
typedef struct mlim_chains
{
  size_t count;
  size_t* offsets; /* count + 1 */
  int32_t* points; /* a closed chain repeats its first point */
  int32_t* sets;
  unsigned char* is_junction; /* per point of the network */
} mlim_chains;

void mlim_chains_free(mlim_chains* chains);

/* Grows all chains: from the junctions in their order, then what is left, as closed ones. A
   junction is a point where not just two segments of equal sets meet, or one with is_corner not 0
   (one byte a point; NULL: none). */
mlim_status mlim_chains_grow(
  const mlim_network* network, const unsigned char* is_corner, mlim_chains* out);

/* Marks the sharp corners of chains, seen over a length of `reach` on either side: only a ball on
   the corner itself keeps the two sides apart. is_corner has a byte a point, all 0. */
void mlim_chains_mark_corners(
  const mlim_network* network, const mlim_chains* chains, double reach, unsigned char* is_corner);

/* Makes junctions closer than the tolerance one, and drops the chains between them, tiny closed
   chains and tiny ends. What lies on the box, [0, size], stays there. *has_changed tells whether
   there was anything to do; the network has to be grown again then. */
mlim_status mlim_network_clean(mlim_network* network, const mlim_chains* chains, double tolerance,
  const double size[3], int* has_changed);

/* Takes out of chains what goes out and comes back within a width: thinner than any ball. The
   network has new segments then, and has to be grown again. */
mlim_status mlim_network_cut_detours(
  mlim_network* network, const mlim_chains* chains, double width, int* has_changed);

#endif
