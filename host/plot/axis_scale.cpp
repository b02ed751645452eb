#include "host/plot/axis_scale.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace scree {
namespace {

constexpr double kZeroBand = 0.07;
constexpr int kMostTicks = 8;

/// The next larger of 1, 2, 5, 10, 20, ... times a power of ten.
double round_step(double least) {
  const double unit = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * unit >= least * (1 - 1e-9)) return factor * unit;
  return 10 * unit;
}

std::string power_of_ten(int exponent) {
  if (exponent >= 0 && exponent <= 3) return fmt::format("{:.0f}", std::pow(10.0, exponent));
  return fmt::format("1e{}", exponent);
}

}  // namespace

AxisScale::AxisScale(const Axis& axis, const std::vector<double>& values)
    : is_log_(axis.is_log), most_(axis.most) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  double least = infinity, largest = -infinity;
  bool has_zero = false;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    if (is_log_ && !(value > 0)) {
      has_zero = true;
      continue;
    }
    least = std::min({least, value, most_});
    largest = std::max(largest, std::min(value, most_));
  }
  const bool is_empty = !(least <= largest);
  if (is_log_) {
    first_ = is_empty ? 0 : std::log10(least);
    last_ = is_empty ? 1 : std::log10(largest);
    if (std::floor(last_) - std::ceil(first_) < 1) {  // two labels are the least
      first_ = std::floor(first_);
      last_ = std::max(first_ + 1, std::ceil(last_));
    }
    zero_band_ = has_zero ? kZeroBand : 0;
    make_decades(static_cast<int>(std::ceil((last_ - first_) / kMostTicks)));
  } else {
    if (is_empty) least = 0, largest = 1;
    if (!(least < largest)) {  // one value, which has no size but its own
      (least < 0 ? largest : least) = 0;
      if (!(least < largest)) largest = 1;
    }
    const double size = std::max({std::abs(least), std::abs(largest), 1e-300});
    const double step = round_step(std::max((largest - least) / kMostTicks, 1e-9 * size));
    first_ = step * std::floor(least / step + 1e-9);
    last_ = std::max(first_ + step, step * std::ceil(largest / step - 1e-9));
    make_steps(step);
  }
}

double AxisScale::place(double value) const {
  value = std::min(value, most_);
  if (!is_log_) return std::clamp((value - first_) / (last_ - first_), 0.0, 1.0);
  if (!(value > 0)) return 0;
  const double along = (std::log10(value) - first_) / (last_ - first_);
  return std::clamp(zero_band_ + (1 - zero_band_) * along, 0.0, 1.0);
}

void AxisScale::make_decades(int stride) {
  if (zero_band_ > 0) ticks_.push_back({0, "0"});
  const auto first = static_cast<int>(std::ceil(first_));
  for (int k = first; k <= last_; ++k) {
    const bool has_label = (k - first) % stride == 0;
    ticks_.push_back({place(std::pow(10.0, k)), has_label ? power_of_ten(k) : ""});
  }
}

void AxisScale::make_steps(double step) {
  const auto count = static_cast<int>(std::lround((last_ - first_) / step));
  for (int k = 0; k <= count; ++k) {
    const double value = first_ + k * step;
    // A zero that rounding left a little beside zero.
    const double label = std::abs(value) < 1e-9 * step ? 0 : value;
    ticks_.push_back({place(value), fmt::format("{:.6g}", label)});
  }
}

}  // namespace scree
