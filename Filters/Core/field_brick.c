#include "field_brick.h"

#include "memory.h"
#include "scalars.h"

#include <float.h>
#include <math.h>

/* Corner c of a cell among the brick's points, from its first corner on. */
static const int32_t corner_at[8] = { 0, 1, BRICK_SIDE, BRICK_SIDE + 1, BRICK_SIDE* BRICK_SIDE,
  BRICK_SIDE* BRICK_SIDE + 1, BRICK_SIDE* BRICK_SIDE + BRICK_SIDE,
  BRICK_SIDE* BRICK_SIDE + BRICK_SIDE + 1 };

static int32_t first_corner(uint32_t slot)
{
  return (int32_t)((slot & 3) + BRICK_SIDE * ((slot >> 2 & 3) + BRICK_SIDE * (slot >> 4)));
}

mlim_status mlim_field_brick_create(const mlim_field_source* source, mlim_field_brick* out)
{
  const mlim_samples* samples = source->samples;
  const size_t labels = (size_t)samples->label_count + 1;
  const size_t row = (size_t)samples->grid->dims[0];
  const int has_complement = samples->grid->background == MLIM_BACKGROUND_COMPLEMENT;
  *out = (mlim_field_brick){ .complement_of = { -1, -1 } };
  out->labels = mlim_allocate(labels, sizeof *out->labels);
  out->at = mlim_allocate(labels, sizeof *out->at);
  out->complement =
    has_complement ? mlim_allocate(BRICK_SIDE * BRICK_SIDE * row, sizeof *out->complement) : NULL;
  if (out->labels == NULL || out->at == NULL || (has_complement && out->complement == NULL))
  {
    mlim_field_brick_free(out);
    return MLIM_OUT_OF_MEMORY;
  }
  return MLIM_OK;
}

void mlim_field_brick_free(mlim_field_brick* brick)
{
  mlim_release(brick->labels);
  mlim_release(brick->at);
  mlim_release(brick->values);
  mlim_release(brick->complement);
  *brick = (mlim_field_brick){ 0 };
}

/* ---- one label ---- */

static size_t point_index(const mlim_field_source* source, const int32_t at[3])
{
  const int32_t* dims = source->field->grid.dims;
  return (size_t)at[0] + (size_t)dims[0] * ((size_t)at[1] + (size_t)dims[1] * (size_t)at[2]);
}

/* A complement takes all arrays, for whole rows at once. */
static void read_complement(const mlim_field_source* source, mlim_field_brick* brick)
{
  const mlim_point_box* box = &brick->box;
  const size_t nx = (size_t)source->field->grid.dims[0];
  if (brick->complement_of[0] == box->first[1] && brick->complement_of[1] == box->first[2])
  {
    return;
  }
  for (int32_t z = box->first[2]; z <= box->last[2]; ++z)
  {
    for (int32_t y = box->first[1]; y <= box->last[1]; ++y)
    {
      const size_t row = (size_t)(y - box->first[1]) + BRICK_SIDE * (size_t)(z - box->first[2]);
      mlim_samples_row(source->samples, source->samples->outside_label,
        point_index(source, (const int32_t[3]){ 0, y, z }), nx, brick->complement + row * nx);
    }
  }
  brick->complement_of[0] = box->first[1];
  brick->complement_of[1] = box->first[2];
}

static void read_row(const mlim_field_source* source, mlim_field_brick* brick, int32_t label,
  const int32_t at[3], double* out)
{
  const mlim_samples* samples = source->samples;
  const mlim_point_box* box = &brick->box;
  const size_t count = (size_t)(box->last[0] - box->first[0] + 1);
  const size_t first = point_index(source, at);
  if (label != mlim_samples_rule_label(samples))
  {
    mlim_scalars_read(&samples->grid->arrays[label - samples->first_array], first, count, out);
  }
  else if (brick->complement != NULL)
  {
    const size_t row =
      (size_t)(at[1] - box->first[1]) + BRICK_SIDE * (size_t)(at[2] - box->first[2]);
    memcpy(out, brick->complement + row * (size_t)source->field->grid.dims[0] + at[0],
      count * sizeof *out);
  }
  else
  {
    mlim_samples_row(samples, label, first, count, out);
  }
}

static size_t tied_point(const mlim_field_source* source, const mlim_field_brick* brick, int32_t n)
{
  const int32_t at[3] = { brick->box.first[0] + n % BRICK_SIDE,
    brick->box.first[1] + n / BRICK_SIDE % BRICK_SIDE,
    brick->box.first[2] + n / (BRICK_SIDE * BRICK_SIDE) };
  return point_index(source, at);
}

/* Appends the values of a label; *most receives the largest one. Not 0: out of memory. */
static int read_label(
  const mlim_field_source* source, mlim_field_brick* brick, int32_t label, double* most)
{
  if (mlim_reserve(&brick->values, &brick->capacity, brick->read_count + 1,
        BRICK_POINTS * sizeof *brick->values))
  {
    return 1;
  }
  const mlim_point_box* box = &brick->box;
  const int32_t count = box->last[0] - box->first[0] + 1;
  double* values = brick->values + brick->read_count * BRICK_POINTS;
  *most = -DBL_MAX;
  for (int32_t z = box->first[2]; z <= box->last[2]; ++z)
  {
    for (int32_t y = box->first[1]; y <= box->last[1]; ++y)
    {
      double* row = values + BRICK_SIDE * ((y - box->first[1]) + BRICK_SIDE * (z - box->first[2]));
      read_row(source, brick, label, (const int32_t[3]){ box->first[0], y, z }, row);
      for (int32_t x = 0; x < count; ++x)
      {
        *most = row[x] > *most ? row[x] : *most;
      }
    }
  }
  for (int32_t n = 0; n < brick->tied_count; ++n)
  {
    const int32_t p = brick->tied[n];
    values[p] += mlim_plateau_bonus(source->plateau, tied_point(source, brick, p), label);
  }
  ++brick->read_count;
  return 0;
}

