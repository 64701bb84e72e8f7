#include "refine_batch.h"

#include "ahead.h"
#include "partner.h"
#include "refine_judge.h"
#include "status.h"
#include "vector.h"

enum
{
  UPDATE_EVERY = 1536, /* cells made between two updates: they are still in the cache then */
  VERTICES = 2048, /* room for what an update's cells have at most: one in four, and its partners */
  RECORDS_AHEAD = 6, /* entries of the batch to the one whose record is asked for */
  CELLS_AHEAD = 4,   /* and to those whose cell is, and the one beyond */
  NEIGHBORS_AHEAD = 2,
  PARTS = 7, /* of what is looked at; with the insertions as many as hosts hand out singly */
  FEW = 256  /* cells that are not worth waking a thread for */
};

/* The partners of a vertex that was inserted just now. */
static mlim_status insert_partners(
  mlim_refinement* r, const mlim_partners* partners, mlim_context* context)
{
  const int32_t vertex = (int32_t)r->complex.vertex_count - 1;
  mlim_status status = MLIM_OK;
  for (size_t k = 0; k < partners->count && status == MLIM_OK; ++k)
  {
    int is_there;
    status = mlim_partner_insert(
      &r->complex, r->options, &partners->vertices[k], vertex, context, &is_there);
    r->insertion_count += (size_t)is_there;
  }
  return status;
}

static mlim_status insert_crossing(mlim_refinement* r, int32_t record, mlim_context* context)
{
  mlim_complex* complex = &r->complex;
  const mlim_facet* facet = &complex->facets[record];
  mlim_vertex vertex = { .kind = MLIM_VERTEX_SURFACE, .ball = -1, .sheet = facet->sheet };
  mlim_copy(facet->crossing, vertex.point);
  const int32_t sides[2] = { facet->cell, complex->cells[facet->cell].neighbors[facet->index] };
  int is_found = 0;
  mlim_status status = MLIM_OK;
  /* The crossing lies on the dual, between the two power centres: both cells are in conflict but
     for rounding. That no vertex is too near was seen before the facet was queued. */
  for (int k = 0; k < 2 && status == MLIM_OK && !is_found; ++k)
  {
    status =
      mlim_complex_probe(complex, &vertex, sides[k], MLIM_START_IN_CONFLICT, context, &is_found);
  }
  mlim_partners partners;
  if (!is_found || !mlim_partners_find(complex, r->options, &vertex, &partners))
  {
    return status;
  }
  status = mlim_complex_commit(complex, context);
  r->insertion_count += status == MLIM_OK;
  return status == MLIM_OK ? insert_partners(r, &partners, context) : status;
}

/* Insertions and, beside them, the duals that those before have left. */
typedef struct turn
{
  mlim_refinement* refinement;
  mlim_badness badness;
  size_t next; /* entry of the batch */
  mlim_context* context;
  mlim_status status;
} turn;

static int is_due(const mlim_refinement* r, const mlim_queue_entry* entry, mlim_badness badness)
{
  const mlim_facet* facet = &r->complex.facets[entry->record];
  return facet->is_alive && facet->generation == entry->generation &&
         mlim_records_hold(&r->complex, facet) &&
         (badness != MLIM_BAD_DISK ||
           mlim_criteria_may_insert(&r->complex, r->options, facet, badness));
}

/* What insertions begin with, on its way while those before them are at work. */
static void ask_ahead(const turn* t)
{
  const mlim_complex* complex = &t->refinement->complex;
  const mlim_queue_bin* batch = &t->refinement->queue.batch;
  const size_t left = batch->count - t->next;
  const mlim_queue_entry* next = batch->entries + t->next;
  if (left > RECORDS_AHEAD)
  {
    mlim_prefetch(&complex->facets[next[RECORDS_AHEAD].record]);
  }
  if (left > CELLS_AHEAD)
  {
    const mlim_facet* facet = &complex->facets[next[CELLS_AHEAD].record];
    mlim_prefetch(&complex->cells[facet->cell]);
    mlim_field_ahead(complex->oracle.field, facet->crossing, 0);
  }
  if (left > NEIGHBORS_AHEAD)
  {
    const mlim_facet* facet = &complex->facets[next[NEIGHBORS_AHEAD].record];
    mlim_ahead_of_neighbor(complex, facet->cell, facet->index);
    mlim_field_ahead(complex->oracle.field, facet->crossing, 1);
  }
}

static void insert_some(turn* t)
{
  mlim_refinement* r = t->refinement;
  const size_t limit = r->complex.vertex_count + VERTICES / 4;
  for (; t->next < r->queue.batch.count && t->status == MLIM_OK &&
         r->complex.made_count < UPDATE_EVERY && r->complex.vertex_count < limit;
       ++t->next)
  {
    const mlim_queue_entry entry = r->queue.batch.entries[t->next];
    ask_ahead(t);
    if (is_due(r, &entry, t->badness))
    {
      t->status = insert_crossing(r, entry.record, t->context);
    }
  }
}

/* Item 0 inserts, the others look at what those before have left: what one changes, no other reads. A thread that has
   both looks first, as long as the cells are in its cache. */
static void turn_body(void* data, size_t begin, size_t end)
{
  turn* t = (turn*)data;
  const size_t first = begin == 0 ? 0 : begin - 1;
  if (end > first + 1)
  {
    mlim_records_look(&t->refinement->records, first, end - 1);
  }
  for (size_t part = first; part + 1 < end; ++part)
  {
    mlim_judge_duals(t->refinement, part);
  }
  if (begin == 0)
  {
    insert_some(t);
  }
}

/* Records and queues what was found. */
static mlim_status settle(mlim_refinement* r, mlim_context* context)
{
  const mlim_status status = mlim_records_settle(&r->records, &r->complex, context);
  return status == MLIM_OK ? mlim_judge_settled(r, context) : status;
}

static mlim_status take_turn(turn* t)
{
  mlim_refinement* r = t->refinement;
  mlim_complex* complex = &r->complex;
  const int is_shared = r->records.is_pending && r->records.cell_count > FEW;
  const size_t parts = r->records.is_pending ? PARTS : 0;
  mlim_parallel_for(is_shared ? t->context : NULL, 1 + parts, turn_body, t);
  mlim_status status = parts > 0 ? settle(r, t->context) : mlim_refine_report(r, t->context);
  status = t->status == MLIM_OK ? status : t->status;
  /* Insertions leave the vertices where they are when they are looked at. */
  status = status == MLIM_OK ? mlim_complex_reserve(complex, VERTICES, t->context) : status;
  return status == MLIM_OK ? mlim_records_take(&r->records, complex, PARTS, t->context) : status;
}

mlim_status mlim_batch_work(
  mlim_refinement* refinement, mlim_badness badness, mlim_context* context)
{
  mlim_refinement* r = refinement;
  turn t = { .refinement = r, .badness = badness, .context = context };
  mlim_status status = mlim_judge_fresh(r, context);
  while ((t.next < r->queue.batch.count || r->records.is_pending) && status == MLIM_OK)
  {
    status = take_turn(&t);
  }
  return status;
}
