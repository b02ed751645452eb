#pragma once
// The table of pair functions for two binned bodies, by shape kinds.

#include "kernels/broad_phase/contact_range.h"
#include "kernels/narrow_phase/pairs/box_box.h"
#include "kernels/narrow_phase/pairs/sphere_box.h"
#include "kernels/narrow_phase/pairs/sphere_sphere.h"
#include "kernels/narrow_phase/walls.h"

namespace scree {

/// What a run holds. Element programs are compiled for each, so that simple runs do not carry the
/// registers of the others.
enum class ShapeMix {
  spheres_and_planes,  ///< binned bodies are spheres, walls are half-spaces and containers
  spheres,             ///< binned bodies are spheres, walls of any kind
  any
};

/// What pair functions need of one body.
struct BodySample {
  ShapeKind kind = ShapeKind::sphere;
  Vec3d position;
  double radius = 0;
  RigidMotion motion;  ///< on its course, see course_velocity()
  Quatd orientation;   ///< boxes only
  Vec3d half_extents;  ///< boxes only
  Index name = 0;      ///< boxes only: stays when bodies change places in memory
};

/// @tparam kMix  without `any` no binned body has a shape record, so none is looked up
template <ShapeMix kMix, class Real>
SCREE_HD BodySample load_body(const BodyView<Real>& bodies, Span<const ShapeRecord<Real>> shapes,
                              const ContactRange& range, Index i) {
  BodySample s;
  s.position = bodies.position[i];
  s.radius = bodies.radius[i];
  s.motion.linear = course_velocity(bodies, range, i);
  if constexpr (kMix == ShapeMix::any) {
    s.motion.angular = Vec3d(bodies.angular_velocity[i]);
    if (bodies.shape[i] >= 0) {
      const ShapeRecord<Real>& shape = shapes[bodies.shape[i]];
      s.kind = shape.kind;
      s.half_extents = Vec3d(shape.half_extents);
      s.orientation = load_orientation(bodies, i);
      s.name = bodies.id.empty() ? i : bodies.id[i];
    }
  }
  return s;
}

/// The pair functions of two binned bodies.
enum class PairKind { none, sphere_sphere, sphere_box, box_sphere, box_box };

/// Two kinds as one number, for a switch.
SCREE_HD constexpr int pair_of(ShapeKind a, ShapeKind b) {
  return static_cast<int>(a) * 16 + static_cast<int>(b);
}

/// A scene in which two bodies could meet that have no pair function is refused before a run.
SCREE_HD constexpr PairKind pair_kind(ShapeKind a, ShapeKind b) {
  switch (pair_of(a, b)) {
    case pair_of(ShapeKind::sphere, ShapeKind::sphere):
      return PairKind::sphere_sphere;
    case pair_of(ShapeKind::sphere, ShapeKind::box):
      return PairKind::sphere_box;
    case pair_of(ShapeKind::box, ShapeKind::sphere):
      return PairKind::box_sphere;
    case pair_of(ShapeKind::box, ShapeKind::box):
      return PairKind::box_box;
    default:
      return PairKind::none;
  }
}

/// A contact that is never listed.
SCREE_HD inline ContactGeometry no_contact() { return {{0, 0, 1}, INFINITY, {}, {}}; }

SCREE_HD inline BoxAxes box_axes(const BodySample& body) {
  return {body.orientation, body.half_extents};
}

/// Two boxes in the order of their names, which outlives that in memory: so their contacts keep
/// their features.
struct NamedBoxes {
  bool is_swapped;
  BoxPair pair;

  SCREE_HD NamedBoxes(const BodySample& a, const BodySample& b, const Vec3d& d)
      : is_swapped(b.name < a.name),
        pair{{box_axes(is_swapped ? b : a), box_axes(is_swapped ? a : b)}, is_swapped ? -d : d} {}
  SCREE_HD ContactGeometry in_memory(const ContactGeometry& g) const {
    return is_swapped ? swapped(g) : g;
  }
};

/// Contact `feature` of two bodies.
/// @param d  center of A to center of B, nearest image [m]
template <ShapeMix kMix>
SCREE_HD ContactGeometry body_pair(const BodySample& a, const BodySample& b, const Vec3d& d,
                                   [[maybe_unused]] std::uint32_t feature) {
  if constexpr (kMix != ShapeMix::any) {
    return sphere_sphere(d, a.radius, b.radius);
  } else {
    switch (pair_kind(a.kind, b.kind)) {
      case PairKind::sphere_sphere:
        return sphere_sphere(d, a.radius, b.radius);
      case PairKind::sphere_box:
        return sphere_box(d, a.radius, b.orientation, b.half_extents);
      case PairKind::box_sphere:
        return swapped(sphere_box(-d, b.radius, a.orientation, a.half_extents));
      case PairKind::box_box: {
        const NamedBoxes boxes(a, b, d);
        return boxes.in_memory(box_box_contact(boxes.pair, feature));
      }
      case PairKind::none:
        break;
    }
    return no_contact();
  }
}

/// Largest speed with which points of two bodies may approach [m/s].
SCREE_HD inline double most_speed(const BodySample& a, const RigidMotion& motion_b,
                                  double radius_b) {
  return norm(motion_b.linear - a.motion.linear) + norm(a.motion.angular) * a.radius +
         norm(motion_b.angular) * radius_b;
}

/// Calls emit(feature) for each listed contact of two bodies of any kinds, features ascending. What
/// two boxes have is found once for all of their contacts.
/// @param reach  contacts are listed up to this gap [m], see is_listed()
template <class Emit>
SCREE_HD void visit_pair(const BodySample& a, const BodySample& b, const Vec3d& d, double reach,
                         double h, Emit&& emit) {
  const auto listed = [&](const ContactGeometry& g) {
    return is_listed(g.gap, separation_speed(g, a.motion, b.motion), reach, h);
  };
  if (pair_kind(a.kind, b.kind) != PairKind::box_box) {
    if (listed(body_pair<ShapeMix::any>(a, b, d, 0))) emit(0u);
    return;
  }
  const NamedBoxes boxes(a, b, d);
  const Manifold m = box_box(boxes.pair, reach + h * most_speed(a, b.motion, b.radius),
                             [&](const ContactGeometry& g) { return listed(boxes.in_memory(g)); });
  for (int k = 0; k < m.count; ++k) emit(m.feature[k]);
}

}  // namespace scree
