#include "field.h"

#include "field_index.h"
#include "memory.h"
#include "vector.h"

#include <math.h>

void mlim_field_free(mlim_field* field)
{
  if (field == NULL)
  {
    return;
  }
  for (size_t z = 0; field->layers != NULL && z < field->layer_count; ++z)
  {
    mlim_release(field->layers[z].words);
    mlim_release(field->layers[z].pool);
  }
  mlim_release(field->layers);
  mlim_release(field->coarse);
  mlim_release(field->clearances);
  mlim_release(field->winners);
  mlim_release(field->ids);
  mlim_release(field);
}

int32_t mlim_field_label_count(const mlim_field* field)
{
  return field->label_count;
}

int32_t mlim_field_label_id(const mlim_field* field, int32_t label)
{
  return label >= 0 && label < field->label_count ? field->ids[label] : 0;
}

int32_t mlim_field_outside_label(const mlim_field* field)
{
  return field->outside_label;
}

const mlim_field_grid* mlim_field_grid_of(const mlim_field* field)
{
  return &field->grid;
}

size_t mlim_field_max_candidates(const mlim_field* field)
{
  return field->max_candidates < 2 ? 2 : field->max_candidates;
}

const uint16_t* mlim_field_point_labels(const mlim_field* field)
{
  return field->winners;
}

int32_t mlim_field_point_label(const mlim_field* field, const int32_t point[3])
{
  return field->winners[(size_t)point[0] +
                        (size_t)field->grid.dims[0] *
                          ((size_t)point[1] + (size_t)field->grid.dims[1] * (size_t)point[2])];
}

mlim_candidates mlim_field_cell(
  const mlim_field* field, const int32_t cell[3], const mlim_cell_buffer* buffer)
{
  const uint32_t word = field_cell_word(field, cell);
  mlim_candidates out = { .count = 1, .labels = buffer->labels, .values = NULL };
  if (!(word & (uint32_t)MIXED))
  {
    buffer->labels[0] = (uint16_t)word;
    return out;
  }
  const uint32_t* entry = field_pool_entry(field, cell, word);
  out.values = buffer->values;
  if (!(word & (uint32_t)MANY))
  {
    out.count = 2;
    buffer->labels[0] = (uint16_t)(entry[0] & 0xffffu);
    buffer->labels[1] = (uint16_t)(entry[0] >> 16);
    for (int c = 0; c < 8; ++c)
    {
      const float difference = field_float(entry[1 + c]);
      buffer->values[c] = difference < 0 ? difference : 0;
      buffer->values[8 + c] = difference > 0 ? -difference : 0;
    }
    return out;
  }
  out.count = (int32_t)entry[0];
  for (int32_t n = 0; n < out.count; ++n)
  {
    buffer->labels[n] = (uint16_t)entry[1 + n];
  }
  memcpy(buffer->values, entry + 1 + out.count, 8 * (size_t)out.count * sizeof(float));
  return out;
}

int32_t mlim_field_find_many(const mlim_field* field, const int32_t from[3])
{
  const uint32_t many = (uint32_t)MIXED | (uint32_t)MANY;
  const int32_t count = field->grid.cells[0];
  int32_t cell[3] = { from[0], from[1], from[2] };
  while (cell[0] < count)
  {
    const uint32_t brick = field->coarse[field_brick_of(field, cell)];
    const int32_t end = (cell[0] / BRICK + 1) * BRICK;
    if (!(brick & (uint32_t)MIXED))
    {
      cell[0] = end;
      continue;
    }
    const uint32_t* word =
      field->layers[cell[2] / BRICK].words + (brick & DETAIL) * BRICK_CELLS + field_slot_of(cell);
    for (; cell[0] < end && cell[0] < count; ++cell[0], ++word)
    {
      if ((*word & many) == many)
      {
        return cell[0];
      }
    }
  }
  return count;
}

/* Trilinear interpolation of corner values, in double. */
static double trilinear(const uint32_t* values, const double at[3])
{
  double edge[4];
  for (int e = 0; e < 4; ++e)
  {
    const double low = (double)field_float(values[2 * e]);
    edge[e] = low + at[0] * ((double)field_float(values[2 * e + 1]) - low);
  }
  const double low = edge[0] + at[1] * (edge[1] - edge[0]);
  const double high = edge[2] + at[1] * (edge[3] - edge[2]);
  return low + at[2] * (high - low);
}

int32_t field_mixed_label(const uint32_t* entry, uint32_t word, const double at[3])
{
  if (!(word & (uint32_t)MANY))
  {
    return trilinear(entry + 1, at) >= 0 ? (int32_t)(entry[0] & 0xffffu)
                                         : (int32_t)(entry[0] >> 16);
  }
  const uint32_t count = entry[0];
  double best = trilinear(entry + 1 + count, at);
  uint32_t winner = 0;
  for (uint32_t n = 1; n < count; ++n)
  {
    const double value = trilinear(entry + 1 + count + 8 * (size_t)n, at);
    if (value > best)
    {
      best = value;
      winner = n;
    }
  }
  return (int32_t)entry[1 + winner];
}

