/* The facets between two labels of eight cells round a vertex, however they are labelled, and after labels
   have changed. */
#include "boundary.h"
#include "check.h"

#include <string.h>

enum
{
  CELLS = 8
};

/* Cell k is the octant whose bits say on which side it lies; its neighbour k + 1 is across axis k. */
static void set_up(mlim_cell cells[CELLS], unsigned labelling)
{
  memset(cells, 0, CELLS * sizeof *cells);
  for (int32_t c = 0; c < CELLS; ++c)
  {
    cells[c].label = (int32_t)(labelling >> c & 1u);
    cells[c].neighbors[0] = MLIM_NO_CELL;
    for (int k = 0; k < 3; ++k)
    {
      cells[c].neighbors[k + 1] = c ^ 1 << k;
    }
  }
}

static void compare(const mlim_cell cells[CELLS], const mlim_boundary* boundary)
{
  mlim_boundary_facet list[4 * CELLS];
  size_t count = 0;
  mlim_boundary_list(boundary, list);
  for (int32_t c = 0; c < CELLS; ++c)
  {
    for (int32_t k = 0; k < 4; ++k)
    {
      const int32_t other = cells[c].neighbors[k];
      const int is_between =
        cells[c].vertices[0] >= 0 && other != MLIM_NO_CELL && cells[other].label != cells[c].label;
      CHECK((boundary->sides[c] >> k & 1) == is_between);
      CHECK((boundary->sides[c] >> (MLIM_FIRST_SHIFT + k) & 1) == (is_between && c < other));
      if (is_between && c < other)
      {
        CHECK(list[count].cell == c && list[count].index == k);
        ++count;
      }
    }
  }
  CHECK_COUNT(mlim_boundary_count(boundary), count);
}

static void test_labelling(unsigned labelling)
{
  mlim_cell cells[CELLS];
  set_up(cells, labelling);
  const mlim_complex complex = { .cells = cells, .cell_count = CELLS };
  mlim_boundary boundary;
  CHECK(mlim_boundary_find(&complex, 0, NULL, &boundary) == MLIM_OK);
  compare(cells, &boundary);
  for (int32_t c = 0; c < CELLS; ++c)
  {
    cells[c].label =
      2 - cells[c].label; /* 0 and 1 become 2 and 1: the zeros' facets stay, or appear */
    mlim_boundary_update(&boundary, &complex, c);
    compare(cells, &boundary);
  }
  mlim_boundary_free(&boundary);
}

/* Ids without a cell have no facets, whatever labels they had. */
static void test_dead(void)
{
  mlim_cell cells[CELLS];
  set_up(cells, 0x96);
  for (int32_t c = 1; c < CELLS; ++c)
  {
    cells[c].vertices[0] = -1;
  }
  for (int k = 0; k < 4; ++k)
  {
    cells[0].neighbors[k] = MLIM_NO_CELL;
  }
  const mlim_complex complex = { .cells = cells, .cell_count = CELLS };
  mlim_boundary boundary;
  CHECK(mlim_boundary_find(&complex, 0, NULL, &boundary) == MLIM_OK);
  CHECK_COUNT(mlim_boundary_count(&boundary), 0);
  mlim_boundary_free(&boundary);
}

int main(void)
{
  for (unsigned labelling = 0; labelling < 1u << CELLS; ++labelling)
  {
    test_labelling(labelling);
  }
  test_dead();
  return check_result();
}
