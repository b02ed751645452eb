#pragma once
// Images of box and mesh walls in a periodic domain: every one that a body can reach.

#include "kernels/math/periodic.h"
#include "kernels/narrow_phase/walls.h"

namespace scree {

/// Images on either side of the one nearest to a body that are searched along a periodic axis.
inline constexpr int kImagesAside = 3;
/// The most periods a wall may span, so that all it may touch are among them.
inline constexpr int kMostPeriods = 2 * kImagesAside - 1;

/// Images of a wall along an axis that have names.
SCREE_HD inline int image_count(double period) { return period > 0 ? 2 * kImagesAside + 1 : 1; }
/// Images of a wall that have names.
SCREE_HD inline int image_count(const Vec3d& period) {
  return image_count(period.x) * image_count(period.y) * image_count(period.z);
}

/// Whether a wall is the same all along an axis: then it has one image there, whose center goes with the body.
SCREE_HD inline bool is_endless(const WallSolid& solid, int axis) {
  return (solid.endless >> axis & 1) != 0;
}

/// Center of a body to the center of that image of a wall whose middle is nearest to it [m].
SCREE_HD inline Vec3d nearest_wall(const WallSolid& solid, const Vec3d& period, const Vec3d& x) {
  const Vec3d d = solid.center - x;
  Vec3d nearest = minimum_image(d + solid.middle, period) - solid.middle;
  for (int k = 0; k < 3; ++k)
    if (is_endless(solid, k)) nearest[k] = 0;
  return nearest;
}

/// The same to a given image.
SCREE_HD inline Vec3d image_of_wall(const WallSolid& solid, const Vec3d& period, const Vec3d& x,
                                    std::uint32_t image) {
  Vec3d d = solid.center - x;
  if (!(period.x > 0 || period.y > 0 || period.z > 0)) return d;
  d = nearest_wall(solid, period, x);
  for (int k = 0; k < 3; ++k) {
    const auto count = static_cast<std::uint32_t>(image_count(period[k]));
    if (count > 1) d[k] += (static_cast<double>(image % count) - kImagesAside) * period[k];
    image /= count;
  }
  return d;
}

/// The images that touch a box about a body; by default the only one.
struct WallImages {
  int first[3] = {0, 0, 0};
  int last[3] = {0, 0, 0};

  WallImages() = default;
  /// @param reach  half the edge of that box [m]
  SCREE_HD WallImages(const WallSolid& solid, const Vec3d& period, const Vec3d& x, double reach) {
    for (int k = 0; k < 3; ++k) {
      if (!(period[k] > 0)) continue;
      const double d = nearest_wall(solid, period, x)[k] + solid.middle[k];
      const double far = solid.half[k] + reach;
      first[k] = last[k] = kImagesAside;
      if (is_endless(solid, k)) continue;
      while (first[k] > 0 && d - (kImagesAside - first[k] + 1) * period[k] >= -far) --first[k];
      while (last[k] < 2 * kImagesAside && d + (last[k] + 1 - kImagesAside) * period[k] <= far) {
        ++last[k];
      }
    }
  }
  SCREE_HD bool is_one() const {
    return first[0] == last[0] && first[1] == last[1] && first[2] == last[2];
  }
  /// Calls f(image) for each, in ascending order.
  template <class F>
  SCREE_HD void for_each(const Vec3d& period, F&& f) const {
    const int nx = image_count(period.x), ny = image_count(period.y);
    for (int z = first[2]; z <= last[2]; ++z) {
      for (int y = first[1]; y <= last[1]; ++y) {
        for (int x = first[0]; x <= last[0]; ++x) {
          f(static_cast<std::uint32_t>((z * ny + y) * nx + x));
        }
      }
    }
  }
};

}  // namespace scree
