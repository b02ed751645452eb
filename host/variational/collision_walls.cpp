#include "host/collision_walls.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/error.h"

namespace scree {
namespace {

WallFunction linear_function(const std::string& name, const HalfSpaceOfCoordinates& side) {
  double square = 0;
  for (const double x : side.normal) square += x * x;
  if (!(square > 0) || !std::isfinite(square))
    throw InputError(fmt::format("wall \"{}\": a normal of length {}, expected a finite one > 0",
                                 name, std::sqrt(square)));
  WallFunction out;
  out.value = [side](std::span<const double> q) {
    double sum = -side.offset;
    for (std::size_t i = 0; i < side.normal.size(); ++i) sum += side.normal[i] * q[i];
    return sum;
  };
  out.gradient = [side](std::span<const double>, std::span<double> gradient) {
    for (std::size_t i = 0; i < side.normal.size(); ++i) gradient[i] = side.normal[i];
  };
  out.curvature.assign(side.normal.size(), 0);
  return out;
}

Wall smooth_wall(std::string name, WallFunction function) {
  Wall wall;
  wall.name = std::move(name);
  wall.parts.push_back(std::move(function));
  return wall;
}

}  // namespace

Wall half_space_wall(std::string name, const HalfSpaceOfCoordinates& side) {
  WallFunction function = linear_function(name, side);
  return smooth_wall(std::move(name), std::move(function));
}

Wall quadric_wall(std::string name, std::vector<double> matrix, std::vector<double> linear,
                  double constant) {
  const std::size_t n = linear.size();
  if (matrix.size() != n * n)
    throw InputError(
        fmt::format("wall \"{}\": a matrix of {} numbers, expected {} for {} coordinates", name,
                    matrix.size(), n * n, n));
  WallFunction function;
  function.curvature.assign(n, 0);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) {
      if (matrix[i * n + j] != matrix[j * n + i])
        throw InputError(
            fmt::format("wall \"{}\": a matrix with {} and {} across its diagonal, "
                        "expected a symmetric one",
                        name, matrix[i * n + j], matrix[j * n + i]));
      function.curvature[i] += std::abs(matrix[i * n + j]);  // diag(b) +- A is diagonally dominant
    }
  function.value = [matrix, linear, constant, n](std::span<const double> q) {
    double sum = constant;
    for (std::size_t i = 0; i < n; ++i) {
      double row = 0;
      for (std::size_t j = 0; j < n; ++j) row += matrix[i * n + j] * q[j];
      sum += q[i] * (0.5 * row + linear[i]);
    }
    return sum;
  };
  function.gradient = [matrix = std::move(matrix), linear = std::move(linear), n](
                          std::span<const double> q, std::span<double> gradient) {
    for (std::size_t i = 0; i < n; ++i) {
      gradient[i] = linear[i];
      for (std::size_t j = 0; j < n; ++j) gradient[i] += matrix[i * n + j] * q[j];
    }
  };
  return smooth_wall(std::move(name), std::move(function));
}

Wall convex_obstacle(std::string name, const std::vector<HalfSpaceOfCoordinates>& sides) {
  Wall wall;
  for (const HalfSpaceOfCoordinates& side : sides)
    wall.parts.push_back(linear_function(name, side));
  wall.name = std::move(name);
  return wall;
}

Wall ball_pair_wall(std::string name, const BallPair& pair) {
  const bool is_apart = std::abs(pair.first_a - pair.first_b) >= pair.dimension;
  const int last = std::max(pair.first_a, pair.first_b) + pair.dimension;
  if (std::min(pair.first_a, pair.first_b) < 0 || pair.dimension < 1 || !is_apart ||
      last > pair.coordinate_count)
    throw InputError(fmt::format(
        "wall \"{}\": {} coordinates from {} and from {} on of {}, expected two sets of them", name,
        pair.dimension, pair.first_a, pair.first_b, pair.coordinate_count));
  if (!(pair.distance > 0) || !std::isfinite(pair.distance))
    throw InputError(
        fmt::format("wall \"{}\": distance {}, expected a finite number > 0", name, pair.distance));
  const auto a = static_cast<std::size_t>(pair.first_a), b = static_cast<std::size_t>(pair.first_b);
  const auto dimension = static_cast<std::size_t>(pair.dimension);
  const double distance = pair.distance;
  WallFunction function;
  function.value = [=](std::span<const double> q) {
    double square = 0;
    for (std::size_t i = 0; i < dimension; ++i)
      square += (q[b + i] - q[a + i]) * (q[b + i] - q[a + i]);
    return (square - distance * distance) / (2 * distance);
  };
  function.gradient = [=](std::span<const double> q, std::span<double> gradient) {
    std::fill(gradient.begin(), gradient.end(), 0.0);
    for (std::size_t i = 0; i < dimension; ++i) {
      gradient[b + i] = (q[b + i] - q[a + i]) / distance;
      gradient[a + i] = -gradient[b + i];
    }
  };
  function.curvature.assign(static_cast<std::size_t>(pair.coordinate_count), 0);
  for (std::size_t i = 0; i < dimension; ++i)
    function.curvature[a + i] = function.curvature[b + i] = 2 / distance;
  return smooth_wall(std::move(name), std::move(function));
}

Wall plane_body_wall(std::string name, const PlaneBodyPoint& point, double normal_x,
                     double normal_y, double offset) {
  const auto first = static_cast<std::size_t>(point.first);
  if (point.first < 0 || point.first + 3 > point.coordinate_count)
    throw InputError(fmt::format("wall \"{}\": coordinates {} to {} of {}, expected three of them",
                                 name, point.first, point.first + 2, point.coordinate_count));
  const double length = std::hypot(normal_x, normal_y);
  if (!(length > 0) || !std::isfinite(length))
    throw InputError(
        fmt::format("wall \"{}\": a normal of length {}, expected a finite one > 0", name, length));
  // The point turned by the angle: along is its part along the normal, across its derivative by the angle.
  const auto turned = [=](double angle, double& along, double& across) {
    const double c = std::cos(angle), s = std::sin(angle);
    along = normal_x * (c * point.x - s * point.y) + normal_y * (s * point.x + c * point.y);
    across = normal_x * (-s * point.x - c * point.y) + normal_y * (c * point.x - s * point.y);
  };
  WallFunction function;
  function.value = [=](std::span<const double> q) {
    double along = 0, across = 0;
    turned(q[first + 2], along, across);
    return normal_x * q[first] + normal_y * q[first + 1] + along - offset;
  };
  function.gradient = [=](std::span<const double> q, std::span<double> gradient) {
    double along = 0, across = 0;
    turned(q[first + 2], along, across);
    std::fill(gradient.begin(), gradient.end(), 0.0);
    gradient[first] = normal_x;
    gradient[first + 1] = normal_y;
    gradient[first + 2] = across;
  };
  function.curvature.assign(static_cast<std::size_t>(point.coordinate_count), 0);
  function.curvature[first + 2] = std::hypot(normal_x, normal_y) * std::hypot(point.x, point.y);
  return smooth_wall(std::move(name), std::move(function));
}

}  // namespace scree
