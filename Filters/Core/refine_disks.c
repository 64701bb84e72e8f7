#include "refine_disks.h"

#include "memory.h"
#include "refine_rings.h"
#include "status.h"
#include "vector.h"

#include <stdlib.h>

enum
{
  BATCH = 4096, /* vertices between two looks at the host, about 3 ms */
  FEW = 256     /* vertices that are not worth waking a thread for */
};

typedef struct disks
{
  mlim_refinement* refinement;
  mlim_placed* order;
  int is_queueing;
  double done; /* of the certificate's stage, unless queueing */
  unsigned char has_memory[BATCH];
  unsigned char fails[BATCH];
  int32_t records[BATCH]; /* to queue where it fails; 0: none */
} disks;

/* The facet of a failed star whose crossing is farthest from the vertex, 0: none can be refined. */
static int32_t find_farthest(const mlim_refinement* r, int32_t vertex, const mlim_star* star)
{
  const mlim_complex* complex = &r->complex;
  int32_t best = 0;
  double most = -1;
  for (size_t k = 0; k < star->facet_count; ++k)
  {
    const mlim_facet* facet = &complex->facets[star->facets[k]];
    const double d = mlim_distance_squared(facet->crossing, complex->vertices[vertex].point);
    if (d > most && mlim_criteria_may_insert(complex, r->options, facet, MLIM_BAD_DISK))
    {
      most = d;
      best = star->facets[k];
    }
  }
  return best;
}

static void check_body(void* data, size_t begin, size_t end)
{
  disks* d = (disks*)data;
  const mlim_refinement* r = d->refinement;
  mlim_star star = { 0 };
  for (size_t k = begin; k < end; ++k)
  {
    const int32_t vertex = d->order[k].id;
    mlim_disk disk;
    d->has_memory[k % BATCH] =
      mlim_disk_check(&r->complex, &r->links, vertex, &star, NULL, &disk) == MLIM_OK;
    const int fails = disk == MLIM_DISK_FAILS;
    d->fails[k % BATCH] = (unsigned char)fails;
    d->records[k % BATCH] = fails && d->is_queueing ? find_farthest(r, vertex, &star) : 0;
  }
  mlim_star_free(&star);
}

static mlim_status note(void* data, size_t begin, size_t end, mlim_context* context)
{
  const disks* d = (const disks*)data;
  mlim_refinement* r = d->refinement;
  mlim_status status = MLIM_OK;
  for (size_t k = begin; k < end && status == MLIM_OK; ++k)
  {
    const int32_t record = d->records[k % BATCH];
    mlim_vertex* vertex = &r->complex.vertices[d->order[k].id];
    vertex->is_dirty = 0;
    vertex->is_broken = d->fails[k % BATCH] & 1;
    if (!d->has_memory[k % BATCH])
    {
      status = mlim_fail_memory(context, "a vertex's star");
    }
    else if (record > 0 &&
             mlim_queue_push(&r->queue, mlim_queue_bin_of(MLIM_BAD_DISK, 1), &r->complex, record))
    {
      status = mlim_fail_memory(context, "the queue of facets");
    }
  }
  return status != MLIM_OK ? status
         : d->is_queueing  ? mlim_refine_report(r, context)
                           : mlim_progress(context, MLIM_STAGE_CERTIFICATE, d->done);
}

/* Neighbours one after the other: their stars share cells. */
static mlim_status check(disks* d, mlim_context* context)
{
  mlim_complex* complex = &d->refinement->complex;
  d->order = mlim_allocate(complex->dirty_count, sizeof *d->order);
  if (d->order == NULL)
  {
    return mlim_fail_memory(context, "the order of the vertices");
  }
  for (size_t k = 0; k < complex->dirty_count; ++k)
  {
    const int32_t vertex = complex->dirty[k];
    const double* point = complex->vertices[vertex].point;
    d->order[k] =
      (mlim_placed){ .place = mlim_queue_place(&d->refinement->queue, point), .id = vertex };
  }
  mlim_queue_sort(d->order, complex->dirty_count);
  const mlim_status status =
    mlim_parallel_batches(context, &(mlim_batches){ .count = complex->dirty_count,
                                     .size = BATCH,
                                     .few = FEW,
                                     .body = check_body,
                                     .finish = note,
                                     .job = d });
  mlim_release(d->order);
  complex->dirty_count = 0;
  return status;
}

mlim_status mlim_disks_check(mlim_refinement* refinement, mlim_context* context)
{
  const mlim_status status = mlim_rings_settle(refinement, context);
  return status == MLIM_OK ? check(&(disks){ .refinement = refinement, .is_queueing = 1 }, context)
                           : status;
}

mlim_status mlim_disks_settle(mlim_refinement* refinement, double done, mlim_context* context)
{
  return check(&(disks){ .refinement = refinement, .done = done }, context);
}
