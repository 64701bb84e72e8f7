#include "solid.h"

#include "memory.h"
#include "status.h"
#include "vector.h"

#include <math.h>

mlim_status mlim_solid_create(size_t vertices, size_t cells, mlim_context* context, mlim_solid* out)
{
  *out = (mlim_solid){ 0 };
  out->table = mlim_allocate_zeroed(MLIM_SOLID_TABLE, sizeof *out->table);
  out->new_neighbors = mlim_allocate(MLIM_SOLID_MAX_NEW, sizeof *out->new_neighbors);
  out->outer = mlim_allocate((size_t)4 * MLIM_SOLID_MAX_NEW, sizeof *out->outer);
  if (out->table == NULL || out->new_neighbors == NULL || out->outer == NULL ||
      mlim_reserve(&out->points, &out->vertex_capacity, vertices, 3 * sizeof *out->points) ||
      mlim_reserve(&out->cells, &out->cell_capacity, cells, sizeof *out->cells))
  {
    mlim_solid_free(out);
    return mlim_fail_memory(context, "the volume's cells");
  }
  return MLIM_OK;
}

void mlim_solid_free(mlim_solid* solid)
{
  mlim_release(solid->points);
  mlim_release(solid->cells);
  mlim_release(solid->free_cells);
  mlim_release(solid->table);
  mlim_release(solid->new_neighbors);
  mlim_release(solid->outer);
  *solid = (mlim_solid){ 0 };
}

double mlim_solid_shape(const mlim_solid* solid, const int32_t vertices[4])
{
  const double* points[4];
  int has_ball = 0;
  for (int k = 0; k < 4; ++k)
  {
    const size_t v = (size_t)vertices[k];
    points[k] = solid->points + 3 * v;
    has_ball |= v < solid->fixed_count && solid->is_ball[v];
  }
  const mlim_shape_bound bound = { .sine = solid->bound.sine,
    .radius_edge_ratio = has_ball ? INFINITY : solid->bound.radius_edge_ratio };
  return mlim_shape_of(&bound, points);
}

int mlim_solid_is_open(const mlim_solid* solid, const mlim_solid_cell* cell, int index)
{
  const int32_t other = cell->neighbors[index];
  return other != MLIM_SOLID_NOTHING && solid->cells[other].label == cell->label;
}

int mlim_solid_star(mlim_solid* solid, int32_t cell, int32_t vertex, mlim_solid_change* change)
{
  const uint32_t stamp = ++solid->stamp;
  change->old_count = 0;
  change->old_cells[change->old_count++] = cell;
  solid->cells[cell].mark = stamp;
  for (size_t k = 0; k < change->old_count; ++k)
  {
    const mlim_solid_cell* c = &solid->cells[change->old_cells[k]];
    for (int i = 0; i < 4; ++i)
    {
      const int32_t other = c->neighbors[i];
      if (c->vertices[i] == vertex)
      {
        continue;
      }
      if (!mlim_solid_is_open(solid, c, i))
      {
        return 0;
      }
      if (solid->cells[other].mark == stamp)
      {
        continue;
      }
      if (change->old_count == MLIM_SOLID_MAX_OLD)
      {
        return 0;
      }
      solid->cells[other].mark = stamp;
      change->old_cells[change->old_count++] = other;
    }
  }
  return 1;
}

/* ---- exchange ---- */

int mlim_solid_is_positive(const mlim_solid* solid, const mlim_solid_change* change)
{
  for (size_t c = 0; c < change->new_count; ++c)
  {
    const double* points[4];
    for (int k = 0; k < 4; ++k)
    {
      points[k] = solid->points + 3 * (size_t)change->new_cells[c][k];
    }
    if (!mlim_shape_is_positive(points))
    {
      return 0;
    }
  }
  return 1;
}

static void sort_face(const int32_t vertices[4], int index, int32_t out[3])
{
  int32_t a = vertices[(index + 1) & 3];
  int32_t b = vertices[(index + 2) & 3];
  int32_t c = vertices[(index + 3) & 3];
  const int32_t low = a < b ? a : b;
  const int32_t high = a < b ? b : a;
  a = low < c ? low : c;
  b = low < c ? (high < c ? high : c) : low;
  c = high < c ? c : high;
  out[0] = a;
  out[1] = b;
  out[2] = c;
}

/* The face's entry in the table, or the free one where it would be. The table is never full. */
static mlim_solid_face* find_face(mlim_solid* solid, const int32_t vertices[3])
{
  uint32_t at = (uint32_t)vertices[0] * 73856093u ^ (uint32_t)vertices[1] * 19349663u ^
                (uint32_t)vertices[2] * 83492791u;
  at ^= at >> 15;
  for (;; ++at)
  {
    mlim_solid_face* face = &solid->table[at & (MLIM_SOLID_TABLE - 1)];
    if (face->stamp != solid->table_stamp ||
        (face->vertices[0] == vertices[0] && face->vertices[1] == vertices[1] &&
          face->vertices[2] == vertices[2]))
    {
      return face;
    }
  }
}

