/* The same input gives the same bytes: again, at other addresses, with work in any order, and with any number
   of threads. */
#include "shapes.h"

#include <pthread.h>

/* FNV-1a, 64 bits. */
static uint64_t hash_bytes(uint64_t hash, const void* data, size_t size)
{
  const unsigned char* bytes = (const unsigned char*)data;
  for (size_t k = 0; k < size; ++k)
  {
    hash = (hash ^ bytes[k]) * 1099511628211u;
  }
  return hash;
}

static uint64_t hash_sets(uint64_t h, const mlim_sets* s)
{
  h = hash_bytes(h, &s->count, sizeof s->count);
  h = hash_bytes(h, s->offsets, (s->count + 1) * sizeof *s->offsets);
  return hash_bytes(h, s->labels, s->offsets[s->count] * sizeof *s->labels);
}

static uint64_t hash_curves(uint64_t h, const mlim_curves* c)
{
  h = hash_bytes(h, c->points, 3 * c->point_count * sizeof *c->points);
  h = hash_bytes(h, c->curve_offsets, (c->curve_count + 1) * sizeof *c->curve_offsets);
  h = hash_bytes(h, c->curve_points, c->curve_offsets[c->curve_count] * sizeof *c->curve_points);
  h = hash_bytes(h, c->curve_sets, c->curve_count * sizeof *c->curve_sets);
  h = hash_bytes(h, c->junction_points, c->junction_count * sizeof *c->junction_points);
  h = hash_bytes(h, c->junction_sets, c->junction_count * sizeof *c->junction_sets);
  return hash_sets(h, &c->sets);
}

static uint64_t hash_balls(uint64_t h, const mlim_balls* b)
{
  h = hash_bytes(h, b->centers, 3 * b->ball_count * sizeof *b->centers);
  h = hash_bytes(h, b->radii, b->ball_count * sizeof *b->radii);
  h = hash_bytes(h, b->ball_curves, b->ball_count * sizeof *b->ball_curves);
  h = hash_bytes(h, b->ball_sets, b->ball_count * sizeof *b->ball_sets);
  h = hash_bytes(h, b->edges, 2 * b->edge_count * sizeof *b->edges);
  h = hash_bytes(h, b->edge_curves, b->edge_count * sizeof *b->edge_curves);
  return hash_sets(h, &b->sets);
}

static uint64_t hash_mesh(uint64_t h, const mlim_mesh* m)
{
  h = hash_bytes(h, m->vertices, 3 * m->vertex_count * sizeof *m->vertices);
  h = hash_bytes(h, m->node_types, m->vertex_count * sizeof *m->node_types);
  h = hash_bytes(h, m->label_counts, m->vertex_count * sizeof *m->label_counts);
  h = hash_bytes(h, m->triangles, 3 * m->triangle_count * sizeof *m->triangles);
  h = hash_bytes(h, m->triangle_labels, 2 * m->triangle_count * sizeof *m->triangle_labels);
  h = hash_bytes(h, m->triangle_faces, m->triangle_count * sizeof *m->triangle_faces);
  h = hash_bytes(h, m->triangle_patches, m->triangle_count * sizeof *m->triangle_patches);
  h = hash_bytes(h, m->edges, 2 * m->edge_count * sizeof *m->edges);
  h = hash_bytes(h, m->edge_curves, m->edge_count * sizeof *m->edge_curves);
  h = hash_bytes(h, m->junctions, m->junction_count * sizeof *m->junctions);
  h = hash_bytes(h, m->volumes, m->label_count * sizeof *m->volumes);
  h = hash_bytes(h, &m->report, sizeof m->report);
  return hash_bytes(h, &m->certificate, sizeof m->certificate);
}

static uint64_t hash_volume(uint64_t h, const mlim_volume* v)
{
  h = hash_bytes(h, v->vertices, 3 * v->vertex_count * sizeof *v->vertices);
  h = hash_bytes(h, v->cells, 4 * v->cell_count * sizeof *v->cells);
  h = hash_bytes(h, v->cell_labels, v->cell_count * sizeof *v->cell_labels);
  h = hash_bytes(h, v->label_volumes, v->label_count * sizeof *v->label_volumes);
  return hash_bytes(h, &v->report, sizeof v->report);
}

typedef struct digest
{
  uint64_t curves, balls, mesh, volume;
} digest;

