#include "volume.h"

#include "box.h"
#include "cells.h"
#include "faces.h"
#include "memory.h"
#include "slivers.h"
#include "status.h"
#include "vector.h"

#include <math.h>
#include <string.h>

enum
{
  LOOK_EVERY = 1 << 17 /* cells read between two looks at the host: about 30 ms */
};

/* Shares of the stage. */
static const double REFINED = 0.5;
static const double MENDED = 0.95;

/* Cells are bettered until their dihedral angles are from 15 to 165 degrees: more than the 10 that
   are reached nearly everywhere, since some neighbours then suffer a little. */
static const double GOOD_SINE = 0.25881904510252074;

typedef struct maker
{
  const mlim_volume_input* input;
  mlim_context* context;
  mlim_solid solid;
  int32_t* vertices;      /* of the solid, for each of the complex; -1 */
  int32_t* ids;           /* of the solid's cell, for each of the complex's; -1 */
  unsigned char* is_ball; /* per fixed vertex */
  mlim_volume* out;
} maker;

static void take_vertex(maker* m, int32_t vertex)
{
  if (m->vertices[vertex] < 0)
  {
    mlim_copy(
      m->input->complex->vertices[vertex].point, m->solid.points + 3 * m->solid.vertex_count);
    m->vertices[vertex] = (int32_t)m->solid.vertex_count++;
  }
}

/* The surface's vertices come first, in the order of the mesh, then those on the box: both stay. */
static void take_vertices(maker* m)
{
  const mlim_complex* complex = m->input->complex;
  const mlim_mesh* mesh = m->input->mesh;
  const double* size = mlim_field_grid_of(complex->oracle.field)->size;
  mlim_solid* solid = &m->solid;
  memcpy(solid->points, mesh->vertices, 3 * mesh->vertex_count * sizeof *mesh->vertices);
  solid->vertex_count = mesh->vertex_count;
  for (int is_inside = 0; is_inside < 2; ++is_inside)
  {
    for (size_t c = 0; c < complex->cell_count; ++c)
    {
      for (int k = 0; k < 4 && m->ids[c] >= 0; ++k)
      {
        const int32_t v = complex->cells[c].vertices[k];
        if (is_inside || mlim_faces_at(size, complex->vertices[v].point) != 0)
        {
          take_vertex(m, v);
        }
      }
    }
    solid->fixed_count = is_inside ? solid->fixed_count : solid->vertex_count;
  }
}

/* Looks at the host every now and then. */
static mlim_status look(maker* m, size_t cell, double fraction)
{
  return cell % LOOK_EVERY == 0 ? mlim_progress(m->context, MLIM_STAGE_VOLUME, fraction) : MLIM_OK;
}

static mlim_status take_cells(maker* m)
{
  mlim_status status = MLIM_OK;
  const mlim_complex* complex = m->input->complex;
  for (size_t c = 0; c < complex->cell_count && status == MLIM_OK; ++c)
  {
    status = look(m, c, REFINED);
    if (m->ids[c] < 0)
    {
      continue;
    }
    const mlim_cell* from = &complex->cells[c];
    mlim_solid_cell* cell = &m->solid.cells[m->ids[c]];
    *cell = (mlim_solid_cell){ .label = from->label };
    for (int k = 0; k < 4; ++k)
    {
      const int32_t other = from->neighbors[k];
      cell->vertices[k] = m->vertices[from->vertices[k]];
      cell->neighbors[k] = other == MLIM_NO_CELL ? MLIM_SOLID_NOTHING : m->ids[other];
    }
  }
  return status;
}

static void find_balls(maker* m)
{
  const mlim_mesh* mesh = m->input->mesh;
  for (size_t v = 0; v < m->solid.fixed_count; ++v)
  {
    m->is_ball[v] =
      v < mesh->vertex_count && mesh->node_types[v] % MLIM_NODE_ON_BOX != MLIM_NODE_INTERFACE;
  }
}

static mlim_status take_solid(maker* m)
{
  const mlim_complex* complex = m->input->complex;
  m->ids = mlim_allocate(complex->cell_count, sizeof *m->ids);
  m->vertices = mlim_allocate(complex->vertex_count, sizeof *m->vertices);
  m->is_ball = mlim_allocate(complex->vertex_count, sizeof *m->is_ball);
  if (m->ids == NULL || m->vertices == NULL || m->is_ball == NULL)
  {
    return mlim_fail_memory(m->context, "the volume's cells");
  }
  size_t count = 0;
  for (size_t c = 0; c < complex->cell_count; ++c)
  {
    const int is_inside = mlim_cells_is_inside(complex, m->input->options, &complex->cells[c]);
    m->ids[c] = is_inside ? (int32_t)count++ : -1;
  }
  for (size_t v = 0; v < complex->vertex_count; ++v)
  {
    m->vertices[v] = v < m->input->mesh_vertices_count ? m->input->mesh_vertices[v] : -1;
  }
  const mlim_status status = mlim_solid_create(complex->vertex_count, count, m->context, &m->solid);
  if (status != MLIM_OK)
  {
    return status;
  }
  m->solid.bound = (mlim_shape_bound){ .sine = GOOD_SINE,
    .radius_edge_ratio = m->input->options->cell_radius_edge_ratio };
  m->solid.cell_count = count;
  m->solid.is_ball = m->is_ball;
  take_vertices(m);
  find_balls(m);
  return take_cells(m);
}

/* ---- the product ---- */

