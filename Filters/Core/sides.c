#include "sides.h"

#include "triangle.h"

/* Of the distance from the crossing to the vertices. A cell on a triangle of circumradius R that reaches a
   height h has a radius-edge ratio up to 2 only if h is 0.26 R or more; cells in films leave gaps. */
static const double LEAST_DEPTH = 0.5;

static void go_along(const double middle[3], const double normal[3], double offset, double out[3])
{
  out[0] = middle[0] + offset * normal[0];
  out[1] = middle[1] + offset * normal[1];
  out[2] = middle[2] + offset * normal[2];
}

static int32_t label_at(
  const mlim_field* field, const double middle[3], const double normal[3], double offset)
{
  double at[3];
  go_along(middle, normal, offset, at);
  return mlim_field_label(field, at);
}

int mlim_sides_are_seen_from(const mlim_field* field, const double middle[3],
  const double normal[3], const int32_t labels[2], double reach)
{
  int is_inner = 0;
  int is_outer = 0;
  for (int look = 0; look < MLIM_SIDE_LOOKS && !(is_inner && is_outer); ++look, reach *= 0.5)
  {
    is_inner = is_inner || label_at(field, middle, normal, -reach) == labels[0];
    is_outer = is_outer || label_at(field, middle, normal, reach) == labels[1];
  }
  return is_inner && is_outer;
}

/* The middle of a facet and its normal, of length 1, out of the cell. */
static void place_of(
  const mlim_complex* complex, int32_t cell, int index, double middle[3], double normal[3])
{
  int32_t v[3];
  mlim_complex_facet_vertices(complex, cell, index, v);
  const double* a = complex->vertices[v[0]].point;
  const double* b = complex->vertices[v[1]].point;
  const double* c = complex->vertices[v[2]].point;
  mlim_triangle_normal(a, b, c, normal);
  const double length = sqrt(mlim_dot(normal, normal));
  for (int k = 0; k < 3; ++k)
  {
    normal[k] /= length;
    middle[k] = a[k] + (b[k] - a[k] + (c[k] - a[k])) / 3;
    middle[k] = a[k] == b[k] && a[k] == c[k] ? a[k] : middle[k];
  }
}

int mlim_sides_are_seen(
  const mlim_complex* complex, int32_t cell, int index, int32_t inner, int32_t outer, double reach)
{
  double normal[3];
  double middle[3];
  place_of(complex, cell, index, middle, normal);
  const int32_t labels[2] = { inner, outer };
  return mlim_sides_are_seen_from(complex->oracle.field, middle, normal, labels, reach);
}

void mlim_sides_look(const mlim_complex* complex, int32_t cell, int index, double reach, int begin,
  int end, int32_t seen[2][MLIM_SIDE_LOOKS])
{
  double normal[3];
  double middle[3];
  place_of(complex, cell, index, middle, normal);
  for (int look = 0; look < end; ++look, reach *= 0.5)
  {
    if (look >= begin)
    {
      seen[0][look] = label_at(complex->oracle.field, middle, normal, -reach);
      seen[1][look] = label_at(complex->oracle.field, middle, normal, reach);
    }
  }
}

/* The places at which the regions are to be met; 0: the facet counts as wide. */
static int find_depths(const mlim_complex* complex, const mlim_facet* facet, double at[2][3])
{
  int32_t v[3];
  mlim_complex_facet_vertices(complex, facet->cell, facet->index, v);
  const double* p[3];
  for (int k = 0; k < 3; ++k)
  {
    p[k] = complex->vertices[v[k]].point;
    if (facet->sheet.face >= 0 || complex->vertices[v[k]].weight > 0)
    {
      return 0;
    }
  }
  double normal[3]; /* out of the facet's cell */
  mlim_triangle_normal(p[0], p[1], p[2], normal);
  const double depth = LEAST_DEPTH * mlim_distance(p[0], facet->crossing) /
                       sqrt(mlim_dot(normal, normal)); /* in lengths of the normal */
  go_along(facet->crossing, normal, -depth, at[0]);
  go_along(facet->crossing, normal, depth, at[1]);
  return 1;
}

/* Whether these are the labels of a facet's cell and of the one beyond. */
static int are_labels(const mlim_complex* complex, const mlim_facet* facet, const int32_t labels[2])
{
  const mlim_cell* cell = &complex->cells[facet->cell];
  return labels[0] == cell->label &&
         labels[1] == complex->cells[cell->neighbors[facet->index]].label;
}

int mlim_sides_are_wide(const mlim_complex* complex, const mlim_facet* facet)
{
  double at[2][3];
  int32_t labels[2];
  if (!find_depths(complex, facet, at))
  {
    return 1;
  }
  mlim_field_labels(complex->oracle.field, at[0], 2, labels);
  return are_labels(complex, facet, labels);
}

void mlim_sides_judge(const mlim_complex* complex, mlim_sides* sides, size_t count)
{
  double points[4 * MLIM_SIDES_TOGETHER][3] = { { 0 } };
  int32_t labels[4 * MLIM_SIDES_TOGETHER];
  size_t begins[MLIM_SIDES_TOGETHER + 1] = { 0 };
  for (size_t k = 0; k < count; ++k)
  {
    const mlim_facet* facet = sides[k].facet;
    const size_t depths = find_depths(complex, facet, points + begins[k]) ? 2 : 0;
    double(*ends)[3] = points + begins[k] + depths;
    double middle[3];
    double normal[3];
    place_of(complex, facet->cell, facet->index, middle, normal);
    go_along(middle, normal, -sides[k].reach, ends[0]);
    go_along(middle, normal, sides[k].reach, ends[1]);
    begins[k + 1] = begins[k] + depths + 2;
  }
  mlim_field_labels(complex->oracle.field, points[0], begins[count], labels);
  for (size_t k = 0; k < count; ++k)
  {
    const mlim_facet* facet = sides[k].facet;
    const mlim_cell* cell = &complex->cells[facet->cell];
    const int are_wide =
      begins[k + 1] - begins[k] == 2 || are_labels(complex, facet, labels + begins[k]);
    /* The first look is nearly always enough. */
    sides[k].are_right =
      are_wide && (are_labels(complex, facet, labels + begins[k + 1] - 2) ||
                    mlim_sides_are_seen(complex, facet->cell, facet->index, cell->label,
                      complex->cells[cell->neighbors[facet->index]].label, sides[k].reach));
  }
}
