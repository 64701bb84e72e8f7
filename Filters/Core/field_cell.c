/* The candidates of a mixed cell: the labels that no single other one beats at all corners, with their
   values relative to the best. */
#include "field_cell.h"

#include "memory.h"

#include <math.h>

/* The corners' winners and their values, against which every label has to stand. */
typedef struct rivals
{
  int32_t count;
  int32_t labels[8];
  double values[8][8];
  double best[8]; /* the largest value at each corner */
} rivals;

typedef struct mixed_cell
{
  const mlim_field_source* source;
  const mlim_field_brick* brick;
  const mlim_field_place* place;
} mixed_cell;

static int has_indicators(const mlim_field_source* source)
{
  return source->samples->grid->indicators != NULL;
}

static void read_corners(const mixed_cell* cell, int32_t label, double out[8])
{
  const mlim_field_source* source = cell->source;
  const size_t first = cell->place->first;
  const size_t* corner = cell->place->corner;
  mlim_samples_corners(source->samples, label, first, out);
  for (int c = 0; c < 8 && source->plateau->count > 0; ++c)
  {
    if (source->field->winners[first + corner[c]] & MLIM_TIED_FLAG)
    {
      out[c] += mlim_plateau_bonus(source->plateau, first + corner[c], label);
    }
  }
}

static void find_rivals(const mixed_cell* cell, rivals* out)
{
  const mlim_field_place* place = cell->place;
  out->count = 0;
  for (int c = 0; c < 8; ++c)
  {
    const int32_t label =
      cell->source->field->winners[place->first + place->corner[c]] & ~MLIM_TIED_FLAG;
    int32_t r = 0;
    while (r < out->count && out->labels[r] != label)
    {
      ++r;
    }
    if (r == out->count)
    {
      out->labels[r] = label;
      if (has_indicators(cell->source))
      {
        read_corners(cell, label, out->values[r]);
      }
      else
      {
        const size_t n = (size_t)mlim_field_brick_find(cell->brick, label);
        mlim_field_brick_corners(cell->brick, n, place->slot, out->values[r]);
      }
      ++out->count;
    }
    out->best[c] = out->values[r][c];
  }
}

/* Label l stays unless one rival beats it at all corners (ties: the lower label beats). */
static int is_candidate(const rivals* rival, int32_t label, const double value[8])
{
  for (int32_t r = 0; r < rival->count; ++r)
  {
    if (rival->labels[r] == label)
    {
      continue;
    }
    const double* v = rival->values[r];
    const int wins_ties = rival->labels[r] < label;
    int c = 0;
    while (c < 8 && (v[c] > value[c] || (wins_ties && v[c] == value[c])))
    {
      ++c;
    }
    if (c == 8)
    {
      return 0;
    }
  }
  return 1;
}

/* The labels that the 27 neighbours of a grid point have. */
typedef struct sight
{
  int32_t count;
  int32_t labels[27];
} sight;

static void look_round(const mlim_field* field, const int32_t point[3], sight* out)
{
  out->count = 0;
  for (int n = 0; n < 27; ++n)
  {
    const int32_t p[3] = { point[0] + n % 3 - 1, point[1] + n / 3 % 3 - 1, point[2] + n / 9 - 1 };
    if (p[0] < 0 || p[1] < 0 || p[2] < 0 || p[0] >= field->grid.dims[0] ||
        p[1] >= field->grid.dims[1] || p[2] >= field->grid.dims[2])
    {
      continue;
    }
    const int32_t label = mlim_field_point_label(field, p) & ~MLIM_TIED_FLAG;
    int32_t k = 0;
    while (k < out->count && out->labels[k] != label)
    {
      ++k;
    }
    out->labels[k] = label;
    out->count += k == out->count;
  }
}

static double value_at(const mlim_field_source* source, int32_t label, size_t point)
{
  const double value = mlim_samples_value(source->samples, label, point);
  const int is_tied = (source->field->winners[point] & MLIM_TIED_FLAG) != 0;
  return value + (is_tied ? mlim_plateau_bonus(source->plateau, point, label) : 0);
}

/* Where a label is not seen it is at most second among those that are. The corrected value depends
   on the grid point alone, so all cells that share it agree. */
