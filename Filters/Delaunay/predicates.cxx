// The predicates behind Core/predicates.h: CGAL's, filtered and exact. The only file that includes CGAL.

extern "C" {
#include "predicates.h"
#include "status.h"
}

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <exception>
#include <new>

namespace
{
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Weighted = Kernel::Weighted_point_3;
using Exact = CGAL::Simple_cartesian<CGAL::Exact_rational>;

Point PointOf(const double at[3])
{
  return Point(at[0], at[1], at[2]);
}

Weighted WeightedOf(const double at[4])
{
  return Weighted(PointOf(at), at[3]);
}

Exact::Weighted_point_3 ExactOf(const double at[4])
{
  return Exact::Weighted_point_3(Exact::Point_3(at[0], at[1], at[2]), at[3]);
}

// Runs a function; no exception leaves it.
template <typename Function>
mlim_status Guard(mlim_context* context, const Function& function)
{
  try
  {
    function();
    return MLIM_OK;
  }
  catch (const std::bad_alloc&)
  {
    return mlim_fail_memory(context, "exact arithmetic");
  }
  catch (const std::exception& error)
  {
    return mlim_fail(context, MLIM_INTERNAL, "Exact arithmetic failed: %s", error.what());
  }
  catch (...)
  {
    return mlim_fail(context, MLIM_INTERNAL, "Exact arithmetic failed.");
  }
}
}

mlim_status mlim_predicates_orientation(const double a[3], const double b[3], const double c[3],
  const double d[3], mlim_context* context, int* out)
{
  *out = 0;
  return Guard(context, [&]
    { *out = Kernel().orientation_3_object()(PointOf(a), PointOf(b), PointOf(c), PointOf(d)); });
}

mlim_status mlim_predicates_conflict(
  const double* const cell[4], const double point[4], mlim_context* context, int* out)
{
  *out = 0;
  return Guard(context,
    [&]
    {
      const CGAL::Oriented_side side =
        Kernel().power_side_of_oriented_power_sphere_3_object()(WeightedOf(cell[0]),
          WeightedOf(cell[1]), WeightedOf(cell[2]), WeightedOf(cell[3]), WeightedOf(point));
      *out = side == CGAL::ON_POSITIVE_SIDE;
    });
}

mlim_status mlim_predicates_center(
  const double* const cell[4], mlim_context* context, double out[3])
{
  out[0] = out[1] = out[2] = 0;
  return Guard(context,
    [&]
    {
      const Exact::Point_3 center = Exact().construct_weighted_circumcenter_3_object()(
        ExactOf(cell[0]), ExactOf(cell[1]), ExactOf(cell[2]), ExactOf(cell[3]));
      out[0] = CGAL::to_double(center.x());
      out[1] = CGAL::to_double(center.y());
      out[2] = CGAL::to_double(center.z());
    });
}
