/* Labels of new cells and records of their facets. Insertions leave both undone; once a batch of them is
   through, all that is there is brought up to date: what came and went in between is never looked at, and
   what is left can be looked at in parallel.

   Looking needs nothing of the complex but a copy of the new cells and what is round them, the vertices'
   points and the records' sheets, which insertions leave alone. It can be done beside the next batch of insertions;
   labels and records come a batch later. Same records for any number of threads. */
#ifndef mlim_records_h
#define mlim_records_h

#include "dual.h"
#include "team.h"

enum
{
  MLIM_RECORD_PARTS = 64 /* at most */
};

/* A cell that was there before, as it was when it was taken down. */
typedef struct mlim_old_cell
{
  double center[3];
  int32_t id;
  int32_t label; /* MLIM_NO_LABEL: it is new as well, but its turn comes later */
  uint16_t clearance;
} mlim_old_cell;

typedef struct mlim_new_cell
{
  union
  {
    mlim_old_cell seen; /* by its neighbours */
    struct
    {
      double center[3];
      int32_t id;
      int32_t label;
      uint16_t clearance;
    };
  };
  int32_t vertices[4], facets[4];
  int32_t
    beyond[4]; /* new cell k: k; old cell k: -1 - k; INT32_MAX: nothing, or looked at from there */
} mlim_new_cell;

/* What is on its way. All 0 to begin with. */
typedef struct mlim_records
{
  mlim_new_cell* cells;
  size_t cell_count, cell_capacity;
  mlim_old_cell* old_cells;
  size_t old_capacity;
  int is_pending;   /* taken down, but not settled */
  mlim_dual* duals; /* room for all facets of the cells, part after part */
  size_t dual_capacity;
  size_t part_count;
  uint32_t dual_counts[MLIM_RECORD_PARTS];
  const mlim_complex* complex; /* borrowed */
  const mlim_oracle* oracle;   /* of the complex, which is not asked for them beside insertions */
  const mlim_vertex* vertices; /* the same */
  const mlim_facet* facets;    /* the same */
} mlim_records;

void mlim_records_free(mlim_records* records);

/* Takes down the cells made since the last time, to be looked at in parts, more of them if the team has others to
   do so. Nothing may be on its way. */
mlim_status mlim_records_take(
  mlim_records* records, mlim_complex* complex, mlim_team* team, mlim_context* context);

/* Labels parts `begin` to `end` of what is on its way; looks along their duals, parts up to `labelled` having their
   labels. Parts may be looked at at the same time, and beside insertions into the complex as long as no vertex
   moves. */
void mlim_records_label(mlim_records* records, size_t begin, size_t end);
void mlim_records_look(mlim_records* records, size_t begin, size_t end, size_t labelled);

/* The duals of a part that has been looked at: those that cross, or contradict a record. */
typedef struct mlim_duals
{
  size_t count;
  mlim_dual* all;
} mlim_duals;
mlim_duals mlim_records_duals(const mlim_records* records, size_t part);

/* Gives the complex the labels and records of what is on its way, as far as cells and facets are still there.
   All parts have been looked at. The duals stay until the next ones are taken, and tell their records. */
mlim_status mlim_records_settle(
  mlim_records* records, mlim_complex* complex, mlim_context* context);

/* All of it: what is on its way and what is new. fresh lists the records. `done` is reported as the share of the
   surface's stage. */
mlim_status mlim_records_update(
  mlim_records* records, mlim_complex* complex, double done, mlim_context* context);

/* Whether a live record's crossing still lies on its dual, which insertions since the last time may have
   shortened. 0 also where that is not known before the next time. */
int mlim_records_hold(const mlim_complex* complex, const mlim_facet* facet);

#endif
