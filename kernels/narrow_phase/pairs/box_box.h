#pragma once
// Two solid boxes: up to four contacts.
//
// The axis of the largest separation among the 15 normals of faces and of pairs of edges
// (Gottschalk, Lin, Manocha, OBBTree, 1996) says how the boxes meet: a face of one, the reference,
// with the face of the other that points most against it, clipped by the sides of the reference;
// or two edges that cross. Faces are preferred to edges and the first box to the second unless the
// other is better by more than a bias, so that what rounding decides does not change from step to
// step. Boxes that are apart and whose nearest points lie on other features, such as two corners,
// have one contact there.
//
// Boxes that pass each other within the step meet along a face that parts them longer, see ahead.h.
//
// A feature tells which corners, edges and sides make a contact, and so its geometry without any
// further choice: what was listed is what is filled in.

#include "kernels/narrow_phase/pairs/ahead.h"
#include "kernels/narrow_phase/pairs/box_half_space.h"
#include "kernels/narrow_phase/pairs/convex_distance.h"
#include "kernels/narrow_phase/pairs/face_points.h"
#include "kernels/narrow_phase/pairs/manifold.h"
#include "kernels/narrow_phase/pairs/middle_contact.h"
#include "kernels/narrow_phase/pairs/sphere_box.h"

namespace scree {

/// A box in world axes.
struct BoxAxes {
  Vec3d axis[3];  ///< unit
  Vec3d half;     ///< half extents [m]

  BoxAxes() = default;
  SCREE_HD BoxAxes(const Quatd& q, const Vec3d& half_extents)
      : axis{rotate(q, Vec3d{1, 0, 0}), rotate(q, Vec3d{0, 1, 0}), rotate(q, Vec3d{0, 0, 1})},
        half(half_extents) {}

  /// From the center to the point with these coordinates in the body frame [m].
  SCREE_HD Vec3d world(const Vec3d& x) const {
    return x.x * axis[0] + x.y * axis[1] + x.z * axis[2];
  }
  SCREE_HD Vec3d local(const Vec3d& x) const {
    return {dot(x, axis[0]), dot(x, axis[1]), dot(x, axis[2])};
  }
  /// Half the length of its shadow on a direction, which need not be a unit vector.
  SCREE_HD double shadow(const Vec3d& direction) const {
    const Vec3d n = local(direction);
    return half.x * std::abs(n.x) + half.y * std::abs(n.y) + half.z * std::abs(n.z);
  }
  /// Center to the middle of edge e: along axis e / 4, its bits 0 and 1 set at the positive ends of
  /// the next two axes.
  SCREE_HD Vec3d edge_middle(int e) const {
    const int k = e / 4, p = (k + 1) % 3, q = (k + 2) % 3;
    return (e & 1 ? half[p] : -half[p]) * axis[p] + (e & 2 ? half[q] : -half[q]) * axis[q];
  }
};

struct BoxPair {
  BoxAxes box[2];
  Vec3d d;           ///< center of box 0 to center of box 1 [m]
  Vec3d way = {};    ///< of box 1 relative to box 0 in the step [m]
  Vec3d moved = {};  ///< what of it is in `d` already [m]

  /// The boxes at the end of the step. They meet on the sides that they have at its start, wherever the centers are then: a fast one
  /// may be behind the other.
  SCREE_HD void move(const Vec3d& by) { d += by, moved += by; }
  SCREE_HD Vec3d at_start() const { return d - moved; }

