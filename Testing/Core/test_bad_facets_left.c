/* Facets that nothing keeps from being refined were left bad: the record of a facet had been stored
   with the wrong side of a neighbour that borders an insertion's zone twice, because the neighbour was
   asked for the id of a dead cell that was in use again. Noise brings such zones about. */
#include "audit.h"
#include "check.h"
#include "random_field.h"
#include "shapes.h"
#include "triangle.h"

/* Of the triangles. */
static const double FEW = 3e-4;

static random_field f;

/* Triangles above the radius-edge bound without a ball's vertex. */
static size_t count_bad(const run* r)
{
  size_t count = 0;
  for (size_t t = 0; t < r->mesh.triangle_count; ++t)
  {
    const int32_t* v = r->mesh.triangles + 3 * t;
    const double* p = audit_point(&r->mesh, v[0]);
    const double* q = audit_point(&r->mesh, v[1]);
    const double* o = audit_point(&r->mesh, v[2]);
    int has_ball = 0;
    for (int k = 0; k < 3; ++k)
    {
      has_ball = has_ball || r->mesh.node_types[v[k]] % MLIM_NODE_ON_BOX > MLIM_NODE_INTERFACE;
    }
    count += !has_ball && mlim_radius_edge_ratio_squared(p, q, o) > 1 + 1e-9;
  }
  return count;
}

int main(void)
{
  for (uint64_t seed = 1; seed <= 2; ++seed)
  {
    random_field_make(&f, 3, 7, 0, seed);
    run r;
    const mlim_options options = run_options(0.7);
    CHECK(run_grid(&f.grid, &options, NULL, &r) == MLIM_OK);
    /* Away from balls every point that mends a triangle's size or ratio may be inserted, but in films that
       are too thin for any vertex. */
    CHECK_BELOW((double)count_bad(&r), FEW * (double)r.mesh.triangle_count);
    CHECK(r.mesh.report.unresolved_size_count == 0);
    CHECK(r.mesh.certificate.open_edge_count == 0);
    run_free(&r);
  }
  return check_result();
}
