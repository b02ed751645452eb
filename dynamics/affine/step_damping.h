#pragma once
// Newton steps that barriers block one after another.

#include <algorithm>

namespace scree::affine {

/// Inertia that Newton steps are given beside that of bodies. A gap far below what a turn bends a way by leaves a small share of
/// each step, and of that the gap is no wider: without damping steps went along it hundreds of times. With more inertia bodies go
/// less far along the gap, but the barrier, which is stiffer by far, opens it as fast as before.
class StepDamping {
 public:
  /// What is added, over the inertia of bodies.
  double value() const { return value_; }

  /// @param share  that was gone of a step
  void note(double share) {
    short_steps_ = share < kShort ? short_steps_ + 1 : 0;
    if (value_ > 0 ? share < kHalf : short_steps_ >= kMostShort) {
      value_ = std::max(kMore, kMore * value_);
    } else if (share >= kWhole) {
      value_ = value_ > kLeast ? value_ / kLess : 0;
    }
  }

 private:
  static constexpr double kShort = 0.2, kHalf = 0.5, kWhole = 0.9;  ///< shares of a step
  static constexpr int kMostShort = 5;
  /// A whole step about doubles a gap, and the damping may fall as fast.
  static constexpr double kMore = 10, kLess = 2, kLeast = 0.1;

  double value_ = 0;
  int short_steps_ = 0;  ///< one after another
};

}  // namespace scree::affine
