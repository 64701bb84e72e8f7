#include "skin.h"

#include "ahead.h"
#include "memory.h"
#include "status.h"
#include "vector.h"

#include <string.h>

/* No more blocks than this along an axis: they are there to save time, not to be fine. */
static const double MAX_BLOCKS = 128;

mlim_status mlim_skin_blocks_create(
  const double size[3], double distance, mlim_context* context, mlim_skin_blocks* out)
{
  const double largest = mlim_max(size[0], mlim_max(size[1], size[2]));
  *out = (mlim_skin_blocks){ .distance = distance,
    .side = mlim_max(4 * distance, largest / MAX_BLOCKS) };
  size_t count = 1;
  for (int k = 0; k < 3; ++k)
  {
    out->counts[k] = (int32_t)(size[k] / out->side) + 1;
    count *= (size_t)out->counts[k];
  }
  out->is_near = mlim_allocate_zeroed(count, 1);
  return out->is_near != NULL ? MLIM_OK
                              : mlim_fail_memory(context, "the crossings far from the mesh");
}

void mlim_skin_blocks_free(mlim_skin_blocks* blocks)
{
  mlim_release(blocks->is_near);
  *blocks = (mlim_skin_blocks){ 0 };
}

typedef struct block_range
{
  int32_t low[3];
  int32_t high[3];
} block_range;

static int32_t block_of(const mlim_skin_blocks* blocks, double value, int axis)
{
  const double b = value / blocks->side;
  return b < 0 ? 0 : b >= blocks->counts[axis] ? blocks->counts[axis] - 1 : (int32_t)b;
}

static unsigned char* block_at(const mlim_skin_blocks* blocks, int32_t x, int32_t y, int32_t z)
{
  return &blocks->is_near[(size_t)x + (size_t)blocks->counts[0] *
                                        ((size_t)y + (size_t)blocks->counts[1] * (size_t)z)];
}

void mlim_skin_blocks_add(mlim_skin_blocks* blocks, const double point[3])
{
  block_range r;
  for (int k = 0; k < 3; ++k)
  {
    r.low[k] = block_of(blocks, point[k] - blocks->distance, k);
    r.high[k] = block_of(blocks, point[k] + blocks->distance, k);
  }
  for (int32_t z = r.low[2]; z <= r.high[2]; ++z)
  {
    for (int32_t y = r.low[1]; y <= r.high[1]; ++y)
    {
      for (int32_t x = r.low[0]; x <= r.high[0]; ++x)
      {
        *block_at(blocks, x, y, z) = 1;
      }
    }
  }
}

/* Whether the box round a triangle touches a block that is near. */
static int reaches(
  const mlim_skin_blocks* blocks, const mlim_complex* complex, const int32_t vertices[3])
{
  block_range r;
  for (int k = 0; k < 3; ++k)
  {
    const double a = complex->vertices[vertices[0]].point[k];
    const double b = complex->vertices[vertices[1]].point[k];
    const double c = complex->vertices[vertices[2]].point[k];
    r.low[k] = block_of(blocks, mlim_min(a, mlim_min(b, c)), k);
    r.high[k] = block_of(blocks, mlim_max(a, mlim_max(b, c)), k);
  }
  for (int32_t z = r.low[2]; z <= r.high[2]; ++z)
  {
    for (int32_t y = r.low[1]; y <= r.high[1]; ++y)
    {
      for (int32_t x = r.low[0]; x <= r.high[0]; ++x)
      {
        if (*block_at(blocks, x, y, z))
        {
          return 1;
        }
      }
    }
  }
  return 0;
}

static int is_new(const mlim_facet* facet)
{
  return facet->is_alive && !facet->is_measured;
}

/* Every facet between two labels has a record. */
static int is_boundary(const mlim_complex* complex, const mlim_facet* facet)
{
  const mlim_cell* cell = &complex->cells[facet->cell];
  return cell->label != complex->cells[cell->neighbors[facet->index]].label;
}

enum
{
  BLOCK = 1 << 12,    /* records whose triangles follow each other */
  BLOCKS_A_PIECE = 32 /* between two looks at the host: some milliseconds */
};

