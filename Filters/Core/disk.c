#include "disk.h"

#include "memory.h"
#include "status.h"

#include <stdlib.h>
#include <string.h>

enum
{
  FIRST_TABLE = 256, /* slots; a star has about 25 cells */
  LONG_LINK = 64     /* vertices of a link from which on insertion is slower than qsort */
};

mlim_status mlim_ball_links_create(
  const mlim_balls* balls, mlim_context* context, mlim_ball_links* out)
{
  out->offsets = mlim_allocate_zeroed(balls->ball_count + 2, sizeof *out->offsets);
  out->neighbors = mlim_allocate(2 * balls->edge_count, sizeof *out->neighbors);
  if (out->offsets == NULL || out->neighbors == NULL)
  {
    mlim_ball_links_free(out);
    return mlim_fail_memory(context, "the balls' neighbours");
  }
  for (size_t e = 0; e < 2 * balls->edge_count; ++e)
  {
    ++out->offsets[balls->edges[e] + 2];
  }
  for (size_t b = 0; b < balls->ball_count; ++b)
  {
    out->offsets[b + 2] += out->offsets[b + 1];
  }
  for (size_t e = 0; e < balls->edge_count; ++e)
  {
    const int32_t* edge = balls->edges + 2 * e;
    out->neighbors[out->offsets[edge[0] + 1]++] = edge[1];
    out->neighbors[out->offsets[edge[1] + 1]++] = edge[0];
  }
  return MLIM_OK;
}

void mlim_ball_links_free(mlim_ball_links* links)
{
  mlim_release(links->offsets);
  mlim_release(links->neighbors);
  *links = (mlim_ball_links){ 0 };
}

void mlim_star_free(mlim_star* star)
{
  mlim_release(star->cells);
  mlim_release(star->seen);
  mlim_release(star->edges);
  mlim_release(star->facets);
  mlim_release(star->parents);
  mlim_release(star->link);
  *star = (mlim_star){ 0 };
}

/* ---- the star ---- */

/* 1: the cell was not in the star. There is room: the table is at most half full. */
static size_t add_seen(mlim_star* star, int32_t cell)
{
  const uint64_t entry = (uint64_t)star->stamp << 32 | (uint32_t)cell;
  size_t at = (size_t)((uint32_t)cell * 2654435769u) & (star->seen_capacity - 1);
  while (star->seen[at] >> 32 == star->stamp && star->seen[at] != entry)
  {
    at = (at + 1) & (star->seen_capacity - 1);
  }
  const size_t is_new = star->seen[at] != entry;
  star->seen[at] = entry;
  return is_new;
}

/* A larger table with the star's cells. Not 0: out of memory. */
static int grow_table(mlim_star* star)
{
  const size_t capacity = star->seen_capacity == 0 ? FIRST_TABLE : 2 * star->seen_capacity;
  uint64_t* seen = mlim_allocate_zeroed(capacity, sizeof *seen);
  if (seen == NULL)
  {
    return 1;
  }
  mlim_release(star->seen);
  star->seen = seen;
  star->seen_capacity = capacity;
  star->stamp = 1;
  for (size_t c = 0; c < star->cell_count; ++c)
  {
    add_seen(star, star->cells[c]);
  }
  return 0;
}

/* Room for all that one more cell may add. Not 0: out of memory. */
static int reserve(mlim_star* star)
{
  return (2 * (star->cell_count + 3) > star->seen_capacity && grow_table(star)) ||
         mlim_reserve(
           &star->cells, &star->cell_capacity, star->cell_count + 3, sizeof *star->cells) ||
         mlim_reserve(
           &star->edges, &star->edge_capacity, star->edge_count + 6, sizeof *star->edges) ||
         mlim_reserve(
           &star->facets, &star->facet_capacity, star->facet_count + 3, sizeof *star->facets);
}

/* For each vertex of a cell, the facets that have it, and the edges of these opposite to it. */
static const struct
{
  unsigned char facet;
  unsigned char edge[2];
} facets_at[4][3] = { { { 1, { 2, 3 } }, { 2, { 1, 3 } }, { 3, { 1, 2 } } },
  { { 0, { 2, 3 } }, { 2, { 0, 3 } }, { 3, { 0, 2 } } },
  { { 0, { 1, 3 } }, { 1, { 0, 3 } }, { 3, { 0, 1 } } },
  { { 0, { 1, 2 } }, { 1, { 0, 2 } }, { 2, { 0, 1 } } } };

