#pragma once
// When a way first leaves the walls.

#include <optional>
#include <span>

#include "host/mechanical_system.h"
#include "host/variational/way.h"

namespace scree::variational {

inline std::span<const double> as_span(const Vector& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}
inline std::span<double> as_span(Vector& v) {
  return {v.data(), static_cast<std::size_t>(v.size())};
}

/// A way begins on or within a wall to within this many roundings of the wall function.
inline constexpr double kStartSlack = 64;

/// Least of the walls at q; infinite without walls.
double gap_at(std::span<const Wall> walls, const Vector& q);

/// What rounding of q makes of a function with this gradient.
double rounding_of(const Vector& gradient, const Vector& q);
/// The same where q is a place of a way, with all that was added for it.
double rounding_of(const Vector& gradient, const Vector& q, const Way& way);

/// Finds first hits; keeps arrays, so that steps allocate nothing.
class HitSearch {
 public:
  HitSearch(std::span<const Wall> walls, int n, int samples);

  /// The first time at which a wall is zero and would be negative next, or none up to the end of the way. Walls that are zero at the
  /// start and grow are left behind, and so are those that stay zero, as between bodies that go on together. Where all parts have a curvature bound b, a part g is followed by
  ///
  ///   g(s + r) >= g + g' r + (grad g.a - K) r^2/2,   K = max b.w^2 + (D - s) (max b.w^2)^1/2 (b.a^2)^1/2
  ///
  /// with w the rates of the coordinates between s and the end D, a the acceleration: r to the zero of the bound is safe,
  /// and such steps come to the first zero of g from below, quadratically where it is crossed. Of several
  /// parts the one that is safe for longest counts.
  /// @throws RunError when a wall is not finite
  std::optional<double> first(const Way& way);

 private:
  std::optional<double> first_of(const Wall& wall, const Way& way, double limit);
  std::optional<double> first_sampled(const Wall& wall, const Way& way, double limit);
  double safe_time(const Wall& wall, const Way& way, double s, double limit);
  /// How long a part that is zero at the start, without a rate, is safe: until the end where it is zero there and on the way.
  double safe_time_along(const Wall& wall, const WallFunction& part, const Way& way, double left,
                         double rounding);
  double value_on(const Wall& wall, const Way& way, double s);
  double rate_on(const Wall& wall, const Way& way, double s);

  std::span<const Wall> walls_;
  int samples_;
  Vector q_, w_, gradient_;
};

}  // namespace scree::variational
