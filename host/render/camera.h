#pragma once
// Where the camera and the key light of a picture stand. Plain host arithmetic in double; the
// result is a View, which the element programs use.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "host/scene.h"
#include "kernels/render/statistics.h"
#include "kernels/render/view.h"

namespace scree::render {

/// An axis-aligned box in the world [m]; empty while lower > upper.
struct Box {
  Vec3d lower{1, 1, 1};
  Vec3d upper{0, 0, 0};

  bool empty() const { return lower.x > upper.x || lower.y > upper.y || lower.z > upper.z; }
  Vec3d center() const { return 0.5 * (lower + upper); }
  double diagonal() const { return norm(upper - lower); }
  Vec3d corner(int c) const {
    return {(c & 1) != 0 ? upper.x : lower.x, (c & 2) != 0 ? upper.y : lower.y,
            (c & 4) != 0 ? upper.z : lower.z};
  }
};

/// Smallest box around both; an empty one adds nothing.
inline Box join(const Box& a, const Box& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {{std::min(a.lower.x, b.lower.x), std::min(a.lower.y, b.lower.y),
           std::min(a.lower.z, b.lower.z)},
          {std::max(a.upper.x, b.upper.x), std::max(a.upper.y, b.upper.y),
           std::max(a.upper.z, b.upper.z)}};
}

/// Common part of both; may be empty.
inline Box cut(const Box& a, const Box& b) {
  return {{std::max(a.lower.x, b.lower.x), std::max(a.lower.y, b.lower.y),
           std::max(a.lower.z, b.lower.z)},
          {std::min(a.upper.x, b.upper.x), std::min(a.upper.y, b.upper.y),
           std::min(a.upper.z, b.upper.z)}};
}

/// The box grown by `margin` [m] on every side.
inline Box grown(const Box& a, double margin) {
  const Vec3d m{margin, margin, margin};
  return {a.lower - m, a.upper + m};
}

/// The box around the centers of most bodies: along each axis the two percent at either end are
/// left out, so fewer than 50 bodies all count. Points that are not finite do not.
inline Box bulk_of(std::vector<Vec3d> centers) {
  std::erase_if(centers, [](const Vec3d& p) { return !is_finite(p); });
  if (centers.empty()) return {};
  const std::size_t cut = centers.size() / 50;
  Box box{centers[0], centers[0]};
  std::vector<double> along(centers.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < along.size(); ++i) along[i] = centers[i][axis];
    const auto low = along.begin() + static_cast<std::ptrdiff_t>(cut);
    const auto high = along.end() - 1 - static_cast<std::ptrdiff_t>(cut);
    std::nth_element(along.begin(), low, along.end());
    box.lower[axis] = *low;
    std::nth_element(along.begin(), high, along.end());
    box.upper[axis] = *high;
  }
  return box;
}

/// Keeps bodies within half the size of the bulk beside it. That is more than a heap or a full
/// container reaches beyond the middle 96 percent of its bodies, and less than strays fly.
inline KeepRule keep_rule(const Box& bulk, double mean_radius) {
  if (bulk.empty()) return {};
  const Vec3d size = bulk.upper - bulk.lower;
  const Vec3d margin = 0.5 * size + Vec3d{1, 1, 1} * (3 * mean_radius);
  const double far = 2 * std::max({size.x, size.y, size.z});
  return {bulk.lower - margin, bulk.upper + margin, {far, far, far}, 3 * mean_radius};
}

/// Right-handed axes of a camera: right x up = -forward.
struct CameraAxes {
  Vec3d right;
  Vec3d up;
  Vec3d forward;
};

/// Axes that look along `direction` with `up` pointing up in the picture. Directions that leave the
/// axes undefined (zero, or parallel to up) get some valid answer.
inline CameraAxes camera_axes(const Vec3d& direction, const Vec3d& up) {
  CameraAxes axes;
  axes.forward = normalized(direction, Vec3d{0, 1, 0});
  const Vec3d vertical = normalized(up);
  Vec3d right = cross(axes.forward, vertical);
  if (norm(right) < 1e-6) right = any_orthogonal(axes.forward);
  axes.right = normalized(right);
  axes.up = cross(axes.right, axes.forward);
  return axes;
}

/// Axes of the automatic camera: a three-quarter view from the front right and above.
/// @param base    gives vertical_angle and up
/// @param center  any point near what is to be shown [m]
/// @param aspect  picture width / height
/// @param margin  part of the half picture left free on the tightest side, 0 to 1
inline FrameAxes automatic_axes(const CameraSettings& base, const Vec3d& center, double aspect,
                                double margin = 0.08) {
  // 32 degrees off the front, 27 degrees above the horizon; "front" is -y where z is up.
  const Vec3d up = normalized(base.up);
  const bool z_is_up = norm(cross(up, Vec3d{0, 0, 1})) < 1e-6;
  const Vec3d front = z_is_up ? Vec3d{0, -1, 0} : any_orthogonal(up);
  const Vec3d side = cross(up, front) * (up.z < 0 ? -1.0 : 1.0);
  constexpr double kDegree = std::numbers::pi / 180;
  const double azimuth = 32 * kDegree, elevation = 27 * kDegree;
  const Vec3d away = std::cos(elevation) * (std::cos(azimuth) * front + std::sin(azimuth) * side) +
                     std::sin(elevation) * up;
  const CameraAxes axes = camera_axes(-away, up);
  const double tan_y = std::tan(0.5 * base.vertical_angle * kDegree) * (1 - margin);
  return {center, axes.right, axes.up, axes.forward, tan_y * aspect, tan_y};
}

