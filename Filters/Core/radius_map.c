#include "radius_map.h"
#include "memory.h"
#include "pieces.h"
#include "vector.h"

#include <math.h>
#include <string.h>

enum
{
  SAMPLES_A_PIECE = 4096 /* between two looks at the host: about 20 ms */
};

/* Balls on two curves at distance d may have radii of this times d: just below a half, so that they
   are disjoint. */
static const double DISTANCE_SHARE = 0.47;
/* The same for the balls of the two junctions of one curve, which need a ball between them. */
static const double CHORD_SHARE = 0.38;
static const double LENGTH_SHARE = 0.36;
/* A curve from a junction back to itself needs three balls on its way. */
static const double LOOP_SHARE = 0.14;
/* Growth of the radius per length. With centres 1.5 radii apart neighbours differ by up to 1.45
   times. Larger: fewer balls, more uneven triangles. */
static const double GRADE = 0.25;
/* Two places of one curve are near each other in earnest only if the way along the curve is this
   many times their distance: a circle's opposite points are 1.6 apart, a hairpin's many. */
static const double DETOUR = 2;
/* Of two curves that leave a junction, a place of one is compared with places of the other that are
   at least this many times as far from the junction: nearer ones are the junction ball's. */
static const double ABREAST = 0.8;
/* Length of samples, of edge_size: a sixth of a first radius. Shorter: slower; longer: limits that
   reach too far. */
static const double SAMPLE_SHARE = 0.125;

/* Smallest radius, of smallest_distance. A wedge of 4 degrees between two curves needs radii of 0.033
   times the distance from its junction, from about a spacing on: a larger floor gives such wedges
   up, a smaller one lets curves that all but touch make hundreds of tiny balls. */
static const double FLOOR_SHARE = 0.1;

enum
{
  MAX_GRADE_ROUNDS = 64 /* limits travel one curve a round, and end after a few lengths */
};

void mlim_radius_map_free(mlim_radius_map* map)
{
  mlim_release(map->offsets);
  mlim_release(map->points);
  mlim_release(map->arcs);
  mlim_release(map->limits);
  mlim_release(map->wedges);
  mlim_release(map->ends);
  mlim_release(map->junction_limits);
  mlim_release(map->is_lowered);
  mlim_release(map->is_changed);
  *map = (mlim_radius_map){ 0 };
}

static const double* curve_point(const mlim_curves* curves, size_t index)
{
  return curves->points + 3 * (size_t)curves->curve_points[index];
}

static size_t piece_count(const mlim_curves* curves, size_t index, double step)
{
  const double length = mlim_distance(curve_point(curves, index), curve_point(curves, index + 1));
  return (size_t)mlim_max(ceil(length / step), 1);
}

static mlim_status allocate_samples(mlim_radius_map* map, double step)
{
  const mlim_curves* curves = map->curves;
  map->offsets = mlim_allocate(curves->curve_count + 1, sizeof(size_t));
  if (!map->offsets)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  map->offsets[0] = 0;
  for (size_t c = 0; c < curves->curve_count; ++c)
  {
    size_t count = 1;
    for (size_t i = curves->curve_offsets[c]; i + 1 < curves->curve_offsets[c + 1]; ++i)
    {
      count += piece_count(curves, i, step);
    }
    map->offsets[c + 1] = map->offsets[c] + count;
  }
  map->sample_count = map->offsets[curves->curve_count];
  map->points = mlim_allocate(map->sample_count, 3 * sizeof(double));
  map->arcs = mlim_allocate(map->sample_count, sizeof(double));
  map->limits = mlim_allocate(map->sample_count, sizeof(double));
  map->wedges = mlim_allocate(map->sample_count, sizeof(double));
  map->ends = mlim_allocate(curves->curve_count, 2 * sizeof(int32_t));
  map->junction_limits = mlim_allocate(curves->junction_count, sizeof(double));
  map->is_lowered = mlim_allocate(curves->curve_count, 1);
  map->is_changed = mlim_allocate(curves->curve_count, 1);
  return map->points && map->arcs && map->limits && map->wedges && map->ends &&
             map->junction_limits && map->is_lowered && map->is_changed
           ? MLIM_OK
           : MLIM_OUT_OF_MEMORY;
}

