/* Ties of integer data. Along x two indicators fall and rise by whole steps and are equal on four grid
   points, so there is a plateau three cells wide. */
#include "check.h"
#include "oracle.h"

#include <math.h>

enum
{
  NX = 10,
  NY = 6,
  NZ = 5,
  POINTS = NX * NY * NZ
};

static unsigned char left[POINTS];
static unsigned char right[POINTS];

static mlim_field* make_field(mlim_tie_breaking tie_breaking)
{
  static const unsigned char falling[NX] = { 9, 8, 7, 5, 5, 5, 5, 3, 2, 1 };
  static const unsigned char rising[NX] = { 1, 2, 3, 5, 5, 5, 5, 7, 8, 9 };
  for (int p = 0; p < POINTS; ++p)
  {
    left[p] = falling[p % NX];
    right[p] = rising[p % NX];
  }
  const mlim_array arrays[2] = { { .values = left, .type = MLIM_UINT8, .stride = 1, .id = 1 },
    { .values = right, .type = MLIM_UINT8, .stride = 1, .id = 2 } };
  const mlim_grid grid = { .dims = { NX, NY, NZ },
    .spacing = { 1, 1, 1 },
    .array_count = 2,
    .arrays = arrays,
    .tie_breaking = tie_breaking };
  mlim_field* field = NULL;
  CHECK(mlim_field_create(&grid, NULL, &field) == MLIM_OK);
  return field;
}

/* Where the line along x at (y, z) changes label; -1 unless it does exactly once, from 0 to 1. */
static double change_at(const mlim_field* field, double y, double z)
{
  const mlim_oracle oracle = { .field = field, .tolerance = 1e-9, .mode = MLIM_ORACLE_EXACT };
  const double start[3] = { 0.25, y, z };
  const double end[3] = { NX - 1.25, y, z };
  mlim_crossing crossing[4];
  const size_t count = mlim_oracle_crossings(&oracle, start, end, 4, crossing);
  return count == 1 && crossing[0].from == 0 && crossing[0].to == 1 ? crossing[0].point[0] : -1;
}

int main(void)
{
  mlim_field* smooth = make_field(MLIM_TIE_SMOOTH);
  mlim_field* lowest = make_field(MLIM_TIE_LOWEST_INDEX);
  for (double y = 0.3; y < NY - 1; y += 0.4)
  {
    for (double z = 0.2; z < NZ - 1; z += 0.6)
    {
      /* Half-way, since both sides are alike; a few sweeps more would come nearer. */
      CHECK(fabs(change_at(smooth, y, z) - 4.5) < 1e-3);
      /* Label 0 keeps the whole plateau. */
      CHECK(fabs(change_at(lowest, y, z) - 6) < 1e-6);
    }
  }
  mlim_field_free(smooth);
  mlim_field_free(lowest);
  return check_result();
}
