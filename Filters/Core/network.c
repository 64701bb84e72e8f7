#include "network.h"
#include "memory.h"
#include "point_grid.h"
#include "vector.h"

#include <stdlib.h>
#include <string.h>

void mlim_network_free(mlim_network* network)
{
  mlim_release(network->points);
  mlim_release(network->point_sets);
  mlim_release(network->segments);
  mlim_set_table_free(&network->table);
  *network = (mlim_network){ 0 };
}

mlim_status mlim_network_add_point(
  mlim_network* network, const double point[3], int32_t set, int32_t* out)
{
  const size_t count = network->point_count;
  if (count >= INT32_MAX ||
      mlim_reserve(&network->points, &network->point_capacity, count + 1, 3 * sizeof(double)) ||
      mlim_reserve(&network->point_sets, &network->point_set_capacity, count + 1, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  mlim_copy(point, network->points + 3 * count);
  network->point_sets[count] = set;
  *out = (int32_t)count;
  ++network->point_count;
  return MLIM_OK;
}

mlim_status mlim_network_add_segment(mlim_network* network, int32_t a, int32_t b, int32_t set)
{
  if (mlim_reserve(&network->segments, &network->segment_capacity, network->segment_count + 1,
        sizeof(mlim_segment)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  network->segments[network->segment_count] =
    (mlim_segment){ .ends = { a < b ? a : b, a < b ? b : a }, .set = set };
  ++network->segment_count;
  return MLIM_OK;
}

mlim_status mlim_network_append(mlim_network* network, const mlim_network* other)
{
  const mlim_sets* sets = &other->table.sets;
  mlim_status status = MLIM_OK;
  const int32_t first = (int32_t)network->point_count;
  int32_t* numbers = mlim_allocate(sets->count, sizeof(*numbers));
  if (!numbers)
  {
    return MLIM_OUT_OF_MEMORY;
  }
  for (size_t s = 0; s < sets->count && !status; ++s)
  {
    size_t count;
    const int32_t* labels = mlim_set_labels(sets, (int32_t)s, &count);
    status = mlim_set_table_add(&network->table, labels, count, numbers + s);
  }
  for (size_t p = 0; p < other->point_count && !status; ++p)
  {
    int32_t number;
    status = mlim_network_add_point(
      network, other->points + 3 * p, numbers[other->point_sets[p]], &number);
  }
  for (size_t s = 0; s < other->segment_count && !status; ++s)
  {
    const mlim_segment* segment = other->segments + s;
    status = mlim_network_add_segment(
      network, first + segment->ends[0], first + segment->ends[1], numbers[segment->set]);
  }
  mlim_release(numbers);
  return status;
}

static int compare_segments(const void* a, const void* b)
{
  const mlim_segment* s = a;
  const mlim_segment* t = b;
  for (int k = 0; k < 2; ++k)
  {
    if (s->ends[k] != t->ends[k])
    {
      return s->ends[k] < t->ends[k] ? -1 : 1;
    }
  }
  return s->set < t->set ? -1 : s->set > t->set;
}

/* Sorts the segments and makes those with equal ends one. */
static mlim_status unite_segments(mlim_network* network)
{
  if (network->segment_count == 0)
  {
    return MLIM_OK;
  }
  qsort(network->segments, network->segment_count, sizeof(mlim_segment), compare_segments);
  size_t kept = 0;
  for (size_t s = 0; s < network->segment_count; ++s)
  {
    const mlim_segment* segment = network->segments + s;
    mlim_segment* last = kept > 0 ? network->segments + kept - 1 : NULL;
    if (last && last->ends[0] == segment->ends[0] && last->ends[1] == segment->ends[1])
    {
      const mlim_status status =
        mlim_set_table_join(&network->table, last->set, segment->set, &last->set);
      if (status)
      {
        return status;
      }
    }
    else if (segment->ends[0] != segment->ends[1])
    {
      network->segments[kept] = *segment;
      ++kept;
    }
  }
  network->segment_count = kept;
  return MLIM_OK;
}

/* Points are walked in order, and each takes the number of the first earlier kept point that is
   near, so chains of near points do not run away. */
mlim_status mlim_network_weld(mlim_network* network, double distance)
{
  mlim_point_grid grid = { 0 };
  mlim_status status = MLIM_OUT_OF_MEMORY;
  int32_t* numbers = mlim_allocate(network->point_count, sizeof(*numbers));
  if (!numbers || mlim_point_grid_create(4 * distance, network->point_count, &grid))
  {
    goto done;
  }
  size_t kept = 0;
  for (size_t p = 0; p < network->point_count; ++p)
  {
    const double* point = network->points + 3 * p;
    int32_t found = -1;
    mlim_point_walk walk;
    for (int32_t q = mlim_point_grid_first(&grid, point, distance, &walk); q >= 0;
         q = mlim_point_grid_next(&grid, &walk))
    {
      if (mlim_distance_squared(point, network->points + 3 * (size_t)q) <= distance * distance)
      {
        found = found < 0 || q < found ? q : found;
      }
    }
    if (found < 0)
    {
      found = (int32_t)kept;
      memmove(network->points + 3 * kept, point, 3 * sizeof(double));
      network->point_sets[kept] = network->point_sets[p];
      mlim_point_grid_add(&grid, network->points + 3 * kept, found);
      ++kept;
    }
    else
    {
      int32_t* set = network->point_sets + found;
      status = mlim_set_table_join(&network->table, *set, network->point_sets[p], set);
      if (status)
      {
        goto done;
      }
    }
    numbers[p] = found;
  }
  network->point_count = kept;
  for (size_t s = 0; s < network->segment_count; ++s)
  {
    mlim_segment* segment = network->segments + s;
    const int32_t a = numbers[segment->ends[0]];
    const int32_t b = numbers[segment->ends[1]];
    segment->ends[0] = a < b ? a : b;
    segment->ends[1] = a < b ? b : a;
  }
  status = unite_segments(network);

done:
  mlim_point_grid_free(&grid);
  mlim_release(numbers);
  return status;
}
