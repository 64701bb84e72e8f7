/* A failed check prints where, and the test goes on. A test's main returns check_result(). */
#ifndef mlim_check_h
#define mlim_check_h

#include <math.h>
#include <stdio.h>

static int check_failures = 0;

static inline void check_true(int is_true, const char* text, const char* file, int line)
{
  if (!is_true)
  {
    fprintf(stderr, "%s:%d: failed: %s\n", file, line, text);
    ++check_failures;
  }
}

static inline void check_count(
  size_t value, size_t expected, const char* text, const char* file, int line)
{
  if (value != expected)
  {
    fprintf(stderr, "%s:%d: failed: %s is %zu, not %zu\n", file, line, text, value, expected);
    ++check_failures;
  }
}

static inline void check_below(
  double value, double bound, const char* text, const char* file, int line)
{
  if (!(value <= bound))
  {
    fprintf(stderr, "%s:%d: failed: %s is %g, above %g\n", file, line, text, value, bound);
    ++check_failures;
  }
}

static inline int check_result(void)
{
  if (check_failures > 0)
  {
    fprintf(stderr, "%d checks failed\n", check_failures);
  }
  return check_failures > 0;
}

#define CHECK(condition) check_true((condition) != 0, #condition, __FILE__, __LINE__)
#define CHECK_COUNT(value, expected) check_count(value, expected, #value, __FILE__, __LINE__)
#define CHECK_BELOW(value, bound) check_below(value, bound, #value, __FILE__, __LINE__)

#endif