static void place_samples(mlim_radius_map* map, double step)
{
  const mlim_curves* curves = map->curves;
  for (size_t c = 0; c < curves->curve_count; ++c)
  {
    size_t s = map->offsets[c];
    mlim_copy(curve_point(curves, curves->curve_offsets[c]), map->points + 3 * s);
    map->arcs[s] = 0;
    for (size_t i = curves->curve_offsets[c]; i + 1 < curves->curve_offsets[c + 1]; ++i)
    {
      const double* a = curve_point(curves, i);
      const double* b = curve_point(curves, i + 1);
      const size_t count = piece_count(curves, i, step);
      for (size_t k = 1; k <= count; ++k)
      {
        ++s;
        mlim_interpolate(a, b, (double)k / (double)count, map->points + 3 * s);
        if (k == count)
        {
          mlim_copy(b, map->points + 3 * s);
        }
        map->arcs[s] =
          map->arcs[s - 1] + mlim_distance(map->points + 3 * (s - 1), map->points + 3 * s);
      }
    }
  }
  memset(map->is_lowered, 1, curves->curve_count);
  memset(map->is_changed, 1, curves->curve_count);
  for (size_t s = 0; s < map->sample_count; ++s)
  {
    map->limits[s] = map->first_radius;
    map->wedges[s] = map->first_radius;
  }
}

static mlim_status find_ends(mlim_radius_map* map)
{
  const mlim_curves* curves = map->curves;
  int32_t* junctions = mlim_allocate(curves->point_count, sizeof(int32_t));
  if (!junctions)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  memset(junctions, -1, curves->point_count * sizeof(int32_t));
  for (size_t j = 0; j < curves->junction_count; ++j)
  {
    junctions[curves->junction_points[j]] = (int32_t)j;
    map->junction_limits[j] = map->first_radius;
  }
  for (size_t c = 0; c < curves->curve_count; ++c)
  {
    map->ends[2 * c] = junctions[curves->curve_points[curves->curve_offsets[c]]];
    map->ends[2 * c + 1] = junctions[curves->curve_points[curves->curve_offsets[c + 1] - 1]];
  }
  mlim_release(junctions);
  return MLIM_OK;
}

static double curve_length(const mlim_radius_map* map, size_t curve)
{
  return map->arcs[map->offsets[curve + 1] - 1];
}

/* How two places of the network lie to each other. */
typedef enum relation
{
  UNRELATED,           /* their distance is a limit */
  ABREAST_OF_JUNCTION, /* on two curves from one junction: a wedge */
  IN_LINE              /* no limit: along one curve, or round a junction */
} relation;

/* From the two lengths to a common junction. */
static relation relate_at_junction(double arc, double other_arc)
{
  return other_arc >= ABREAST * arc ? ABREAST_OF_JUNCTION : IN_LINE;
}

static relation relate(const mlim_radius_map* map, size_t curve, double arc, size_t other,
  double other_arc, double distance)
{
  const double length = curve_length(map, curve);
  const double other_length = curve_length(map, other);
  relation found = UNRELATED;
  double shortest = HUGE_VAL;
  if (curve == other)
  {
    shortest = fabs(arc - other_arc);
    const double round = length - shortest;
    shortest = map->ends[2 * curve] < 0 ? mlim_min(shortest, round) : shortest;
    found = shortest > DETOUR * distance ? UNRELATED : IN_LINE;
  }
  for (int e = 0; e < 2; ++e)
  {
    const double from = e ? length - arc : arc;
    for (int f = 0; f < 2; ++f)
    {
      const double to = f ? other_length - other_arc : other_arc;
      const int is_common = map->ends[2 * curve + (size_t)e] >= 0 &&
                            map->ends[2 * curve + (size_t)e] == map->ends[2 * other + (size_t)f];
      if (is_common && !(curve == other && e == f) && from + to < shortest)
      {
        shortest = from + to;
        found = relate_at_junction(from, to);
      }
    }
  }
  return found;
}

static double distance_to_sample_piece(
  const mlim_radius_map* map, const double point[3], size_t sample, double* arc)
{
  const double* a = map->points + 3 * sample;
  double along[3];
  double to[3];
  double nearest[3];
  mlim_subtract(a + 3, a, along);
  mlim_subtract(point, a, to);
  const double length_squared = mlim_dot(along, along);
  const double t = length_squared > 0 ? mlim_dot(to, along) / length_squared : 0;
  const double part = mlim_min(mlim_max(t, 0), 1);
  mlim_interpolate(a, a + 3, part, nearest);
  *arc = map->arcs[sample] + part * (map->arcs[sample + 1] - map->arcs[sample]);
  return mlim_distance(point, nearest);
}

