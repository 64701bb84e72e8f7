/* Cleaning of binary masks in a block, and where a mask is thin. Bytes are 0 or 1. */
#ifndef mlim_morphology_h
#define mlim_morphology_h

#include <stddef.h>
#include <stdint.h>

/* A point is set where more than half of the cube of 2 radius + 1 points round it are. Beyond the
   block its outermost values go on. counts: 2 blocks, one after the other. */
void mlim_morphology_median(
  int32_t radius, const int32_t size[3], unsigned char* mask, int32_t* counts);

/* Sets every point within `radius` points (Euclidean) of the mask. scratch: as large as the block. */
void mlim_morphology_dilate(
  int32_t radius, const int32_t size[3], unsigned char* mask, unsigned char* scratch);

/* Points of the mask none of whose 27 neighbours of the mask lies in a cube of 2 x 2 x 2 points of it:
   sheets, threads and specks of one point, but not the rim of something thicker. The result is the
   number of such points. */
size_t mlim_morphology_thin(
  const int32_t size[3], const unsigned char* mask, unsigned char* scratch, unsigned char* out);

#endif
