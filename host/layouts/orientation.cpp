#include <cmath>

#include "host/layouts/layouts.h"

namespace scree {
namespace {

/// A point of the unit disk, all of them alike likely. @return its squared distance from the center
double draw_in_disk(RandomNumbers& random, double& x, double& y) {
  for (;;) {
    x = random.uniform(-1, 1);
    y = random.uniform(-1, 1);
    const double square = std::fma(x, x, y * y);
    if (square < 1 && square > 0) return square;
  }
}

}  // namespace

/// A point of the unit sphere in four dimensions, by two of disks (Marsaglia 1972): no function
/// enters it whose last bit depends on the platform.
Quatd random_orientation(RandomNumbers& random) {
  Quatd q;
  const double first = draw_in_disk(random, q.w, q.x);
  const double second = draw_in_disk(random, q.y, q.z);
  const double stretch = std::sqrt((1 - first) / second);
  q.y *= stretch;
  q.z *= stretch;
  return q;
}

}  // namespace scree
