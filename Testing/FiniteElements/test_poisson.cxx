// What the volume mesh is for: a Poisson problem whose coefficient is constant in each region, solved
// with linear elements on our tetrahedra and compared with the exact solution.
//
// div (k grad u) = -f, u known on the boundary. Integrals are exact but for the load's and the
// error's, which take four points a cell.
#include "mlim.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

namespace
{

using Vector = Eigen::Vector3d;

int failures = 0;

void Check(bool isTrue, const char* text, double value, double bound)
{
  if (!isTrue)
  {
    std::fprintf(stderr, "failed: %s is %g, bound %g\n", text, value, bound);
    ++failures;
  }
}

// ---- meshing ------------------------------------------------------------------------------------

struct Scene
{
  int Side; // grid points along each axis; spacing 1
  std::vector<std::function<double(const Vector&)>> Indicators;
  bool HasBackground; // the first indicator
};

struct Volume : mlim_volume
{
  Volume() : mlim_volume() {}
  Volume(const Volume&) = delete;
  Volume& operator=(const Volume&) = delete;
  ~Volume() { mlim_volume_free(this); }

  Vector Point(int32_t vertex) const { return Vector(this->vertices + 3 * vertex); }
};

bool MakeVolume(const Scene& scene, double size, Volume* out)
{
  std::vector<std::vector<double>> values(scene.Indicators.size());
  std::vector<mlim_array> arrays;
  for (size_t l = 0; l < values.size(); ++l)
  {
    for (int k = 0; k < scene.Side; ++k)
    {
      for (int j = 0; j < scene.Side; ++j)
      {
        for (int i = 0; i < scene.Side; ++i)
        {
          values[l].push_back(scene.Indicators[l](Vector(i, j, k)));
        }
      }
    }
    mlim_array array = {};
    array.values = values[l].data();
    array.type = MLIM_FLOAT64;
    array.stride = 1;
    array.id = static_cast<int32_t>(l) + (scene.HasBackground ? 0 : 1);
    arrays.push_back(array);
  }
  mlim_grid grid = {};
  for (int k = 0; k < 3; ++k)
  {
    grid.dims[k] = scene.Side;
    grid.spacing[k] = 1;
  }
  grid.array_count = arrays.size();
  grid.arrays = arrays.data();
  grid.background = scene.HasBackground ? MLIM_BACKGROUND_ARRAY : MLIM_BACKGROUND_NONE;

  mlim_context context = {};
  mlim_field* field = nullptr;
  mlim_curves curves = {};
  mlim_balls balls = {};
  mlim_mesh mesh = {};
  mlim_status status = mlim_field_create(&grid, &context, &field);
  mlim_options options = {};
  if (status == MLIM_OK)
  {
    options = mlim_options_default(field);
    options.facet_size = size;
    options.cell_size = size;
    options.facet_distance = options.edge_size = options.smallest_distance = 0;
    options.volume_tolerance = 0;
    status = mlim_options_complete(field, &context, &options);
  }
  status = status == MLIM_OK ? mlim_curves_extract(field, &options, &context, &curves) : status;
  status = status == MLIM_OK ? mlim_balls_cover(&curves, &options, &context, &balls) : status;
  status =
    status == MLIM_OK ? mlim_volume_refine(field, &balls, &options, &context, &mesh, out) : status;
  mlim_mesh_free(&mesh);
  mlim_balls_free(&balls);
  mlim_curves_free(&curves);
  mlim_field_free(field);
  if (status != MLIM_OK)
  {
    std::fprintf(stderr, "%s\n", context.message);
    ++failures;
  }
  return status == MLIM_OK;
}

// ---- the finite elements ------------------------------------------------------------------------

struct Problem
{
  std::vector<double> Coefficients; // a label
  double Load;
  std::function<double(const Vector&)> Exact;
  std::function<bool(const Vector&)> IsKnown; // of a vertex on the surface: u is given there
};

// Gradients of the four linear shape functions, and the cell's volume.
struct Element
{
  Eigen::Matrix<double, 3, 4> Gradients;
  double Size;

  Element(const Volume& volume, size_t cell)
  {
    const int32_t* v = volume.cells + 4 * cell;
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k)
    {
      edges.col(k) = volume.Point(v[k + 1]) - volume.Point(v[0]);
    }
    this->Size = edges.determinant() / 6;
    const Eigen::Matrix3d inverse = edges.inverse();
    this->Gradients.rightCols<3>() = inverse.transpose();
    this->Gradients.col(0) = -this->Gradients.rightCols<3>().rowwise().sum();
  }
};

