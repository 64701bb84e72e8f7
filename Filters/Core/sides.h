/* Whether a triangle lies between the two labels that it separates. */
#ifndef mlim_sides_h
#define mlim_sides_h

#include "complex.h"

enum
{
  MLIM_SIDE_LOOKS = 4 /* at the reach, its half, and so on */
};

/* Looks from the middle of a triangle along its normal, of length 1, to both sides, at several lengths up to
   the reach: 1 if the labels are met, labels[1] on the normal's side and labels[0] on the other. */
int mlim_sides_are_seen_from(const mlim_field* field, const double middle[3],
  const double normal[3], const int32_t labels[2], double reach);

/* The same for facet `index` of a cell: `inner` on the cell's side and `outer` on the other. */
int mlim_sides_are_seen(
  const mlim_complex* complex, int32_t cell, int index, int32_t inner, int32_t outer, double reach);

/* The labels that looks `begin` to `end` meet on the cell's side of a facet, seen[0], and on the other. */
void mlim_sides_look(const mlim_complex* complex, int32_t cell, int index, double reach, int begin,
  int end, int32_t seen[2][MLIM_SIDE_LOOKS]);

/* Whether both regions beside a facet without a ball's vertex are as thick, where its dual crosses, as half
   the distance from there to its vertices. Cells between larger triangles and the other sheet of a film
   are flat, whatever their vertices. Facets with a ball's vertex, and in the box's faces, count as wide. */
int mlim_sides_are_wide(const mlim_complex* complex, const mlim_facet* facet);

enum
{
  MLIM_SIDES_TOGETHER = 16 /* facets that wait for memory together */
};

/* A facet between two labels, and whether it is wide and both are seen beside it. */
typedef struct mlim_sides
{
  const mlim_facet* facet;
  double reach;
  int are_right;
} mlim_sides;

/* For no more facets than may wait together. */
void mlim_sides_judge(const mlim_complex* complex, mlim_sides* sides, size_t count);

#endif
