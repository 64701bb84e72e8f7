#include "ball_list.h"

#include "memory.h"
#include "vector.h"

void mlim_ball_list_free(mlim_ball_list* list)
{
  mlim_balls_free(&list->balls);
  *list = (mlim_ball_list){ 0 };
}

mlim_status mlim_ball_list_add(
  mlim_ball_list* list, const double center[3], double radius, int32_t curve, int32_t set)
{
  mlim_balls* balls = &list->balls;
  const size_t count = balls->ball_count;
  if (count >= INT32_MAX ||
      mlim_reserve(&balls->centers, &list->capacities[0], count + 1, 3 * sizeof(double)) ||
      mlim_reserve(&balls->radii, &list->capacities[1], count + 1, sizeof(double)) ||
      mlim_reserve(&balls->ball_curves, &list->capacities[2], count + 1, sizeof(int32_t)) ||
      mlim_reserve(&balls->ball_sets, &list->capacities[3], count + 1, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  mlim_copy(center, balls->centers + 3 * count);
  balls->radii[count] = radius;
  balls->ball_curves[count] = curve;
  balls->ball_sets[count] = set;
  ++balls->ball_count;
  return MLIM_OK;
}

mlim_status mlim_ball_list_join(mlim_ball_list* list, int32_t a, int32_t b, int32_t curve)
{
  mlim_balls* balls = &list->balls;
  const size_t count = balls->edge_count;
  if (mlim_reserve(&balls->edges, &list->capacities[4], count + 1, 2 * sizeof(int32_t)) ||
      mlim_reserve(&balls->edge_curves, &list->capacities[5], count + 1, sizeof(int32_t)))
  {
    return MLIM_OUT_OF_MEMORY;
  }
  balls->edges[2 * count] = a;
  balls->edges[2 * count + 1] = b;
  balls->edge_curves[count] = curve;
  ++balls->edge_count;
  return MLIM_OK;
}

void mlim_ball_list_take(mlim_ball_list* list, mlim_balls* out)
{
  *out = list->balls;
  list->balls = (mlim_balls){ 0 };
}
