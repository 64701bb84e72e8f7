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
  TURNS = 512,  /* between two looks at the host, */
  CELLS = 36864 /* and cells, about 20 ms */
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

/* Facets get their points, batch after batch, and beside the insertions the duals that those before have left are
   looked along. */
typedef struct turn
{
  mlim_refinement* refinement;
  mlim_badness badness;
  size_t next; /* entry of the batch */
  int is_over; /* the queue is empty, and nothing is on its way */
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

/* What one part changes no other reads, nor do insertions. */
static void look(void* data, size_t item)
{
  mlim_refinement* r = (mlim_refinement*)data;
  const size_t parts = r->records.part_count;
  if (item < parts)
  {
    mlim_records_label(&r->records, item, item + 1);
    return;
  }
  mlim_records_look(&r->records, item - parts, item - parts + 1, parts);
  mlim_judge_duals(r, item - parts);
}

/* Records and queues what was found. */
static mlim_status settle(mlim_refinement* r, mlim_context* context)
{
  const int is_pending = r->records.is_pending;
  const mlim_status status = mlim_records_settle(&r->records, &r->complex, context);
  return status == MLIM_OK && is_pending ? mlim_judge_settled(r, context) : status;
}

static mlim_status take_turn(turn* t, mlim_team* team)
{
  mlim_refinement* r = t->refinement;
  const size_t parts = r->records.is_pending ? r->records.part_count : 0;
  mlim_team_offer(
    team, &(mlim_team_work){ .body = look, .job = r, .count = 2 * parts, .second = parts });
  if (mlim_team_is_alone(team))
  {
    mlim_team_finish(team); /* as long as the cells are in the cache */
  }
  insert_some(t);
  mlim_team_finish(team);
  mlim_status status = settle(r, t->context);
  status = t->status == MLIM_OK ? status : t->status;
  /* Insertions leave the vertices where they are when they are looked at. */
  status = status == MLIM_OK ? mlim_complex_reserve(&r->complex, VERTICES, t->context) : status;
  return status == MLIM_OK ? mlim_records_take(&r->records, &r->complex, team, t->context) : status;
}

/* Whether there is one more. */
static int next_batch(turn* t)
{
  const int bin = mlim_queue_next(&t->refinement->queue);
  t->badness = mlim_queue_badness_of(bin);
  t->next = 0;
  t->is_over = bin < 0;
  return bin >= 0;
}

/* As much as a host can wait for. */
static void take_turns(void* data, mlim_team* team)
{
  turn* t = (turn*)data;
  const mlim_refinement* r = t->refinement;
  size_t cells = 0;
  for (size_t turns = 0; turns < TURNS && cells < CELLS && !t->is_over && t->status == MLIM_OK;
       ++turns)
  {
    if (t->next < r->queue.batch.count || r->records.is_pending || next_batch(t))
    {
      t->status = take_turn(t, team);
      cells += r->records.cell_count;
    }
  }
}

mlim_status mlim_batches_work(mlim_refinement* refinement, mlim_context* context)
{
  turn t = { .refinement = refinement, .context = context };
  next_batch(&t);
  mlim_status status = t.is_over ? MLIM_OK : mlim_judge_fresh(refinement, context);
  while (!t.is_over && status == MLIM_OK)
  {
    mlim_team_run(context, take_turns, &t);
    status = t.status == MLIM_OK ? mlim_refine_report(refinement, context) : t.status;
  }
  return status;
}
