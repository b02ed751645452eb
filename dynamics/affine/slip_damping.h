#pragma once
// Newton steps that go too far because friction stops what the system takes for sliding.

namespace scree::affine {

/// Stiffness along the slip that Newton steps are given, over that of a contact that its force would stop at once. What slides has
/// none, so a step that stops it goes as far as inertia lets it, past the place where it sticks: there the energy is higher, and shorter
/// steps were taken back and forth. What slides on is known best without: with it steps go a part of their way.
class SlipDamping {
 public:
  double value() const { return value_; }

  /// @param went_too_far  whether the energy was not lower where a step would have led
  void note(bool went_too_far) {
    value_ = went_too_far ? kFirst : value_ > kLeast ? value_ / 2 : 0;
  }

 private:
  static constexpr double kFirst = 0.25, kLeast = 0.01;

  double value_ = 0;
};

}  // namespace scree::affine