/* The cells round one of the star: it is there itself, but they would be waited for when its turn comes. */
static void ask_round(const mlim_complex* complex, int32_t id)
{
  const int32_t* n = complex->cells[id].neighbors;
  for (int k = 0; k < 4; ++k)
  {
    mlim_prefetch(&complex->cells[n[k] == MLIM_NO_CELL ? id : n[k]]);
  }
}

/* Each facet of the star is seen from its two cells and taken from the one with the lower id. What is not
   taken is written all the same and written over by the next: branches here would be foretold wrong at
   every other facet, and cost more than all the rest. */
static void visit_cell(const mlim_complex* complex, int32_t id, int32_t vertex, mlim_star* star)
{
  const mlim_cell* cell = &complex->cells[id];
  const int32_t* v = cell->vertices;
  const int at = (v[1] == vertex) + 2 * (v[2] == vertex) + 3 * (v[3] == vertex);
  size_t cell_count = star->cell_count;
  size_t edge_count = star->edge_count;
  size_t facet_count = star->facet_count;
  for (int f = 0; f < 3; ++f)
  {
    const int k = facets_at[at][f].facet;
    const int32_t n = cell->neighbors[k];
    if (n == MLIM_NO_CELL)
    {
      continue;
    }
    const mlim_cell* other = &complex->cells[n];
    star->cells[cell_count] = n;
    cell_count += add_seen(star, n);
    ask_round(complex, n);
    const size_t is_first = id < n;
    star->facets[facet_count] = cell->facets[k];
    facet_count += is_first & (cell->facets[k] != 0);
    star->edges[edge_count] = v[facets_at[at][f].edge[0]];
    star->edges[edge_count + 1] = v[facets_at[at][f].edge[1]];
    edge_count += 2 * (is_first & (other->label != cell->label));
  }
  star->cell_count = cell_count;
  star->edge_count = edge_count;
  star->facet_count = facet_count;
}

static int gather(const mlim_complex* complex, int32_t vertex, mlim_star* star)
{
  star->cell_count = star->edge_count = star->facet_count = 0;
  if (reserve(star))
  {
    return 1;
  }
  if (++star->stamp == 0)
  {
    memset(star->seen, 0, star->seen_capacity * sizeof *star->seen);
    star->stamp = 1;
  }
  const int32_t first = complex->vertices[vertex].cell;
  add_seen(star, first);
  star->cells[star->cell_count++] = first;
  for (size_t c = 0; c < star->cell_count; ++c)
  {
    if (reserve(star))
    {
      return 1;
    }
    visit_cell(complex, star->cells[c], vertex, star);
  }
  return 0;
}

/* ---- the link as a graph ---- */

static int compare_ids(const void* a, const void* b)
{
  const int32_t x = *(const int32_t*)a;
  const int32_t y = *(const int32_t*)b;
  return (x > y) - (x < y);
}

/* By insertion: a link has about a dozen vertices, and qsort costs more than that. A far vertex or one
   amid specks may have thousands. */
static void sort_ids(int32_t* ids, size_t count)
{
  if (count > LONG_LINK)
  {
    qsort(ids, count, sizeof *ids, compare_ids);
    return;
  }
  for (size_t k = 1; k < count; ++k)
  {
    const int32_t id = ids[k];
    size_t at = k;
    for (; at > 0 && ids[at - 1] > id; --at)
    {
      ids[at] = ids[at - 1];
    }
    ids[at] = id;
  }
}

static int collect_link(mlim_star* star)
{
  if (mlim_reserve(&star->link, &star->link_capacity, star->edge_count, sizeof *star->link))
  {
    return 1;
  }
  star->link_count = star->edge_count;
  if (star->edge_count > 0)
  {
    memcpy(star->link, star->edges, star->edge_count * sizeof *star->link);
  }
  sort_ids(star->link, star->link_count);
  size_t kept = 0;
  for (size_t k = 0; k < star->link_count; ++k)
  {
    if (kept == 0 || star->link[kept - 1] != star->link[k])
    {
      star->link[kept++] = star->link[k];
    }
  }
  star->link_count = kept;
  /* Two numbers a link vertex: parent, degree. */
  return mlim_reserve(&star->parents, &star->parent_capacity, 2 * kept, sizeof *star->parents);
}

static size_t place_of(const mlim_star* star, int32_t vertex)
{
  size_t low = 0;
  size_t high = star->link_count;
  while (low + 1 < high)
  {
    const size_t middle = (low + high) / 2;
    low = star->link[middle] <= vertex ? middle : low;
    high = star->link[middle] <= vertex ? high : middle;
  }
  return low;
}

