/* Which stars are no disks, asked again and again while few labels change. Private to tidying. */
#ifndef mlim_tidy_disks_h
#define mlim_tidy_disks_h

#include "tidy.h"

enum
{
  TIDY_FANS =
    64 /* a power of two: the cells that are tried one after the other have fewer vertices */
};

typedef struct tidy_disks
{
  mlim_refinement* refinement; /* borrowed */
  mlim_star star;
  mlim_fan* fans; /* TIDY_FANS: those looked at last, by vertex */
  unsigned char*
    known; /* a vertex that has become dirty: whether its disk fails, if that is known */
  unsigned char* changes; /* a vertex: the sweep in which a label of its star was last changed */
  unsigned char sweep;
} tidy_disks;

/* Once all disks are settled. */
mlim_status tidy_disks_create(mlim_refinement* refinement, mlim_context* context, tidy_disks* out);
void tidy_disks_free(tidy_disks* disks);

/* Checks the disk of a vertex, as the labels are now. */
mlim_status tidy_disks_check(
  tidy_disks* disks, int32_t vertex, mlim_context* context, int* has_failed);

/* The same without a check for what is known. Not while labels are tried. */
mlim_status tidy_disks_ask(
  tidy_disks* disks, int32_t vertex, mlim_context* context, int* has_failed);

/* A cell has a new label for good: the stars of its vertices have changed. Nothing before the disks are made. */
void tidy_disks_update(tidy_disks* disks, int32_t cell);

/* Whether a star of a cell's or its neighbours' vertices has changed in this sweep or the one before. */
int tidy_disks_are_new(const tidy_disks* disks, int32_t cell);

#endif
