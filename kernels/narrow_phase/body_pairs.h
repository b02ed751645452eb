#pragma once
// Contacts of two binned bodies, by the pair function of their shapes.

#include "kernels/broad_phase/contact_range.h"
#include "kernels/narrow_phase/pairs/pair_list.h"
#include "kernels/narrow_phase/pairs/small_on_sphere.h"
#include "kernels/narrow_phase/walls.h"
#include "shapes/shape_list.h"

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
  ShapeKind kind = kNoShape;
  Vec3d position;
  double radius = 0;
  RigidMotion motion;  ///< on its course, see course_velocity()
  // Not of spheres:
  Quatd orientation;
  Vec3d half_extents;
  Hull hull;
  Rounding<double> rounded;
  Index name = 0;  ///< stays when bodies change places in memory

  SCREE_HD PairSide side() const {
    return {radius, orientation, half_extents, kind, hull, rounded};
  }
};

/// @tparam kMix  without `any` no binned body has a shape record, so none is looked up
template <ShapeMix kMix, class Real>
SCREE_HD BodySample load_body(const BodyView<Real>& bodies, const ShapeSet<Real>& shapes,
                              const ContactRange& range, Index i) {
  BodySample s;
  s.kind = shapes::Sphere::kind;
  s.position = bodies.position[i];
  s.radius = bodies.radius[i];
  s.motion.linear = course_velocity(bodies, range, i);
  if constexpr (kMix == ShapeMix::any) {
    s.motion.angular = Vec3d(bodies.angular_velocity[i]);
    if (bodies.shape[i] >= 0) {
      const ShapeRecord<Real>& shape = shapes.records[bodies.shape[i]];
      s.kind = shape.kind;
      s.half_extents = Vec3d(shape.half_extents);
      s.orientation = load_orientation(bodies, i);
      s.rounded = in_double(shape.rounded);
      if (shapes::has_hull(shape)) s.hull = shapes.hulls.hull(shape.mesh, s.half_extents.x);
      s.name = bodies.id.empty() ? i : bodies.id[i];
    }
  }
  return s;
}

/// A contact that is never listed. A scene in which two bodies could meet that have no pair
/// function is refused before a run.
SCREE_HD inline ContactGeometry no_contact() { return {{0, 0, 1}, INFINITY, {}, {}}; }

/// Cores of shapes that are known when a run is.
struct CoresOfAny {
  [[gnu::noinline]] SCREE_HD static ConvexCore core(const PairSide& side, const Vec3d& center) {
    ConvexCore c;
    ShapeList::visit(side.kind, [&](auto shape) {
      using S = decltype(shape);
      if constexpr (PairList::has_core<S>()) c = core_of<S>(side, center);
    });
    return c;
  }
  SCREE_HD static ConvexCore of_a(const PairSide& a) { return core(a, {}); }
  SCREE_HD static ConvexCore of_b(const PairSide& b, const Vec3d& d) { return core(b, d); }
};

/// Runs the pair functions of all shapes that have cores, see ConvexPair.
struct ConvexProgram : ConvexParts<CoresOfAny> {};

/// How far body B goes in a step relative to A, where the smaller one is: what turns takes along with it what is far out [m].
/// @param d  center of A to center of B [m]
SCREE_HD inline Vec3d relative_way(const RigidMotion& a, double radius_a, const RigidMotion& b,
                                   double radius_b, const Vec3d& d, double h) {
  const double larger = radius_a < radius_b ? radius_b : radius_a, length = norm(d);
  const Vec3d arm = (larger < length ? larger / length : 1) * d;
  return h * (b.linear - a.linear - cross(radius_a < radius_b ? b.angular : a.angular, arm));
}

/// Two bodies as a pair function takes them. Two of one shape with several contacts come in the
/// order of their names, which outlives that in memory: so their contacts keep their features.
template <class P>
struct OrderedPair {
  bool is_swapped;
  PairSide a, b;
  Vec3d d;  ///< center of a to center of b [m]

  /// @param along  center of the first to that of the second [m]
  /// @param h      time step [s]
  SCREE_HD OrderedPair(const BodySample& first, const BodySample& second, const Vec3d& along,
                       bool is_reversed, double h)
      : is_swapped(is_reversed ||
                   (P::kFeatureBits > 0 && first.kind == second.kind && second.name < first.name)),
        a(is_swapped ? second.side() : first.side()),
        b(is_swapped ? first.side() : second.side()),
        d(is_swapped ? -along : along) {
    b.way = is_swapped ? way(second, first, h) : way(first, second, h);
  }
  SCREE_HD ContactGeometry in_memory(const ContactGeometry& g) const {
    return is_swapped ? swapped(g) : g;
  }

 private:
  SCREE_HD Vec3d way(const BodySample& from, const BodySample& to, double h) const {
    return relative_way(from.motion, from.radius, to.motion, to.radius, d, h);
  }
};

/// Largest speed with which points of two bodies may approach [m/s].
SCREE_HD inline double most_speed(const BodySample& a, const RigidMotion& motion_b,
                                  double radius_b) {
  return norm(motion_b.linear - a.motion.linear) + norm(a.motion.angular) * a.radius +
         norm(motion_b.angular) * radius_b;
}

/// Calls emit(feature) for the contacts that a pair function lists, features ascending. What several
/// have in common is found once.
/// @param most    bodies that are farther apart have none [m]
/// @param listed  listed(contact): whether it is wanted
template <class P, class Listed, class Emit>
SCREE_HD void list_features(const PairSide& a, const PairSide& b, const Vec3d& d, double most,
                            Listed&& listed, Emit&& emit) {
  if constexpr (P::kFeatureBits == 0) {
    if (listed(pair_contact<P>(a, b, d, 0))) emit(0u);
  } else {
    const Manifold m = P::manifold(a, b, d, most, listed);
    for (int k = 0; k < m.count; ++k) emit(m.feature[k]);
  }
}

}  // namespace scree