static int32_t root_of(int32_t* parents, int32_t k)
{
  while (parents[k] != k)
  {
    parents[k] = parents[parents[k]];
    k = parents[k];
  }
  return k;
}

static void join_link(mlim_star* star)
{
  int32_t* degree = star->parents + star->link_count;
  for (size_t k = 0; k < star->link_count; ++k)
  {
    star->parents[k] = (int32_t)k;
    degree[k] = 0;
  }
  for (size_t e = 0; e + 1 < star->edge_count; e += 2)
  {
    const int32_t a = (int32_t)place_of(star, star->edges[e]);
    const int32_t b = (int32_t)place_of(star, star->edges[e + 1]);
    ++degree[a];
    ++degree[b];
    const int32_t ra = root_of(star->parents, a);
    const int32_t rb = root_of(star->parents, b);
    star->parents[ra < rb ? rb : ra] = ra < rb ? ra : rb;
  }
}

static int is_curve_neighbor(
  const mlim_complex* complex, const mlim_ball_links* links, int32_t ball, int32_t vertex)
{
  const int32_t other = complex->vertices[vertex].ball;
  if (ball < 0 || other < 0)
  {
    return 0;
  }
  for (size_t k = links->offsets[ball]; k < links->offsets[ball + 1]; ++k)
  {
    if (links->neighbors[k] == other)
    {
      return 1;
    }
  }
  return 0;
}

static int is_contact(const mlim_complex* complex, int32_t vertex)
{
  const int32_t ball = complex->vertices[vertex].ball;
  return ball >= 0 && complex->balls->ball_curves[ball] == MLIM_CONTACT;
}

/* Neighbours on curves that are no contacts: a curve may end before a contact. */
static size_t count_neighbors(
  const mlim_complex* complex, const mlim_ball_links* links, int32_t ball)
{
  size_t count = 0;
  for (size_t k = links->offsets[ball]; k < links->offsets[ball + 1]; ++k)
  {
    count += complex->balls->ball_curves[links->neighbors[k]] != MLIM_CONTACT;
  }
  return count;
}

/* Sheets may meet at an edge between two balls of which one is a contact. */
static int is_contact_edge(const mlim_complex* complex, int32_t a, int32_t b)
{
  return complex->vertices[a].ball >= 0 && complex->vertices[b].ball >= 0 &&
         (is_contact(complex, a) || is_contact(complex, b));
}

int mlim_disk_is_ring(const int32_t* edges, size_t count)
{
  enum
  {
    MAX_EDGES = 32
  };
  if (count < 3 || count > MAX_EDGES)
  {
    return 0;
  }
  uint32_t is_passed = 1;
  int32_t at = edges[1];
  for (size_t step = 1; step < count; ++step)
  {
    size_t next = 0;
    size_t choices = 0;
    for (size_t e = 1; e < count; ++e)
    {
      const int goes_on = (edges[2 * e] == at) | (edges[2 * e + 1] == at);
      const size_t is_choice = (size_t)goes_on & ~(is_passed >> e) & 1;
      choices += is_choice;
      next = is_choice ? e : next;
    }
    if (choices != 1)
    {
      return 0;
    }
    is_passed |= (uint32_t)1 << next;
    at = edges[2 * next] == at ? edges[2 * next + 1] : edges[2 * next];
  }
  return at == edges[0];
}

/* A sheet's vertex has one cycle for its link. At a ball the link's branching points are exactly its
   neighbours on curves, each of them is there, and every part of the link hangs on one. At a contact
   sheets touch: its link may have any number of parts, and branch at any ball. */
static int holds(
  const mlim_complex* complex, const mlim_ball_links* links, int32_t vertex, mlim_star* star)
{
  join_link(star);
  const int32_t* degree = star->parents + star->link_count;
  const int32_t ball = complex->vertices[vertex].ball;
  size_t found = 0;
  size_t part_count = 0;
  for (size_t k = 0; k < star->link_count; ++k)
  {
    const int is_neighbor = is_curve_neighbor(complex, links, ball, star->link[k]);
    found += (size_t)(is_neighbor && !is_contact(complex, star->link[k]));
    const int may_branch = is_neighbor || is_contact_edge(complex, vertex, star->link[k]);
    if (may_branch ? degree[k] < 2 : degree[k] != 2)
    {
      return 0;
    }
    part_count += star->parents[k] == (int32_t)k;
  }
  if (ball < 0)
  {
    return part_count == 1;
  }
  if (is_contact(complex, vertex))
  {
    return 1;
  }
  size_t anchored = 0;
  for (size_t k = 0; k < star->link_count; ++k)
  {
    if (star->parents[k] != (int32_t)k)
    {
      continue;
    }
    int has_neighbor = 0;
    for (size_t j = 0; j < star->link_count && !has_neighbor; ++j)
    {
      has_neighbor = root_of(star->parents, (int32_t)j) == (int32_t)k &&
                     (is_contact(complex, star->link[j]) ||
                       is_curve_neighbor(complex, links, ball, star->link[j]));
    }
    anchored += (size_t)has_neighbor;
  }
  return anchored == part_count && found == count_neighbors(complex, links, ball);
}

