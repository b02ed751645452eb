#pragma once
// Where values stand on an axis, and its ticks.

#include <string>
#include <vector>

#include "host/plot/figure.h"

namespace scree {

class AxisScale {
 public:
  struct Tick {
    double place;       ///< 0 at the start of the axis, 1 at its end
    std::string label;  ///< empty: a line of the grid only
  };

  /// Takes in all values: a logarithmic axis from the least to the largest, or the decades around
  /// them where that is less than one; a linear one from tick to tick, and zero where there is one
  /// value only. Those that are not finite are skipped; without any value a logarithmic axis is
  /// [1, 10] and a linear one [0, 1].
  AxisScale(const Axis& axis, const std::vector<double>& values);

  /// Place of a finite value, in [0, 1].
  double place(double value) const;

  const std::vector<Tick>& ticks() const { return ticks_; }

 private:
  void make_decades(int stride);
  void make_steps(double step);

  bool is_log_;
  double most_;
  double first_ = 0, last_ = 1;  ///< values at the ends, or their logarithms to base 10
  double zero_band_ = 0;         ///< share of a logarithmic axis below its first decade
  std::vector<Tick> ticks_;
};

}  // namespace scree