static void limit_by_piece(
  mlim_radius_map* map, const mlim_pieces* pieces, size_t curve, size_t sample, size_t piece)
{
  double arc;
  const double distance = distance_to_sample_piece(map, map->points + 3 * sample, piece, &arc);
  const double radius = mlim_max(DISTANCE_SHARE * distance, map->floor_radius);
  if (radius >= map->limits[sample])
  {
    return;
  }
  switch (relate(map, curve, map->arcs[sample], (size_t)pieces->curves[piece], arc, distance))
  {
    case UNRELATED:
      map->limits[sample] = radius;
      break;
    case ABREAST_OF_JUNCTION:
      map->wedges[sample] = mlim_min(map->wedges[sample], radius);
      break;
    case IN_LINE:
      break;
  }
}

/* A piece that starts farther away than this does not lower the limit. The last hundredth of a step is for
   rounding. */
static double reach_of(const mlim_pieces* pieces, double limit)
{
  return limit / DISTANCE_SHARE + 1.01 * pieces->step;
}

static int may_limit(
  const mlim_radius_map* map, const mlim_pieces* pieces, size_t sample, const double start[3])
{
  const double far = reach_of(pieces, map->limits[sample]);
  return mlim_distance_squared(start, map->points + 3 * sample) < far * far;
}

static void limit_by_list(mlim_radius_map* map, const mlim_pieces* pieces, size_t curve,
  size_t sample, const mlim_piece_list* list)
{
  for (size_t k = 0; k < list->count; ++k)
  {
    if (may_limit(map, pieces, sample, list->starts[k]))
    {
      limit_by_piece(map, pieces, curve, sample, (size_t)list->pieces[k]);
    }
  }
}

static void limit_by_search(mlim_radius_map* map, const mlim_pieces* pieces, size_t curve,
  size_t sample, const mlim_piece_level* level)
{
  const double* point = map->points + 3 * sample;
  mlim_point_walk walk;
  for (int32_t s = mlim_point_grid_first(&level->grid, point, level->reach, &walk); s >= 0;
       s = mlim_point_grid_next(&level->grid, &walk))
  {
    if (may_limit(map, pieces, sample, map->points + 3 * (size_t)s))
    {
      limit_by_piece(map, pieces, curve, sample, (size_t)s);
    }
  }
}

/* Farther and farther away, as long as something there could lower the limit. */
static void limit_sample(mlim_radius_map* map, const mlim_pieces* pieces, size_t curve,
  size_t sample, mlim_piece_list* list)
{
  if (mlim_pieces_list(pieces, map->points + 3 * sample, list))
  {
    limit_by_list(map, pieces, curve, sample, list);
  }
  else
  {
    limit_by_search(map, pieces, curve, sample, &pieces->levels[0]);
  }
  for (size_t l = 1; l < pieces->level_count &&
                     reach_of(pieces, map->limits[sample]) > pieces->levels[l - 1].reach;
       ++l)
  {
    limit_by_search(map, pieces, curve, sample, &pieces->levels[l]);
  }
}

typedef struct limit_job
{
  mlim_radius_map* map;
  const mlim_pieces* pieces;
} limit_job;

/* Each sample has limits of its own. */
static void limit_body(void* data, size_t begin, size_t end)
{
  const limit_job* job = (const limit_job*)data;
  mlim_radius_map* map = job->map;
  size_t curve = 0;
  mlim_piece_list list = { .is_listed = 0 };
  for (size_t s = begin; s < end; ++s)
  {
    while (map->offsets[curve + 1] <= s)
    {
      ++curve;
    }
    limit_sample(map, job->pieces, curve, s, &list);
  }
}

static void limit_junction_by(
  mlim_radius_map* map, const mlim_pieces* pieces, size_t junction, const mlim_piece_level* level)
{
  const double* point = map->curves->points + 3 * (size_t)map->curves->junction_points[junction];
  mlim_point_walk walk;
  for (int32_t s = mlim_point_grid_first(&level->grid, point, level->reach, &walk); s >= 0;
       s = mlim_point_grid_next(&level->grid, &walk))
  {
    const int32_t* ends = map->ends + 2 * (size_t)pieces->curves[s];
    if (ends[0] != (int32_t)junction && ends[1] != (int32_t)junction)
    {
      double arc;
      const double distance = distance_to_sample_piece(map, point, (size_t)s, &arc);
      mlim_radius_map_lower_junction(map, junction, DISTANCE_SHARE * distance);
    }
  }
}

