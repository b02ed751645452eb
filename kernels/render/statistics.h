#pragma once
// What the camera and the color map need to know about all free bodies: extent,
// mean size, value range.

#include "kernels/render/color.h"
#include "kernels/render/solids.h"

namespace scree::render {

/// Whether a point lies in a box; points that are not finite do not.
SCREE_HD inline bool is_inside(const Vec3<double>& p, const Vec3<double>& lower,
                               const Vec3<double>& upper) {
  return p.x >= lower.x && p.x <= upper.x && p.y >= lower.y && p.y <= upper.y && p.z >= lower.z &&
         p.z <= upper.z;
}

/// Which bodies a picture is made for. Strays are left out, but large bodies, of which there are
/// few, only when they are far away. Leaves out what is not finite; by default nothing else.
struct KeepRule {
  Vec3<double> lower{-1e300, -1e300, -1e300};
  Vec3<double> upper{1e300, 1e300, 1e300};
  Vec3<double> large_margin;    ///< by which the box is larger for large bodies [m]
  double large_radius = 1e300;  ///< from which on a body is large [m]

  SCREE_HD bool operator()(const Vec3<double>& center, double radius) const {
    if (radius < large_radius) return is_inside(center, lower, upper);
    return is_inside(center, lower - large_margin, upper + large_margin);
  }
};

/// Copies every n-th position.
struct PickPositions {
  static constexpr const char* name = "render_pick_positions";
  Span<const Vec3<double>> position;
  Index stride = 1;
  Span<Vec3<double>> picked;  ///< out
  SCREE_HD void operator()(Index i) const { picked[i] = position[i * stride]; }
};

/// Extent and mean size of bodies. Those with a position that is not finite are left out.
struct BodyStatistics {
  double lower[3] = {1e300, 1e300, 1e300};  ///< of the bodies' own bounds [m]
  double upper[3] = {-1e300, -1e300, -1e300};
  double sum_radius = 0;  ///< [m]
  double count = 0;

  SCREE_HD void combine(const BodyStatistics& o) {
    for (int k = 0; k < 3; ++k) {
      lower[k] = lower[k] < o.lower[k] ? lower[k] : o.lower[k];
      upper[k] = upper[k] > o.upper[k] ? upper[k] : o.upper[k];
    }
    sum_radius += o.sum_radius;
    count += o.count;
  }
};

/// Body first + i.
template <class Real>
struct MeasureBodies {
  static constexpr const char* name = "render_measure_bodies";
  Index first = 0;  ///< storage index of i = 0
  Span<const Vec3<double>> position;
  PerBody<Real> radius;  ///< [m]; bodies with radius zero are unbounded: left out
  KeepRule keep;
  Span<const Quat<Real>> orientation;
  PerBody<Index> shape;
  Span<const ShapeRecord<Real>> shapes;

  /// Half the size of the body along the world axes: that of the box about
  /// it, or else the bounding radius.
  SCREE_HD Vec3<double> half_size(Index body, double r) const {
    const Index s = shape[body];
    if (s < 0 || outline_of(shapes[s].kind) != Outline::box) return {r, r, r};
    Vec3<double> size;
    for (int axis = 0; axis < 3; ++axis) {
      Vec3<double> edge;
      edge[axis] = static_cast<double>(shapes[s].reach()[axis]);
      edge = rotate(Quat<double>(orientation[body]), edge);
      size += {std::abs(edge.x), std::abs(edge.y), std::abs(edge.z)};
    }
    return size;
  }

  SCREE_HD BodyStatistics operator()(Index i) const {
    const Vec3<double> p = position[first + i];
    const double r = static_cast<double>(radius[first + i]);
    BodyStatistics s;
    if (!(r > 0.0)) return s;
    if (!keep(p, r)) return s;
    const Vec3<double> reach = half_size(first + i, r);
    for (int k = 0; k < 3; ++k) {
      s.lower[k] = p[k] - reach[k];
      s.upper[k] = p[k] + reach[k];
    }
    s.sum_radius = r;
    s.count = 1;
    return s;
  }
};

/// How far back a camera of given axes must stand so that each side of its picture holds
/// everything: the smallest of z - x / tan and so on, over all points. Host code turns
/// it into a position.
struct FrameSides {
  double left = 1e300;     ///< of z + x / tan_x [m]
  double right = 1e300;    ///< of z - x / tan_x
  double bottom = 1e300;   ///< of z + y / tan_y
  double top = 1e300;      ///< of z - y / tan_y
  double nearest = 1e300;  ///< of z
  SCREE_HD void combine(const FrameSides& o) {
    left = left < o.left ? left : o.left;
    right = right < o.right ? right : o.right;
    bottom = bottom < o.bottom ? bottom : o.bottom;
    top = top < o.top ? top : o.top;
    nearest = nearest < o.nearest ? nearest : o.nearest;
  }
};

/// Camera axes around a point, and the opening of the picture.
struct FrameAxes {
  Vec3<double> center;   ///< world [m]
  Vec3<double> right;    ///< unit
  Vec3<double> up;       ///< unit
  Vec3<double> forward;  ///< unit
  double tan_x = 1;      ///< half width over distance
  double tan_y = 1;

  /// Sides for one sphere; a point when the radius is zero.
  SCREE_HD FrameSides sides(const Vec3<double>& point, double radius) const {
    const Vec3<double> d = point - center;
    const double x = dot(d, right) / tan_x, y = dot(d, up) / tan_y, z = dot(d, forward);
    // The sphere's own part: its radius times the length of the gradient of z - x / tan.
    const double rx = radius * std::sqrt(1.0 + 1.0 / (tan_x * tan_x));
    const double ry = radius * std::sqrt(1.0 + 1.0 / (tan_y * tan_y));
    return {z + x - rx, z - x - rx, z + y - ry, z - y - ry, z - radius};
  }
};

/// Frame sides of free body i.
template <class Real>
struct MeasureFrame {
  static constexpr const char* name = "render_measure_frame";
  FrameAxes axes;
  Span<const Vec3<double>> position;
  PerBody<Real> radius;
  KeepRule keep;
  SCREE_HD FrameSides operator()(Index i) const {
    const Vec3<double> p = position[i];
    const double r = static_cast<double>(radius[i]);
    if (!(r > 0.0) || !keep(p, r)) return {};
    return axes.sides(p, r);
  }
};

/// Range and moments of the value that colors the bodies.
struct ValueStatistics {
  double low = 1e300;
  double high = -1e300;
  double sum = 0;
  double sum_squares = 0;
  double count = 0;
  SCREE_HD void combine(const ValueStatistics& o) {
    low = low < o.low ? low : o.low;
    high = high > o.high ? high : o.high;
    sum += o.sum;
    sum_squares += o.sum_squares;
    count += o.count;
  }
};

template <class Real>
struct MeasureValues {
  static constexpr const char* name = "render_measure_values";
  ColorValue<Real> value;
  SCREE_HD ValueStatistics operator()(Index i) const {
    const double v = static_cast<double>(value(i));
    ValueStatistics s;
    if (!(v - v == 0.0)) return s;  // not finite
    s.low = s.high = s.sum = v;
    s.sum_squares = v * v;
    s.count = 1;
    return s;
  }
};

}  // namespace scree::render
