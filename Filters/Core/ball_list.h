/* Protecting balls in the making: a list that grows. */
#ifndef mlim_ball_list_h
#define mlim_ball_list_h

#include "status.h"

/* All 0 is an empty list. */
typedef struct mlim_ball_list
{
  mlim_balls balls; /* owned; its sets are the caller's to fill */
  size_t capacities[6];
} mlim_ball_list;

void mlim_ball_list_free(mlim_ball_list* list);

mlim_status mlim_ball_list_add(
  mlim_ball_list* list, const double center[3], double radius, int32_t curve, int32_t set);
/* An edge of a curve between two balls. */
mlim_status mlim_ball_list_join(mlim_ball_list* list, int32_t a, int32_t b, int32_t curve);

/* Hands the balls over. */
void mlim_ball_list_take(mlim_ball_list* list, mlim_balls* out);

#endif
