/* The largest radius a ball may have at each place of the curve network. */
#ifndef mlim_radius_map_h
#define mlim_radius_map_h

#include "status.h"

/* Samples along the curves. A ball on a sample may be as large as both limits say; between samples
   limits are linear. All 0 is empty. */
typedef struct mlim_radius_map
{
  const mlim_curves* curves; /* borrowed */
  double first_radius;       /* the limit where nothing is near */
  double floor_radius;       /* limits do not fall below it */
  size_t sample_count;
  size_t* offsets; /* per curve, one more at the end */
  double* points;  /* 3 each */
  double* arcs;    /* length along the curve from its start */
  double* limits;  /* graded along the whole network */
  double* wedges;  /* by curves that leave the same junction; graded along the curve only, so that
                       the junction's own ball stays large */
  int32_t* ends;   /* 2 per curve: its junctions; -1 for a closed curve without */
  double* junction_limits;
  unsigned char* is_lowered; /* a curve: its own limits have fallen since it was graded */
  unsigned char*
    is_changed; /* a curve: limits may have fallen since the user took this back; 1 at first */
} mlim_radius_map;

/* Looks at the host between samples. */
mlim_status mlim_radius_map_create(const mlim_curves* curves, const mlim_options* options,
  mlim_context* context, mlim_radius_map* out);
void mlim_radius_map_free(mlim_radius_map* map);

/* Restores the grading after limits were lowered. */
void mlim_radius_map_grade(mlim_radius_map* map);

/* The radius at a length along a curve, and the point there. *near: a sample where to look first, any number
   at the beginning; becomes the one found. */
double mlim_radius_map_radius(const mlim_radius_map* map, size_t curve, double arc, size_t* near);
void mlim_radius_map_point(const mlim_radius_map* map, size_t curve, double arc, double out[3]);

typedef enum mlim_radius_limit
{
  MLIM_LIMIT_NETWORK,
  MLIM_LIMIT_WEDGE
} mlim_radius_limit;

/* Lowers a limit round a place of a curve. Returns whether it changed. */
int mlim_radius_map_lower(
  mlim_radius_map* map, mlim_radius_limit which, size_t curve, double arc, double radius);
int mlim_radius_map_lower_junction(mlim_radius_map* map, size_t junction, double radius);

#endif
