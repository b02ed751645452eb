#pragma once
// What frames of bodies hold of each, beside position and the fields of the model: name, type and value of what never
// changes, in one table for all files that have it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "host/body_constants.h"
#include "shapes/shape_card.h"

namespace scree {

/// Calls visit(name, value) for each, where value(bodies, id) is a number or an array of numbers.
/// @tparam Real  number type of the run
template <class Real, class Visit>
void for_each_constant(Visit&& visit) {
  using Bodies = const BodyConstants&;
  using Id = std::size_t;
  visit("id", [](Bodies, Id id) { return static_cast<std::int64_t>(id); });
  visit("radius", [](Bodies bodies, Id id) {
    const BodyConstant body = bodies[id];
    return static_cast<Real>(shape_card(body.shape).is_ball ? body.radius : 0.0);
  });
  visit("half_extents", [](Bodies bodies, Id id) {
    const Vec3d half = bodies.half_extents(id);
    return std::array<Real, 3>{static_cast<Real>(half.x), static_cast<Real>(half.y),
                               static_cast<Real>(half.z)};
  });
  visit("mass", [](Bodies bodies, Id id) { return bodies[id].mass; });
  visit("group", [](Bodies bodies, Id id) { return static_cast<std::int32_t>(bodies[id].group); });
  visit("kind", [](Bodies bodies, Id id) { return static_cast<std::uint8_t>(bodies[id].kind); });
  visit("shape", [](Bodies bodies, Id id) { return static_cast<std::uint8_t>(bodies[id].shape); });
}

/// The numbers of a value of for_each_constant().
template <class T>
struct Numbers {
  using Type = T;
  static constexpr std::uint64_t columns = 0;  ///< as in h5::Shape
  static void append(const T& value, std::vector<T>& to) { to.push_back(value); }
};
template <class T, std::size_t n>
struct Numbers<std::array<T, n>> {
  using Type = T;
  static constexpr std::uint64_t columns = n;
  static void append(const std::array<T, n>& value, std::vector<T>& to) {
    to.insert(to.end(), value.begin(), value.end());
  }
};
/// Those of a function of for_each_constant().
template <class Value>
using NumbersOf =
    Numbers<decltype(std::declval<Value>()(std::declval<const BodyConstants&>(), std::size_t{}))>;

/// Their names.
inline std::vector<std::string> constant_names() {
  std::vector<std::string> names;
  for_each_constant<float>([&](const char* name, auto) { names.emplace_back(name); });
  return names;
}

}  // namespace scree
