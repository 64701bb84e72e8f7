/* The host stops at any call of its progress function; fractions never fall. */
#include "shapes.h"

typedef struct host
{
  size_t calls;
  size_t stop_at; /* the call that cancels, from 1; 0: none */
  mlim_stage stage;
  double fraction;
  size_t bad;        /* fractions outside [0, 1] or below the last one of the stage */
  size_t late;       /* calls after the one that cancelled */
  unsigned finished; /* bit of each stage that has reported 1 */
} host;

static int progress(void* user, mlim_stage stage, double fraction)
{
  host* h = (host*)user;
  ++h->calls;
  h->late += h->stop_at > 0 && h->calls > h->stop_at;
  h->bad += !(fraction >= 0 && fraction <= 1) || stage < h->stage || stage >= MLIM_STAGE_END;
  h->bad += stage == h->stage && fraction < h->fraction;
  h->stage = stage;
  h->fraction = fraction;
  h->finished |= fraction >= 1 ? 1u << stage : 0;
  return h->calls == h->stop_at;
}

static host run_host(const image* im, size_t stop_at)
{
  host h = { .stop_at = stop_at };
  mlim_context context = { .progress = progress, .user = &h };
  const mlim_options options = run_options(1);
  run r;
  const mlim_status status = run_volume(&im->grid, &options, &context, &r);
  if (stop_at == 0)
  {
    CHECK(status == MLIM_OK);
  }
  else
  {
    CHECK(status == MLIM_CANCELLED);
    CHECK(context.message[0] != '\0');
    const mlim_stage stage = h.stage >= MLIM_STAGE_CERTIFICATE ? MLIM_STAGE_SURFACE : h.stage;
    CHECK(run_is_empty_from(&r, stage));
  }
  CHECK_COUNT(h.bad, 0);
  CHECK_COUNT(h.late, 0);
  run_free(&r);
  return h;
}

static void test_shape(int kind)
{
  const int before = check_failures;
  const shape s = shape_of(kind);
  image* im = shape_sample(&s);
  const host whole = run_host(im, 0);
  CHECK(whole.calls >= 2 * MLIM_STAGE_END); /* each stage has a beginning and an end */
  /* There is no label map. */
  const unsigned all = ((1u << MLIM_STAGE_END) - 1) & ~(1u << MLIM_STAGE_INDICATORS);
  const unsigned open_ended = 1u << MLIM_STAGE_SURFACE; /* its end is where refinement ends */
  CHECK((whole.finished | open_ended) == all);
  for (size_t k = 1; k <= whole.calls; ++k)
  {
    const host h = run_host(im, k);
    CHECK_COUNT(h.calls, k);
  }
  image_free(im);
  shape_report(s.name, before);
}

int main(void)
{
  test_shape(SHAPE_EMPTY);
  test_shape(SHAPE_HALVES);
  test_shape(SHAPE_OCTANTS);
  test_shape(SHAPE_CUT_SPHERE);
  return check_result();
}