static mlim_status allocate_volume(maker* m)
{
  const mlim_solid* solid = &m->solid;
  mlim_volume* out = m->out;
  out->vertices = mlim_allocate(3 * solid->vertex_count, sizeof *out->vertices);
  out->cells = mlim_allocate(4 * solid->cell_count, sizeof *out->cells);
  out->cell_labels = mlim_allocate(solid->cell_count, sizeof *out->cell_labels);
  out->label_count = m->input->mesh->label_count;
  out->label_volumes = mlim_allocate_zeroed(out->label_count, sizeof *out->label_volumes);
  return out->vertices != NULL && out->cells != NULL && out->cell_labels != NULL &&
             out->label_volumes != NULL
           ? MLIM_OK
           : mlim_fail_memory(m->context, "the volume");
}

static void measure_cell(maker* m, const mlim_solid_cell* cell)
{
  mlim_volume_report* report = &m->out->report;
  const double* points[4];
  int has_ball = 0;
  for (int k = 0; k < 4; ++k)
  {
    points[k] = m->solid.points + 3 * (size_t)cell->vertices[k];
    const size_t v = (size_t)cell->vertices[k];
    has_ball |= v < m->solid.fixed_count && m->is_ball[v];
  }
  const mlim_shape_figures f = mlim_shape_measure(points);
  report->min_dihedral_angle = mlim_min(report->min_dihedral_angle, f.min_angle);
  report->max_dihedral_angle = mlim_max(report->max_dihedral_angle, f.max_angle);
  m->out->label_volumes[cell->label] += f.volume;
  report->min_cell_volume = mlim_min(report->min_cell_volume, f.volume);
  if (!has_ball)
  {
    report->max_radius_edge_ratio = mlim_max(report->max_radius_edge_ratio, f.radius_edge_ratio);
    report->unresolved_ratio_count +=
      f.radius_edge_ratio > m->input->options->cell_radius_edge_ratio;
  }
}

static mlim_status read_volume(maker* m)
{
  mlim_solid* solid = &m->solid;
  mlim_volume* out = m->out;
  mlim_status status = allocate_volume(m);
  int32_t* renumbered = mlim_allocate(solid->vertex_count, sizeof *renumbered);
  if (status != MLIM_OK || renumbered == NULL)
  {
    mlim_release(renumbered);
    return status == MLIM_OK ? mlim_fail_memory(m->context, "the volume") : status;
  }
  out->surface_vertex_count = m->input->mesh->vertex_count;
  out->vertex_count = out->surface_vertex_count;
  memcpy(out->vertices, solid->points, 3 * out->vertex_count * sizeof *out->vertices);
  for (size_t v = 0; v < solid->vertex_count; ++v)
  {
    renumbered[v] = v < out->surface_vertex_count ? (int32_t)v : -1;
  }
  out->report.min_dihedral_angle = 180;
  out->report.min_cell_volume = INFINITY;
  for (size_t c = 0; c < solid->cell_count && status == MLIM_OK; ++c)
  {
    status = look(m, c, MENDED);
    const mlim_solid_cell* cell = &solid->cells[c];
    if (cell->vertices[0] < 0)
    {
      continue;
    }
    for (int k = 0; k < 4; ++k)
    {
      const int32_t v = cell->vertices[k];
      if (renumbered[v] < 0)
      {
        mlim_copy(solid->points + 3 * (size_t)v, out->vertices + 3 * out->vertex_count);
        renumbered[v] = (int32_t)out->vertex_count++;
      }
      out->cells[4 * out->cell_count + (size_t)k] = renumbered[v];
    }
    out->cell_labels[out->cell_count++] = cell->label;
    measure_cell(m, cell);
  }
  out->report.min_cell_volume = out->cell_count > 0 ? out->report.min_cell_volume : 0;
  mlim_release(renumbered);
  return status;
}

static mlim_status make(maker* m)
{
  mlim_volume_report* report = &m->out->report;
  const mlim_options* options = m->input->options;
  mlim_cells_result refined;
  const mlim_status outcome =
    mlim_cells_refine(m->input->complex, options, REFINED, m->context, &refined);
  mlim_status status = outcome == MLIM_VERTEX_LIMIT ? MLIM_OK : outcome;
  if (status == MLIM_OK)
  {
    report->insertion_count = refined.insertion_count;
    report->unresolved_size_count = refined.unresolved_size_count;
    report->unresolved_box_count = refined.unresolved_box_count;
    status = take_solid(m);
  }
  if (status == MLIM_OK && options->remove_slivers)
  {
    mlim_slivers_result mended;
    status =
      mlim_slivers_remove(&m->solid, options->vertex_limit, REFINED, MENDED, m->context, &mended);
    report->sliver_count = mended.sliver_count;
    report->added_vertex_count = mended.added_count;
    report->exchange_count = mended.exchange_count;
    report->unresolved_sliver_count = mended.left_count;
  }
  if (status == MLIM_OK)
  {
    status = read_volume(m);
  }
  if (status == MLIM_OK)
  {
    status = mlim_progress(m->context, MLIM_STAGE_VOLUME, 1);
  }
  return status == MLIM_OK ? outcome : status;
}

mlim_status mlim_volume_make(
  const mlim_volume_input* input, mlim_context* context, mlim_volume* out)
{
  *out = (mlim_volume){ 0 };
  maker m = { .input = input, .context = context, .out = out };
  const mlim_status status = make(&m);
  mlim_solid_free(&m.solid);
  mlim_release(m.vertices);
  mlim_release(m.ids);
  mlim_release(m.is_ball);
  if (status != MLIM_OK && status != MLIM_VERTEX_LIMIT)
  {
    mlim_volume_free(out);
  }
  return status;
}

void mlim_volume_free(mlim_volume* volume)
{
  mlim_release(volume->vertices);
  mlim_release(volume->cells);
  mlim_release(volume->cell_labels);
  mlim_release(volume->label_volumes);
  *volume = (mlim_volume){ 0 };
}
