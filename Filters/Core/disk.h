/* The disk condition: the restricted facets round a vertex form one disk on a sheet, half-disks
   along the curve at a curve's vertex, and a fan between the curves at a junction. */
#ifndef mlim_disk_h
#define mlim_disk_h

#include "complex.h"

/* Neighbours of each ball on its curves. */
typedef struct mlim_ball_links
{
  size_t* offsets;    /* ball_count + 1 */
  int32_t* neighbors; /* balls */
} mlim_ball_links;

mlim_status mlim_ball_links_create(
  const mlim_balls* balls, mlim_context* context, mlim_ball_links* out);
void mlim_ball_links_free(mlim_ball_links* links);

/* Memory that checks use again and again; all 0 to begin with. */
typedef struct mlim_star
{
  int32_t* cells;
  size_t cell_count, cell_capacity;
  uint64_t* seen;       /* table of the cells: stamp << 32 | cell */
  size_t seen_capacity; /* a power of two */
  uint32_t stamp;
  int32_t* edges; /* the facets' edges opposite to the vertex, 2 vertices each */
  size_t edge_count, edge_capacity;
  int32_t* facets; /* records in the star */
  size_t facet_count, facet_capacity;
  int32_t* parents; /* union-find over the link's vertices */
  size_t parent_capacity;
  int32_t* link; /* the link's vertices, ascending */
  size_t link_count, link_capacity;
} mlim_star;

void mlim_star_free(mlim_star* star);

typedef enum mlim_disk
{
  MLIM_DISK_HOLDS,
  MLIM_DISK_EMPTY, /* the vertex has no restricted facet */
  MLIM_DISK_FAILS
} mlim_disk;

/* Whether the edges, 2 vertices each, are one cycle that passes no vertex twice: nearly every link is, and
   that is seen without sorting. 0 also for one with many edges. */
int mlim_disk_is_ring(const int32_t* edges, size_t count);

/* Checks one vertex; star->facets receives its records. Changes nothing but the star. */
mlim_status mlim_disk_check(const mlim_complex* complex, const mlim_ball_links* links,
  int32_t vertex, mlim_star* star, mlim_context* context, mlim_disk* out);

/* The facets of a vertex's star, restricted or not: where labels alone change, the star need not be
   gathered again to look at its disk. To begin with without a vertex, the rest 0. */
typedef struct mlim_fan_facet
{
  int32_t cells[2];
  int32_t edge[2]; /* opposite to the vertex */
} mlim_fan_facet;

typedef struct mlim_fan
{
  int32_t vertex; /* -1: not read */
  mlim_fan_facet* facets;
  size_t count, capacity;
} mlim_fan;

void mlim_fan_free(mlim_fan* fan);
mlim_status mlim_fan_read(const mlim_complex* complex, int32_t vertex, mlim_star* star,
  mlim_context* context, mlim_fan* out);

/* As mlim_disk_check, with the labels as they are now. Of the star it uses the edges alone. */
mlim_status mlim_fan_check(const mlim_complex* complex, const mlim_ball_links* links,
  const mlim_fan* fan, mlim_star* star, mlim_context* context, mlim_disk* out);

#endif
