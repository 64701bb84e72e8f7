#include "complex.h"

#include "faces.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <string.h>

mlim_status mlim_complex_create(
  const mlim_oracle* oracle, const mlim_balls* balls, mlim_context* context, mlim_complex* out)
{
  *out = (mlim_complex){ .oracle = *oracle, .balls = balls, .vertex_limit = SIZE_MAX };
  mlim_status status =
    mlim_delaunay_create(mlim_field_grid_of(oracle->field)->size, context, &out->delaunay);
  if (status != MLIM_OK)
  {
    return status;
  }
  const size_t labels = (size_t)mlim_field_label_count(oracle->field);
  out->distance_shares = mlim_allocate(labels, sizeof *out->distance_shares);
  if (out->distance_shares == NULL ||
      mlim_reserve(&out->facets, &out->facet_capacity, 1, sizeof *out->facets))
  {
    mlim_complex_free(out);
    return mlim_fail_memory(context, "the triangulation");
  }
  for (size_t l = 0; l < labels; ++l)
  {
    out->distance_shares[l] = 1;
  }
  out->facets[0] = (mlim_facet){ 0 };
  out->facet_count = 1;
  out->vertices = mlim_delaunay_vertices(out->delaunay);
  for (int32_t v = 0; v < MLIM_FAR_VERTICES; ++v)
  {
    out->vertices[v].kind = MLIM_VERTEX_FAR;
    out->vertices[v].ball = -1;
    out->vertices[v].cell = MLIM_NO_CELL;
  }
  out->vertex_count = MLIM_FAR_VERTICES;
  return MLIM_OK;
}

void mlim_complex_free(mlim_complex* complex)
{
  mlim_delaunay_free(complex->delaunay);
  mlim_release(complex->distance_shares);
  mlim_complex_free_records(complex);
  *complex = (mlim_complex){ 0 };
}

void mlim_complex_free_records(mlim_complex* complex)
{
  mlim_release(complex->facets);
  mlim_release(complex->free_facets);
  mlim_release(complex->fresh);
  mlim_release(complex->made);
  mlim_release(complex->dirty);
  complex->facets = NULL;
  complex->free_facets = complex->fresh = complex->made = complex->dirty = NULL;
  complex->facet_count = complex->free_count = complex->fresh_count = 0;
  complex->facet_capacity = complex->free_capacity = complex->fresh_capacity = 0;
  complex->made_count = complex->dirty_count = 0;
  complex->made_capacity = complex->dirty_capacity = 0;
}

size_t mlim_complex_count_broken(const mlim_complex* complex)
{
  size_t count = 0;
  for (size_t v = MLIM_FAR_VERTICES; v < complex->vertex_count; ++v)
  {
    count += complex->vertices[v].is_broken;
  }
  return count;
}

void mlim_complex_facet_vertices(
  const mlim_complex* complex, int32_t cell, int index, int32_t out[3])
{
  const int32_t* v = complex->cells[cell].vertices;
  const int is_odd = index & 1;
  out[0] = v[(index + 1) & 3];
  out[1] = v[(index + (is_odd ? 3 : 2)) & 3];
  out[2] = v[(index + (is_odd ? 2 : 3)) & 3];
}

int32_t mlim_complex_face(const mlim_complex* complex, int32_t cell, int index)
{
  const double* size = mlim_field_grid_of(complex->oracle.field)->size;
  const int32_t* v = complex->cells[cell].vertices;
  unsigned faces = 63;
  for (int k = 1; k < 4 && faces != 0; ++k)
  {
    faces &= mlim_faces_at(size, complex->vertices[v[(index + k) & 3]].point);
  }
  return mlim_faces_first(faces);
}

static int has_code(const mlim_balls* balls, int32_t set, int32_t code)
{
  for (size_t k = balls->sets.offsets[set]; k < balls->sets.offsets[set + 1]; ++k)
  {
    if (balls->sets.labels[k] == code)
    {
      return 1;
    }
  }
  return 0;
}