/* How far a point is outside the box, in cells along the axis where it is farthest; finite also for a
   point that is not. */
static double cells_outside(const mlim_field* field, const double point[3])
{
  double most = 0;
  for (int k = 0; k < 3; ++k)
  {
    const double g = point[k] * field->grid.inverse_spacing[k];
    const double beyond = g < 0 ? -g : g - field->grid.cells[k];
    most = beyond > most ? beyond : most;
  }
  return mlim_min(most, 1e30);
}

/* The cell that holds a point, and where in it; 0 for a point outside the box. */
static int find_cell(const mlim_field* field, const double point[3], int32_t cell[3], double at[3])
{
  for (int k = 0; k < 3; ++k)
  {
    if (!(point[k] >= 0 && point[k] <= field->grid.size[k]))
    {
      return 0;
    }
    const double g = point[k] * field->grid.inverse_spacing[k];
    cell[k] = (int32_t)g;
    cell[k] = cell[k] >= field->grid.cells[k] ? field->grid.cells[k] - 1 : cell[k];
    at[k] = g - cell[k];
  }
  return 1;
}

/* Corner values of f_first - f_second in a mixed cell. 0: it does not list both. */
static int difference_of(
  const uint32_t* entry, uint32_t word, int32_t first, int32_t second, double out[8])
{
  const uint32_t* values[2] = { NULL, NULL };
  if (!(word & (uint32_t)MANY))
  {
    const int32_t pair[2] = { (int32_t)(entry[0] & 0xffffu), (int32_t)(entry[0] >> 16) };
    const double sign = first == pair[0] ? 1 : -1;
    for (int c = 0; c < 8; ++c)
    {
      out[c] = sign * (double)field_float(entry[1 + c]);
    }
    return (first == pair[0] && second == pair[1]) || (first == pair[1] && second == pair[0]);
  }
  const uint32_t count = entry[0];
  for (uint32_t n = 0; n < count; ++n)
  {
    const int32_t label = (int32_t)entry[1 + n];
    const uint32_t* own = entry + 1 + count + 8 * (size_t)n;
    values[0] = label == first ? own : values[0];
    values[1] = label == second ? own : values[1];
  }
  for (int c = 0; c < 8 && values[0] != NULL && values[1] != NULL; ++c)
  {
    out[c] = (double)field_float(values[0][c]) - (double)field_float(values[1][c]);
  }
  return values[0] != NULL && values[1] != NULL;
}

void mlim_field_ahead(const mlim_field* field, const double point[3], int is_second)
{
  int32_t cell[3];
  double at[3];
  if (!find_cell(field, point, cell, at))
  {
    return;
  }
  if (is_second)
  {
    field_entry_ahead(field, cell);
  }
  else
  {
    field_word_ahead(field, cell);
  }
}

int mlim_field_normal(
  const mlim_field* field, const double point[3], int32_t first, int32_t second, double out[3])
{
  int32_t cell[3];
  double at[3];
  double v[8];
  if (!find_cell(field, point, cell, at))
  {
    return 0;
  }
  const uint32_t word = field_cell_word(field, cell);
  if (!(word & (uint32_t)MIXED) ||
      !difference_of(field_pool_entry(field, cell, word), word, first, second, v))
  {
    return 0;
  }
  double squared = 0;
  for (int k = 0; k < 3; ++k)
  {
    const int a = (k + 1) % 3;
    const int b = (k + 2) % 3;
    out[k] = 0;
    for (int c = 0; c < 4; ++c)
    {
      const int low = (c & 1) << a | (c >> 1) << b;
      const double share = (c & 1 ? at[a] : 1 - at[a]) * (c >> 1 ? at[b] : 1 - at[b]);
      out[k] += share * (v[low | 1 << k] - v[low]) * field->grid.inverse_spacing[k];
    }
    squared += out[k] * out[k];
  }
  for (int k = 0; k < 3 && squared > 0; ++k)
  {
    out[k] /= sqrt(squared);
  }
  return squared > 0;
}

int32_t mlim_field_label(const mlim_field* field, const double point[3])
{
  int32_t cell[3];
  double at[3];
  if (!find_cell(field, point, cell, at))
  {
    return field->outside_label;
  }
  const uint32_t word = field_cell_word(field, cell);
  return word & (uint32_t)MIXED ? field_mixed_label(field_pool_entry(field, cell, word), word, at)
                                : (int32_t)word;
}