/* Of the edges of the restricted facets. */
static mlim_status judge(const mlim_complex* complex, const mlim_ball_links* links, int32_t vertex,
  mlim_star* star, mlim_context* context, mlim_disk* out)
{
  *out = MLIM_DISK_EMPTY;
  if (complex->vertices[vertex].ball < 0 && mlim_disk_is_ring(star->edges, star->edge_count / 2))
  {
    *out = MLIM_DISK_HOLDS;
    return MLIM_OK;
  }
  if (collect_link(star))
  {
    return mlim_fail_memory(context, "a vertex's star");
  }
  if (star->edge_count > 0 || complex->vertices[vertex].ball >= 0)
  {
    *out = star->edge_count > 0 && holds(complex, links, vertex, star) ? MLIM_DISK_HOLDS
                                                                       : MLIM_DISK_FAILS;
  }
  return MLIM_OK;
}

mlim_status mlim_disk_check(const mlim_complex* complex, const mlim_ball_links* links,
  int32_t vertex, mlim_star* star, mlim_context* context, mlim_disk* out)
{
  *out = MLIM_DISK_EMPTY;
  return gather(complex, vertex, star) ? mlim_fail_memory(context, "a vertex's star")
                                       : judge(complex, links, vertex, star, context, out);
}

/* ---- the star under other labels ---- */

void mlim_fan_free(mlim_fan* fan)
{
  mlim_release(fan->facets);
  *fan = (mlim_fan){ 0 };
}

/* The facets round a vertex that a cell of its star has with cells of higher ids. */
static void add_facets(const mlim_complex* complex, int32_t id, int32_t vertex, mlim_fan* fan)
{
  const mlim_cell* cell = &complex->cells[id];
  const int32_t* v = cell->vertices;
  const int at = (v[1] == vertex) + 2 * (v[2] == vertex) + 3 * (v[3] == vertex);
  for (int f = 0; f < 3; ++f)
  {
    const int32_t other = cell->neighbors[facets_at[at][f].facet];
    if (other > id)
    {
      fan->facets[fan->count++] = (mlim_fan_facet){ .cells = { id, other },
        .edge = { v[facets_at[at][f].edge[0]], v[facets_at[at][f].edge[1]] } };
    }
  }
}

mlim_status mlim_fan_read(const mlim_complex* complex, int32_t vertex, mlim_star* star,
  mlim_context* context, mlim_fan* out)
{
  out->vertex = -1;
  out->count = 0;
  if (gather(complex, vertex, star) ||
      mlim_reserve(&out->facets, &out->capacity, 3 * star->cell_count, sizeof *out->facets))
  {
    return mlim_fail_memory(context, "a vertex's star");
  }
  for (size_t c = 0; c < star->cell_count; ++c)
  {
    add_facets(complex, star->cells[c], vertex, out);
  }
  out->vertex = vertex;
  return MLIM_OK;
}

mlim_status mlim_fan_check(const mlim_complex* complex, const mlim_ball_links* links,
  const mlim_fan* fan, mlim_star* star, mlim_context* context, mlim_disk* out)
{
  size_t count = 0;
  *out = MLIM_DISK_EMPTY;
  if (mlim_reserve(&star->edges, &star->edge_capacity, 2 * fan->count + 2, sizeof *star->edges))
  {
    return mlim_fail_memory(context, "a vertex's star");
  }
  for (size_t f = 0; f < fan->count; ++f)
  {
    const mlim_fan_facet* facet = &fan->facets[f];
    star->edges[count] = facet->edge[0];
    star->edges[count + 1] = facet->edge[1];
    count += complex->cells[facet->cells[0]].label != complex->cells[facet->cells[1]].label ? 2 : 0;
  }
  star->edge_count = count;
  return judge(complex, links, fan->vertex, star, context, out);
}
