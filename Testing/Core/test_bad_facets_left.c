/* Facets that nothing keeps from being refined were left bad: the record of a facet had been stored
   with the wrong side of a neighbour that borders an insertion's zone twice, because the neighbour was
   asked for the id of a dead cell that was in use again. Noise brings such zones about. */
#include "check.h"
#include "random_field.h"
#include "shapes.h"

static random_field f;

int main(void)
{
  for (uint64_t seed = 1; seed <= 2; ++seed)
  {
    random_field_make(&f, 3, 7, 0, seed);
    run r;
    const mlim_options options = run_options(0.7);
    CHECK(run_grid(&f.grid, &options, NULL, &r) == MLIM_OK);
    /* Away from balls every point that mends a size or a ratio may be inserted. */
    CHECK(r.mesh.report.unresolved_ratio_count == 0);
    CHECK(r.mesh.report.unresolved_size_count == 0);
    CHECK(r.mesh.certificate.open_edge_count == 0);
    run_free(&r);
  }
  return check_result();
}
