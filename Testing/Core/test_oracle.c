/* The field and the oracle against a naive argmax over all labels. */
#include "check.h"
#include "field.h"
#include "oracle.h"
#include "random_field.h"

#include <math.h>

static random_field f;

/* A margin below this may be decided either way by rounding (values are at most 12). */
static const double CLEAR = 1e-5;

static void random_point(uint64_t* seed, double out[3])
{
  for (int k = 0; k < 3; ++k)
  {
    out[k] = (f.dims[k] - 1) * f.spacing[k] * (1.2 * random_unit(seed) - 0.1);
  }
}

static void test_labels(const mlim_field* field, uint64_t seed)
{
  for (int n = 0; n < 4000; ++n)
  {
    double point[3];
    double margin;
    random_point(&seed, point);
    const int32_t expected = random_field_label(&f, point, &margin);
    CHECK(margin < CLEAR || mlim_field_label(field, point) == expected);
  }
  for (int n = 0; n < 200; ++n)
  {
    const int32_t at[3] = { (int32_t)(random_unit(&seed) * f.dims[0]),
      (int32_t)(random_unit(&seed) * f.dims[1]), (int32_t)(random_unit(&seed) * f.dims[2]) };
    double margin;
    const double point[3] = { at[0] * f.spacing[0], at[1] * f.spacing[1], at[2] * f.spacing[2] };
    CHECK(mlim_field_point_label(field, at) == random_field_label(&f, point, &margin));
  }
}

/* The best candidate at a cell's corner is the grid point's label, ties included: so cells that share
   the point agree on it. */
static void test_corners(const mlim_field* field)
{
  uint16_t labels[RANDOM_MAX_LABELS];
  float values[8 * RANDOM_MAX_LABELS];
  const mlim_cell_buffer buffer = { labels, values };
  CHECK(mlim_field_max_candidates(field) <= RANDOM_MAX_LABELS);
  for (int n = 0; n < (f.dims[0] - 1) * (f.dims[1] - 1) * (f.dims[2] - 1); ++n)
  {
    const int32_t cell[3] = { n % (f.dims[0] - 1), n / (f.dims[0] - 1) % (f.dims[1] - 1),
      n / ((f.dims[0] - 1) * (f.dims[1] - 1)) };
    const mlim_candidates in = mlim_field_cell(field, cell, &buffer);
    for (int c = 0; c < 8; ++c)
    {
      const int32_t at[3] = { cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2) };
      int32_t best = 0;
      for (int32_t k = 1; k < in.count; ++k)
      {
        best = in.values[8 * k + c] > in.values[8 * best + c] ? k : best;
      }
      CHECK(in.labels[best] == mlim_field_point_label(field, at));
    }
  }
}

static int32_t label_at(const double a[3], const double b[3], double t, double* margin)
{
  double point[3];
  for (int k = 0; k < 3; ++k)
  {
    point[k] = a[k] + t * (b[k] - a[k]);
  }
  return random_field_label(&f, point, margin);
}

/* Between two crossings the label is the same everywhere; labels chain; both sides are right. */
static void test_segment(const mlim_field* field, const double a[3], const double b[3])
{
  enum
  {
    CAPACITY = 256,
    SAMPLES = 400
  };
  mlim_crossing crossing[CAPACITY];
  const mlim_oracle oracle = { .field = field, .tolerance = 1e-7, .mode = MLIM_ORACLE_EXACT };
  const size_t count = mlim_oracle_crossings(&oracle, a, b, CAPACITY, crossing);
  double length = 0;
  for (int k = 0; k < 3; ++k)
  {
    length += (b[k] - a[k]) * (b[k] - a[k]);
  }
  double at[CAPACITY + 1];
  for (size_t c = 0; c < count; ++c)
  {
    double t = 0;
    for (int k = 0; k < 3; ++k)
    {
      t += (crossing[c].point[k] - a[k]) * (b[k] - a[k]) / length;
    }
    at[c] = t;
    CHECK(c == 0 || (t >= at[c - 1] - 1e-9 && crossing[c].from == crossing[c - 1].to));
    CHECK(crossing[c].from != crossing[c].to);
  }
  size_t next = 0;
  for (int n = 0; n <= SAMPLES; ++n)
  {
    const double t = (double)n / SAMPLES;
    while (next < count && at[next] < t)
    {
      ++next;
    }
    double margin;
    const int32_t label = label_at(a, b, t, &margin);
    const int is_near =
      (next < count && at[next] - t < 1e-6) || (next > 0 && t - at[next - 1] < 1e-6);
    if (margin > CLEAR && !is_near && count > 0)
    {
      CHECK(label == (next < count ? crossing[next].from : crossing[next - 1].to));
    }
    if (count == 0 && margin > CLEAR)
    {
      double other;
      CHECK(label == label_at(a, b, 0, &other) || other < CLEAR);
    }
  }
}

