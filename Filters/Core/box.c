#include "box.h"

#include "faces.h"
#include "status.h"
#include "vector.h"
#include "zone.h"

#include <math.h>

enum
{
  MAX_DIVISIONS = 1000,
  MAX_ROUNDS = 16 /* of mending; each halves what reaches out, or nearly */
};

/* A point of the lattice keeps this part of the lattice's spacing from others. */
static const double LATTICE_DISTANCE = 0.4;
/* A mending point keeps this part of it. */
static const double MENDING_DISTANCE = 1e-3;

/* How often an edge of the box is divided at least: fewer points, and far vertices would see into
   the box. */
static const double LEAST_DIVISIONS = 4;

typedef struct filler
{
  mlim_complex* complex;
  mlim_context* context;
  double spacing; /* of the lattice */
  int32_t near;   /* a cell to search from */
} filler;

/* Inserts the point if it lies in the background and keeps the distance. */
static mlim_status insert(filler* f, const double point[3], double distance, int* is_there)
{
  mlim_complex* complex = f->complex;
  const mlim_zone_demand demand = { .label = mlim_field_outside_label(complex->oracle.field),
    .least_squared = distance * distance,
    .may_have_far = 1 };
  mlim_delaunay_zone zone;
  *is_there = 0;
  mlim_status status =
    mlim_delaunay_find(complex->delaunay, point, 0, f->near, MLIM_START_NEAR, f->context, &zone);
  if (status != MLIM_OK || !mlim_zone_is_free(complex, &zone, point, &demand))
  {
    return status;
  }
  mlim_delaunay_zone made;
  status = mlim_zone_fill(complex, demand.label, f->context, &made);
  if (status == MLIM_OK)
  {
    *is_there = 1;
    f->near = made.cells[0];
  }
  return status;
}

/* ---- lattice ---- */

/* The corners first, then the edges, then the faces: `free_count` axes run between their ends. */
static mlim_status place_lattice(filler* f, const int32_t divisions[3], int free_count)
{
  const double* size = mlim_field_grid_of(f->complex->oracle.field)->size;
  mlim_status status = MLIM_OK;
  int32_t at[3];
  for (at[2] = 0; at[2] <= divisions[2] && status == MLIM_OK; ++at[2])
  {
    for (at[1] = 0; at[1] <= divisions[1] && status == MLIM_OK; ++at[1])
    {
      const int is_inner_row =
        at[2] > 0 && at[2] < divisions[2] && at[1] > 0 && at[1] < divisions[1];
      const int32_t step = is_inner_row ? divisions[0] : 1;
      for (at[0] = 0; at[0] <= divisions[0] && status == MLIM_OK; at[0] += step)
      {
        double point[3];
        int inner = 0;
        for (int k = 0; k < 3; ++k)
        {
          inner += at[k] > 0 && at[k] < divisions[k];
          point[k] = at[k] == divisions[k] ? size[k] : size[k] * at[k] / divisions[k];
        }
        int is_there;
        if (inner == free_count)
        {
          status = insert(f, point, free_count == 0 ? 0 : LATTICE_DISTANCE * f->spacing, &is_there);
        }
      }
      status = status == MLIM_OK ? mlim_progress(f->context, MLIM_STAGE_VOLUME, 0) : status;
    }
  }
  return status;
}

/* ---- mending ---- */

/* Looks whether a cell with a far vertex reaches into the box, that is, whether its other vertices
   are not all on one face. If so, `out` is a point on a face that keeps it out. */
static int reaches_in(const mlim_complex* complex, const mlim_cell* cell, double out[3])
{
  const double* size = mlim_field_grid_of(complex->oracle.field)->size;
  const double* inmost = NULL;
  unsigned common = 63;
  unsigned others = 63;
  int far_count = 0;
  for (int k = 0; k < 4; ++k)
  {
    const mlim_vertex* v = &complex->vertices[cell->vertices[k]];
    if (v->kind == MLIM_VERTEX_FAR)
    {
      ++far_count;
      continue;
    }
    const unsigned faces = mlim_faces_at(size, v->point);
    if (inmost == NULL || (common & faces) == 0)
    {
      others = faces == 0 ? 63 : common;
      inmost = v->point;
    }
    common &= faces;
  }
  if (far_count == 0 || far_count == 4 || common != 0)
  {
    return 0;
  }
  int best = -1;
  double least = INFINITY;
  for (int face = 0; face < 6; ++face)
  {
    const double distance = face & 1 ? size[face >> 1] - inmost[face >> 1] : inmost[face >> 1];
    if ((others >> face & 1) && distance < least)
    {
      least = distance;
      best = face;
    }
  }
  if (best < 0)
  {
    return 0;
  }
  mlim_copy(inmost, out);
  out[best >> 1] = best & 1 ? size[best >> 1] : 0;
  return 1;
}

static mlim_status mend(filler* f, size_t* inserted, size_t* left)
{
  mlim_complex* complex = f->complex;
  const size_t count = complex->cell_count;
  *inserted = 0;
  *left = 0;
  mlim_status status = MLIM_OK;
  for (size_t c = 0; c < count && status == MLIM_OK; ++c)
  {
    const mlim_cell* cell = &complex->cells[c];
    double point[3];
    if (cell->vertices[0] < 0 || !reaches_in(complex, cell, point))
    {
      continue;
    }
    int is_there;
    f->near = (int32_t)c;
    status = insert(f, point, MENDING_DISTANCE * f->spacing, &is_there);
    *inserted += (size_t)is_there;
    *left += !is_there;
  }
  return status;
}

mlim_status mlim_box_fill(mlim_complex* complex, double size, mlim_context* context, size_t* left)
{
  const double* box = mlim_field_grid_of(complex->oracle.field)->size;
  filler f = { .complex = complex, .context = context, .near = MLIM_NO_CELL };
  int32_t divisions[3];
  for (int k = 0; k < 3; ++k)
  {
    const double wanted = mlim_max(LEAST_DIVISIONS, ceil(box[k] / size));
    divisions[k] = (int32_t)mlim_min(wanted, MAX_DIVISIONS);
    f.spacing = k == 0 ? box[k] / divisions[k] : mlim_min(f.spacing, box[k] / divisions[k]);
  }
  *left = 0;
  mlim_status status = MLIM_OK;
  for (int axes = 0; axes < 3 && status == MLIM_OK; ++axes)
  {
    status = place_lattice(&f, divisions, axes);
  }
  size_t inserted = 1;
  for (int round = 0; round < MAX_ROUNDS && inserted > 0 && status == MLIM_OK; ++round)
  {
    status = mend(&f, &inserted, left);
    status = status == MLIM_OK ? mlim_progress(context, MLIM_STAGE_VOLUME, 0) : status;
  }
  return status;
}
