#pragma once
// Cameras as the element programs see them: where the ray of a sample goes, and which samples a
// solid can cover. A sample is one ray; a pixel of the picture averages kSupersampling^2 of them.
//
// View coordinates are (x, y, z) along (right, up, forward), with the eye at zero. Depth is z [m].
// Everything here is float: positions are made relative to the eye in double first.

#include "kernels/math/quat.h"
#include "kernels/types.h"
#include "shapes/ray.h"

namespace scree::render {

using scree::Vec3f;

inline constexpr int kSupersampling = 2;  ///< samples per pixel and axis
/// Samples per axis of a chunk, one work item of a drawing pass.
inline constexpr int kChunkSide = 8;

SCREE_HD inline float smaller(float a, float b) { return a < b ? a : b; }
SCREE_HD inline float larger(float a, float b) { return a > b ? a : b; }
SCREE_HD inline float clamp(float a, float low, float high) {
  return smaller(larger(a, low), high);
}
SCREE_HD inline float mix(float a, float b, float t) { return a + (b - a) * t; }
SCREE_HD inline Vec3f mix(const Vec3f& a, const Vec3f& b, float t) { return a + (b - a) * t; }
/// The eye and the axes of a view in the frame of a solid: makes rays in that frame.
struct Eye {
  Vec3f origin;
  Vec3f right;
  Vec3f up;
  Vec3f forward;
  bool orthographic = false;

  /// The ray through (x, y) of the image plane.
  SCREE_HD Ray ray(float x, float y) const {
    const Vec3f across = x * right + y * up;
    if (orthographic) return {origin + across, forward};
    return {origin, forward + across};
  }
  /// View coordinates of a point of the frame.
  SCREE_HD Vec3f to_view(const Vec3f& p) const {
    const Vec3f q = p - origin;
    return {dot(q, right), dot(q, up), dot(q, forward)};
  }
  /// Frame vector from view components.
  SCREE_HD Vec3f from_view(const Vec3f& v) const { return v.x * right + v.y * up + v.z * forward; }
};

/// A camera or a light. Image-plane coordinates are tangents (perspective) or meters
/// (orthographic).
///
/// Its sample buffer is a ring of rows: row j of the image lies in row j modulo buffer_rows, so a
/// buffer lower than the image holds a window of it that moves down.
struct View {
  Vec3<double> origin;   ///< eye, or center of the orthographic near plane, world [m]
  Vec3f right;           ///< unit, world
  Vec3f up;              ///< unit, world
  Vec3f forward;         ///< unit, world
  float left = -1;       ///< image-plane x of the left border
  float top = 1;         ///< image-plane y of the upper border
  float pitch = 1;       ///< image-plane size of a sample
  float near_depth = 0;  ///< nothing nearer is drawn [m]; positive for a perspective view
  int width = 0;         ///< [samples]
  int height = 0;
  int row_begin = 0;  ///< rows [row_begin, row_end) are drawn now; solids are clipped to them
  int row_end = 0;
  int buffer_rows = 1;  ///< rows that the sample buffer holds
  bool orthographic = false;

  SCREE_HD float plane_x(int i) const { return left + pitch * (static_cast<float>(i) + 0.5f); }
  SCREE_HD float plane_y(int j) const { return top - pitch * (static_cast<float>(j) + 0.5f); }
  /// Samples of the buffer, and where it keeps sample (i, j).
  SCREE_HD Offset sample_count() const { return static_cast<Offset>(width) * buffer_rows; }
  SCREE_HD Offset index(int i, int j) const {
    return static_cast<Offset>(j % buffer_rows) * width + i;
  }
  /// Size of a sample at a depth [m].
  SCREE_HD float footprint(float depth) const { return orthographic ? pitch : pitch * depth; }
  /// View coordinates from image-plane coordinates and depth.
  SCREE_HD Vec3f at(float x, float y, float depth) const {
    return orthographic ? Vec3f{x, y, depth} : Vec3f{x * depth, y * depth, depth};
  }
  /// The eye in a frame at `position`, with world axes.
  SCREE_HD Eye eye_at(const Vec3<double>& position) const {
    return {Vec3f(origin - position), right, up, forward, orthographic};
  }
  /// The eye in the frame of a body.
  template <class Real>
  SCREE_HD Eye eye_at(const Vec3<double>& position, const Quat<Real>& orientation) const {
    const Quat<float> q = normalized(Quat<float>(orientation));
    return {rotate_back(q, Vec3f(origin - position)), rotate_back(q, right), rotate_back(q, up),
            rotate_back(q, forward), orthographic};
  }
};

/// The view with all rows drawn at once, into a buffer that holds them all.
inline View with_all_rows(View view) {
  view.row_begin = 0;
  view.row_end = view.height;
  view.buffer_rows = view.height > 0 ? view.height : 1;
  return view;
}

/// Samples [x_begin, x_end) x [y_begin, y_end).
struct SampleRect {
  int x_begin = 0;
  int x_end = 0;
  int y_begin = 0;
  int y_end = 0;

