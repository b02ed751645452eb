#pragma once
// Light that reaches a point: the shadow of the key light, and how much of the sky neighbors hide.

#include "kernels/render/visibility.h"

namespace scree::render {

inline constexpr int kOcclusionReach = 160;  ///< farthest occlusion tap [samples]

/// Points spread evenly over the unit disk. The samples of one pixel take different ones, so that a
/// pixel averages all of them; the pattern is fixed, so pictures repeat bit for bit.
/// @tparam taps  points that one sample takes
template <int taps>
struct TapDisk {
  static constexpr int kTaps = taps;
  static constexpr int kPoints = taps * kSupersampling * kSupersampling;
  float x[kPoints] = {};
  float y[kPoints] = {};

  /// Number of point k of a sample. @param sub  number of the sample in its pixel
  SCREE_HD static int point(int k, int sub) { return k * kSupersampling * kSupersampling + sub; }
};

/// Movable bodies are small and textured: few taps will do. On walls, which are large and plain,
/// few taps would show as faint copies of the outlines before them.
using BodyTaps = TapDisk<8>;
using WallTaps = TapDisk<32>;

/// Fills a disk with a sunflower spiral. Host only: element programs take the finished table.
template <class Disk>
Disk make_tap_disk() {
  Disk disk;
  for (int k = 0; k < Disk::kPoints; ++k) {
    const float r = std::sqrt((static_cast<float>(k) + 0.5f) / static_cast<float>(Disk::kPoints));
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
  float penumbra = 0;  ///< radius of the soft border [m], at least kLeastPenumbra samples

  /// A border of fewer samples of the light's view would show their edges.
  static constexpr float kLeastPenumbra = 2.5f;
  /// Part of the light's view at its borders over which shadows fade.
  static constexpr float kFade = 0.04f;

  /// Part of the light that arrives, 0 to 1.
  /// @param point   relative to the camera origin, world axes [m]
  /// @param normal  unit, world axes, towards the light
  template <class Disk>
  SCREE_HD float operator()(const Disk& disk, int sub, const Vec3f& point,
                            const Vec3f& normal) const {
    // Taps are compared with the depth of the surface's own tangent plane there, so a flat surface
    // cannot shadow itself; the small step off it covers rounding and concave surfaces.
    const Vec3f p = point + eye_offset + (1.5f * light.pitch) * normal;
    const float s = 1.0f / light.pitch;
    const float fx = (dot(p, light.right) - light.left) * s;
    const float fy = (light.top - dot(p, light.up)) * s;
    const float depth = dot(p, light.forward);
    const float w = static_cast<float>(light.width), h = static_cast<float>(light.height);
    const float border = smaller(smaller(fx, w - fx), smaller(fy, h - fy));
    if (border <= 0.0f) return 1.0f;
    // Slopes along the view's columns and rows [m per sample]; grazing light gets little weight
    // anyway, and very steep planes would reach behind their bodies.
    constexpr float kLeastFacing = 0.1f;
    const float facing = larger(-dot(normal, light.forward), kLeastFacing);
    const float slope_x = dot(normal, light.right) / facing * light.pitch;
    const float slope_y = -dot(normal, light.up) / facing * light.pitch;
    const float reach = larger(penumbra * s, kLeastPenumbra);
    int lit = 0;
    for (int k = 0; k < Disk::kTaps; ++k) {
      const int tap = Disk::point(k, sub);
      const int i = static_cast<int>(std::floor(fx + reach * disk.x[tap]));
      const int j = static_cast<int>(std::floor(fy + reach * disk.y[tap]));
      if (i < 0 || j < 0 || i >= light.width || j >= light.height) {
        lit += 1;
        continue;
      }
      const float plane = depth + slope_x * (static_cast<float>(i) + 0.5f - fx) +
                          slope_y * (static_cast<float>(j) + 0.5f - fy);
      lit += plane < depth_of(samples[light.index(i, j)]) ? 1 : 0;
    }
    const float part = static_cast<float>(lit) / static_cast<float>(Disk::kTaps);
    return mix(1.0f, part, smooth_step(0.0f, kFade * w, border));
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
  /// @param wide           sample both reaches; plain walls take the small one only
  template <class Disk>
  SCREE_HD float operator()(const Disk& disk, int i, int j, const Vec3f& point, const Vec3f& normal,
                            bool wide) const {
    const int sub = (i & 1) + 2 * (j & 1);
    const float inv_footprint = 1.0f / view.footprint(point.z);
    float hidden = 0;
    for (int k = 0; k < Disk::kTaps; ++k) {
      const int tap = Disk::point(k, sub);
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
    return smaller(hidden * (2.7f / static_cast<float>(Disk::kTaps)), 1.0f);
  }
};

}  // namespace scree::render
