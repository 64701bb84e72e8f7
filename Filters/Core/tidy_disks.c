#include "tidy_disks.h"

#include "memory.h"
#include "status.h"

enum
{
  UNKNOWN,
  HOLDS,
  FAILS
};

mlim_status tidy_disks_create(mlim_refinement* refinement, mlim_context* context, tidy_disks* out)
{
  const size_t count = refinement->complex.vertex_count;
  *out = (tidy_disks){ .refinement = refinement,
    .fans = mlim_allocate_zeroed(TIDY_FANS, sizeof *out->fans),
    .known = mlim_allocate_zeroed(count, 1),
    .changes = mlim_allocate_zeroed(count, 1) };
  if (out->fans == NULL || out->known == NULL || out->changes == NULL)
  {
    tidy_disks_free(out);
    return mlim_fail_memory(context, "mending the topology");
  }
  for (int k = 0; k < TIDY_FANS; ++k)
  {
    out->fans[k].vertex = -1;
  }
  return MLIM_OK;
}

void tidy_disks_free(tidy_disks* disks)
{
  for (int k = 0; k < TIDY_FANS && disks->fans != NULL; ++k)
  {
    mlim_fan_free(&disks->fans[k]);
  }
  mlim_star_free(&disks->star);
  mlim_release(disks->fans);
  mlim_release(disks->known);
  mlim_release(disks->changes);
  *disks = (tidy_disks){ 0 };
}

mlim_status tidy_disks_check(
  tidy_disks* disks, int32_t vertex, mlim_context* context, int* has_failed)
{
  const mlim_refinement* r = disks->refinement;
  mlim_disk disk = MLIM_DISK_HOLDS;
  mlim_fan* fan = &disks->fans[vertex & (TIDY_FANS - 1)];
  mlim_status status = fan->vertex == vertex
                         ? MLIM_OK
                         : mlim_fan_read(&r->complex, vertex, &disks->star, context, fan);
  if (status == MLIM_OK)
  {
    status = mlim_fan_check(&r->complex, &r->links, fan, &disks->star, context, &disk);
  }
  *has_failed = disk == MLIM_DISK_FAILS;
  return status;
}

mlim_status tidy_disks_ask(
  tidy_disks* disks, int32_t vertex, mlim_context* context, int* has_failed)
{
  const mlim_vertex* v = &disks->refinement->complex.vertices[vertex];
  unsigned char* known = &disks->known[vertex];
  if (!v->is_dirty)
  {
    *has_failed = v->is_broken;
    return MLIM_OK;
  }
  mlim_status status = MLIM_OK;
  *has_failed = *known == FAILS;
  if (*known == UNKNOWN)
  {
    status = tidy_disks_check(disks, vertex, context, has_failed);
    *known = status != MLIM_OK ? UNKNOWN : *has_failed ? FAILS : HOLDS;
  }
  return status;
}

void tidy_disks_update(tidy_disks* disks, int32_t cell)
{
  for (int k = 0; k < 4 && disks->known != NULL; ++k)
  {
    const mlim_complex* complex = &disks->refinement->complex;
    const int32_t v = complex->cells[cell].vertices[k];
    disks->known[v] = UNKNOWN;
    disks->changes[v] = disks->sweep;
  }
}

int tidy_disks_are_new(const tidy_disks* disks, int32_t cell)
{
  const mlim_complex* complex = &disks->refinement->complex;
  const mlim_cell* own = &complex->cells[cell];
  int most = 0;
  for (int k = 0; k < 4; ++k)
  {
    const mlim_cell* other = &complex->cells[own->neighbors[k]];
    const int32_t beyond = other->vertices[mlim_complex_index_apart(other, own)];
    most = disks->changes[own->vertices[k]] > most ? disks->changes[own->vertices[k]] : most;
    most = disks->changes[beyond] > most ? disks->changes[beyond] : most;
  }
  return most + 1 >= disks->sweep;
}
