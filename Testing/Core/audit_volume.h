/* Properties that any volume of the core has. Nothing here shares code with the core. */
#ifndef mlim_audit_volume_h
#define mlim_audit_volume_h

#include "audit_index.h"

/* A face of a cell, or a triangle of the surface. */
typedef struct audit_face
{
  int32_t vertices[3]; /* ascending */
  int32_t label;       /* of the cell; -1: a triangle's entry */
  int32_t pair[2];     /* a triangle's labels, ascending */
} audit_face;

static inline int audit_compare_faces(const void* a, const void* b)
{
  return memcmp(a, b, 3 * sizeof(int32_t));
}

static inline audit_face audit_face_of(int32_t a, int32_t b, int32_t c, int32_t label)
{
  const int32_t low = a < b ? (a < c ? a : c) : (b < c ? b : c);
  const int32_t high = a > b ? (a > c ? a : c) : (b > c ? b : c);
  return (audit_face){ .vertices = { low, a ^ b ^ c ^ low ^ high, high }, .label = label };
}

static inline const double* audit_corner(const mlim_volume* volume, size_t cell, int k)
{
  return volume->vertices + 3 * (size_t)volume->cells[4 * cell + (size_t)k];
}

/* Six times the signed volume. */
static inline double audit_determinant(const mlim_volume* volume, size_t cell)
{
  double e[3][3];
  for (int k = 0; k < 3; ++k)
  {
    mlim_subtract(audit_corner(volume, cell, k + 1), audit_corner(volume, cell, 0), e[k]);
  }
  return e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) -
         e[0][1] * (e[1][0] * e[2][2] - e[1][2] * e[2][0]) +
         e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
}

static inline int audit_has_valid_cells(const mlim_volume* volume)
{
  size_t bad = 0;
  for (size_t k = 0; k < 4 * volume->cell_count; ++k)
  {
    bad += volume->cells[k] < 0 || (size_t)volume->cells[k] >= volume->vertex_count;
  }
  for (size_t c = 0; c < volume->cell_count; ++c)
  {
    bad += volume->cell_labels[c] < 0 || (size_t)volume->cell_labels[c] >= volume->label_count;
  }
  CHECK_COUNT(bad, 0);
  return bad == 0;
}

/* One group of equal faces: two cells of one label; two of different labels and their triangle; or
   one cell and its triangle against the outside. */
static inline int audit_is_good_group(const audit_face* first, size_t count, int32_t outside)
{
  int32_t labels[2] = { outside, outside };
  int32_t pair[2] = { -1, -1 };
  size_t cells = 0;
  for (size_t k = 0; k < count; ++k)
  {
    if (first[k].label < 0)
    {
      pair[0] = first[k].pair[0];
      pair[1] = first[k].pair[1];
    }
    else if (cells < 2)
    {
      labels[cells++] = first[k].label;
    }
    else
    {
      return 0;
    }
  }
  const int32_t low = labels[0] < labels[1] ? labels[0] : labels[1];
  const int32_t high = labels[0] < labels[1] ? labels[1] : labels[0];
  return low == high ? count == 2 && cells == 2
                     : count == cells + 1 && pair[0] == low && pair[1] == high;
}

/* Faces that are not as the surface wants them. With `has_background` the faces that close it are
   free of triangles. */
static inline size_t audit_count_bad_faces(
  const mlim_volume* volume, const mlim_mesh* mesh, int32_t outside, int has_background)
{
  static const int corners[4][3] = { { 1, 2, 3 }, { 0, 2, 3 }, { 0, 1, 3 }, { 0, 1, 2 } };
  audit_face* faces = calloc(4 * volume->cell_count + mesh->triangle_count + 1, sizeof *faces);
  size_t count = 0;
  for (size_t c = 0; c < volume->cell_count; ++c)
  {
    const int32_t* v = volume->cells + 4 * c;
    for (int k = 0; k < 4; ++k)
    {
      faces[count++] =
        audit_face_of(v[corners[k][0]], v[corners[k][1]], v[corners[k][2]], volume->cell_labels[c]);
    }
  }
  for (size_t t = 0; t < mesh->triangle_count; ++t)
  {
    const int32_t* v = mesh->triangles + 3 * t;
    const int32_t* l = mesh->triangle_labels + 2 * t;
    audit_face face = audit_face_of(v[0], v[1], v[2], -1);
    face.pair[0] = l[0] < l[1] ? l[0] : l[1];
    face.pair[1] = l[0] < l[1] ? l[1] : l[0];
    faces[count++] = face;
  }
  qsort(faces, count, sizeof *faces, audit_compare_faces);
  size_t bad = 0;
  for (size_t begin = 0, end; begin < count; begin = end)
  {
    for (end = begin + 1; end < count && audit_compare_faces(&faces[begin], &faces[end]) == 0;
         ++end)
    {
    }
    const int is_rim = has_background && end - begin == 1 && faces[begin].label == outside;
    bad += !is_rim && !audit_is_good_group(&faces[begin], end - begin, outside);
  }
  free(faces);
  return bad;
}

