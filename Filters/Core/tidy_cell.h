/* What is wrong with single cells and facets of the complex, for tidying. Private to its files. */
#ifndef mlim_tidy_cell_h
#define mlim_tidy_cell_h

#include "tidy.h"

/* The cells round the box keep their label. Any other lies in the box, also if its power centre does
   not, and may have every label: caps are the facets next to frozen cells, flat whatever happens. */
int tidy_is_frozen(const mlim_complex* complex, const mlim_cell* cell);

/* Number of vertices of a facet that are not on the sheet between two labels; 0 for equal ones. */
int tidy_stray_count(
  const mlim_complex* complex, const mlim_cell* cell, int index, int32_t label, int32_t other);

/* 1 for a facet between two labels whose shape is worse than asked for, away from balls. */
int tidy_is_misshapen(const mlim_refinement* r, const mlim_cell* cell, int index);

/* Vertices of the cell's facets that are off their sheets if it had this label. */
int tidy_cell_strays(const mlim_complex* complex, int32_t id, int32_t label);

/* The label for a cell that leaves the fewest strays, among its neighbours', its vertices' and its own. */
int32_t tidy_best_label(const mlim_complex* complex, int32_t id);

/* Facets of a cell that are misshapen. */
int tidy_cell_misshapen(const mlim_refinement* r, int32_t id);

/* The label beyond a facet, for the cell to take: not from outside the box, so that caps stay flat. */
int32_t tidy_label_beyond(const mlim_complex* complex, int32_t id, int index);

#endif