typedef struct skin_job
{
  mlim_complex* complex;
  const mlim_skin_blocks* blocks;
  mlim_skin* skin;
  size_t* counts; /* triangles of each block of records, at the block's place in the mesh */
} skin_job;

static void ask_ahead(const skin_job* job, size_t f, size_t end)
{
  const mlim_complex* complex = job->complex;
  const mlim_facet* facets = complex->facets;
  if (f + MLIM_CELLS_AHEAD < end && is_new(&facets[f + MLIM_CELLS_AHEAD]))
  {
    mlim_prefetch(&complex->cells[facets[f + MLIM_CELLS_AHEAD].cell]);
  }
  if (f + MLIM_VERTICES_AHEAD < end && is_new(&facets[f + MLIM_VERTICES_AHEAD]))
  {
    const mlim_facet* facet = &facets[f + MLIM_VERTICES_AHEAD];
    mlim_ahead_of_neighbor(complex, facet->cell, facet->index);
    if (job->blocks->is_near != NULL)
    {
      mlim_ahead_of_vertices(complex, facet->cell, facet->index, 0);
    }
  }
}

/* Marks what it takes. */
static void facet_body(void* data, size_t begin, size_t end)
{
  const skin_job* job = (const skin_job*)data;
  mlim_complex* complex = job->complex;
  for (size_t b = begin; b < end; ++b)
  {
    const size_t left = complex->facet_count - b * BLOCK;
    const size_t last = b * BLOCK + (left < BLOCK ? left : BLOCK);
    size_t count = 0;
    for (size_t f = b * BLOCK; f < last; ++f)
    {
      ask_ahead(job, f, last);
      mlim_facet* facet = &complex->facets[f];
      int32_t* triangle = job->skin->triangles + 3 * (b * BLOCK + count);
      if (is_new(facet) && is_boundary(complex, facet))
      {
        facet->is_measured = 1;
        mlim_complex_facet_vertices(complex, facet->cell, facet->index, triangle);
        count += job->blocks->is_near == NULL || reaches(job->blocks, complex, triangle);
      }
    }
    job->counts[b] = count;
  }
}

/* Closes the gaps between the blocks' triangles. */
static void close_up(const skin_job* job, size_t block_count)
{
  int32_t* triangles = job->skin->triangles;
  size_t count = 0;
  for (size_t b = 0; b < block_count; ++b)
  {
    memmove(
      triangles + 3 * count, triangles + 3 * b * BLOCK, 3 * job->counts[b] * sizeof *triangles);
    count += job->counts[b];
  }
  job->skin->triangle_count = count;
}

static mlim_status read_all(const skin_job* job, double done, mlim_context* context)
{
  const size_t block_count = (job->complex->facet_count + BLOCK - 1) / BLOCK;
  const mlim_stage_work work = { .count = block_count,
    .body = facet_body,
    .job = (void*)job,
    .stage = MLIM_STAGE_SURFACE,
    .from = done,
    .to = done,
    .step = BLOCKS_A_PIECE };
  const mlim_status status = mlim_parallel_stage(context, &work);
  if (status == MLIM_OK)
  {
    close_up(job, block_count);
  }
  return status;
}

mlim_status mlim_skin_read(mlim_complex* complex, const mlim_skin_blocks* blocks, double done,
  mlim_context* context, mlim_skin* out)
{
  *out = (mlim_skin){ 0 };
  out->triangles = mlim_allocate(3 * complex->facet_count, sizeof *out->triangles);
  const skin_job job = { .complex = complex,
    .blocks = blocks,
    .skin = out,
    .counts = mlim_allocate(complex->facet_count / BLOCK + 1, sizeof *job.counts) };
  const mlim_status status =
    out->triangles != NULL && job.counts != NULL
      ? read_all(&job, done, context)
      : mlim_fail_memory(context, "the triangles near the grid's crossings");
  mlim_release(job.counts);
  if (status != MLIM_OK)
  {
    mlim_skin_free(out);
  }
  return status;
}

void mlim_skin_free(mlim_skin* skin)
{
  mlim_release(skin->triangles);
  *skin = (mlim_skin){ 0 };
}
