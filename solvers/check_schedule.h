#pragma once
// When a solver checks its residual: a check costs more than half an iteration on a GPU, and every
// iteration past the tolerance is wasted.

#include <algorithm>
#include <cmath>

namespace scree {

/// Predicts from the last two checks when the tolerance will be reached.
class CheckSchedule {
 public:
  /// @param longest    most iterations between two checks, at least 1
  /// @param tolerance  residual to be reached; 0: never
  CheckSchedule(int longest, double tolerance) : longest_(longest), tolerance_(tolerance) {}

  void set_longest(int longest) { longest_ = longest; }

  /// Iterations from this check to the next one.
  /// @param done  iterations so far; not less than at the check before
  /// @param rms   residual found, above the tolerance
  int next(int done, double rms) {
    const double wait = predict(done, rms);
    done_ = done;
    rms_ = rms;
    const double least = std::min(kMinWait, longest_);
    return static_cast<int>(std::ceil(std::clamp(wait, least, static_cast<double>(longest_))));
  }

 private:
  static constexpr int kMinWait = 3;
  static constexpr double kOffset = 5;  ///< iterations: the power law below holds from the start

  /// Residuals of accelerated methods fall like a power of the iterations done.
  double predict(int done, double rms) const {
    if (!(tolerance_ > 0 && rms_ > rms && done > done_)) return longest_;
    const double here = done + kOffset;
    const double power = std::log(rms_ / rms) / std::log(here / (done_ + kOffset));
    if (!(power > 0.01)) return longest_;
    return here * (std::pow(rms / tolerance_, 1 / power) - 1);
  }

  int longest_;
  double tolerance_;
  int done_ = 0;
  double rms_ = 0;  ///< 0: no check so far
};

}  // namespace scree
