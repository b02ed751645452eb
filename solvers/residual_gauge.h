#pragma once
// Predicts the residual from something that a solver measures in every iteration anyway.

#include <algorithm>

namespace scree {

/// Learns from residual checks how many times the measure the residual is. For the steps of
/// projected gradients that number hardly changes within a solve and from one time step to the
/// next: 5 % in settled beds, but for single iterations in which the step size jumps and the
/// measure is too large. So the largest number seen counts, and that of solves before fades slowly.
class ResidualGauge {
 public:
  void start_solve() { carry(carried()); }
  /// A residual check.
  void note(double measure, double rms) {
    if (measure > 0) seen_ = std::max(seen_, rms / measure);
  }
  bool is_known() const { return ratio() > 0; }
  /// The measure at which a residual should be reached, negative if not known.
  double level(double rms) const { return rms > 0 && is_known() ? kSure * rms / ratio() : -1; }

  double carried() const { return ratio(); }
  void carry(double ratio) { carried_ = ratio, seen_ = 0; }

 private:
  static constexpr double kSure = 0.98;   ///< below the level, a check rarely fails
  static constexpr double kForget = 0.9;  ///< of what the last solve saw

  double ratio() const { return seen_ > 0 ? std::max(seen_, kForget * carried_) : carried_; }

  double seen_ = 0;     ///< in this solve
  double carried_ = 0;  ///< from those before
};

}  // namespace scree