int mlim_complex_is_on_sheet(
  const mlim_complex* complex, const mlim_vertex* vertex, const mlim_sheet* sheet)
{
  if (vertex->kind == MLIM_VERTEX_SURFACE)
  {
    return vertex->sheet.low == sheet->low && vertex->sheet.high == sheet->high &&
           vertex->sheet.face == sheet->face;
  }
  if (vertex->kind == MLIM_VERTEX_FAR)
  {
    return 0;
  }
  const int32_t set = complex->balls->ball_sets[vertex->ball];
  const mlim_field* field = complex->oracle.field;
  if (sheet->face < 0)
  {
    return has_code(complex->balls, set, sheet->low) && has_code(complex->balls, set, sheet->high);
  }
  /* On a cap the outside is a side of the sheet, but names the set by the face. */
  const int32_t outside = mlim_field_outside_label(field);
  const int32_t region = sheet->low == outside ? sheet->high : sheet->low;
  return has_code(complex->balls, set, region) &&
         has_code(complex->balls, set, mlim_field_label_count(field) + sheet->face);
}

/* ---- records ---- */

/* Room for all vertices is there. */
void mlim_complex_touch_vertex(mlim_complex* complex, int32_t vertex)
{
  mlim_vertex* v = &complex->vertices[vertex];
  if (!v->is_dirty && v->kind != MLIM_VERTEX_FAR)
  {
    v->is_dirty = 1;
    complex->dirty[complex->dirty_count++] = vertex;
  }
}

void mlim_complex_touch_facet(mlim_complex* complex, int32_t cell, int index)
{
  for (int k = 1; k < 4; ++k)
  {
    mlim_complex_touch_vertex(complex, complex->cells[cell].vertices[(index + k) & 3]);
  }
}

void mlim_complex_touch_cell(mlim_complex* complex, int32_t cell)
{
  for (int k = 0; k < 4; ++k)
  {
    mlim_complex_touch_vertex(complex, complex->cells[cell].vertices[k]);
  }
}

/* Room for a use in every slot is there: free_capacity grows with facet_capacity. */
void mlim_complex_kill_record(mlim_complex* complex, int32_t record)
{
  mlim_facet* facet = &complex->facets[record];
  facet->is_alive = 0;
  ++facet->generation;
  complex->free_facets[complex->free_count++] = record;
}

/* ---- insertion ---- */

void mlim_complex_borrow_cells(mlim_complex* complex)
{
  const mlim_delaunay_cells all = mlim_delaunay_all(complex->delaunay);
  complex->cells = all.cells;
  complex->spheres = all.spheres;
  complex->cell_count = all.count;
}

void mlim_complex_borrow_vertices(mlim_complex* complex, const mlim_vertex* last)
{
  complex->vertices = mlim_delaunay_vertices(complex->delaunay);
  mlim_vertex* vertex = &complex->vertices[complex->vertex_count++];
  vertex->kind = last->kind;
  vertex->ball = last->ball;
  vertex->sheet = last->sheet;
}

void mlim_complex_take_cell(mlim_complex* complex, int32_t cell)
{
  for (int k = 0; k < 4; ++k)
  {
    complex->vertices[complex->cells[cell].vertices[k]].cell = cell;
  }
}

mlim_status mlim_complex_probe(mlim_complex* complex, const mlim_vertex* vertex, int32_t start,
  mlim_delaunay_start kind, mlim_context* context, int* is_found)
{
  complex->pending = *vertex;
  const mlim_status status = mlim_delaunay_find(
    complex->delaunay, vertex->point, vertex->weight, start, kind, context, &complex->zone);
  *is_found = status == MLIM_OK && complex->zone.count > 0;
  return status;
}

double mlim_complex_power(const mlim_complex* complex)
{
  const double* point = complex->pending.point;
  double least = INFINITY;
  for (size_t c = 0; c < complex->zone.count; ++c)
  {
    const mlim_cell* cell = &complex->cells[complex->zone.cells[c]];
    for (int k = 0; k < 4; ++k)
    {
      const mlim_vertex* v = &complex->vertices[cell->vertices[k]];
      least = mlim_min(least, mlim_distance_squared(v->point, point) - v->weight);
    }
  }
  return least;
}

