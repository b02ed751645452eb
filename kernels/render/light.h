#pragma once
// Light that reaches a point: the shadow of the key light, and how much of the sky neighbors hide.

#include "kernels/render/visibility.h"

namespace scree::render {

inline constexpr int kTaps = 8;                                            ///< per sample
inline constexpr int kDiskTaps = kTaps * kSupersampling * kSupersampling;  ///< per pixel
inline constexpr int kOcclusionReach = 160;  ///< farthest occlusion tap [samples]

/// Points spread evenly over the unit disk. The samples of one pixel take different ones, so that a
/// pixel averages all of them; the pattern is fixed, so pictures repeat bit for bit.
struct TapDisk {
  float x[kDiskTaps] = {};
  float y[kDiskTaps] = {};
};

/// Fills a disk with a sunflower spiral. Host only: element programs take the finished table.
inline TapDisk make_tap_disk() {
  TapDisk disk;
  for (int k = 0; k < kDiskTaps; ++k) {
    const float r = std::sqrt((static_cast<float>(k) + 0.5f) / static_cast<float>(kDiskTaps));
    const float angle = 2.39996323f * static_cast<float>(k);
    disk.x[k] = r * std::cos(angle);
    disk.y[k] = r * std::sin(angle);
  }
  return disk;
}

/// Shadows by the depth buffer of an orthographic view along the light.
struct Shadow {
  View light;
  Span<const std::uint32_t> samples;
  Vec3f eye_offset;    ///< camera origin minus light origin [m]
  float penumbra = 0;  ///< radius of the soft border [m]

  /// Part of the light that arrives, 0 to 1.
  /// @param point   relative to the camera origin, world axes [m]
  /// @param normal  unit, world axes
  SCREE_HD float operator()(const TapDisk& disk, int sub, const Vec3f& point,
                            const Vec3f& normal) const {
    // Starting off the surface by the filter's reach keeps a surface from shadowing itself.
    const Vec3f p = point + eye_offset + (penumbra + 1.5f * light.pitch) * normal;
    const float s = 1.0f / light.pitch;
    const float fx = (dot(p, light.right) - light.left) * s;
    const float fy = (light.top - dot(p, light.up)) * s;
    const float depth = dot(p, light.forward);
    const float reach = penumbra * s;
    if (fx < -reach || fy < -reach || fx > static_cast<float>(light.width) + reach ||
        fy > static_cast<float>(light.height) + reach) {
      return 1.0f;
    }
    int lit = 0;
    for (int k = 0; k < kTaps; ++k) {
      const int tap = k * kSupersampling * kSupersampling + sub;
      const int i = static_cast<int>(std::floor(fx + reach * disk.x[tap]));
      const int j = static_cast<int>(std::floor(fy + reach * disk.y[tap]));
      const bool inside = i >= 0 && j >= 0 && i < light.width && j < light.height;
      lit += !inside || depth < depth_of(samples[light.index(i, j)]) ? 1 : 0;
    }
    return static_cast<float>(lit) / static_cast<float>(kTaps);
  }
};

/// Ambient occlusion from the depths around a sample, at two reaches: the gaps between bodies, and
/// hollows of a few body sizes.
struct Occlusion {
  View view;
  Span<const std::uint64_t> samples;  ///< read up to kOcclusionReach rows away from row j
  float reach_small = 1;              ///< [m]
  float reach_large = 1;              ///< [m]

  /// Part of the sky that is hidden, 0 to 1.
  /// @param point, normal  view coordinates
  /// @param wide           look at both reaches; plain walls take the small one only, since the
  /// sparse
  ///                       taps of the large one would show on them as ghosts of what stands before
  ///                       them
  SCREE_HD float operator()(const TapDisk& disk, int i, int j, const Vec3f& point,
                            const Vec3f& normal, bool wide) const {
    const int sub = (i & 1) + 2 * (j & 1);
    const float inv_footprint = 1.0f / view.footprint(point.z);
    float hidden = 0;
    for (int k = 0; k < kTaps; ++k) {
      const int tap = k * kSupersampling * kSupersampling + sub;
      const float reach = wide && (k & 1) != 0 ? reach_large : reach_small;
      const float spread = clamp(reach * inv_footprint, 3.0f, static_cast<float>(kOcclusionReach));
      const int x = i + static_cast<int>(std::floor(spread * disk.x[tap] + 0.5f));
      const int y = j + static_cast<int>(std::floor(spread * disk.y[tap] + 0.5f));
      if (x < 0 || y < 0 || x >= view.width || y >= view.height) continue;
      const std::uint64_t sample = samples[view.index(x, y)];
      if (sample == kNothing) continue;
      const Vec3f d = view.at(view.plane_x(x), view.plane_y(y), depth_of(sample)) - point;
      const float d2 = norm2(d) + kTiny;
      const float fade = 1.0f - d2 / (2.0f * reach * reach);
      const float above = dot(d, normal) / std::sqrt(d2) - 0.08f;
      if (fade > 0.0f && above > 0.0f) hidden += above * fade;
    }
    return smaller(hidden * (2.7f / static_cast<float>(kTaps)), 1.0f);
  }
};

}  // namespace scree::render
