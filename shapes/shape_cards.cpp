#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "kernels/bodies/range.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

constexpr double kShortest = 1e-12;      // length of a body [m]
constexpr double kUnitTolerance = 1e-6;  // deviation from length one that is taken for rounding

// Written so that NaN fails.
bool is_positive(double x) { return std::isfinite(x) && x > 0; }

std::optional<Fault> range_of_length(const char* field, double value) {
  if (value >= kShortest && value <= kFarthest) return std::nullopt;
  return Fault{field, fmt::format("{}", value),
               fmt::format("must be from {:g} to {:g} [m]", kShortest, kFarthest)};
}

}  // namespace

std::string vector_text(const Vec3d& v) { return fmt::format("[{}, {}, {}]", v.x, v.y, v.z); }

std::optional<Fault> length_fault(const char* field, double value) {
  if (!is_positive(value)) return Fault{field, fmt::format("{}", value), "must be positive [m]"};
  return range_of_length(field, value);
}

std::optional<Fault> lengths_fault(const char* field, const Vec3d& value) {
  if (!is_positive(value.x) || !is_positive(value.y) || !is_positive(value.z))
    return Fault{field, vector_text(value), "must be positive [m]"};
  for (int k = 0; k < 3; ++k)
    if (auto fault = range_of_length(field, value[k])) return fault;
  return std::nullopt;
}

std::optional<Fault> unit_fault(const char* field, const Vec3d& value) {
  if (std::abs(norm(value) - 1) <= kUnitTolerance) return std::nullopt;
  return Fault{field, vector_text(value), "must have length 1"};
}

std::optional<Fault> rounding_fault(double radius, double longest) {
  constexpr double kMost = 1000;
  if (radius <= kMost * longest) return std::nullopt;
  return Fault{"rounding", fmt::format("{}", radius),
               fmt::format("must not be above {:g} times half the longest edge of the box about "
                           "what is rounded, {:.6g} [m]",
                           kMost, kMost * longest)};
}

std::optional<Fault> round_fault(const Shape& shape) {
  const Vec3d& e = shape.half_extents;
  if (auto fault = lengths_fault("half_extents", e)) return fault;
  if (e.x == e.y) return std::nullopt;
  return Fault{"half_extents", vector_text(e), "must be the radius twice [m]"};
}

bool is_shape(ShapeKind kind) {
  for (const ShapeCard& card : shape_cards())
    if (card.kind == kind) return true;
  return false;
}

const ShapeCard& shape_card(ShapeKind kind) {
  for (const ShapeCard& card : shape_cards())
    if (card.kind == kind) return card;
  throw std::logic_error(fmt::format("no shape has the number {}", static_cast<int>(kind)));
}

}  // namespace scree