  /// Distance along a normal of the faces of a box [m], negative is overlap.
  SCREE_HD double face_separation(int side, int k) const {
    const Vec3d n = box[side].axis[k];
    return std::abs(dot(d, n)) - box[side].half[k] - box[1 - side].shadow(n);
  }
};

/// Whether a normal of a face tells that two boxes are farther apart than that.
SCREE_HD inline bool are_apart(const BoxPair& pair, double most) {
  for (int side = 0; side < 2; ++side) {
    for (int k = 0; k < 3; ++k) {
      if (pair.face_separation(side, k) > most) return true;
    }
  }
  return false;
}

/// Features of two boxes: the nearest points of boxes that are apart, an edge of each by their
/// axes, or a reference face with a corner of the other box, a corner of its own, or where an edge
/// of the other box passes one of its sides.
struct BoxFeature {
  static constexpr int kBits = 9;
  static constexpr std::uint32_t kNearest = 0;
  static constexpr std::uint32_t kMiddle = (1u << kBits) - 1;  ///< see MiddleContact
  static constexpr std::uint32_t kEdges = 1;
  static constexpr std::uint32_t kFaces = 10;
  // Points of a reference face.
  static constexpr int kOtherCorner = 0;
  static constexpr int kOwnCorner = 8;
  static constexpr int kSide = 20;
  static constexpr int kPoints = 68;

  SCREE_HD static std::uint32_t edges(int axis_0, int axis_1) {
    return kEdges + static_cast<std::uint32_t>(3 * axis_0 + axis_1);
  }
  SCREE_HD static std::uint32_t face(int box, int axis, int point) {
    return kFaces + static_cast<std::uint32_t>((3 * box + axis) * kPoints + point);
  }
  /// @param signs  bits 0 and 1: the positive ends of the two axes after that of the reference
  SCREE_HD static int own_corner(int signs, int other_axis) {
    return kOwnCorner + 4 * other_axis + signs;
  }
  /// @param side  bit 0: the positive end; bit 1: of the second axis after that of the reference
  SCREE_HD static int side(int edge, int side) { return kSide + 4 * edge + side; }
};
static_assert(BoxFeature::kFaces + 6 * BoxFeature::kPoints <= BoxFeature::kMiddle);

namespace box_box_parts {

/// Distances below this part of the smallest half extent are ties.
inline constexpr double kTie = 1e-4;
/// By so much, in the same measure, edges must separate boxes better than faces do.
inline constexpr double kEdgeBias = 1e-3;
/// Faces the cosine of whose angle is less meet at a corner, or lie so.
inline constexpr double kBeside = 0.99;
/// Edges with a smaller squared sine of the angle between them are parallel.
inline constexpr double kParallel = 1e-6;

SCREE_HD inline double smallest(const Vec3d& v) {
  const double m = v.x < v.y ? v.x : v.y;
  return m < v.z ? m : v.z;
}
SCREE_HD inline Vec3d along(const Vec3d& axis, const Vec3d& direction) {
  return dot(axis, direction) < 0 ? -axis : axis;
}

/// The reference face, and the face of the other box against it.
struct ReferenceFace {
  const BoxAxes& own;
  const BoxAxes& other;
  Vec3d d;  ///< center of the reference box to that of the other [m]
  int axis;
  Vec3d normal;  ///< out of the reference box, toward the other

  SCREE_HD ReferenceFace(const BoxPair& pair, int box, int axis_)
      : own(pair.box[box]),
        other(pair.box[1 - box]),
        d(box == 0 ? pair.d : -pair.d),
        axis(axis_),
        normal(along(own.axis[axis_], box == 0 ? pair.at_start() : -pair.at_start())) {}

