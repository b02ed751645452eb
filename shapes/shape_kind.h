#pragma once
// Which shape a body has, as a number. Each shape has its own, in its file: Sphere::kind and so on.

#include <cstdint>

#include "kernels/types.h"

namespace scree {

/// Number of a shape. It stands in output files, so it stays what it is.
enum class ShapeKind : std::uint8_t {};

/// No shape has been chosen.
inline constexpr ShapeKind kNoShape{255};

/// What a rounded shape is made of: all points that are no farther from its core than a radius.
template <class Real>
struct Rounding {
  ShapeKind core = kNoShape;  ///< none: the shape is not rounded
  Real radius = 0;            ///< [m]
  Real shift = 0;  ///< of the center of the core along z of the body, from that of the body [m]

  /// What it adds to half an edge of the box about a core, if that stays about the center of the body [m].
  SCREE_HD Real reach() const { return radius + (shift < 0 ? -shift : shift); }
};

template <class Real>
SCREE_HD Rounding<double> in_double(const Rounding<Real>& r) {
  return {r.core, static_cast<double>(r.radius), static_cast<double>(r.shift)};
}

}  // namespace scree
