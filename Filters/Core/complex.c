#include "complex.h"

#include "faces.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <string.h>

enum
{
  MAX_CROSSINGS = 16,     /* on one dual; more of them change nothing: it is refined anyway */
  LABEL_BATCH = 64,       /* cells labelled together */
  LOOK_EVERY_CELLS = 4096 /* cells between two looks at the host: about 20 ms */
};

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
      mlim_reserve(
        &out->vertices, &out->vertex_capacity, MLIM_FAR_VERTICES, sizeof *out->vertices) ||
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
  for (int32_t v = 0; v < MLIM_FAR_VERTICES; ++v)
  {
    out->vertices[v] = (mlim_vertex){ .kind = MLIM_VERTEX_FAR, .ball = -1, .cell = MLIM_NO_CELL };
    mlim_delaunay_far_vertex(out->delaunay, v, out->vertices[v].point);
  }
  out->vertex_count = MLIM_FAR_VERTICES;
  return MLIM_OK;
}

void mlim_complex_free(mlim_complex* complex)
{
  mlim_delaunay_free(complex->delaunay);
  mlim_release(complex->distance_shares);
  mlim_release(complex->vertices);
  mlim_release(complex->facets);
  mlim_release(complex->free_facets);
  mlim_release(complex->fresh);
  mlim_release(complex->dirty);
  *complex = (mlim_complex){ 0 };
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

/* Room is there: dirty_capacity grows with vertex_capacity. */
static void mark_dirty(mlim_complex* complex, int32_t vertex)
{
  mlim_vertex* v = &complex->vertices[vertex];
  if (!v->is_dirty && v->kind != MLIM_VERTEX_FAR)
  {
    v->is_dirty = 1;
    complex->dirty[complex->dirty_count++] = vertex;
  }
}

static void mark_facet_dirty(mlim_complex* complex, int32_t cell, int index)
{
  for (int k = 1; k < 4; ++k)
  {
    mark_dirty(complex, complex->cells[cell].vertices[(index + k) & 3]);
  }
}

void mlim_complex_touch_cell(mlim_complex* complex, int32_t cell)
{
  for (int k = 0; k < 4; ++k)
  {
    mark_dirty(complex, complex->cells[cell].vertices[k]);
  }
}

/* Room for a use in every slot is there: free_capacity grows with facet_capacity. */
static void kill_record(mlim_complex* complex, int32_t record)
{
  mlim_facet* facet = &complex->facets[record];
  facet->is_alive = 0;
  ++facet->generation;
  complex->free_facets[complex->free_count++] = record;
}

static int32_t new_record(mlim_complex* complex)
{
  if (complex->free_count > 0)
  {
    return complex->free_facets[--complex->free_count];
  }
  if (complex->facet_count >= INT32_MAX - 1 ||
      mlim_reserve(&complex->facets, &complex->facet_capacity, complex->facet_count + 1,
        sizeof *complex->facets) ||
      mlim_reserve(&complex->free_facets, &complex->free_capacity, complex->facet_capacity,
        sizeof *complex->free_facets) ||
      mlim_reserve(
        &complex->fresh, &complex->fresh_capacity, complex->facet_capacity, sizeof *complex->fresh))
  {
    return 0;
  }
  complex->facets[complex->facet_count] = (mlim_facet){ 0 };
  return (int32_t)complex->facet_count++;
}

/* Index in `cell` of the vertex that its neighbour `other` does not have: their common facet. Asked
   for by the neighbours' ids it could be wrong, since the id of a dead cell may be in use again. */
static int index_apart(const mlim_cell* cell, const mlim_cell* other)
{
  for (int k = 0; k < 3; ++k)
  {
    const int32_t v = cell->vertices[k];
    if (v != other->vertices[0] && v != other->vertices[1] && v != other->vertices[2] &&
        v != other->vertices[3])
    {
      return k;
    }
  }
  return 3;
}

/* The crossing farthest from the facet: Chew's rule. All its vertices are equally far in power. */
static size_t farthest(const mlim_crossing* crossing, size_t count, const double vertex[3])
{
  size_t best = 0;
  double most = -1;
  for (size_t c = 0; c < count; ++c)
  {
    const double d = mlim_distance_squared(crossing[c].point, vertex);
    if (d > most)
    {
      most = d;
      best = c;
    }
  }
  return best;
}

/* A dual that stays where the field is uniform, as most between cells of one label do: round each end
   lies a cube of its label, and the two cover it together. */
static int is_clear(const mlim_complex* complex, int32_t a, int32_t b)
{
  const double* inverse = mlim_field_grid_of(complex->oracle.field)->inverse_spacing;
  const double* start = mlim_complex_center(complex, a);
  const double* end = mlim_complex_center(complex, b);
  double longest = 0;
  for (int k = 0; k < 3; ++k)
  {
    longest = mlim_max(longest, fabs(start[k] - end[k]) * inverse[k]);
  }
  return longest <= (double)complex->cells[a].clearance + (double)complex->cells[b].clearance;
}

static mlim_sheet sheet_of(const mlim_crossing* crossing)
{
  const int is_up = crossing->from < crossing->to;
  return (mlim_sheet){ .low = is_up ? crossing->from : crossing->to,
    .high = is_up ? crossing->to : crossing->from,
    .face = crossing->face };
}

/* Looks along the dual of a facet and records what it crosses. Returns 1 when out of memory. */
static int record_facet(mlim_complex* complex, int32_t cell, int index)
{
  mlim_cell* a = &complex->cells[cell];
  if (a->neighbors[index] == MLIM_NO_CELL)
  {
    return 0;
  }
  const int32_t other = a->neighbors[index];
  mlim_cell* b = &complex->cells[other];
  const int differs = a->label != b->label;
  if (!differs && is_clear(complex, cell, other))
  {
    return 0;
  }
  mlim_crossing crossing[MAX_CROSSINGS];
  const size_t count =
    mlim_oracle_crossings_between(&complex->oracle, mlim_complex_center(complex, cell),
      mlim_complex_center(complex, other), differs, MAX_CROSSINGS, crossing);
  if (count == 0)
  {
    return 0;
  }
  const int32_t record = new_record(complex);
  if (record == 0 || mlim_reserve(&complex->fresh, &complex->fresh_capacity,
                       complex->fresh_count + 1, sizeof *complex->fresh))
  {
    return 1;
  }
  const double* near = complex->vertices[a->vertices[(index + 1) & 3]].point;
  const mlim_crossing* far = &crossing[farthest(crossing, count, near)];
  mlim_facet* facet = &complex->facets[record];
  facet->sheet = sheet_of(far);
  mlim_copy(far->point, facet->crossing);
  facet->cell = cell;
  facet->index = (unsigned char)index;
  facet->is_alive = 1;
  facet->is_multiple = count > 1 || !differs;
  facet->is_judged = 0;
  facet->is_settled = 0;
  a->facets[index] = record;
  b->facets[index_apart(b, a)] = record;
  complex->fresh[complex->fresh_count++] = record;
  mark_facet_dirty(complex, cell, index);
  return 0;
}

/* ---- insertion ---- */

void mlim_complex_borrow_cells(mlim_complex* complex)
{
  const mlim_delaunay_cells all = mlim_delaunay_all(complex->delaunay);
  complex->cells = all.cells;
  complex->spheres = all.spheres;
  complex->cell_count = all.count;
}

void mlim_complex_take_cell(mlim_complex* complex, int32_t cell)
{
  for (int k = 0; k < 4; ++k)
  {
    complex->vertices[complex->cells[cell].vertices[k]].cell = cell;
  }
}

static void take_and_label(mlim_complex* complex, const int32_t* made, size_t made_count)
{
  mlim_field_look looks[LABEL_BATCH];
  for (size_t begin = 0; begin < made_count; begin += LABEL_BATCH)
  {
    const size_t count = made_count - begin < LABEL_BATCH ? made_count - begin : LABEL_BATCH;
    for (size_t k = 0; k < count; ++k)
    {
      looks[k].point = mlim_complex_center(complex, made[begin + k]);
    }
    mlim_field_look_at(complex->oracle.field, looks, count);
    for (size_t k = 0; k < count; ++k)
    {
      mlim_complex_take_cell(complex, made[begin + k]);
      mlim_cell* cell = &complex->cells[made[begin + k]];
      cell->label = looks[k].label;
      cell->clearance = looks[k].clearance;
    }
  }
}

static void take_and_label_all(mlim_complex* complex)
{
  int32_t alive[LABEL_BATCH];
  size_t count = 0;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    alive[count] = (int32_t)c;
    count += complex->cells[c].vertices[0] >= 0;
    if (count == LABEL_BATCH || c + 1 == complex->cell_count)
    {
      take_and_label(complex, alive, count);
      count = 0;
    }
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
        mark_facet_dirty(complex, id, k);
        kill_record(complex, record);
        continue;
      }
      complex->facets[record].cell = other;
      complex->facets[record].index =
        (unsigned char)index_apart(&complex->cells[other], &complex->cells[id]);
    }
  }
}