/* Points outside the box count too: nothing but the outside may be in their cube. */
static void test_clearance(const mlim_field* field, uint64_t seed)
{
  enum
  {
    COUNT = 300
  };
  double points[COUNT][3];
  mlim_field_look looks[COUNT];
  int32_t labels[COUNT];
  for (int n = 0; n < COUNT; ++n)
  {
    random_point(&seed, points[n]);
    looks[n].point = points[n];
  }
  mlim_field_look_at(field, looks, COUNT);
  mlim_field_labels(field, points[0], COUNT, labels);
  for (int n = 0; n < COUNT; ++n)
  {
    const double clearance = (double)looks[n].clearance;
    CHECK(clearance >= 0 && looks[n].label == mlim_field_label(field, points[n]));
    CHECK(labels[n] == looks[n].label);
    for (int s = 0; s < 20 && clearance > 0; ++s)
    {
      double other[3];
      double margin;
      for (int k = 0; k < 3; ++k)
      {
        other[k] = points[n][k] + clearance * f.spacing[k] * (2 * random_unit(&seed) - 1);
      }
      CHECK(random_field_label(&f, other, &margin) == looks[n].label);
    }
  }
}

/* Taken together, with what is known at their ends, segments have the crossings that each has alone without. */
static void test_together(const mlim_field* field, uint64_t seed)
{
  enum
  {
    CAPACITY = 64,
    LOOKS = 2 * MLIM_SEGMENTS
  };
  static mlim_crossing together[MLIM_SEGMENTS * CAPACITY];
  mlim_crossing alone[CAPACITY];
  double points[LOOKS][3];
  mlim_field_look looks[LOOKS];
  mlim_segment segments[MLIM_SEGMENTS];
  size_t counts[MLIM_SEGMENTS];
  const mlim_oracle oracle = { .field = field, .tolerance = 1e-7, .mode = MLIM_ORACLE_EXACT };
  const size_t some = 1 + (size_t)(random_unit(&seed) * MLIM_SEGMENTS) % MLIM_SEGMENTS;
  for (int n = 0; n < LOOKS; ++n)
  {
    random_point(&seed, points[n]);
    for (int k = 0; k < 3 && n % 4 == 3; ++k)
    {
      points[n][k] = points[n - 1][k] + 0.1 * (points[n][k] - points[n - 1][k]); /* a short one */
    }
    looks[n].point = points[n];
  }
  mlim_field_look_at(field, looks, LOOKS);
  for (size_t s = 0; s < some; ++s)
  {
    const mlim_field_look* ends = &looks[2 * s];
    segments[s] = (mlim_segment){ .ends = { ends[0].point, ends[1].point },
      .labels = { ends[0].label, ends[1].label },
      .clearances = { ends[0].clearance, ends[1].clearance } };
  }
  mlim_oracle_cross_all(&oracle, segments, some, CAPACITY, together, counts);
  for (size_t s = 0; s < some; ++s)
  {
    const size_t count =
      mlim_oracle_crossings(&oracle, points[2 * s], points[2 * s + 1], CAPACITY, alone);
    CHECK(counts[s] == count);
    for (size_t c = 0; c < count && c < counts[s]; ++c)
    {
      const mlim_crossing* crossing = &together[s * CAPACITY + c];
      CHECK(crossing->from == alone[c].from && crossing->to == alone[c].to &&
            crossing->face == alone[c].face);
      for (int k = 0; k < 3; ++k)
      {
        CHECK(fabs(crossing->point[k] - alone[c].point[k]) < 1e-6);
      }
    }
  }
}

static int32_t slab(const void* user, const double point[3])
{
  (void)user;
  return point[0] < 1 ? 0 : point[0] < 1.5 ? 1 : 2;
}

/* The paper's oracle on an analytic function: looks at midpoints only. */
static void test_bisection(void)
{
  const double a[3] = { 0, 0, 0 };
  const double b[3] = { 3, 0, 0 };
  mlim_crossing crossing[4];
  const size_t count = mlim_oracle_bisect(slab, NULL, a, b, 1e-9, 4, crossing);
  CHECK(count == 2);
  CHECK(fabs(crossing[0].point[0] - 1) < 1e-8 && crossing[0].from == 0 && crossing[0].to == 1);
  CHECK(fabs(crossing[1].point[0] - 1.5) < 1e-8 && crossing[1].from == 1 && crossing[1].to == 2);
}

int main(void)
{
  for (int32_t labels = 2; labels <= RANDOM_MAX_LABELS; ++labels)
  {
    for (int steps = 0; steps <= 4; steps += 2)
    {
      mlim_field* field = NULL;
      uint64_t seed = (uint64_t)labels * 10 + (uint64_t)steps;
      random_field_make(&f, labels, 8, steps, seed);
      mlim_context context = { 0 };
      CHECK(mlim_field_create(&f.grid, &context, &field) == MLIM_OK);
      test_labels(field, seed);
      test_corners(field);
      test_clearance(field, seed);
      for (int n = 0; n < 150; ++n)
      {
        double a[3];
        double b[3];
        random_point(&seed, a);
        random_point(&seed, b);
        test_segment(field, a, b);
        test_together(field, seed);
      }
      mlim_field_free(field);
    }
  }
  test_bisection();
  return check_result();
}
