/* Partners: where a region is thinner than the smallest distance of two vertices, a vertex on one of its
   sheets gets another straight across, on the other sheet. Between such pairs the Voronoi diagram follows
   the film however thin it is, and triangles may be as large as anywhere. The paper samples films as
   densely as they are thin. */
#ifndef mlim_partner_h
#define mlim_partner_h

#include "complex.h"

typedef struct mlim_partners
{
  size_t count; /* one a side of the sheet at most */
  mlim_vertex vertices[2];
} mlim_partners;

/* Looks for the partners of a surface vertex, the last one that was probed. 0: a film at the vertex is so
   thin that neither the vertex nor a partner should be inserted. */
int mlim_partners_find(const mlim_complex* complex, const mlim_options* options,
  const mlim_vertex* vertex, mlim_partners* out);

/* Inserts a partner of `vertex` unless it would be in a ball or beside a vertex of its own sheet.
   *is_there: whether it was inserted. */
mlim_status mlim_partner_insert(mlim_complex* complex, const mlim_options* options,
  const mlim_vertex* partner, int32_t vertex, mlim_context* context, int* is_there);

#endif
