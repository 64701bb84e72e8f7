/* The shape of a single cell. */
#ifndef mlim_shape_h
#define mlim_shape_h

/* What the shapes of cells are held against. */
typedef struct mlim_shape_bound
{
  double sine;              /* of the dihedral angles; in (0, 1) */
  double radius_edge_ratio; /* > 0 */
} mlim_shape_bound;

/* One figure for the shape of the cell of four points, larger is better. Below 1: its dihedral
   angles miss the bound; not above 0 if it is inverted or flat. From 1 to 2: only its radius-edge
   ratio does. Above 2, where it is good: 2 + the smallest sine of its dihedral angles. */
double mlim_shape_of(const mlim_shape_bound* bound, const double* const points[4]);

typedef struct mlim_shape_figures
{
  double volume;               /* signed */
  double min_angle, max_angle; /* dihedral, degrees */
  double radius_edge_ratio;
} mlim_shape_figures;

mlim_shape_figures mlim_shape_measure(const double* const points[4]);

/* Dihedral angle at the edge of the two points that are not i and j, degrees. */
double mlim_shape_angle(const double* const points[4], int i, int j);

#endif
