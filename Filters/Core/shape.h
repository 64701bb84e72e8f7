/* The shape of a single cell. */
#ifndef mlim_shape_h
#define mlim_shape_h

/* What the shapes of cells are held against. */
typedef struct mlim_shape_bound
{
  double sine;              /* of the dihedral angles; in (0, 1) */
  double radius_edge_ratio; /* > 0 */
} mlim_shape_bound;

/* One figure for the shape of the cell of four points, larger is better. Below 1 it misses a bound:
   the smaller of the sine's part of its bound and the square root of the ratio's, so that angles
   weigh more; not above 0 if the cell is inverted or flat. Above 1, where it meets both: 1 + the
   smallest sine of its dihedral angles. */
double mlim_shape_of(const mlim_shape_bound* bound, const double* const points[4]);

/* Whether the cell of four points is positively oriented beyond all rounding errors. Cells thinner than
   these are refused whatever they are. */
int mlim_shape_is_positive(const double* const points[4]);

typedef struct mlim_shape_figures
{
  double volume;               /* signed */
  double min_angle, max_angle; /* dihedral, degrees */
  double radius_edge_ratio;
} mlim_shape_figures;

mlim_shape_figures mlim_shape_measure(const double* const points[4]);

/* Squared circumradius. */
double mlim_shape_radius_squared(const double* const points[4]);

/* Circumcentre. */
void mlim_shape_center(const double* const points[4], double out[3]);

#endif
