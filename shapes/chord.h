#pragma once
// The part of a line that lies in a convex body.

#include <cmath>
#include <limits>
#include <utility>

#include "kernels/math/vec3.h"

namespace scree {

/// From `in` to `out` along a line, in lengths of its direction; none where `out` is not above `in`.
struct Chord {
  double in = -std::numeric_limits<double>::infinity();
  double out = std::numeric_limits<double>::infinity();

  bool is_empty() const { return !(out > in); }
  void clear() { in = out = 0; }
  void cut(double first, double last) {
    in = first > in ? first : in;
    out = last < out ? last : out;
  }
  /// Keeps what is below a plane. @param above   height of the start of the line over it
  ///                              @param rising  what it gains along the direction
  void cut_above(double above, double rising) {
    if (rising > 0) {
      cut(in, -above / rising);
    } else if (rising < 0) {
      cut(-above / rising, out);
    } else if (above > 0) {
      clear();
    }
  }
  /// Keeps what is between two planes at +-half from the middle.
  void cut_slab(double start, double direction, double half) {
    cut_above(start - half, direction);
    cut_above(-start - half, -direction);
  }
  /// Keeps where square t^2 + 2 linear t + constant <= 0, of a body that is convex: square >= 0.
  void cut_quadric(double square, double linear, double constant) {
    if (!(square > 0)) {
      if (constant > 0) clear();
      return;
    }
    const double root = linear * linear - square * constant;
    if (!(root > 0)) {
      clear();
      return;
    }
    const double half = std::sqrt(root) / square, middle = -linear / square;
    cut(middle - half, middle + half);
  }
};

}  // namespace scree
