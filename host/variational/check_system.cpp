#include "host/variational/check_system.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/variational/first_hit.h"

namespace scree::variational {
namespace {

bool all_finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); });
}

void require(bool is_met, const std::string& message) {
  if (!is_met) throw InputError("collision integrator: " + message);
}

void check_mass(const std::vector<double>& mass, std::size_t n) {
  require(mass.size() == n * n,
          fmt::format("mass has {} numbers, expected n x n = {} for {} coordinates", mass.size(),
                      n * n, n));
  require(all_finite(mass), "mass has a number that is not finite");
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j)
      require(
          mass[i * n + j] == mass[j * n + i],
          fmt::format("mass[{0}][{1}] = {2} and mass[{1}][{0}] = {3}, expected a symmetric matrix",
                      i, j, mass[i * n + j], mass[j * n + i]));
  const auto size = static_cast<Eigen::Index>(n);
  require(Eigen::Map<const Matrix>(mass.data(), size, size).llt().info() == Eigen::Success,
          "mass is not positive definite");
}

void check_settings(const ImpactSettings& s) {
  const auto in_range = [](const char* key, double value, bool is_met, const char* expected) {
    require(is_met, fmt::format("{} is {}, expected {}", key, value, expected));
  };
  in_range("step", s.step, s.step > 0 && std::isfinite(s.step), "a finite number > 0");
  in_range("max_impacts", s.max_impacts, s.max_impacts > 0, "a number > 0");
  in_range("together", s.together, s.together >= 0 && s.together < 1, "a number in [0, 1)");
  in_range("handover_speed", s.handover_speed,
           s.handover_speed >= 0 && std::isfinite(s.handover_speed), "a finite number >= 0");
  in_range("samples", s.samples, s.samples > 0, "a number > 0");
}

void check_part(const Wall& wall, const WallFunction& part, std::size_t n) {
  require(part.value && part.gradient,
          fmt::format("wall \"{}\" has a part without value or gradient", wall.name));
  if (part.curvature.empty()) return;
  require(part.curvature.size() == n,
          fmt::format(
              "wall \"{}\": curvature has {} numbers, expected {}, or none where it is not known",
              wall.name, part.curvature.size(), n));
  for (const double b : part.curvature)
    require(b >= 0 && std::isfinite(b),
            fmt::format("wall \"{}\": curvature {}, expected finite numbers >= 0", wall.name, b));
}

void check_wall(const Wall& wall, const Vector& q) {
  require(!wall.parts.empty(), fmt::format("wall \"{}\" has no parts", wall.name));
  require(wall.restitution >= 0 && wall.restitution <= 1,
          fmt::format("wall \"{}\": restitution {}, expected a number in [0, 1]", wall.name,
                      wall.restitution));
  require(wall.friction >= 0 && std::isfinite(wall.friction),
          fmt::format("wall \"{}\": friction {}, expected a finite number >= 0", wall.name,
                      wall.friction));
  bool is_inside = false;
  Vector gradient(q.size());
  for (const WallFunction& part : wall.parts) {
    check_part(wall, part, static_cast<std::size_t>(q.size()));
    part.gradient(as_span(q), as_span(gradient));
    is_inside |= part.value(as_span(q)) >= -kStartSlack * rounding_of(gradient, q);
  }
  require(is_inside,
          fmt::format("wall \"{}\" is {} at the start, expected a position within it, >= 0",
                      wall.name, gap_at({&wall, 1}, q)));
}

}  // namespace

void check_system(const MechanicalSystem& system, const ImpactSettings& settings,
                  const std::vector<double>& position, const std::vector<double>& velocity) {
  const std::size_t n = position.size();
  require(n > 0, "position is empty, expected n > 0 numbers");
  require(velocity.size() == n,
          fmt::format("velocity has {} numbers, expected {} as position", velocity.size(), n));
  require(all_finite(position) && all_finite(velocity),
          "position or velocity has a number that is not finite");
  check_mass(system.mass, n);
  require(static_cast<bool>(system.potential) == static_cast<bool>(system.potential_gradient),
          "a potential needs a gradient, and the other way");
  for (const MomentumMap& map : system.momenta)
    require(static_cast<bool>(map.value), fmt::format("momentum \"{}\" has no function", map.name));
  check_settings(settings);
  const Vector q = Eigen::Map<const Vector>(position.data(), static_cast<Eigen::Index>(n));
  for (const Wall& wall : system.walls) check_wall(wall, q);
}

}  // namespace scree::variational