/* A point's cell, while what there is of it is on its way from memory. */
typedef struct place
{
  int32_t cell[3];
  double at[3];
  size_t brick;
  uint32_t coarse; /* of the brick */
  uint32_t word;
  const uint32_t* entry; /* of a mixed cell, or NULL */
  int is_inside;
} place;

enum
{
  BATCH = 32 /* places; an insertion makes about 25 cells */
};

static void ask_for_brick(const mlim_field* field, const double point[3], place* out)
{
  out->entry = NULL;
  out->is_inside = find_cell(field, point, out->cell, out->at);
  if (out->is_inside)
  {
    out->brick = field_brick_of(field, out->cell);
    mlim_prefetch(&field->coarse[out->brick]);
  }
}

static const uint32_t* word_of(const mlim_field* field, const place* where)
{
  return field->layers[where->cell[2] >> 2].words + BRICK_CELLS * (size_t)(where->coarse & DETAIL) +
         field_slot_of(where->cell);
}

static void ask_for_word(const mlim_field* field, place* where)
{
  if (where->is_inside)
  {
    where->coarse = field->coarse[where->brick];
    if (where->coarse & (uint32_t)MIXED)
    {
      mlim_prefetch(word_of(field, where));
    }
  }
}

static void ask_for_entry(const mlim_field* field, place* where)
{
  if (where->is_inside)
  {
    where->word = where->coarse & (uint32_t)MIXED ? *word_of(field, where) : where->coarse;
    if (where->word & (uint32_t)MIXED)
    {
      where->entry = field_pool_entry(field, where->cell, where->word);
      mlim_prefetch(where->entry);
      mlim_prefetch(where->entry + PAIR_WORDS - 1);
    }
  }
}

/* What lies behind the bricks, which have been asked for. */
static void fetch_places(const mlim_field* field, place* places, size_t count)
{
  for (size_t k = 0; k < count; ++k)
  {
    ask_for_word(field, &places[k]);
  }
  for (size_t k = 0; k < count; ++k)
  {
    ask_for_entry(field, &places[k]);
  }
}

static int32_t label_of(const mlim_field* field, const place* where)
{
  return where->entry != NULL ? field_mixed_label(where->entry, where->word, where->at)
         : where->is_inside   ? (int32_t)where->word
                              : field->outside_label;
}

void mlim_field_labels(const mlim_field* field, const double* points, size_t count, int32_t* labels)
{
  place places[BATCH];
  for (size_t begin = 0; begin < count; begin += BATCH)
  {
    const size_t some = count - begin < BATCH ? count - begin : BATCH;
    for (size_t k = 0; k < some; ++k)
    {
      ask_for_brick(field, points + 3 * (begin + k), &places[k]);
    }
    fetch_places(field, places, some);
    for (size_t k = 0; k < some; ++k)
    {
      labels[begin + k] = label_of(field, &places[k]);
    }
  }
}

static void look_at_place(const mlim_field* field, const place* where, mlim_field_look* look)
{
  /* Rounding to float must not make the cube larger. */
  const double below_one = 1 - 1e-6;
  if (!where->is_inside)
  {
    look->clearance = (float)(below_one * cells_outside(field, look->point));
    look->label = field->outside_label;
    return;
  }
  if (where->word & (uint32_t)MIXED)
  {
    look->clearance = 0;
    look->label = field_mixed_label(where->entry, where->word, where->at);
    return;
  }
  double least = 1;
  for (int k = 0; k < 3; ++k)
  {
    least = mlim_min(least, mlim_min(where->at[k], 1 - where->at[k]));
  }
  double reach =
    field->clearances[BRICK_CELLS * where->brick + field_slot_of(where->cell)] - 1 + least;
  for (int k = 0; k < 3 && where->word != (uint32_t)field->outside_label; ++k)
  {
    const double in = where->cell[k] + where->at[k];
    reach = mlim_min(reach, mlim_min(in, field->grid.cells[k] - in));
  }
  look->clearance = (float)(below_one * reach);
  look->label = (int32_t)where->word;
}

void mlim_field_look_at(const mlim_field* field, mlim_field_look* looks, size_t count)
{
  place places[BATCH];
  for (size_t begin = 0; begin < count; begin += BATCH)
  {
    const size_t some = count - begin < BATCH ? count - begin : BATCH;
    for (size_t k = 0; k < some; ++k)
    {
      ask_for_brick(field, looks[begin + k].point, &places[k]);
      if (places[k].is_inside)
      {
        mlim_prefetch(&field->clearances[BRICK_CELLS * places[k].brick]);
      }
    }
    fetch_places(field, places, some);
    for (size_t k = 0; k < some; ++k)
    {
      look_at_place(field, &places[k], &looks[begin + k]);
    }
  }
}