/* Index in a cell of the facet that it shares with a living neighbour; all ids are of living cells. */
static int index_beside(const mlim_cell* cell, int32_t neighbor)
{
  const int32_t* n = cell->neighbors;
  return (n[1] == neighbor) + 2 * (n[2] == neighbor) + 3 * (n[3] == neighbor);
}

/* Records inside the zone die; those on its surface go over to the cell outside. */
static void empty_zone(mlim_complex* complex)
{
  const uint32_t stamp = ++complex->stamp;
  for (size_t c = 0; c < complex->zone.count; ++c)
  {
    complex->cells[complex->zone.cells[c]].mark = stamp;
  }
  for (size_t c = 0; c < complex->zone.count; ++c)
  {
    const int32_t id = complex->zone.cells[c];
    for (int k = 0; k < 4; ++k)
    {
      const int32_t record = complex->cells[id].facets[k];
      if (record == 0 || !complex->facets[record].is_alive)
      {
        continue;
      }
      const int32_t other = complex->cells[id].neighbors[k];
      if (complex->cells[other].mark == stamp)
      {
        mlim_complex_touch_facet(complex, id, k);
        mlim_complex_kill_record(complex, record);
        continue;
      }
      complex->facets[record].cell = other;
      complex->facets[record].index = (unsigned)index_beside(&complex->cells[other], id) & 3;
    }
  }
}

void mlim_complex_take_new_cell(mlim_complex* complex, int32_t cell)
{
  mlim_complex_take_cell(complex, cell);
  complex->cells[cell].label = MLIM_NO_LABEL;
  complex->made[complex->made_count++] = cell;
}

mlim_status mlim_complex_expect_cells(mlim_complex* complex, size_t count, mlim_context* context)
{
  mlim_complex_borrow_cells(complex);
  return mlim_reserve_apart(&complex->made, &complex->made_capacity, complex->made_count + count,
           sizeof *complex->made)
           ? mlim_fail_memory(context, "the triangulation")
           : MLIM_OK;
}

mlim_status mlim_complex_commit(mlim_complex* complex, mlim_context* context)
{
  const int is_recorded = complex->cell_count > 0;
  if (complex->vertex_count >= complex->vertex_limit)
  {
    return mlim_fail(context, MLIM_VERTEX_LIMIT,
      "The mesh has %zu vertices, the limit; what is still bad is counted.",
      complex->vertex_limit - MLIM_FAR_VERTICES);
  }
  if (mlim_reserve_apart(&complex->dirty, &complex->dirty_capacity, complex->vertex_count + 1,
        sizeof *complex->dirty))
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  if (is_recorded)
  {
    empty_zone(complex);
  }
  mlim_delaunay_zone made;
  mlim_status status = mlim_delaunay_fill(complex->delaunay, context, is_recorded ? &made : NULL);
  if (status == MLIM_OK)
  {
    mlim_complex_borrow_vertices(complex, &complex->pending);
  }
  if (status != MLIM_OK || !is_recorded)
  {
    return status;
  }
  status = mlim_complex_expect_cells(complex, made.count, context);
  for (size_t k = 0; k < made.count && status == MLIM_OK; ++k)
  {
    mlim_complex_take_new_cell(complex, made.cells[k]);
  }
  return status;
}

mlim_status mlim_complex_reserve(mlim_complex* complex, size_t count, mlim_context* context)
{
  const mlim_status status = mlim_delaunay_reserve(complex->delaunay, count, context);
  complex->vertices = mlim_delaunay_vertices(complex->delaunay);
  return status;
}

mlim_status mlim_complex_take_all(mlim_complex* complex, mlim_context* context)
{
  mlim_complex_borrow_cells(complex);
  if (mlim_reserve_apart(
        &complex->made, &complex->made_capacity, complex->cell_count, sizeof *complex->made))
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    if (complex->cells[c].vertices[0] >= 0)
    {
      mlim_complex_take_new_cell(complex, (int32_t)c);
    }
  }
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    mlim_complex_touch_vertex(complex, (int32_t)v); /* a ball without any facet fails too */
  }
  return MLIM_OK;
}