  /// From the center of the reference box to a point of the contact [m], see BoxFeature.
  SCREE_HD Vec3d point(int p) const {
    if (p < BoxFeature::kOwnCorner) return d + other.world(box_corner(other.half, p));
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    if (p < BoxFeature::kSide) {
      const int signs = (p - BoxFeature::kOwnCorner) % 4;
      const int other_axis = (p - BoxFeature::kOwnCorner) / 4;
      const Vec3d out = -along(other.axis[other_axis], normal);
      const Vec3d corner = own.half[axis] * normal +
                           (signs & 1 ? own.half[u] : -own.half[u]) * own.axis[u] +
                           (signs & 2 ? own.half[v] : -own.half[v]) * own.axis[v];
      const double height = dot(d + other.half[other_axis] * out - corner, out) / dot(normal, out);
      return corner + height * normal;
    }
    const int edge = (p - BoxFeature::kSide) / 4, side = (p - BoxFeature::kSide) % 4;
    const int across = side & 2 ? v : u;
    const double limit = side & 1 ? own.half[across] : -own.half[across];
    const Vec3d middle = d + other.edge_middle(edge), direction = other.axis[edge / 4];
    const double t = (limit - dot(middle, own.axis[across])) / dot(direction, own.axis[across]);
    return middle + t * direction;
  }
};

SCREE_HD inline ContactGeometry face_contact(const BoxPair& pair, int box, int axis, int point) {
  const ReferenceFace face(pair, box, axis);
  const Vec3d x = face.point(point);
  ContactGeometry g;
  g.normal = face.normal;
  g.gap = dot(face.normal, x) - face.own.half[axis];
  g.arm_a = x - g.gap * face.normal;
  g.arm_b = x - face.d;
  return box == 0 ? g : swapped(g);
}

/// The edges of both boxes, along these axes, that are nearest to the other box.
struct EdgePair {
  Vec3d normal;     ///< unit, from box 0 to box 1
  Vec3d middle[2];  ///< center of box 0 to the middles of the edges [m]
  double along[2];  ///< of their common normal, from the middles along the axes [m]

  SCREE_HD EdgePair(const BoxPair& pair, int i, int j) {
    const BoxAxes &a = pair.box[0], &b = pair.box[1];
    normal = box_box_parts::along(normalized(cross(a.axis[i], b.axis[j])), pair.d);
    middle[1] = pair.d;
    for (int k = 0; k < 3; ++k) {
      if (k != i) middle[0] += a.half[k] * box_box_parts::along(a.axis[k], normal);
      if (k != j) middle[1] -= b.half[k] * box_box_parts::along(b.axis[k], normal);
    }
    const Vec3d w = middle[1] - middle[0];
    const double c = dot(a.axis[i], b.axis[j]), sine2 = 1 - c * c;
    const double wa = dot(w, a.axis[i]), wb = dot(w, b.axis[j]);
    along[0] = (wa - c * wb) / sine2;
    along[1] = (c * wa - wb) / sine2;
  }
  /// Whether the common normal meets both edges.
  SCREE_HD bool cross_within(const BoxPair& pair, int i, int j, double tie) const {
    return std::abs(along[0]) <= pair.box[0].half[i] + tie &&
           std::abs(along[1]) <= pair.box[1].half[j] + tie;
  }
};

SCREE_HD inline ContactGeometry edge_contact(const BoxPair& pair, int i, int j) {
  const EdgePair edges(pair, i, j);
  ContactGeometry g;
  g.normal = edges.normal;
  g.gap = dot(edges.normal, edges.middle[1] - edges.middle[0]);
  g.arm_a = edges.middle[0] + edges.along[0] * pair.box[0].axis[i];
  g.arm_b = edges.middle[1] + edges.along[1] * pair.box[1].axis[j] - pair.d;
  return g;
}

SCREE_HD inline ConvexCore core_of_box(const BoxAxes& box, const Vec3d& center) {
  ConvexCore core;
  core.center = center;
  for (int k = 0; k < 3; ++k) core.axis[k] = box.axis[k];
  core.half = box.half;
  return core;
}

/// The nearest points of two boxes. @return  whether they are apart, beyond rounding
SCREE_HD inline bool nearest_contact(const BoxPair& pair, ContactGeometry& g) {
  const ConvexCore a = core_of_box(pair.box[0], {}), b = core_of_box(pair.box[1], pair.d);
  const CoreSearch found = convex_parts::find_nearest(a, b, a.size() + b.size(), 1e300);
  if (found.state != CoreSearch::State::parted) return false;
  const CoreDistance distance = found.distance();
  g.normal = distance.normal;
  g.gap = distance.separation;
  g.arm_a = distance.on_a;
  g.arm_b = distance.on_b - pair.d;
  return true;
}

/// What decides about pairs of these boxes [m].
struct BoxScale {
  double size;  ///< the smallest half extent
  double tie;