/// Frame sides of the corners of a box; an empty one adds nothing.
inline FrameSides box_sides(const FrameAxes& axes, const Box& box) {
  FrameSides sides;
  for (int k = 0; k < 8 && !box.empty(); ++k) sides.combine(axes.sides(box.corner(k), 0));
  return sides;
}

/// Axes with the opening narrowed where the picture has room to spare, so that another
/// measurement centers what is shown there, too. Measure, narrow and measure again a few times:
/// kFramingPasses are enough.
inline FrameAxes narrowed(const FrameAxes& axes, const FrameSides& sides) {
  FrameAxes result = axes;
  const double z_x = 0.5 * (sides.left + sides.right), z_y = 0.5 * (sides.bottom + sides.top);
  if (!(z_x < 0 && z_y < 0)) return result;  // nothing to show, or a single point
  const double z = std::min(z_x, z_y);
  result.tan_x = axes.tan_x * (z_x / z);
  result.tan_y = axes.tan_y * (z_y / z);
  return result;
}

inline constexpr int kFramingPasses = 5;

/// The nearest camera along `axes` that shows everything `sides` was measured on.
/// @param size  size of what is shown [m]; keeps the camera off a single point
inline CameraSettings framing_camera(const CameraSettings& base, const FrameAxes& axes,
                                     const FrameSides& sides, double size) {
  CameraSettings camera = base;
  if (sides.nearest > 1e299) return camera;  // nothing to show
  // At (x, y, z) in these axes a point p is inside when |p.x - x| <= tan_x (p.z - z), so each side
  // bounds z by a linear function of x (or y); the best x balances left and right.
  const double x = 0.5 * axes.tan_x * (sides.left - sides.right);
  const double y = 0.5 * axes.tan_y * (sides.bottom - sides.top);
  double z = std::min(0.5 * (sides.left + sides.right), 0.5 * (sides.bottom + sides.top));
  z = std::min(z, sides.nearest - 1e-3 * std::max(size, 1e-12));
  camera.position = axes.center + x * axes.right + y * axes.up + z * axes.forward;
  camera.target = axes.center + x * axes.right + y * axes.up;
  if (z > -1e-9 * size) camera.target = camera.position + std::max(size, 1e-12) * axes.forward;
  return camera;
}

/// The perspective view of a camera.
/// @param width, height  picture size [pixels]
/// @param scene_size     size of what is shown [m]; sets the near plane
inline View camera_view(const CameraSettings& camera, int width, int height, double scene_size) {
  const CameraAxes axes = camera_axes(camera.target - camera.position, camera.up);
  View view;
  view.origin = camera.position;
  view.right = Vec3f(axes.right);
  view.up = Vec3f(axes.up);
  view.forward = Vec3f(axes.forward);
  view.width = width * kSupersampling;
  view.height = height * kSupersampling;
  const double tan_y = std::tan(0.5 * camera.vertical_angle * std::numbers::pi / 180);
  view.pitch = static_cast<float>(2 * tan_y / view.height);
  view.left = static_cast<float>(-tan_y * width / height);
  view.top = static_cast<float>(tan_y);
  const double distance = norm(camera.target - camera.position);
  view.near_depth = static_cast<float>(std::max(1e-4 * std::min(scene_size, distance), 1e-12));
  return with_all_rows(view);
}

/// Unit vector to the key light: from the upper left, a little in front of what the camera sees.
inline Vec3d key_light_direction(const CameraSettings& camera) {
  const CameraAxes axes = camera_axes(camera.target - camera.position, camera.up);
  const Vec3d up = normalized(camera.up);
  // Level direction back to the camera; looking straight down, the picture's lower side.
  const Vec3d back = normalized(cross(axes.right, up) * -1.0, -axes.up);
  return normalized(-0.62 * axes.right + 1.0 * up + 0.30 * back);
}

/// The orthographic view along the light that covers `box`; empty boxes give an empty view.
/// @param to_light  unit
/// @param side      samples per axis
inline View light_view(const Box& box, const Vec3d& to_light, int side) {
  View view;
  view.orthographic = true;
  if (box.empty()) return view;
  const CameraAxes axes = camera_axes(-to_light, any_orthogonal(to_light));
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (int k = 0; k < 8; ++k) {
    const Vec3d d = box.corner(k) - box.center();
    const Vec3d v{dot(d, axes.right), dot(d, axes.up), dot(d, axes.forward)};
    for (int a = 0; a < 3; ++a) {
      low[a] = std::min(low[a], v[a]);
      high[a] = std::max(high[a], v[a]);
    }
  }
  const double half = std::max(0.505 * std::max(high.x - low.x, high.y - low.y), 1e-12);
  const double margin = 0.01 * (high.z - low.z) + 1e-12;
  view.origin = box.center() + (low.z - margin) * axes.forward;
  view.right = Vec3f(axes.right);
  view.up = Vec3f(axes.up);
  view.forward = Vec3f(axes.forward);
  view.width = side;
  view.height = side;
  view.pitch = static_cast<float>(2 * half / side);
  view.left = static_cast<float>(-half);
  view.top = static_cast<float>(half);
  return with_all_rows(view);
}

}  // namespace scree::render