static digest make(int kind, mlim_context* context)
{
  const shape s = shape_of(kind);
  const mlim_options options = run_options(1);
  image* im = shape_sample(&s);
  run r;
  digest d = { 14695981039346656037u, 14695981039346656037u, 14695981039346656037u,
    14695981039346656037u };
  const mlim_status status = run_volume(&im->grid, &options, context, &r);
  CHECK(status == MLIM_OK);
  if (status == MLIM_OK)
  {
    d.curves = hash_curves(d.curves, &r.curves);
    d.balls = hash_balls(d.balls, &r.balls);
    d.mesh = hash_mesh(d.mesh, &r.mesh);
    d.volume = hash_volume(d.volume, &r.volume);
  }
  run_free(&r);
  image_free(im);
  return d;
}

static void compare(const digest* a, const digest* b)
{
  CHECK(a->curves == b->curves);
  CHECK(a->balls == b->balls);
  CHECK(a->mesh == b->mesh);
  CHECK(a->volume == b->volume);
}

/* ---- other orders of parallel work ---- */

static void whole(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  body(job, 0, count);
}

/* One item a range, the last one first. */
static void backwards(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  for (size_t k = count; k > 0; --k)
  {
    body(job, k - 1, k);
  }
}

/* Pieces of 1, 2, 3, ... items: those of odd number first, then the others. */
static void pieces(void* user, size_t count, mlim_body body, void* job)
{
  (void)user;
  for (size_t parity = 1; parity < 3; ++parity)
  {
    size_t begin = 0;
    for (size_t length = 1; begin < count; ++length)
    {
      const size_t end = begin + length < count ? begin + length : count;
      if (length % 2 == parity % 2)
      {
        body(job, begin, end);
      }
      begin = end;
    }
  }
}

/* ---- threads ---- */

enum
{
  MAX_THREADS = 3
};

/* Small ranges, which each thread takes as it comes to them. */
typedef struct shared_work
{
  pthread_mutex_t lock;
  size_t next, count, step;
  mlim_body body;
  void* job;
} shared_work;

static void* take_ranges(void* data)
{
  shared_work* work = data;
  for (;;)
  {
    pthread_mutex_lock(&work->lock);
    const size_t begin = work->next;
    const size_t left = work->count - begin;
    const size_t end = begin + (left < work->step ? left : work->step);
    work->next = end;
    pthread_mutex_unlock(&work->lock);
    if (begin == end)
    {
      return NULL;
    }
    work->body(work->job, begin, end);
  }
}

/* `user`: how many threads. */
static void on_threads(void* user, size_t count, mlim_body body, void* job)
{
  const int threads = *(const int*)user;
  shared_work work = { .count = count, .step = count / 16 + 1, .body = body, .job = job };
  pthread_t others[MAX_THREADS];
  CHECK(pthread_mutex_init(&work.lock, NULL) == 0);
  for (int t = 1; t < threads; ++t)
  {
    CHECK(pthread_create(&others[t], NULL, take_ranges, &work) == 0);
  }
  take_ranges(&work);
  for (int t = 1; t < threads; ++t)
  {
    CHECK(pthread_join(others[t], NULL) == 0);
  }
  pthread_mutex_destroy(&work.lock);
}

static void test_shape(int kind)
{
  enum
  {
    BLOCKS = 1000
  };
  const int before = check_failures;
  const digest first = make(kind, NULL);
  const digest second = make(kind, NULL);
  compare(&first, &second);
  /* Holes of many sizes in the heap, filled with anything but zeros. */
  static void* blocks[BLOCKS];
  for (size_t k = 0; k < BLOCKS; ++k)
  {
    blocks[k] = malloc(16 + k * 61 % 5000);
    memset(blocks[k], 0xa5, 16 + k * 61 % 5000);
  }
  for (size_t k = 0; k < BLOCKS; k += 2)
  {
    free(blocks[k]);
  }
  const digest third = make(kind, NULL);
  compare(&first, &third);
  for (size_t k = 1; k < BLOCKS; k += 2)
  {
    free(blocks[k]);
  }
  void (*const orders[])(void*, size_t, mlim_body, void*) = { whole, backwards, pieces };
  for (size_t k = 0; k < sizeof orders / sizeof *orders; ++k)
  {
    mlim_context context = { .parallel_for = orders[k] };
    const digest other = make(kind, &context);
    compare(&first, &other);
  }
  for (int threads = 1; threads <= MAX_THREADS; ++threads)
  {
    mlim_context context = { .parallel_for = on_threads, .user = &threads };
    const digest other = make(kind, &context);
    compare(&first, &other);
  }
  shape_report(shape_of(kind).name, before);
}

int main(void)
{
  for (int kind = 0; kind < SHAPE_COUNT; ++kind)
  {
    test_shape(kind);
  }
  return check_result();
}