  SCREE_HD explicit BoxScale(const BoxPair& pair) {
    const double size_0 = smallest(pair.box[0].half), size_1 = smallest(pair.box[1].half);
    size = size_0 < size_1 ? size_0 : size_1;
    tie = kTie * size;
  }
};

/// How the boxes meet.
struct SeparatingAxis {
  double separation = 0;     ///< of the boxes along it [m], negative is overlap
  std::int16_t box = -1;     ///< reference; -1: two edges
  std::int8_t i = 0, j = 0;  ///< axis of the reference, or of the edges of the two boxes
  bool beyond = false;       ///< they are farther apart than was asked for; nothing else is known
  bool is_ahead = false;     ///< all of this is that of the end of the step, see ahead.h

  SeparatingAxis() = default;
  /// @param most  boxes that are farther apart need no answer: `separation` is more than this then
  SCREE_HD SeparatingAxis(const BoxPair& pair, double most, double tie, double edge_bias) {
    find(pair, most, tie, edge_bias);
    beyond = separation > most;
  }
  SCREE_HD SeparatingAxis(const BoxPair& pair, double most)
      : SeparatingAxis(pair, most, BoxScale(pair).tie, kEdgeBias * BoxScale(pair).size) {
    if (!beyond) look_ahead(pair, Passing{BoxScale(pair).size});
  }

  SCREE_HD bool is_beyond() const { return beyond; }
  /// Whether it also tells what a search within that distance would [m].
  SCREE_HD bool holds(double most) const { return !beyond || separation > most; }