/* ---- the rivals ---- */

/* Labels of the brick's grid points, and the places where they tie. */
static void read_winners(
  const mlim_field_source* source, mlim_field_brick* brick, uint16_t winners[BRICK_POINTS])
{
  const mlim_point_box* box = &brick->box;
  brick->tied_count = 0;
  for (int32_t z = box->first[2]; z <= box->last[2]; ++z)
  {
    for (int32_t y = box->first[1]; y <= box->last[1]; ++y)
    {
      const uint16_t* row =
        source->field->winners + point_index(source, (const int32_t[3]){ box->first[0], y, z });
      const int32_t to = BRICK_SIDE * ((y - box->first[1]) + BRICK_SIDE * (z - box->first[2]));
      for (int32_t x = 0; x <= box->last[0] - box->first[0]; ++x)
      {
        winners[to + x] = (uint16_t)(row[x] & ~MLIM_TIED_FLAG);
        if (source->plateau->count > 0 && (row[x] & MLIM_TIED_FLAG))
        {
          brick->tied[brick->tied_count++] = to + x;
        }
      }
    }
  }
}

/* The labels of the mixed cells' corners, in the order in which they are met. */
typedef struct rival_list
{
  size_t count;
  uint16_t labels[BRICK_POINTS];
} rival_list;

/* Where among the list; appends the label if it is not there. */
static size_t rival_of(rival_list* list, uint16_t label)
{
  size_t n = 0;
  while (n < list->count && list->labels[n] != label)
  {
    ++n;
  }
  if (n == list->count)
  {
    list->labels[list->count++] = label;
  }
  return n;
}

/* The largest value that some corner's winner has everywhere in the cell: a label that stays below it
   cannot be a candidate there. */
static double cell_floor(
  const mlim_field_brick* brick, const uint8_t rival[BRICK_POINTS], int32_t first)
{
  double out = -DBL_MAX;
  for (int c = 0; c < 8; ++c)
  {
    const uint8_t r = rival[first + corner_at[c]];
    if (c > 0 && r == rival[first + corner_at[c - 1]])
    {
      continue;
    }
    const double* values = brick->values + (size_t)r * BRICK_POINTS + first;
    double least = values[0];
    for (int k = 1; k < 8; ++k)
    {
      const double value = values[corner_at[k]];
      least = value < least ? value : least;
    }
    out = least > out ? least : out;
  }
  return out;
}

/* Reads the rivals' values; *least receives the least floor of the mixed cells. */
static int read_rivals(const mlim_field_source* source, uint64_t mixed, rival_list* list,
  mlim_field_brick* brick, double* least)
{
  uint16_t winners[BRICK_POINTS];
  uint8_t rival[BRICK_POINTS];
  read_winners(source, brick, winners);
  list->count = 0;
  for (uint32_t slot = 0; slot < BRICK_CELLS; ++slot)
  {
    for (int c = 0; c < 8 && (mixed >> slot & 1); ++c)
    {
      const int32_t p = first_corner(slot) + corner_at[c];
      rival[p] = (uint8_t)rival_of(list, winners[p]);
    }
  }
  for (size_t r = 0; r < list->count; ++r)
  {
    double most;
    if (read_label(source, brick, list->labels[r], &most))
    {
      return 1;
    }
  }
  *least = DBL_MAX;
  for (uint32_t slot = 0; slot < BRICK_CELLS; ++slot)
  {
    if (mixed >> slot & 1)
    {
      const double floor = cell_floor(brick, rival, first_corner(slot));
      *least = floor < *least ? floor : *least;
    }
  }
  return 0;
}

/* ---- a brick ---- */

int mlim_field_brick_read(
  const mlim_field_source* source, const int32_t at[3], uint64_t mixed, mlim_field_brick* brick)
{
  for (int k = 0; k < 3; ++k)
  {
    const int32_t last = BRICK * (at[k] + 1);
    const int32_t end = source->field->grid.cells[k];
    brick->box.first[k] = BRICK * at[k];
    brick->box.last[k] = last < end ? last : end;
  }
  brick->read_count = 0;
  if (brick->complement != NULL)
  {
    read_complement(source, brick);
  }
  rival_list list;
  double floor;
  if (read_rivals(source, mixed, &list, brick, &floor))
  {
    return 1;
  }
  const size_t found = mlim_peaks_list(source->peaks, &brick->box, floor, brick->labels);
  brick->count = 0;
  for (size_t n = 0; n < found; ++n)
  {
    const uint16_t label = brick->labels[n];
    size_t slot = 0;
    while (slot < list.count && list.labels[slot] != label)
    {
      ++slot;
    }
    if (slot == list.count)
    {
      double most;
      slot = brick->read_count;
      if (read_label(source, brick, label, &most))
      {
        return 1;
      }
      if (most < floor)
      {
        --brick->read_count;
        continue;
      }
    }
    brick->labels[brick->count] = label;
    brick->at[brick->count] = slot * BRICK_POINTS;
    ++brick->count;
  }
  return 0;
}

int32_t mlim_field_brick_find(const mlim_field_brick* brick, int32_t label)
{
  for (size_t n = 0; n < brick->count; ++n)
  {
    if (brick->labels[n] == label)
    {
      return (int32_t)n;
    }
  }
  return -1;
}

void mlim_field_brick_corners(const mlim_field_brick* brick, size_t n, uint32_t slot, double out[8])
{
  const double* values = brick->values + brick->at[n] + first_corner(slot);
  for (int c = 0; c < 8; ++c)
  {
    out[c] = values[corner_at[c]];
  }
}
