#include "tie.h"

#include <math.h>
#include <string.h>

enum
{
  MAX_STEPS = 4 /* Gauss-Newton from close by: two steps reach 1e-6 of a cell, four do no harm */
};

/* Part of the normal matrix's trace added to its diagonal: makes the step the shortest one where
   the tie is a curve (rank 2). Larger slows the convergence, smaller amplifies rounding along the
   curve. */
static const double DAMPING = 1e-7;

double mlim_tie_value(const double values[8], const double at[3])
{
  double sums[4];
  for (int e = 0; e < 4; ++e)
  {
    sums[e] = values[2 * e] + at[0] * (values[2 * e + 1] - values[2 * e]);
  }
  const double low = sums[0] + at[1] * (sums[1] - sums[0]);
  const double high = sums[2] + at[1] * (sums[3] - sums[2]);
  return low + at[2] * (high - low);
}

/* Gradient in space. */
static void find_gradient(const mlim_tie_cell* cell, const double* values, const double at[3],
  const unsigned char is_fixed[3], double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    double ends[2][3];
    memcpy(ends[0], at, sizeof ends[0]);
    memcpy(ends[1], at, sizeof ends[1]);
    ends[0][k] = 0;
    ends[1][k] = 1;
    out[k] = is_fixed[k] ? 0
                         : (mlim_tie_value(values, ends[1]) - mlim_tie_value(values, ends[0])) /
                             cell->spacing[k];
  }
}

/* Solves the damped normal equations (symmetric, positive) by elimination. 0: no solution. */
static int solve(double m[3][4], double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    if (!(m[k][k] > 0))
    {
      return 0;
    }
    for (int row = k + 1; row < 3; ++row)
    {
      const double factor = m[row][k] / m[k][k];
      for (int column = k; column < 4; ++column)
      {
        m[row][column] -= factor * m[k][column];
      }
    }
  }
  for (int k = 2; k >= 0; --k)
  {
    double sum = m[k][3];
    for (int column = k + 1; column < 3; ++column)
    {
      sum -= m[k][column] * out[column];
    }
    out[k] = sum / m[k][k];
  }
  return 1;
}

static const double* find_values(const mlim_tie_cell* cell, int32_t label)
{
  for (size_t l = 0; l < cell->count; ++l)
  {
    if (cell->labels[l] == label)
    {
      return cell->values + 8 * l;
    }
  }
  return NULL;
}

/* One step in space. Minimises the variance of the labels' values, which no order of the labels
   changes; values are taken from the first label's, against rounding. */
static int find_step(const mlim_tie_cell* cell, const int32_t* labels, size_t label_count,
  const unsigned char is_fixed[3], const double at[3], double step[3])
{
  double m[3][4] = { { 0 } };
  double sum[4] = { 0, 0, 0, 0 };
  double base[4] = { 0, 0, 0, 0 };
  size_t count = 0;
  for (size_t l = 0; l < label_count; ++l)
  {
    const double* values = find_values(cell, labels[l]);
    if (!values)
    {
      continue;
    }
    double row[4];
    find_gradient(cell, values, at, is_fixed, row);
    row[3] = -mlim_tie_value(values, at);
    if (count == 0)
    {
      memcpy(base, row, sizeof row);
    }
    ++count;
    for (int i = 0; i < 4; ++i)
    {
      row[i] -= base[i];
      sum[i] += row[i];
    }
    for (int i = 0; i < 3; ++i)
    {
      for (int j = 0; j < 4; ++j)
      {
        m[i][j] += row[i] * row[j];
      }
    }
  }
  for (int i = 0; i < 3; ++i)
  {
    for (int j = 0; j < 4; ++j)
    {
      m[i][j] -= sum[i] * sum[j] / (double)(count > 0 ? count : 1);
    }
  }
  const double damping = DAMPING * (m[0][0] + m[1][1] + m[2][2]);
  for (int k = 0; k < 3; ++k)
  {
    m[k][k] += damping;
  }
  return solve(m, step);
}

double mlim_tie_project(const mlim_tie_cell* cell, const int32_t* labels, size_t label_count,
  const unsigned char is_fixed[3], double at[3])
{
  double first_length = 0;
  for (int round = 0; round < MAX_STEPS; ++round)
  {
    double step[3];
    if (!find_step(cell, labels, label_count, is_fixed, at, step))
    {
      return first_length;
    }
    const double length = sqrt(step[0] * step[0] + step[1] * step[1] + step[2] * step[2]);
    first_length = round == 0 ? length : first_length;
    for (int k = 0; k < 3; ++k)
    {
      at[k] += is_fixed[k] ? 0 : step[k] / cell->spacing[k];
    }
  }
  return first_length;
}