static void lower_unseen(const mixed_cell* cell, int32_t label, double value[8])
{
  const mlim_field_source* source = cell->source;
  const int32_t* dims = source->field->grid.dims;
  for (int c = 0; c < 8; ++c)
  {
    const size_t point = cell->place->first + cell->place->corner[c];
    const int32_t at[3] = { (int32_t)(point % (size_t)dims[0]),
      (int32_t)(point / (size_t)dims[0] % (size_t)dims[1]),
      (int32_t)(point / ((size_t)dims[0] * (size_t)dims[1])) };
    sight seen;
    look_round(source->field, at, &seen);
    double best = -INFINITY;
    double second = -INFINITY;
    int is_seen = 0;
    for (int32_t k = 0; k < seen.count && !is_seen; ++k)
    {
      is_seen = seen.labels[k] == label;
      const double v = value_at(source, seen.labels[k], point);
      second = v > best ? best : v > second ? v : second;
      best = v > best ? v : best;
    }
    if (!is_seen && second < value[c] && seen.count > 1)
    {
      value[c] = second;
    }
  }
}

static int is_rival(const rivals* rival, int32_t label)
{
  for (int32_t r = 0; r < rival->count; ++r)
  {
    if (rival->labels[r] == label)
    {
      return 1;
    }
  }
  return 0;
}

static uint32_t float_word(double value)
{
  const float f = (float)value;
  uint32_t word;
  memcpy(&word, &f, sizeof word);
  return word;
}

/* The labels that may be candidates. */
static size_t list_labels(const mixed_cell* cell, uint16_t* scratch, const uint16_t** out)
{
  if (!has_indicators(cell->source))
  {
    *out = cell->brick->labels;
    return cell->brick->count;
  }
  size_t points[8];
  for (int c = 0; c < 8; ++c)
  {
    points[c] = cell->place->first + cell->place->corner[c];
  }
  *out = scratch;
  return mlim_samples_list(cell->source->samples, points, 8, scratch);
}

uint32_t mlim_field_add_mixed(const mlim_field_source* source, const mlim_field_brick* brick,
  field_layer* layer, const mlim_field_place* place)
{
  const mlim_samples* samples = source->samples;
  const mixed_cell cell = { source, brick, place };
  rivals rival;
  find_rivals(&cell, &rival);
  const size_t start = layer->pool_count;
  const uint16_t* list;
  const size_t labels = list_labels(&cell, layer->list, &list);
  if (start + 1 + 9 * labels > DETAIL ||
      mlim_reserve(&layer->pool, &layer->pool_capacity, start + 1 + 9 * labels, sizeof(uint32_t)))
  {
    layer->has_failed = 1;
    return 0;
  }
  uint32_t* entry = layer->pool + start;
  uint32_t count = 0;
  uint32_t* names = entry + 1;
  uint32_t* values = entry + 1 + labels;
  for (size_t n = 0; n < labels; ++n)
  {
    const int32_t l = list[n];
    double value[8];
    if (has_indicators(source))
    {
      read_corners(&cell, l, value);
    }
    else
    {
      mlim_field_brick_corners(brick, n, place->slot, value);
    }
    if (!is_candidate(&rival, l, value))
    {
      continue;
    }
    if (samples->grid->unseen == MLIM_UNSEEN_DROP && !is_rival(&rival, l))
    {
      lower_unseen(&cell, l, value);
      if (!is_candidate(&rival, l, value))
      {
        continue;
      }
    }
    names[count] = (uint32_t)l;
    for (int c = 0; c < 8; ++c)
    {
      values[8 * count + (uint32_t)c] = float_word((value[c] - rival.best[c]) * samples->scale);
    }
    ++count;
  }
  if (count == 2)
  {
    uint32_t packed[PAIR_WORDS];
    packed[0] = names[0] | names[1] << 16;
    for (int c = 0; c < 8; ++c)
    {
      /* One of the two is the best and has 0, so the difference loses nothing. */
      packed[1 + c] =
        float_word((double)field_float(values[c]) - (double)field_float(values[8 + c]));
    }
    memcpy(entry, packed, sizeof packed);
    layer->pool_count = start + PAIR_WORDS;
    layer->max_candidates = layer->max_candidates < 2 ? 2 : layer->max_candidates;
    return (uint32_t)MIXED | (uint32_t)start;
  }
  entry[0] = count;
  memmove(entry + 1 + count, values, 8 * (size_t)count * sizeof *values);
  layer->pool_count = start + 1 + 9 * (size_t)count;
  layer->max_candidates = layer->max_candidates < count ? count : layer->max_candidates;
  return (uint32_t)MIXED | (uint32_t)MANY | (uint32_t)start;
}
