/* The limit that refinement is measured against: all points in one bulk insertion. */
#ifndef mlim_bulk_h
#define mlim_bulk_h

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

/* User CPU time of inserting the points, 4 numbers each (x, y, z, weight), as one range into an
   empty regular triangulation: the least of `repeats` times. Below 0: not enough memory. */
double bench_bulk_seconds(const double* xyzw, size_t count, int repeats);

/* CGAL's version; never NULL. */
const char* bench_bulk_version(void);

#ifdef __cplusplus
}
#endif

#endif