  SCREE_HD bool empty() const { return x_end <= x_begin || y_end <= y_begin; }
  SCREE_HD Index chunk_columns() const { return (x_end - x_begin + kChunkSide - 1) / kChunkSide; }
  SCREE_HD Index chunk_rows() const { return (y_end - y_begin + kChunkSide - 1) / kChunkSide; }
  SCREE_HD Index chunk_count() const { return empty() ? 0 : chunk_columns() * chunk_rows(); }
  SCREE_HD SampleRect chunk(Index c) const {
    const int x = x_begin + kChunkSide * (c % chunk_columns());
    const int y = y_begin + kChunkSide * (c / chunk_columns());
    return {x, x + kChunkSide < x_end ? x + kChunkSide : x_end, y,
            y + kChunkSide < y_end ? y + kChunkSide : y_end};
  }
};

/// All samples that are drawn now.
SCREE_HD inline SampleRect drawn_rect(const View& view) {
  return {0, view.width, view.row_begin, view.row_end};
}

/// Grows to the image-plane rectangle around points and edges in view coordinates.
/// Edges are cut at the near depth, so that solids which reach behind the eye get the rectangle
/// of their visible part.
struct PlaneBounds {
  float x_low = 1e30f, x_high = -1e30f;
  float y_low = 1e30f, y_high = -1e30f;

  SCREE_HD void add(float x, float y) {
    x_low = smaller(x_low, x);
    x_high = larger(x_high, x);
    y_low = smaller(y_low, y);
    y_high = larger(y_high, y);
  }
  SCREE_HD void add_point(const View& view, const Vec3f& p) {
    if (p.z < view.near_depth) return;
    if (view.orthographic) {
      add(p.x, p.y);
    } else {
      add(p.x / p.z, p.y / p.z);
    }
  }
  SCREE_HD void add_edge(const View& view, const Vec3f& a, const Vec3f& b) {
    add_point(view, a);
    add_point(view, b);
    if ((a.z < view.near_depth) == (b.z < view.near_depth)) return;
    Vec3f cut = a + ((view.near_depth - a.z) / (b.z - a.z)) * (b - a);
    cut.z = view.near_depth;
    add_point(view, cut);
  }
  /// Drawn samples whose centers may lie inside, `margin` samples added on each side.
  SCREE_HD SampleRect samples(const View& view, float margin = 0.0f) const {
    if (x_high < x_low) return {};
    const float s = 1.0f / view.pitch;
    // The half sample covers rounding: a rectangle may be too large, never too small.
    const float slack = 0.5f + margin;
    const float w = static_cast<float>(view.width);
    const float first = static_cast<float>(view.row_begin), end = static_cast<float>(view.row_end);
    SampleRect r;
    r.x_begin = static_cast<int>(clamp((x_low - view.left) * s - slack, 0.0f, w));
    r.x_end = static_cast<int>(clamp((x_high - view.left) * s + slack + 1.0f, 0.0f, w));
    r.y_begin = static_cast<int>(clamp((view.top - y_high) * s - slack, first, end));
    r.y_end = static_cast<int>(clamp((view.top - y_low) * s + slack + 1.0f, first, end));
    return r;
  }
};

/// Rectangle around a box given in the frame of `eye`.
SCREE_HD inline SampleRect box_rect(const View& view, const Eye& eye, const Vec3f& half_extents) {
  Vec3f corners[8];
  for (int c = 0; c < 8; ++c) {
    corners[c] = eye.to_view({(c & 1) != 0 ? half_extents.x : -half_extents.x,
                              (c & 2) != 0 ? half_extents.y : -half_extents.y,
                              (c & 4) != 0 ? half_extents.z : -half_extents.z});
  }
  PlaneBounds bounds;
  for (int c = 0; c < 8; ++c) {
    for (int bit = 1; bit < 8; bit *= 2) {
      if ((c & bit) == 0) bounds.add_edge(view, corners[c], corners[c | bit]);
    }
  }
  return bounds.samples(view);
}

/// Rectangle around a sphere at `center`, view coordinates. In perspective its silhouette is the
/// ellipse whose extreme tangents are those of the planes through the eye that touch the sphere.
SCREE_HD inline SampleRect sphere_rect(const View& view, const Vec3f& center, float radius) {
  if (center.z + radius < view.near_depth) return {};
  PlaneBounds bounds;
  if (view.orthographic) {
    bounds.add(center.x - radius, center.y - radius);
    bounds.add(center.x + radius, center.y + radius);
    return bounds.samples(view);
  }
  const float depth2 = center.z * center.z - radius * radius;
  if (center.z - radius <= view.near_depth || depth2 <= 0.0f) {
    const Eye eye{-center, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, false};
    return box_rect(view, eye, {radius, radius, radius});
  }
  const float s = 1.0f / depth2;
  const float dx = radius * std::sqrt(center.x * center.x + depth2);
  const float dy = radius * std::sqrt(center.y * center.y + depth2);
  bounds.add((center.x * center.z - dx) * s, (center.y * center.z - dy) * s);
  bounds.add((center.x * center.z + dx) * s, (center.y * center.z + dy) * s);
  return bounds.samples(view);
}

}  // namespace scree::render
