#pragma once
// What methods do to the energy of a system that should keep it.

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace scree::bench {

struct RunLength {
  double step = 0.01;  ///< [s]
  int steps = 100000;
};

/// The energy of one run by one method. Changes are relative to the energy at the start.
class EnergyTrace {
 public:
  /// @param intervals  of equal length, of each of which the largest change is kept
  EnergyTrace(std::string method, const RunLength& length, double energy, int intervals = 1000)
      : method_(std::move(method)), length_(length), start_(energy) {
    energy_.resize(static_cast<std::size_t>(std::min(intervals, length.steps)), 0);
  }

  void add(int step, double energy) {
    last_ = energy / start_ - 1;
    double& largest = energy_[interval(step)];
    largest = std::max(largest, std::abs(last_));
  }
  /// Distance from where the body should be [m], where that is known.
  void add_place(int step, double error) {
    place_.resize(energy_.size(), 0);
    double& largest = place_[interval(step)];
    largest = std::max(largest, std::abs(error));
  }
  /// A body turns at a wall that it is this far from [m], negative: that far beyond it.
  void add_turn(double gap) {
    ++turns_;
    turn_error_ = std::max(turn_error_, std::abs(gap));
  }
  void add_gap(double gap) { lowest_ = std::min(lowest_, gap); }

  const std::string& method() const { return method_; }
  const std::vector<double>& energy_intervals() const { return energy_; }
  const std::vector<double>& place_intervals() const { return place_; }
  double largest() const { return *std::max_element(energy_.begin(), energy_.end()); }
  double last() const { return last_; }
  int turns() const { return turns_; }
  double turn_error() const { return turn_error_; }
  double lowest() const { return lowest_; }

 private:
  std::size_t interval(int step) const {
    return static_cast<std::size_t>(step) * energy_.size() /
           static_cast<std::size_t>(length_.steps);
  }

  std::string method_;
  RunLength length_;
  double start_, last_ = 0;
  std::vector<double> energy_, place_;
  int turns_ = 0;
  double turn_error_ = 0;
  double lowest_ = std::numeric_limits<double>::infinity();
};

/// A ball of 1 kg that is let go 1 m above a floor, and a rod of 1 m and 1 kg that falls on one; both elastic, without friction.
/// By the collision integrator ("variational"), by steps of a World ("time steps"), and by leapfrog steps that are completed, set back on
/// the floor and turned there ("clamped leapfrog").
std::vector<EnergyTrace> ball_traces(const RunLength& length);
std::vector<EnergyTrace> rod_traces(const RunLength& length);

}  // namespace scree::bench
