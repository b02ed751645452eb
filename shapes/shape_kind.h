#pragma once
// Which shape a body has, as a number. Each shape has its own, in its file: Sphere::kind and so on.

#include <cstdint>

namespace scree {

/// Number of a shape. It stands in output files, so it stays what it is.
enum class ShapeKind : std::uint8_t {};

/// No shape has been chosen.
inline constexpr ShapeKind kNoShape{255};

}  // namespace scree
