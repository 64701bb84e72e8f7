#include "boundary.h"

#include "memory.h"
#include "status.h"

#include <string.h>

enum
{
  AHEAD = 16,             /* cells */
  CELLS_A_PIECE = 1 << 18 /* between two looks at the host: some milliseconds */
};

typedef struct boundary_job
{
  const mlim_complex* complex;
  uint16_t* labels; /* of each cell: close together, neighbours' labels are there without waiting */
  unsigned char* sides;
} boundary_job;

static void label_body(void* data, size_t begin, size_t end)
{
  const boundary_job* job = (const boundary_job*)data;
  for (size_t c = begin; c < end; ++c)
  {
    job->labels[c] = (uint16_t)job->complex->cells[c].label; /* a dead cell's is not looked at */
  }
}

static void ask_ahead(const boundary_job* job, size_t c, size_t end)
{
  if (c + 2 * AHEAD < end)
  {
    mlim_prefetch(&job->complex->cells[c + 2 * AHEAD]);
  }
  for (int k = 0; k < 4 && c + AHEAD < end; ++k)
  {
    const int32_t other = job->complex->cells[c + AHEAD].neighbors[k];
    mlim_prefetch(&job->labels[other < 0 ? 0 : other]);
  }
}

static void side_body(void* data, size_t begin, size_t end)
{
  const boundary_job* job = (const boundary_job*)data;
  for (size_t c = begin; c < end; ++c)
  {
    ask_ahead(job, c, end);
    const mlim_cell* cell = &job->complex->cells[c];
    unsigned sides = 0;
    for (int k = 0; k < 4 && cell->vertices[0] >= 0; ++k)
    {
      const int32_t other = cell->neighbors[k];
      const unsigned differs = other != MLIM_NO_CELL && job->labels[other] != job->labels[c];
      const unsigned is_first = other > (int32_t)c;
      sides |= differs << k | (differs & is_first) << (MLIM_FIRST_SHIFT + k);
    }
    job->sides[c] = (unsigned char)sides;
  }
}

mlim_status mlim_boundary_find(
  const mlim_complex* complex, double done, mlim_context* context, mlim_boundary* out)
{
  const size_t count = complex->cell_count;
  boundary_job job = { .complex = complex,
    .labels = mlim_allocate(count, sizeof *job.labels),
    .sides = mlim_allocate(count, 1) };
  *out = (mlim_boundary){ .sides = job.sides, .cell_count = count };
  mlim_stage_work work = { .count = count,
    .body = label_body,
    .job = &job,
    .stage = MLIM_STAGE_CERTIFICATE,
    .from = done,
    .to = done,
    .step = CELLS_A_PIECE };
  mlim_status status = job.labels != NULL && job.sides != NULL
                         ? mlim_parallel_stage(context, &work)
                         : mlim_fail_memory(context, "the facets between labels");
  if (status == MLIM_OK)
  {
    work.body = side_body;
    status = mlim_parallel_stage(context, &work);
  }
  mlim_release(job.labels);
  if (status != MLIM_OK)
  {
    mlim_boundary_free(out);
  }
  return status;
}

void mlim_boundary_free(mlim_boundary* boundary)
{
  mlim_release(boundary->sides);
  *boundary = (mlim_boundary){ 0 };
}

static void set_side(mlim_boundary* boundary, int32_t cell, int index, int differs, int is_first)
{
  const unsigned bits = 1u << index | (unsigned)is_first << (MLIM_FIRST_SHIFT + index);
  const unsigned old = boundary->sides[cell];
  boundary->sides[cell] = (unsigned char)(differs ? old | bits : old & ~bits);
}

void mlim_boundary_update(mlim_boundary* boundary, const mlim_complex* complex, int32_t cell)
{
  const mlim_cell* own = &complex->cells[cell];
  boundary->sides[cell] = 0;
  for (int k = 0; k < 4; ++k)
  {
    const int32_t id = own->neighbors[k];
    if (id == MLIM_NO_CELL)
    {
      continue;
    }
    const mlim_cell* other = &complex->cells[id];
    int back = 0;
    while (back < 3 && other->neighbors[back] != cell)
    {
      ++back;
    }
    const int differs = own->label != other->label;
    set_side(boundary, cell, k, differs, cell < id);
    set_side(boundary, id, back, differs, id < cell);
  }
}

mlim_status mlim_boundary_follow(
  mlim_boundary* boundary, const mlim_complex* complex, mlim_context* context)
{
  const mlim_delaunay_zone dead = mlim_delaunay_dead(complex->delaunay);
  size_t capacity = boundary->cell_count;
  if (mlim_reserve(&boundary->sides, &capacity, complex->cell_count, 1))
  {
    return mlim_fail_memory(context, "the facets between labels");
  }
  memset(boundary->sides + boundary->cell_count, 0, complex->cell_count - boundary->cell_count);
  boundary->cell_count = complex->cell_count;
  for (size_t d = 0; d < dead.count; ++d)
  {
    boundary->sides[dead.cells[d]] = 0;
  }
  return MLIM_OK;
}

size_t mlim_boundary_count(const mlim_boundary* boundary)
{
  size_t count = 0;
  for (size_t c = 0; c < boundary->cell_count; ++c)
  {
    for (unsigned bits = boundary->sides[c] >> MLIM_FIRST_SHIFT; bits != 0; bits &= bits - 1)
    {
      ++count;
    }
  }
  return count;
}

void mlim_boundary_list(const mlim_boundary* boundary, mlim_boundary_facet* out)
{
  size_t count = 0;
  for (size_t c = 0; c < boundary->cell_count; ++c)
  {
    const unsigned bits = boundary->sides[c] >> MLIM_FIRST_SHIFT;
    for (int k = 0; k < 4; ++k)
    {
      if (bits >> k & 1u)
      {
        out[count++] = (mlim_boundary_facet){ .cell = (int32_t)c, .index = k };
      }
    }
  }
}