/* Curves that do not end at the junction limit its ball. */
static void limit_junction(mlim_radius_map* map, const mlim_pieces* pieces, size_t junction)
{
  double reach = 0;
  for (size_t l = 0;
       l < pieces->level_count && reach_of(pieces, map->junction_limits[junction]) > reach; ++l)
  {
    reach = pieces->levels[l].reach;
    limit_junction_by(map, pieces, junction, &pieces->levels[l]);
  }
}

/* A curve has room for a ball between those of its junctions. */
static void limit_by_length(mlim_radius_map* map, size_t curve)
{
  const int32_t* ends = map->ends + 2 * curve;
  const double length = curve_length(map, curve);
  const double* first = map->points + 3 * map->offsets[curve];
  const double* last = map->points + 3 * (map->offsets[curve + 1] - 1);
  const double radius =
    ends[0] == ends[1] ? LOOP_SHARE * length
                       : mlim_min(LENGTH_SHARE * length, CHORD_SHARE * mlim_distance(first, last));
  for (int e = 0; e < 2 && ends[0] >= 0; ++e)
  {
    mlim_radius_map_lower_junction(map, (size_t)ends[e], radius);
  }
}

mlim_status mlim_radius_map_create(const mlim_curves* curves, const mlim_options* options,
  mlim_context* context, mlim_radius_map* out)
{
  const double step = SAMPLE_SHARE * options->edge_size;
  mlim_radius_map map = { .curves = curves,
    .first_radius = options->ball_radius_scale * options->edge_size / 1.5,
    .floor_radius = FLOOR_SHARE * options->smallest_distance };
  mlim_pieces pieces = { 0 };
  mlim_status status = allocate_samples(&map, step);
  if (!status && map.sample_count > 0)
  {
    place_samples(&map, step);
    status = find_ends(&map);
    const mlim_piece_source source = { .points = map.points,
      .offsets = map.offsets,
      .curve_count = curves->curve_count,
      .step = step,
      .reach = map.first_radius / DISTANCE_SHARE + step };
    status = status ? status : mlim_pieces_create(&source, &pieces);
  }
  if (status)
  {
    goto done;
  }
  for (size_t c = 0; c < curves->curve_count; ++c)
  {
    limit_by_length(&map, c);
  }
  status = mlim_parallel_stage(context, &(mlim_stage_work){ .count = map.sample_count,
                                          .body = limit_body,
                                          .job = &(limit_job){ .map = &map, .pieces = &pieces },
                                          .stage = MLIM_STAGE_BALLS,
                                          .step = SAMPLES_A_PIECE });
  if (status)
  {
    goto done;
  }
  for (size_t j = 0; j < curves->junction_count; ++j)
  {
    limit_junction(&map, &pieces, j);
  }
  mlim_radius_map_grade(&map);
  *out = map;
  map = (mlim_radius_map){ 0 };

done:
  mlim_pieces_free(&pieces);
  mlim_radius_map_free(&map);
  return status;
}

/* Both ways along one curve. */
static void grade_curve(const double* arcs, double* limits, size_t count)
{
  for (size_t i = 1; i < count; ++i)
  {
    limits[i] = mlim_min(limits[i], limits[i - 1] + GRADE * (arcs[i] - arcs[i - 1]));
  }
  for (size_t i = count - 1; i > 0; --i)
  {
    limits[i - 1] = mlim_min(limits[i - 1], limits[i] + GRADE * (arcs[i] - arcs[i - 1]));
  }
}

/* Makes the values at two ends the smaller one. Returns whether the first had to fall. */
static int equalise(double* value, double* end)
{
  const int falls = *end < *value;
  *value = mlim_min(*value, *end);
  *end = *value;
  return falls;
}

/* Grades one curve and the limits of its junctions. Returns whether one of these had to fall. */
static int grade_with_ends(mlim_radius_map* map, size_t curve)
{
  const size_t first = map->offsets[curve];
  const size_t last = map->offsets[curve + 1] - 1;
  const int32_t* ends = map->ends + 2 * curve;
  double closed_limit = map->limits[first];
  double* values[2] = { ends[0] >= 0 ? map->junction_limits + ends[0] : &closed_limit,
    ends[0] >= 0 ? map->junction_limits + ends[1] : &closed_limit };
  map->limits[first] = mlim_min(map->limits[first], *values[0]);
  map->limits[last] = mlim_min(map->limits[last], *values[1]);
  grade_curve(map->arcs + first, map->limits + first, last - first + 1);
  const double graded = map->limits[last];
  int has_changed = equalise(values[0], map->limits + first);
  has_changed |= equalise(values[1], map->limits + last);
  grade_curve(map->arcs + first, map->wedges + first, last - first + 1);
  map->is_lowered[curve] = map->limits[last] < graded; /* both ends are one place */
  map->is_changed[curve] = 1;
  return has_changed;
}

