/* Where a segment changes label. Dey, Janoos, Levine, section 3.3.

   The exact oracle walks the cells on the segment, skips uniform space, and solves the cubics that
   the indicators are along a segment inside a mixed cell, so it finds every crossing, also when both
   ends have the same label. The paper's bisection looks only at midpoints; it is kept for
   comparison, and works on any label function. */
#ifndef mlim_oracle_h
#define mlim_oracle_h

#include "field.h"

typedef struct mlim_crossing
{
  double point[3];
  int32_t from; /* label before it, seen from the segment's start */
  int32_t to;
  int32_t face; /* face of the box on which it lies, -1 inside */
} mlim_crossing;

typedef struct mlim_oracle
{
  const mlim_field* field; /* borrowed */
  double tolerance;        /* length at which a search stops */
  mlim_oracle_mode mode;
} mlim_oracle;

/* Up to `capacity` crossings in order along the segment; the result is the number written. */
size_t mlim_oracle_crossings(const mlim_oracle* oracle, const double start[3], const double end[3],
  size_t capacity, mlim_crossing* out);

/* A segment of whose ends is known what mlim_field_look_at tells. */
typedef struct mlim_segment
{
  const double* ends[2];
  int32_t labels[2];
  float clearances[2];
} mlim_segment;

enum
{
  MLIM_SEGMENTS = 16 /* at once */
};

/* The same for up to MLIM_SEGMENTS segments, without looking at what is known, and in less time than one after
   the other: they wait for memory together. Segment s has counts[s] crossings from out + s * capacity on. */
void mlim_oracle_cross_all(const mlim_oracle* oracle, const mlim_segment* segments, size_t count,
  size_t capacity, mlim_crossing* out, size_t* counts);

/* The same for one of them. */
size_t mlim_oracle_crossings_between(
  const mlim_oracle* oracle, const mlim_segment* segment, size_t capacity, mlim_crossing* out);

/* A label function, for bisection: tests give analytic ones. */
typedef int32_t (*mlim_label_function)(const void* user, const double point[3]);

/* The paper's oracle: crossings found by looking at midpoints, in order along the segment. */
size_t mlim_oracle_bisect(mlim_label_function label, const void* user, const double start[3],
  const double end[3], double tolerance, size_t capacity, mlim_crossing* out);

/* The same for the labels of the field. */
size_t mlim_oracle_crossings_by_bisection(const mlim_oracle* oracle, const double start[3],
  const double end[3], size_t capacity, mlim_crossing* out);

#endif