 private:
  SCREE_HD void find(const BoxPair& pair, double most, double tie, double edge_bias) {
    const BoxAxes &a = pair.box[0], &b = pair.box[1];
    separation = -1e300;
    for (int side = 0; side < 2; ++side) {
      double best = -1e300;
      int best_axis = 0;
      for (int k = 0; k < 3; ++k) {
        const double s = pair.face_separation(side, k);
        if (s > best + tie) best = s, best_axis = k;
      }
      if (best > separation + tie) separation = best, set(side, best_axis, 0);
      if (separation > most) return;
    }
    double best = -1e300;
    int best_i = 0, best_j = 0;
    for (int p = 0; p < 3; ++p) {
      for (int q = 0; q < 3; ++q) {
        const Vec3d n = cross(a.axis[p], b.axis[q]);
        const double sine2 = norm2(n);
        if (sine2 < kParallel) continue;
        const double s = (std::abs(dot(pair.d, n)) - a.shadow(n) - b.shadow(n)) / std::sqrt(sine2);
        if (s > best + tie) best = s, best_i = p, best_j = q;
      }
    }
    if (best > separation + edge_bias) separation = best, set(-1, best_i, best_j);
  }
  /// Takes the face that parts boxes longest on their way, where more than one does. That of the start may have no point of the other
  /// box over it there.
  SCREE_HD void look_ahead(const BoxPair& pair, const Passing& passing) {
    const double far = norm(pair.way);
    if (!passing.parts(separation) || separation >= far) return;
    const Vec3d normal = box < 0 ? normalized(cross(pair.box[0].axis[i], pair.box[1].axis[j]))
                                 : pair.box[box].axis[i];
    const double approach = -dot(along(normal, pair.d), pair.way);
    double latest = passing.time(separation, approach) * Passing::kLater;
    bool is_other = false, is_latest = true;
    for (int side = 0; side < 2; ++side) {
      for (int k = 0; k < 3; ++k) {
        const Vec3d& n = pair.box[side].axis[k];
        if (std::abs(dot(n, normal)) > kBeside) continue;
        const double found = pair.face_separation(side, k);
        if (!passing.parts(found)) continue;
        is_other = true;
        const double nearer = -dot(along(n, pair.d), pair.way);
        const double time = passing.time(found, nearer);
        if (!(time > latest) || !passing.goes_far(approach, nearer)) continue;
        latest = time * Passing::kLater;
        separation = found;
        is_latest = false;
        set(side, k, 0);
      }
    }
    if (!is_other || box < 0) return;
    if (is_latest && !passing.goes_far(far, 1e300)) return;
    is_ahead = true;
    separation += dot(along(pair.box[box].axis[i], pair.d), pair.way);
  }
  SCREE_HD void set(int reference, int axis, int other_axis) {
    box = static_cast<std::int16_t>(reference);
    i = static_cast<std::int8_t>(axis);
    j = static_cast<std::int8_t>(other_axis);
  }
};

/// The face of the other box clipped by the sides of the reference.
/// @param found  out: all points, untested
SCREE_HD inline void clip_face(const BoxPair& pair, int box, int axis, double tie,
                               FacePoints& found) {
  const ReferenceFace face(pair, box, axis);
  const BoxAxes &own = face.own, &other = face.other;
  int m = 0;
  double steepest = 0;
  for (int k = 0; k < 3; ++k) {
    const double steep = std::abs(dot(other.axis[k], face.normal));
    if (steep > steepest + kTie) steepest = steep, m = k;
  }
  const bool is_positive = dot(other.axis[m], face.normal) < 0;
  const int p = (m + 1) % 3, q = (m + 2) % 3;
  const Vec3d au = own.axis[(axis + 1) % 3], av = own.axis[(axis + 2) % 3];
  const double hu = own.half[(axis + 1) % 3], hv = own.half[(axis + 2) % 3];
  const Vec3d middle = face.d + (is_positive ? other.half[m] : -other.half[m]) * other.axis[m];
  const Vec3d ep = other.half[p] * other.axis[p], eq = other.half[q] * other.axis[q];
  const double u0 = dot(middle, au), up = dot(ep, au), uq = dot(eq, au);
  const double v0 = dot(middle, av), vp = dot(ep, av), vq = dot(eq, av);

  const auto sign = [](int bits, int bit) { return (bits & bit) != 0 ? 1.0 : -1.0; };
  for (int k = 0; k < 4; ++k) {
    const double u = u0 + sign(k, 1) * up + sign(k, 2) * uq;
    const double v = v0 + sign(k, 1) * vp + sign(k, 2) * vq;
    if (std::abs(u) > hu + tie || std::abs(v) > hv + tie) continue;
    const int corner = (is_positive ? 1 << m : 0) | (k & 1) << p | (k >> 1) << q;
    found.offer(BoxFeature::kOtherCorner + corner, u, v);
  }
  const double determinant = up * vq - uq * vp;
  for (int k = 0; k < 4; ++k) {
    const double u = sign(k, 1) * hu, v = sign(k, 2) * hv;
    const double at_p = ((u - u0) * vq - (v - v0) * uq) / determinant;
    const double at_q = ((v - v0) * up - (u - u0) * vp) / determinant;
    if ((std::abs(at_p) - 1) * other.half[p] > tie) continue;
    if ((std::abs(at_q) - 1) * other.half[q] > tie) continue;
    found.offer(BoxFeature::own_corner(k, m), u, v);
  }
  for (int k = 0; k < 4; ++k) {
    const bool is_p = k < 2;  // edges along p, then along q
    const double end = k & 1 ? 1 : -1;
    const double us = u0 + end * (is_p ? uq : up), vs = v0 + end * (is_p ? vq : vp);
    const double ud = is_p ? up : uq, vd = is_p ? vp : vq;
    // The ends of an edge on the two axes after its own: for p these are q and m, for q m and p.
    const int at_end = k & 1, at_m = is_positive ? 1 : 0;
    const int edge = is_p ? 4 * p + (at_end | at_m << 1) : 4 * q + (at_m | at_end << 1);
    for (int side = 0; side < 4; ++side) {
      const bool is_v = (side & 2) != 0;
      const double limit = sign(side, 1) * (is_v ? hv : hu);
      const double from = is_v ? vs : us, way = is_v ? vd : ud;
      if (!(std::abs(limit - from) < std::abs(way))) continue;
      const double t = (limit - from) / way;
      const double u = is_v ? us + t * ud : limit, v = is_v ? limit : vs + t * vd;
      if (std::abs(u) > hu + tie || std::abs(v) > hv + tie) continue;
      found.offer(BoxFeature::side(edge, side), u, v);
    }
  }
}

/// Of the points of a face contact those that are wanted, and not at the place of another. All are found before any is
/// tested: what threads beside each other find in different places, they test together.
/// @param listed  which contacts are wanted
/// @return        the least gap of all of them [m]
template <class Listed>
SCREE_HD double listed_points(const BoxPair& pair, int box, int axis, double tie, Listed&& listed,
                              FacePoints& points) {
  clip_face(pair, box, axis, tie, points);
  const int offered = points.count;
  double least = 1e300;
  points.count = 0;
  for (int k = 0; k < offered; ++k) {
    const double u = points.u[k], v = points.v[k];
    if (points.has(u, v, tie)) continue;
    const ContactGeometry g = face_contact(pair, box, axis, points.point[k]);
    least = g.gap < least ? g.gap : least;
    if (listed(g)) points.add(points.point[k], u, v, g.gap);
  }
  return least;
}

/// Corner of the other box that lies deepest below the reference face.
SCREE_HD inline int deepest_corner(const BoxPair& pair, int box, int axis) {
  const ReferenceFace face(pair, box, axis);
  int corner = 0;
  for (int k = 0; k < 3; ++k) {
    if (dot(face.other.axis[k], face.normal) < 0) corner |= 1 << k;
  }
  return corner;
}

}  // namespace box_box_parts

/// See MiddleContact, with the normal along which boxes meet.
struct BoxMiddle {
  ConvexCore first, second;
  Vec3d normal, d;

