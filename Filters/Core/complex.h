/* The restricted Delaunay complex: the triangulation's cells with their labels, and a record of
   every facet whose dual Voronoi edge crosses an interface. Dey, Janoos, Levine, section 3.2.

   A cell has the label of its power centre. A facet is restricted if its two cells differ in label;
   it is recorded also if they do not but its dual crosses an interface all the same.

   An insertion only shortens the duals of the facets round its zone; a removal, which lengthens them, leaves
   nothing known about them. So a dual that was found free
   of crossings stays so, and a single crossing stays where it is or vanishes: its record passes from
   the dead cell to the new one, until records.h finds that the labels contradict it. */
#ifndef mlim_complex_h
#define mlim_complex_h

#include "delaunay.h"
#include "oracle.h"

/* Label of a cell that was made since the records were brought up to date; below it: records.h is at it. */
enum
{
  MLIM_NO_LABEL = -1
};

typedef enum mlim_vertex_kind
{
  MLIM_VERTEX_FAR,
  MLIM_VERTEX_BALL,    /* a weighted point on a curve */
  MLIM_VERTEX_SURFACE, /* a point on a sheet */
  MLIM_VERTEX_INSIDE   /* of the volume alone */
} mlim_vertex_kind;

typedef struct mlim_facet
{
  double crossing[3];        /* the farthest one from the facet's vertices */
  mlim_sheet sheet;          /* crossed there */
  unsigned char is_multiple; /* crosses more often than its cells' labels tell; other threads ask */
  unsigned char index : 2;
  unsigned char is_alive : 1;
  unsigned char is_judged : 1;   /* for the loop, which looks at each facet once */
  unsigned char is_settled : 1;  /* for verification, which does so too */
  unsigned char is_measured : 1; /* for it too: it was in a skin */
  unsigned char is_good : 1;     /* if it is judged: by all criteria, and without a ball vertex */
  int32_t cell;                  /* facet `index` of this cell */
  uint32_t generation;           /* counts the uses of this record */
} mlim_facet;

typedef struct mlim_complex
{
  mlim_oracle oracle;
  const mlim_balls* balls; /* borrowed */
  double* distance_shares; /* a label: part of facet_distance allowed at its sheets; 1 at first */
  mlim_delaunay* delaunay;
  mlim_vertex* vertices; /* borrowed from the triangulation */
  size_t vertex_count;
  mlim_cell* cells; /* borrowed from the triangulation, once all is recorded; dead ones too */
  const mlim_power_sphere* spheres; /* of the cells, also borrowed */
  size_t cell_count;
  mlim_facet* facets; /* record 0 is none */
  size_t facet_count, facet_capacity;
  int32_t* free_facets;
  size_t free_count, free_capacity;
  int32_t* made; /* cells made since the records were brought up to date; dead or twice, some */
  size_t made_count, made_capacity;
  int32_t* fresh; /* records that were not judged when they were made */
  size_t fresh_count, fresh_capacity;
  int32_t* dirty; /* vertices with is_dirty */
  size_t dirty_count, dirty_capacity;
  size_t vertex_limit;     /* with the far ones */
  mlim_delaunay_zone zone; /* of the last probe */
  mlim_vertex pending;
  uint32_t stamp;
} mlim_complex;

/* An empty complex round the box of the field. */
mlim_status mlim_complex_create(
  const mlim_oracle* oracle, const mlim_balls* balls, mlim_context* context, mlim_complex* out);
void mlim_complex_free(mlim_complex* complex);

/* The records are needed no more: the cells and vertices stay. */
void mlim_complex_free_records(mlim_complex* complex);

/* Looks where a vertex would go; *is_found: it can be inserted. start and kind as in
   mlim_delaunay_find. */
mlim_status mlim_complex_probe(mlim_complex* complex, const mlim_vertex* vertex, int32_t start,
  mlim_delaunay_start kind, mlim_context* context, int* is_found);

/* The smallest power distance of the point of the last probe, which was found, to all vertices: a surface
   point's squared distance to the nearest one without weight. Only once all is recorded. */
