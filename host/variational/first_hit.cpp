#include "host/variational/first_hit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/error.h"

namespace scree::variational {
namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostSteps = 10000;
/// Where a way touches a wall without a rate, it is looked at after this share of its time.
constexpr double kProbe = 1e-3;
/// Systems that go along a wall without forces, as bodies that stay together, may do so off it by this many roundings.
constexpr double kAlongSlack = 4096;

/// The first r > 0 with value + rate r + bend r^2/2 = 0, value >= 0; infinite if there is none.
double first_zero(double value, double rate, double bend) {
  const double d = rate * rate - 2 * bend * value;
  if (bend >= 0 && (rate >= 0 || d < 0)) return kInfinity;
  if (bend < 0 && rate > 0) return (rate + std::sqrt(d)) / -bend;
  return 2 * value / (-rate + std::sqrt(d));
}

double value_of(const Wall& wall, const WallFunction& part, const Vector& q) {
  const double value = part.value(as_span(q));
  if (!std::isfinite(value))
    throw RunError(
        fmt::format("wall \"{}\": its value is {}, expected a finite number", wall.name, value));
  return value;
}

double value_of(const Wall& wall, const Vector& q) {
  double most = -kInfinity;
  for (const WallFunction& part : wall.parts) most = std::max(most, value_of(wall, part, q));
  return most;
}

bool has_bounds(const Wall& wall) {
  return std::all_of(wall.parts.begin(), wall.parts.end(),
                     [](const WallFunction& part) { return !part.curvature.empty(); });
}

}  // namespace

double gap_at(std::span<const Wall> walls, const Vector& q) {
  double least = kInfinity;
  for (const Wall& wall : walls) least = std::min(least, value_of(wall, q));
  return least;
}

double rounding_of(const Vector& gradient, const Vector& q) {
  return 4 * kEpsilon * gradient.cwiseAbs().dot(q.cwiseAbs());
}

double rounding_of(const Vector& gradient, const Vector& q, const Way& way) {
  double sum = 0;
  for (Eigen::Index i = 0; i < q.size(); ++i)
    sum += std::abs(gradient[i]) *
           (std::abs(q[i]) + way.step * (std::abs(way.velocity[i]) +
                                         0.5 * way.step * std::abs(way.acceleration[i])));
  return 4 * kEpsilon * sum;
}

HitSearch::HitSearch(std::span<const Wall> walls, int n, int samples)
    : walls_(walls), samples_(samples), q_(n), w_(n), gradient_(n) {}

std::optional<double> HitSearch::first(const Way& way) {
  std::optional<double> first;
  double limit = way.duration;
  for (const Wall& wall : walls_) {
    const auto hit =
        has_bounds(wall) ? first_of(wall, way, limit) : first_sampled(wall, way, limit);
    if (!hit) continue;
    first = hit;
    limit = *hit;
  }
  return first;
}

std::optional<double> HitSearch::first_of(const Wall& wall, const Way& way, double limit) {
  double s = 0;
  for (int k = 0; k < kMostSteps; ++k) {
    const double r = safe_time(wall, way, s, limit);
    if (r >= limit - s) return {};
    if (r <= 4 * kEpsilon * way.step) return s;
    s += r;
  }
  return s;
}

double HitSearch::safe_time(const Wall& wall, const Way& way, double s, double limit) {
  way.place(s, q_);
  way.rate(s, w_);
  const double left = limit - s;
  double safe = 0;
  for (const WallFunction& part : wall.parts) {
    const double value = value_of(wall, part, q_);
    part.gradient(as_span(q_), as_span(gradient_));
    const double rate = gradient_.dot(w_);
    const double bend = gradient_.dot(way.acceleration);
    double most = 0, pull = 0;  // of b.w^2 and b.a^2
    double rate_rounding = 0;
    for (Eigen::Index i = 0; i < q_.size(); ++i) {
      const double a = way.acceleration[i], b = part.curvature[static_cast<std::size_t>(i)];
      const double w = std::max(std::abs(w_[i]), std::abs(w_[i] + left * a));
      most += b * w * w;
      pull += b * a * a;
      rate_rounding += 64 * kEpsilon * std::abs(gradient_[i] * w_[i]);
    }
    const double bound = bend - (most + left * std::sqrt(most * pull));
    const double rounding = rounding_of(gradient_, q_, way);
    const double slack = s == 0 ? kStartSlack * rounding : rounding;
    if (value > slack || (value >= -slack && rate > rate_rounding)) {
      safe = std::max(safe, first_zero(std::max(0.0, value), rate, bound));
    } else if (s == 0 && value >= -kAlongSlack * rounding && rate >= -rate_rounding) {
      safe = std::max(safe, safe_time_along(wall, part, way, left, rounding));
      way.place(s, q_);
    }
  }
  return safe;
}

double HitSearch::safe_time_along(const Wall& wall, const WallFunction& part, const Way& way,
                                  double left, double rounding) {
  const auto later = [&](double time) {
    way.place(time, q_);
    return value_of(wall, part, q_);
  };
  if (later(kProbe * left) > kStartSlack * rounding) return kProbe * left;
  for (const double share : {kProbe, 0.5, 1.0})
    if (later(share * left) < -kAlongSlack * rounding) return 0;
  return left;
}

double HitSearch::value_on(const Wall& wall, const Way& way, double s) {
  way.place(s, q_);
  return value_of(wall, q_);
}

double HitSearch::rate_on(const Wall& wall, const Way& way, double s) {
  way.place(s, q_);
  way.rate(s, w_);
  const auto largest = std::max_element(
      wall.parts.begin(), wall.parts.end(),
      [&](const auto& a, const auto& b) { return a.value(as_span(q_)) < b.value(as_span(q_)); });
  largest->gradient(as_span(q_), as_span(gradient_));
  return gradient_.dot(w_);
}

std::optional<double> HitSearch::first_sampled(const Wall& wall, const Way& way, double limit) {
  double a = 0, rate_a = rate_on(wall, way, 0);
  const double slack = kAlongSlack * rounding_of(gradient_, q_, way);
  if (value_on(wall, way, 0) <= slack && rate_a <= 0 &&
      value_on(wall, way, kProbe * limit) < -slack)
    return 0;
  // Keeps a point where the wall is positive below one where it is not.
  const auto zero_between = [&](double low, double high) {
    while (high - low > 4 * kEpsilon * way.step) {
      const double middle = 0.5 * (low + high);
      (value_on(wall, way, middle) > 0 ? low : high) = middle;
    }
    return low;
  };
  for (int i = 1; i <= samples_; ++i) {
    const double b = limit * i / samples_, rate_b = rate_on(wall, way, b);
    if (value_on(wall, way, b) < -slack) return zero_between(a, b);
    if (rate_a < 0 && rate_b > 0) {
      double low = a, high = b;
      while (high - low > kEpsilon * way.step + 1e-8 * (b - a)) {
        const double middle = 0.5 * (low + high);
        (rate_on(wall, way, middle) < 0 ? low : high) = middle;
      }
      if (value_on(wall, way, low) < -slack) return zero_between(a, low);
    }
    a = b;
    rate_a = rate_b;
  }
  return {};
}

}  // namespace scree::variational