/* Pairs the faces of the new cells with each other. */
static int match_new(mlim_solid* solid, const mlim_solid_change* change)
{
  ++solid->table_stamp;
  for (size_t c = 0; c < change->new_count; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      int32_t vertices[3];
      sort_face(change->new_cells[c], k, vertices);
      mlim_solid_face* face = find_face(solid, vertices);
      solid->outer[4 * c + (size_t)k][0] = MLIM_SOLID_NOTHING;
      if (face->stamp != solid->table_stamp)
      {
        *face = (mlim_solid_face){ .vertices = { vertices[0], vertices[1], vertices[2] },
          .cell = (int32_t)c,
          .stamp = solid->table_stamp,
          .index = (unsigned char)k };
        continue;
      }
      if (face->is_matched)
      {
        return 0;
      }
      face->is_matched = 1;
      solid->new_neighbors[c][k] = -2 - face->cell;
      solid->new_neighbors[face->cell][face->index] = -2 - (int32_t)c;
    }
  }
  return 1;
}

static int index_of_neighbor(const mlim_solid_cell* cell, int32_t neighbor)
{
  for (int k = 0; k < 3; ++k)
  {
    if (cell->neighbors[k] == neighbor)
    {
      return k;
    }
  }
  return 3;
}

/* Pairs the rest with the faces round the old cells; each of the two sets has to fit the other. */
static int match_old(mlim_solid* solid, const mlim_solid_change* change)
{
  const uint32_t stamp = ++solid->stamp;
  for (size_t c = 0; c < change->old_count; ++c)
  {
    solid->cells[change->old_cells[c]].mark = stamp;
  }
  for (size_t c = 0; c < change->old_count; ++c)
  {
    const int32_t id = change->old_cells[c];
    const mlim_solid_cell* cell = &solid->cells[id];
    for (int k = 0; k < 4; ++k)
    {
      const int32_t other = cell->neighbors[k];
      if (other != MLIM_SOLID_NOTHING && solid->cells[other].mark == stamp)
      {
        continue;
      }
      int32_t vertices[3];
      sort_face(cell->vertices, k, vertices);
      mlim_solid_face* face = find_face(solid, vertices);
      if (face->stamp != solid->table_stamp || face->is_matched)
      {
        return 0;
      }
      face->is_matched = 1;
      solid->new_neighbors[face->cell][face->index] = other;
      if (other != MLIM_SOLID_NOTHING)
      {
        int32_t* outer = solid->outer[4 * (size_t)face->cell + face->index];
        outer[0] = other;
        outer[1] = index_of_neighbor(&solid->cells[other], id);
      }
    }
  }
  for (size_t c = 0; c < change->new_count; ++c)
  {
    for (int k = 0; k < 4; ++k)
    {
      int32_t vertices[3];
      sort_face(change->new_cells[c], k, vertices);
      if (!find_face(solid, vertices)->is_matched)
      {
        return 0;
      }
    }
  }
  return 1;
}

static int reserve_ids(mlim_solid* solid, const mlim_solid_change* change)
{
  return mlim_reserve(&solid->cells, &solid->cell_capacity, solid->cell_count + change->new_count,
           sizeof *solid->cells) ||
         mlim_reserve(&solid->free_cells, &solid->free_capacity,
           solid->free_count + change->old_count, sizeof *solid->free_cells);
}

static void write_new(mlim_solid* solid, mlim_solid_change* change, int32_t label)
{
  for (size_t c = 0; c < change->old_count; ++c)
  {
    solid->cells[change->old_cells[c]].vertices[0] = -1;
    solid->free_cells[solid->free_count++] = change->old_cells[c];
  }
  for (size_t c = 0; c < change->new_count; ++c)
  {
    change->new_ids[c] =
      solid->free_count > 0 ? solid->free_cells[--solid->free_count] : (int32_t)solid->cell_count++;
  }
  for (size_t c = 0; c < change->new_count; ++c)
  {
    mlim_solid_cell* cell = &solid->cells[change->new_ids[c]];
    *cell = (mlim_solid_cell){ .label = label, .shape = change->new_shapes[c] };
    for (int k = 0; k < 4; ++k)
    {
      const int32_t neighbor = solid->new_neighbors[c][k];
      const int32_t* outer = solid->outer[4 * c + (size_t)k];
      cell->vertices[k] = change->new_cells[c][k];
      cell->neighbors[k] = neighbor <= -2 ? change->new_ids[-2 - neighbor] : neighbor;
      if (outer[0] != MLIM_SOLID_NOTHING)
      {
        solid->cells[outer[0]].neighbors[outer[1]] = change->new_ids[c];
      }
    }
  }
}

int mlim_solid_exchange(mlim_solid* solid, mlim_solid_change* change, int32_t label)
{
  if (reserve_ids(solid, change))
  {
    return -1;
  }
  if (!mlim_solid_is_positive(solid, change) || !match_new(solid, change) ||
      !match_old(solid, change))
  {
    return 0;
  }
  write_new(solid, change, label);
  return 1;
}
