#include <algorithm>
#include <cmath>

#include "host/layouts/layouts.h"

namespace scree {

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
      for (;;) {
        const double r = std::fma(deviation, random.normal(), mean);
        if (r >= low && r <= high) return r;
      }
    case Kind::discrete:
      break;
  }
  double total = 0;
  for (const double weight : weights) total += weight;
  double left = total * random.unit();
  for (std::size_t i = 0; i < values.size(); ++i) {
    left -= weights[i];
    if (left < 0) return values[i];
  }
  return values.back();
}

double RadiusLaw::largest() const {
  if (kind == Kind::constant) return low;
  if (kind == Kind::discrete) return *std::max_element(values.begin(), values.end());
  return high;
}

}  // namespace scree