double mlim_complex_power(const mlim_complex* complex);

/* Inserts the vertex of the last probe. Its cells have no labels, and their facets no records but those
   that they inherit, until records.h brings them up to date. MLIM_VERTEX_LIMIT, and nothing changes, when
   that many vertices are there. */
mlim_status mlim_complex_commit(mlim_complex* complex, mlim_context* context);

/* mlim_delaunay_reserve for the complex's vertices. */
mlim_status mlim_complex_reserve(mlim_complex* complex, size_t count, mlim_context* context);

/* Takes over all cells that are there. For after a first series of insertions; until then commits leave
   them to the triangulation. */
mlim_status mlim_complex_take_all(mlim_complex* complex, mlim_context* context);

/* Takes out the marked vertices, one byte each and no far one; the others close up (delaunay.h). All has to be
   recorded and no vertex dirty, as after a run; it is to be brought up to date afterwards, as after
   insertions. */
mlim_status mlim_complex_remove(
  mlim_complex* complex, const unsigned char* is_marked, double done, mlim_context* context);

/* Borrows the vertices anew after an insertion: the new one has the kind, ball and sheet of `last`. */
void mlim_complex_borrow_vertices(mlim_complex* complex, const mlim_vertex* last);

/* Borrows the cells anew after an insertion, and notes one of them with its vertices. Its label is 0 at first.
   For what goes in without being recorded: the inside of volumes. */
void mlim_complex_borrow_cells(mlim_complex* complex);
void mlim_complex_take_cell(mlim_complex* complex, int32_t cell);

/* The same for cells to be recorded: borrows them, and makes room to note so many of them; they have no label
   before the next update. */
mlim_status mlim_complex_expect_cells(mlim_complex* complex, size_t count, mlim_context* context);
void mlim_complex_take_new_cell(mlim_complex* complex, int32_t cell);

/* Notes that a vertex's star has changed; that of all vertices of a facet; that a cell's label was changed
   from outside, and with it the stars of its vertices. */
void mlim_complex_touch_vertex(mlim_complex* complex, int32_t vertex);
void mlim_complex_touch_facet(mlim_complex* complex, int32_t cell, int index);
void mlim_complex_touch_cell(mlim_complex* complex, int32_t cell);

/* The record's place is free for another. */
void mlim_complex_kill_record(mlim_complex* complex, int32_t record);

/* Vertices whose disk failed at the last look. */
size_t mlim_complex_count_broken(const mlim_complex* complex);

/* The three vertices of facet `index` of a cell, so that its normal points out of the cell. */
void mlim_complex_facet_vertices(
  const mlim_complex* complex, int32_t cell, int index, int32_t out[3]);

/* Index in `cell` of the vertex that its neighbour `other` does not have: their common facet. Asked
   for by the neighbours' ids it could be wrong, since the id of a dead cell may be in use again. */
static inline int mlim_complex_index_apart(const mlim_cell* cell, const mlim_cell* other)
{
  for (int k = 0; k < 3; ++k)
  {
    const int32_t v = cell->vertices[k];
    if (v != other->vertices[0] && v != other->vertices[1] && v != other->vertices[2] &&
        v != other->vertices[3])
    {
      return k;
    }
  }
  return 3;
}

/* Nothing that is inserted round a facet changes that. */
static inline int mlim_complex_is_good(const mlim_facet* facet)
{
  return facet->is_judged && facet->is_good;
}

/* A cell's power centre. */
static inline const double* mlim_complex_center(const mlim_complex* complex, int32_t cell)
{
  return complex->spheres[cell].center;
}

/* The face of the box in which facet `index` of a cell lies, -1 for one inside the box. */
int32_t mlim_complex_face(const mlim_complex* complex, int32_t cell, int index);

/* Whether a sheet passes through a vertex: it is the vertex's own, or belongs to its curve. */
int mlim_complex_is_on_sheet(
  const mlim_complex* complex, const mlim_vertex* vertex, const mlim_sheet* sheet);

#endif