Eigen::VectorXd Solve(const Volume& volume, const Problem& problem)
{
  const int count = static_cast<int>(volume.vertex_count);
  Eigen::VectorXd u = Eigen::VectorXd::Zero(count);
  std::vector<int> unknown(volume.vertex_count, -1);
  int unknownCount = 0;
  for (int v = 0; v < count; ++v)
  {
    const bool isOnSurface = static_cast<size_t>(v) < volume.surface_vertex_count;
    if (isOnSurface && problem.IsKnown(volume.Point(v)))
    {
      u[v] = problem.Exact(volume.Point(v));
    }
    else
    {
      unknown[v] = unknownCount++;
    }
  }
  Eigen::VectorXd right = Eigen::VectorXd::Zero(unknownCount);
  std::vector<Eigen::Triplet<double>> entries;
  for (size_t c = 0; c < volume.cell_count; ++c)
  {
    const int32_t* v = volume.cells + 4 * c;
    const Element element(volume, c);
    const Eigen::Matrix4d stiffness = problem.Coefficients[volume.cell_labels[c]] * element.Size *
                                      element.Gradients.transpose() * element.Gradients;
    for (int i = 0; i < 4; ++i)
    {
      const int row = unknown[v[i]];
      if (row < 0)
      {
        continue;
      }
      right[row] += problem.Load * element.Size / 4;
      for (int j = 0; j < 4; ++j)
      {
        const int column = unknown[v[j]];
        if (column >= 0)
        {
          entries.emplace_back(row, column, stiffness(i, j));
        }
        else
        {
          right[row] -= stiffness(i, j) * u[v[j]];
        }
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(unknownCount, unknownCount);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::VectorXd solution = solver.solve(right);
  Check(solver.info() == Eigen::Success, "the solver", solver.info(), Eigen::Success);
  for (int v = 0; v < count; ++v)
  {
    u[v] = unknown[v] >= 0 ? solution[unknown[v]] : u[v];
  }
  return u;
}

double ErrorNorm(const Volume& volume, const Eigen::VectorXd& u, const Problem& problem)
{
  // Exact for quadratic polynomials.
  const double far = 0.585410196624968454;
  const double near = 0.138196601125010515;
  double sum = 0;
  for (size_t c = 0; c < volume.cell_count; ++c)
  {
    const int32_t* v = volume.cells + 4 * c;
    for (int q = 0; q < 4; ++q)
    {
      Vector at(0, 0, 0);
      double value = 0;
      for (int k = 0; k < 4; ++k)
      {
        const double weight = k == q ? far : near;
        at += weight * volume.Point(v[k]);
        value += weight * u[v[k]];
      }
      const double error = value - problem.Exact(at);
      sum += 0.25 * Element(volume, c).Size * error * error;
    }
  }
  return std::sqrt(sum);
}

// ---- the problems -------------------------------------------------------------------------------

// Two slabs of different coefficients: linear in each, so that linear elements are exact.
void TestSlabs()
{
  const double wall = 4.3;
  const double side = 10;
  const Scene scene = { static_cast<int>(side) + 1,
    { [=](const Vector& p) { return wall - p.x(); },
      [=](const Vector& p) { return p.x() - wall; } },
    false };
  Problem problem;
  problem.Coefficients = { 1, 5, 0 };
  problem.Load = 0;
  problem.Exact = [=](const Vector& p) { return p.x() < wall ? p.x() : wall + (p.x() - wall) / 5; };
  problem.IsKnown = [=](const Vector& p) { return p.x() <= 0 || p.x() >= side; };
  Volume volume;
  if (MakeVolume(scene, 2, &volume))
  {
    const double error = ErrorNorm(volume, Solve(volume, problem), problem);
    // The wall is found to the crossing tolerance, a millionth of the spacing.
    Check(error < 1e-4, "the error of the slabs", error, 1e-4);
    std::printf("slabs: %zu cells, error %.2e\n", volume.cell_count, error);
  }
}

// A ball in a concentric ball of another coefficient, under a constant load: the L2 error falls with
// the square of the cells' size, interface and boundary being curved.
void TestBalls()
{
  const int side = 101;
  const double inner = 24;
  const double outer = 45;
  const Vector middle(50.2, 49.7, 50.1);
  auto squared = [=](const Vector& p) { return (p - middle).squaredNorm(); };
  // Quadratic indicators: the interpolants differ little from them on a grid so fine.
  const Scene scene = { side,
    { [=](const Vector& p) { return squared(p) - outer * outer; },
      [=](const Vector& p)
      { return std::min(outer * outer - squared(p), squared(p) - inner * inner); },
      [=](const Vector& p) { return inner * inner - squared(p); } },
    true };
  Problem problem;
  const double shell = 1;
  const double core = 4;
  problem.Coefficients = { 0, shell, core };
  problem.Load = 1;
  problem.Exact = [=](const Vector& p)
  {
    const double r = squared(p);
    return r > inner * inner
             ? (outer * outer - r) / (6 * shell)
             : (inner * inner - r) / (6 * core) + (outer * outer - inner * inner) / (6 * shell);
  };
  problem.IsKnown = [=](const Vector& p) { return std::sqrt(squared(p)) > 0.5 * (inner + outer); };
  double lastError = 0;
  double lastLength = 0;
  for (double size : { 14.0, 7.0, 3.5 })
  {
    Volume volume;
    if (!MakeVolume(scene, size, &volume))
    {
      return;
    }
    double sum = 0;
    for (size_t l = 0; l < volume.label_count; ++l)
    {
      sum += volume.label_volumes[l];
    }
    const double length = std::cbrt(sum / static_cast<double>(volume.cell_count));
    const double error = ErrorNorm(volume, Solve(volume, problem), problem);
    const double order =
      lastError > 0 ? std::log(lastError / error) / std::log(lastLength / length) : 2;
    std::printf(
      "balls: size %g, %zu cells, error %.4g, order %.2f\n", size, volume.cell_count, error, order);
    Check(order > 1.8, "the order of convergence", order, 1.8);
    lastError = error;
    lastLength = length;
  }
}

}

int main()
{
  TestSlabs();
  TestBalls();
  return failures > 0;
}