/* Not the surface's own where they have to be, of no cell, or outside the box. */
static inline size_t audit_count_bad_points(
  const mlim_field* field, const mlim_volume* volume, const mlim_mesh* mesh)
{
  const double* size = mlim_field_grid_of(field)->size;
  char* is_used = calloc(volume->vertex_count + 1, 1);
  size_t bad = volume->surface_vertex_count != mesh->vertex_count;
  for (size_t k = 0; k < 4 * volume->cell_count; ++k)
  {
    is_used[volume->cells[k]] = 1;
  }
  for (size_t v = 0; v < volume->vertex_count; ++v)
  {
    const double* p = volume->vertices + 3 * v;
    bad += !is_used[v];
    for (int k = 0; k < 3; ++k)
    {
      bad += !(p[k] >= 0 && p[k] <= size[k]);
    }
    bad += v < mesh->vertex_count && memcmp(p, mesh->vertices + 3 * v, 3 * sizeof *p) != 0;
  }
  free(is_used);
  return bad;
}

/* What holds for every volume, finished or not. */
static inline void audit_volume_of(
  const mlim_field* field, const mlim_mesh* mesh, const mlim_volume* volume, int has_background)
{
  CHECK_COUNT(volume->label_count, mesh->label_count);
  if (!audit_has_valid_cells(volume))
  {
    return;
  }
  const int32_t outside = mlim_field_outside_label(field);
  const double* size = mlim_field_grid_of(field)->size;
  double* sums = calloc(volume->label_count + 1, sizeof *sums);
  size_t flat = 0;
  size_t background = 0;
  for (size_t c = 0; c < volume->cell_count; ++c)
  {
    const double determinant = audit_determinant(volume, c);
    flat += !(determinant > 0);
    background += volume->cell_labels[c] == outside;
    sums[volume->cell_labels[c]] += determinant / 6;
  }
  CHECK_COUNT(flat, 0);
  CHECK(has_background || background == 0);
  for (size_t l = 0; l < volume->label_count; ++l)
  {
    const double box = size[0] * size[1] * size[2];
    CHECK_BELOW(fabs(sums[l] - volume->label_volumes[l]), 1e-9 * box);
    if ((int32_t)l != outside)
    {
      CHECK_BELOW(fabs(sums[l] - mesh->volumes[l]), 1e-9 * mesh->volumes[l]);
    }
  }
  free(sums);
  CHECK_COUNT(audit_count_bad_faces(volume, mesh, outside, has_background), 0);
  CHECK_COUNT(audit_count_bad_points(field, volume, mesh), 0);
}

/* ---- shape ---- */

/* Smallest and largest dihedral angle of a cell, degrees. */
static inline void audit_angles(const mlim_volume* volume, size_t cell, double out[2])
{
  out[0] = 180;
  out[1] = 0;
  for (int i = 0; i < 4; ++i)
  {
    for (int j = 0; j < i; ++j)
    {
      /* At the edge i, j: the angle between the parts of the other two corners across it. */
      double edge[3];
      double across[2][3];
      int n = 0;
      mlim_subtract(audit_corner(volume, cell, j), audit_corner(volume, cell, i), edge);
      for (int k = 0; k < 4; ++k)
      {
        if (k != i && k != j)
        {
          double* a = across[n++];
          mlim_subtract(audit_corner(volume, cell, k), audit_corner(volume, cell, i), a);
          const double part = mlim_dot(a, edge) / mlim_dot(edge, edge);
          for (int x = 0; x < 3; ++x)
          {
            a[x] -= part * edge[x];
          }
        }
      }
      const double cosine = mlim_dot(across[0], across[1]) /
                            sqrt(mlim_dot(across[0], across[0]) * mlim_dot(across[1], across[1]));
      const double angle = acos(fmax(-1, fmin(1, cosine))) * 180 / 3.141592653589793;
      out[0] = fmin(out[0], angle);
      out[1] = fmax(out[1], angle);
    }
  }
}

/* Circumradius and shortest edge, from the equations of the circumcentre. */
static inline void audit_radius(
  const mlim_volume* volume, size_t cell, double* radius, double* shortest)
{
  double e[3][3];
  double right[3];
  *shortest = INFINITY;
  for (int k = 0; k < 3; ++k)
  {
    mlim_subtract(audit_corner(volume, cell, k + 1), audit_corner(volume, cell, 0), e[k]);
    right[k] = 0.5 * mlim_dot(e[k], e[k]);
    for (int j = 0; j <= k; ++j)
    {
      *shortest = fmin(
        *shortest, mlim_distance(audit_corner(volume, cell, k + 1), audit_corner(volume, cell, j)));
    }
  }
  /* Cramer's rule. */
  const double determinant = audit_determinant(volume, cell);
  double center[3];
  for (int k = 0; k < 3; ++k)
  {
    double m[3][3];
    for (int row = 0; row < 3; ++row)
    {
      mlim_copy(e[row], m[row]);
      m[row][k] = right[row];
    }
    double cross[3];
    mlim_cross(m[1], m[2], cross);
    center[k] = mlim_dot(m[0], cross) / determinant;
  }
  *radius = sqrt(mlim_dot(center, center));
}

#endif
