#include "unresolved.h"

#include "ahead.h"
#include "memory.h"
#include "status.h"

enum
{
  BLOCK = 1 << 10,        /* records counted together */
  BLOCKS_A_PIECE = 1 << 6 /* between two looks at the host: some milliseconds */
};

typedef struct counts
{
  size_t crossings, sizes, distances, ratios, ball_ratios;
} counts;

typedef struct count_job
{
  const mlim_complex* complex;
  const mlim_options* options;
  counts* blocks;
} count_job;

static void count_facet(const count_job* job, const mlim_facet* facet, counts* out)
{
  const mlim_verdict verdict = mlim_criteria_judge(job->complex, job->options, facet);
  switch (verdict.badness)
  {
    case MLIM_BAD_CROSSINGS:
      ++out->crossings;
      break;
    case MLIM_BAD_SIZE:
      ++out->sizes;
      break;
    case MLIM_BAD_DISTANCE:
      ++out->distances;
      break;
    case MLIM_BAD_FAR:
    case MLIM_BAD_SHEET: /* counted by the labels of the cells, when these are tidied */
    case MLIM_BAD_RATIO:
    case MLIM_BAD_DISK:
    case MLIM_BAD_NONE:
      break;
  }
  if (verdict.radius_edge_ratio > job->options->facet_radius_edge_ratio)
  {
    ++*(verdict.has_ball ? &out->ball_ratios : &out->ratios);
  }
}

/* A good one counts nowhere. */
static int is_asked(const mlim_facet* facet)
{
  return facet->is_alive && !mlim_complex_is_good(facet);
}

static void ask_ahead(const mlim_complex* complex, size_t f, size_t end)
{
  const mlim_facet* facets = complex->facets;
  if (f + MLIM_CELLS_AHEAD < end && is_asked(&facets[f + MLIM_CELLS_AHEAD]))
  {
    mlim_prefetch(&complex->cells[facets[f + MLIM_CELLS_AHEAD].cell]);
  }
  if (f + MLIM_VERTICES_AHEAD < end && is_asked(&facets[f + MLIM_VERTICES_AHEAD]))
  {
    const mlim_facet* facet = &facets[f + MLIM_VERTICES_AHEAD];
    mlim_ahead_of_vertices(complex, facet->cell, facet->index, 1);
  }
}

static void count_body(void* data, size_t begin, size_t end)
{
  const count_job* job = (const count_job*)data;
  for (size_t b = begin; b < end; ++b)
  {
    const size_t left = job->complex->facet_count - b * BLOCK;
    const size_t last = b * BLOCK + (left < BLOCK ? left : BLOCK);
    job->blocks[b] = (counts){ 0 };
    for (size_t f = b * BLOCK; f < last; ++f)
    {
      ask_ahead(job->complex, f, last);
      if (is_asked(&job->complex->facets[f]))
      {
        count_facet(job, &job->complex->facets[f], &job->blocks[b]);
      }
    }
  }
}

mlim_status mlim_unresolved_count(const mlim_complex* complex, const mlim_options* options,
  double done, mlim_context* context, mlim_report* out)
{
  const size_t count = (complex->facet_count + BLOCK - 1) / BLOCK;
  const count_job job = {
    .complex = complex, .options = options, .blocks = mlim_allocate(count, sizeof *job.blocks)
  };
  const mlim_status status = job.blocks == NULL
                               ? mlim_fail_memory(context, "what is left unresolved")
                               : mlim_parallel_stage(context, &(mlim_stage_work){ .count = count,
                                                                .body = count_body,
                                                                .job = (void*)&job,
                                                                .stage = MLIM_STAGE_CERTIFICATE,
                                                                .from = done,
                                                                .to = done,
                                                                .step = BLOCKS_A_PIECE });
  for (size_t b = 0; b < count && status == MLIM_OK; ++b)
  {
    out->unresolved_crossing_count += job.blocks[b].crossings;
    out->unresolved_size_count += job.blocks[b].sizes;
    out->unresolved_distance_count += job.blocks[b].distances;
    out->unresolved_ratio_count += job.blocks[b].ratios;
    out->unresolved_ball_ratio_count += job.blocks[b].ball_ratios;
  }
  mlim_release(job.blocks);
  return status;
}