  SCREE_HD BoxMiddle(const BoxPair& pair, const box_box_parts::SeparatingAxis& axis)
      : first(box_box_parts::core_of_box(pair.box[0], {})),
        second(box_box_parts::core_of_box(pair.box[1], pair.d)),
        normal(axis.box < 0 ? box_box_parts::edge_contact(pair, axis.i, axis.j).normal
                            : box_box_parts::face_contact(pair, axis.box, axis.i, 0).normal),
        d(pair.d) {}
  SCREE_HD bool is_wanted(const Vec3d& way) const {
    return MiddleContact::is_wanted(first, second, normal, way);
  }
  SCREE_HD ContactGeometry geometry() const {
    return MiddleContact::geometry(first, second, normal, d);
  }
};

/// Geometry of the contact that a feature names, but for that of the middle.
SCREE_HD inline ContactGeometry box_box_contact(const BoxPair& pair, std::uint32_t feature) {
  using namespace box_box_parts;
  if (feature == BoxFeature::kNearest) {
    ContactGeometry g;
    nearest_contact(pair, g);
    return g;
  }
  if (feature < BoxFeature::kFaces) {
    const int k = static_cast<int>(feature - BoxFeature::kEdges);
    return edge_contact(pair, k / 3, k % 3);
  }
  const int k = static_cast<int>(feature - BoxFeature::kFaces);
  const int face = k / BoxFeature::kPoints;
  return face_contact(pair, face / 3, face % 3, k % BoxFeature::kPoints);
}

/// Calls emit(feature, contact) for the contacts of two boxes that are wanted, four at most, features ascending.
/// @param most    boxes that are farther apart have none [m]
/// @param wanted  wanted(contact): whether it is
template <class Wanted, class Emit>
SCREE_HD void box_box(BoxPair pair, const box_box_parts::SeparatingAxis& axis, double most,
                      Wanted&& wanted, Emit&& take) {
  using namespace box_box_parts;
  if (axis.separation > most && !axis.is_ahead) return;
  const Vec3d way = axis.is_ahead ? pair.way : Vec3d{};
  pair.move(way);
  const auto listed = [&](const ContactGeometry& g) { return wanted(at_start(g, way)); };
  const double thickness = smallest(pair.box[0].half) < smallest(pair.box[1].half)
                               ? smallest(pair.box[0].half)
                               : smallest(pair.box[1].half);
  // Most pairs are slow, and need not know along which normal.
  const bool is_fast =
      norm2(pair.way) > thickness * thickness && BoxMiddle(pair, axis).is_wanted(pair.way);
  int taken = 0;
  const auto emit = [&](std::uint32_t feature, const ContactGeometry& g) {
    if (is_fast && taken == Manifold::kMaxContacts - 1) return;  // the middle has its place
    ++taken;
    take(feature, at_start(g, way));
  };
  const double tie = BoxScale(pair).tie;
  int count = 0;
  const auto add_listed = [&](std::uint32_t feature, const ContactGeometry& g) {
    if (!listed(g)) return;
    emit(feature, g);
    ++count;
  };
  double least = 1e300;
  if (axis.box < 0) {
    if (axis.separation <= 0 ||
        EdgePair(pair, axis.i, axis.j).cross_within(pair, axis.i, axis.j, tie)) {
      const ContactGeometry g = edge_contact(pair, axis.i, axis.j);
      least = g.gap;
      add_listed(BoxFeature::edges(axis.i, axis.j), g);
    }
  } else {
    FacePoints points;
    least = listed_points(pair, axis.box, axis.i, tie, listed, points);
    int kept[Manifold::kMaxContacts];
    double least_kept = 1e300;
    count = reduced(points, tie, kept, least_kept);
    for (int k = 0; k < count; ++k)
      emit(BoxFeature::face(axis.box, axis.i, kept[k]),
           face_contact(pair, axis.box, axis.i, kept[k]));
  }
  const auto add_middle = [&] {
    if (!is_fast || taken == 0) return;
    const ContactGeometry g = BoxMiddle(pair, axis).geometry();
    if (listed(g)) take(BoxFeature::kMiddle, at_start(g, way));
  };
  // No contact that is nearer than all of these is left, unless corners or other edges are nearest.
  if (count > 0 || least <= axis.separation * (1 + 1e-9)) {
    add_middle();
    return;
  }
  ContactGeometry g;
  std::uint32_t feature = BoxFeature::kNearest;
  if (axis.is_ahead || !(axis.separation > 0 && nearest_contact(pair, g))) {
    feature = axis.box < 0
                  ? BoxFeature::edges(axis.i, axis.j)
                  : BoxFeature::face(axis.box, axis.i, deepest_corner(pair, axis.box, axis.i));
    g = box_box_contact(pair, feature);
  }
  add_listed(feature, g);
  add_middle();
}

struct BoxBox {
  using A = shapes::Box;
  using B = shapes::Box;
  using Search = box_box_parts::SeparatingAxis;
  static constexpr int kFeatureBits = BoxFeature::kBits;
  SCREE_HD static BoxPair pair(const PairSide& a, const PairSide& b, const Vec3d& d) {
    return {{{a.orientation, a.half_extents}, {b.orientation, b.half_extents}}, d, b.way};
  }
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t feature) {
    BoxPair boxes = pair(a, b, d);
    const Search axis(boxes, 1e300);
    const Vec3d way = axis.is_ahead ? boxes.way : Vec3d{};
    boxes.move(way);
    return at_start(feature == BoxFeature::kMiddle ? BoxMiddle(boxes, axis).geometry()
                                                   : box_box_contact(boxes, feature),
                    way);
  }
  SCREE_HD static Search search(const PairSide& a, const PairSide& b, const Vec3d& d, double most,
                                const Search* before) {
    if (before != nullptr && before->holds(most)) return *before;
    return {pair(a, b, d), most};
  }
  template <class Listed, class Emit>
  SCREE_HD static void contacts(const PairSide& a, const PairSide& b, const Vec3d& d,
                                const Search& search, double most, Listed&& listed, Emit&& emit) {
    box_box(pair(a, b, d), search, most, listed, emit);
  }
  template <class Listed>
  SCREE_HD static Manifold manifold(const PairSide& a, const PairSide& b, const Vec3d& d,
                                    double most, Listed&& listed) {
    return manifold_in_parts<BoxBox>(a, b, d, most, listed);
  }
};

}  // namespace scree