/* A facet between a new cell and one outside the zone: its record holds unless labels contradict. */
static int inherit_facet(mlim_complex* complex, int32_t cell, int index)
{
  mlim_cell* a = &complex->cells[cell];
  mlim_cell* b = &complex->cells[a->neighbors[index]];
  const int j = index_apart(b, a);
  const int32_t record = b->facets[j];
  const int differs = a->label != b->label;
  if (record == 0)
  {
    return differs ? record_facet(complex, cell, index) : 0;
  }
  mlim_facet* facet = &complex->facets[record];
  const int32_t low = a->label < b->label ? a->label : b->label;
  const int32_t high = a->label < b->label ? b->label : a->label;
  if (!facet->is_multiple && differs && facet->sheet.low == low && facet->sheet.high == high)
  {
    a->facets[index] = record;
    return 0;
  }
  mark_facet_dirty(complex, cell, index);
  kill_record(complex, record);
  b->facets[j] = 0;
  return facet->is_multiple || differs ? record_facet(complex, cell, index) : 0;
}

static int update_cells(mlim_complex* complex, const mlim_delaunay_zone* made, int32_t vertex)
{
  int failed = 0;
  for (size_t k = 0; k < made->count && !failed; ++k)
  {
    const int32_t id = made->cells[k];
    for (int i = 0; i < 4; ++i)
    {
      if (complex->cells[id].vertices[i] == vertex &&
          complex->cells[id].neighbors[i] != MLIM_NO_CELL)
      {
        failed |= inherit_facet(complex, id, i);
      }
    }
  }
  for (size_t k = 0; k < made->count && !failed; ++k)
  {
    const int32_t id = made->cells[k];
    for (int i = 0; i < 4; ++i)
    {
      if (complex->cells[id].vertices[i] != vertex && id < complex->cells[id].neighbors[i])
      {
        failed |= record_facet(complex, id, i);
      }
    }
  }
  return failed;
}

