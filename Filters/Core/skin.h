/* The boundary between labels as bare triangles, for measuring distances to it while refinement goes
   on: nothing of the mesh's order, labels or lines. */
#ifndef mlim_skin_h
#define mlim_skin_h

#include "complex.h"

/* Blocks of space within a distance of some points. All 0: all of space. */
typedef struct mlim_skin_blocks
{
  double side;
  double distance;
  int32_t counts[3];
  unsigned char* is_near;
} mlim_skin_blocks;

mlim_status mlim_skin_blocks_create(
  const double size[3], double distance, mlim_context* context, mlim_skin_blocks* out);
void mlim_skin_blocks_free(mlim_skin_blocks* blocks);
void mlim_skin_blocks_add(mlim_skin_blocks* blocks, const double point[3]);

/* Triangles of the complex's vertices, by their ids. */
typedef struct mlim_skin
{
  size_t triangle_count;
  int32_t* triangles; /* 3 each */
} mlim_skin;

/* The triangles that reach into the blocks and were in no skin before. `done` is reported as the share of the surface's stage. */
mlim_status mlim_skin_read(mlim_complex* complex, const mlim_skin_blocks* blocks, double done,
  mlim_context* context, mlim_skin* out);
void mlim_skin_free(mlim_skin* skin);

#endif
