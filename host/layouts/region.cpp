#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/layouts/layouts.h"
#include "host/world.h"

namespace scree {
namespace {

/// One of several, by their weights.
std::size_t draw_index(const std::vector<double>& weights, RandomNumbers& random) {
  double total = 0;
  for (const double weight : weights) total += weight;
  double left = total * random.unit();
  for (std::size_t i = 0; i < weights.size(); ++i) {
    left -= weights[i];
    if (left < 0) return i;
  }
  return weights.size() - 1;
}

}  // namespace

bool Region::contains(const Vec3d& point, double r) const {
  if (kind == Kind::box) {
    for (int k = 0; k < 3; ++k)
      if (!(point[k] - r >= lower[k] && point[k] + r <= upper[k])) return false;
    return true;
  }
  const Vec3d offset = point - center;
  const double along = dot(offset, axis);
  return std::abs(along) + r <= length / 2 && norm(offset - along * axis) + r <= radius;
}

void Region::bounds(Vec3d& low, Vec3d& high) const {
  low = lower;
  high = upper;
  if (kind == Kind::box) return;
  for (int k = 0; k < 3; ++k) {
    const double across = std::sqrt(std::max(0.0, 1 - axis[k] * axis[k]));
    const double reach = std::abs(axis[k]) * length / 2 + across * radius;
    low[k] = center[k] - reach;
    high[k] = center[k] + reach;
  }
}

double RadiusLaw::draw(RandomNumbers& random) const {
  switch (kind) {
    case Kind::constant:
      return low;
    case Kind::uniform:
      return random.uniform(low, high);
    case Kind::normal:
      return draw_normal(random);
    case Kind::discrete:
      break;
  }
  return values[draw_index(weights, random)];
}

SizeLaw::Size SizeLaw::draw(RandomNumbers& random) const {
  Size size;
  const std::size_t shape = radii.size() > 1 ? draw_index(weights, random) : 0;
  size.scale = scale.draw(random);
  size.radius = has_shapes() ? size.scale * radii[shape] : size.scale;
  size.shape = static_cast<int>(shape);
  return size;
}

double SizeLaw::smallest() const {
  return scale.smallest() * (has_shapes() ? *std::min_element(radii.begin(), radii.end()) : 1);
}

double SizeLaw::largest() const {
  return scale.largest() * (has_shapes() ? *std::max_element(radii.begin(), radii.end()) : 1);
}

bool SizeLaw::is_constant() const {
  return scale.kind == RadiusLaw::Kind::constant && radii.size() <= 1;
}

/// Redraws what lies outside. From a range so narrow that few draws would hit it, draws evenly and
/// keeps by density, which gives the same distribution and always ends.
double RadiusLaw::draw_normal(RandomNumbers& random) const {
  constexpr double kNarrow = 0.1;  // of the deviation: one draw in 25 still hits a wider range
  if (high - low < kNarrow * deviation) {
    for (;;) {
      const double r = random.uniform(low, high);
      const double away = (r - mean) / deviation;
      if (random.unit() < std::exp(-0.5 * away * away)) return r;
    }
  }
  for (;;) {
    const double r = std::fma(deviation, random.normal(), mean);
    if (r >= low && r <= high) return r;
  }
}

double RadiusLaw::smallest() const {
  if (kind == Kind::discrete) return *std::min_element(values.begin(), values.end());
  return low;
}

double RadiusLaw::largest() const {
  if (kind == Kind::constant) return low;
  if (kind == Kind::discrete) return *std::max_element(values.begin(), values.end());
  return high;
}

void require_resolution(const Region& region, double smallest_radius) {
  constexpr double kParts = 1e6;  // of a radius that coordinates must tell
  Vec3d low;
  Vec3d high;
  region.bounds(low, high);
  double farthest = 0;
  for (int k = 0; k < 3; ++k) farthest = std::max({farthest, std::abs(low[k]), std::abs(high[k])});
  const double most = smallest_radius / (kParts * std::numeric_limits<double>::epsilon());
  if (!(farthest <= most))
    throw DoesNotFit(fmt::format(
        "the region reaches {:.3g} m from the origin, where positions cannot tell spheres of "
        "radius {:.3g} m apart; must stay within {:.3g} m",
        farthest, smallest_radius, most));
}

void require_host_memory(long long count, const SizeLaw& size) {
  double bytes = sizeof(Vec3d);
  if (!size.is_constant()) bytes += 2 * sizeof(double);
  if (!size.is_constant() && size.has_shapes())
    bytes += sizeof(double) + sizeof(int) + sizeof(Shape);
  require_host_memory(count, bytes);
}

void require_host_memory(long long count, double bytes_each) {
  const double bytes = static_cast<double>(count) * bytes_each;
  constexpr double kSmall = 1 << 26;  // not worth asking for
  if (bytes < kSmall) return;
  const auto free = static_cast<double>(device_info(BackendKind::cpu).free_bytes);
  constexpr double mib = 1024.0 * 1024.0;
  if (bytes > free)
    throw DoesNotFit(fmt::format("{} spheres take {:.0f} MiB of host memory, {:.0f} MiB are free",
                                 count, bytes / mib, free / mib));
}

}  // namespace scree