mlim_status mlim_complex_commit(mlim_complex* complex, mlim_context* context)
{
  const int is_recorded = complex->cell_count > 0;
  complex->fresh_count = 0;
  if (complex->vertex_count >= complex->vertex_limit)
  {
    return mlim_fail(context, MLIM_VERTEX_LIMIT,
      "The mesh has %zu vertices, the limit; what is still bad is counted.",
      complex->vertex_limit - MLIM_FAR_VERTICES);
  }
  if (mlim_reserve(&complex->vertices, &complex->vertex_capacity, complex->vertex_count + 1,
        sizeof *complex->vertices) ||
      mlim_reserve(&complex->dirty, &complex->dirty_capacity, complex->vertex_capacity,
        sizeof *complex->dirty))
  {
    return mlim_fail_memory(context, "the triangulation");
  }
  if (is_recorded)
  {
    empty_zone(complex);
  }
  const int32_t vertex = (int32_t)complex->vertex_count++;
  complex->vertices[vertex] = complex->pending;
  complex->vertices[vertex].is_dirty = 0;
  complex->vertices[vertex].is_broken = 0;
  mlim_delaunay_zone made;
  const mlim_status status =
    mlim_delaunay_fill(complex->delaunay, context, is_recorded ? &made : NULL);
  if (status != MLIM_OK || !is_recorded)
  {
    return status;
  }
  mlim_complex_borrow_cells(complex);
  take_and_label(complex, made.cells, made.count);
  if (update_cells(complex, &made, vertex))
  {
    return mlim_fail_memory(context, "the restricted facets");
  }
  return MLIM_OK;
}

mlim_status mlim_complex_record_all(mlim_complex* complex, double done, mlim_context* context)
{
  mlim_complex_borrow_cells(complex);
  take_and_label_all(complex);
  complex->fresh_count = 0;
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    mark_dirty(complex, (int32_t)v); /* a ball without any facet fails too */
  }
  const int32_t count = (int32_t)complex->cell_count;
  for (int32_t id = 0; id < count; ++id)
  {
    for (int i = 0; i < 4 && complex->cells[id].vertices[0] >= 0; ++i)
    {
      if (id < complex->cells[id].neighbors[i] && record_facet(complex, id, i))
      {
        return mlim_fail_memory(context, "the restricted facets");
      }
    }
    const mlim_status status =
      id % LOOK_EVERY_CELLS == 0 ? mlim_progress(context, MLIM_STAGE_SURFACE, done) : MLIM_OK;
    if (status != MLIM_OK)
    {
      return status;
    }
  }
  return MLIM_OK;
}
