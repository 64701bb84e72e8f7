/* Points and segments of curves before they are grown into curves: what the cells and the faces of
   the box emit, gathered and welded. */
#ifndef mlim_network_h
#define mlim_network_h

#include "label_sets.h"

typedef struct mlim_segment
{
  int32_t ends[2];
  int32_t set;
} mlim_segment;

/* All 0 is an empty network. Owns all it points to. */
typedef struct mlim_network
{
  size_t point_count;
  size_t point_capacity;
  size_t point_set_capacity;
  double* points;      /* 3 each */
  int32_t* point_sets; /* labels known to meet at each point */
  size_t segment_count;
  size_t segment_capacity;
  mlim_segment* segments;
  mlim_set_table table;
} mlim_network;

void mlim_network_free(mlim_network* network);

mlim_status mlim_network_add_point(
  mlim_network* network, const double point[3], int32_t set, int32_t* out);
mlim_status mlim_network_add_segment(mlim_network* network, int32_t a, int32_t b, int32_t set);

/* Appends another network's points, segments and sets. */
mlim_status mlim_network_append(mlim_network* network, const mlim_network* other);

/* Makes points closer than the distance one (the first of them, with the labels of all), drops
   segments without length, and makes segments between the same points one. */
mlim_status mlim_network_weld(mlim_network* network, double distance);

#endif