/* A graded curve stays so until its own limits fall, or that of a junction. */
static int is_graded(const mlim_radius_map* map, size_t curve)
{
  const int32_t* ends = map->ends + 2 * curve;
  return !map->is_lowered[curve] &&
         (ends[0] < 0 ||
           (map->limits[map->offsets[curve]] <= map->junction_limits[ends[0]] &&
             map->limits[map->offsets[curve + 1] - 1] <= map->junction_limits[ends[1]]));
}

void mlim_radius_map_grade(mlim_radius_map* map)
{
  int has_changed = 1;
  for (int round = 0; round < MAX_GRADE_ROUNDS && has_changed; ++round)
  {
    has_changed = 0;
    for (size_t c = 0; c < map->curves->curve_count; ++c)
    {
      has_changed |= !is_graded(map, c) && grade_with_ends(map, c);
    }
  }
}

/* Whether a sample is the one at or before a length, by the test that find_sample ends with. */
static int is_at(const mlim_radius_map* map, size_t curve, size_t sample, double arc)
{
  const size_t first = map->offsets[curve];
  const size_t last = map->offsets[curve + 1] - 1;
  return sample >= first && sample < last && (sample == first || map->arcs[sample] <= arc) &&
         (sample + 1 == last || map->arcs[sample + 1] > arc);
}

/* The sample at or before a length along a curve, from the whole curve or one of two samples. */
static size_t find_sample(
  const mlim_radius_map* map, size_t curve, double arc, size_t near, double* part)
{
  size_t low = map->offsets[curve];
  size_t high = map->offsets[curve + 1] - 1;
  for (size_t s = near; s <= near + 1; ++s)
  {
    if (is_at(map, curve, s, arc))
    {
      low = s;
      high = s + 1;
      break;
    }
  }
  while (high - low > 1)
  {
    const size_t middle = low + (high - low) / 2;
    if (map->arcs[middle] <= arc)
    {
      low = middle;
    }
    else
    {
      high = middle;
    }
  }
  const double length = map->arcs[high] - map->arcs[low];
  *part = length > 0 ? mlim_min(mlim_max((arc - map->arcs[low]) / length, 0), 1) : 0;
  return low;
}

double mlim_radius_map_radius(const mlim_radius_map* map, size_t curve, double arc, size_t* near)
{
  double part;
  const size_t s = find_sample(map, curve, arc, *near, &part);
  *near = s;
  const double low = mlim_min(map->limits[s], map->wedges[s]);
  const double high = mlim_min(map->limits[s + 1], map->wedges[s + 1]);
  return mlim_max(low + part * (high - low), map->floor_radius);
}

void mlim_radius_map_point(const mlim_radius_map* map, size_t curve, double arc, double out[3])
{
  double part;
  const size_t s = find_sample(map, curve, arc, map->offsets[curve], &part);
  mlim_interpolate(map->points + 3 * s, map->points + 3 * (s + 1), part, out);
}

int mlim_radius_map_lower(
  mlim_radius_map* map, mlim_radius_limit which, size_t curve, double arc, double radius)
{
  double part;
  const size_t s = find_sample(map, curve, arc, map->offsets[curve], &part);
  double* limits = which == MLIM_LIMIT_WEDGE ? map->wedges : map->limits;
  const double limit = mlim_max(radius, map->floor_radius);
  int has_changed = 0;
  for (size_t i = s; i <= s + 1; ++i)
  {
    has_changed |= limit < limits[i];
    limits[i] = mlim_min(limits[i], limit);
  }
  map->is_lowered[curve] |= (unsigned char)has_changed;
  map->is_changed[curve] |= (unsigned char)has_changed;
  return has_changed;
}

int mlim_radius_map_lower_junction(mlim_radius_map* map, size_t junction, double radius)
{
  const double limit = mlim_max(radius, map->floor_radius);
  const int has_changed = limit < map->junction_limits[junction];
  map->junction_limits[junction] = mlim_min(map->junction_limits[junction], limit);
  return has_changed;
}
