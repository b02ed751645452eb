#pragma once
// Contacts of two convex bodies from the distance of their cores: up to four.
//
// Where the normal is that of a face, this is the reference, and the face of the other core that points most against it
// is clipped by planes through its sides. Where two edges are parallel, their common part has two ends. Else there is one
// contact, at the nearest points. A feature names the points and edges that make a contact.

#include "kernels/narrow_phase/pairs/convex_distance.h"
#include "kernels/narrow_phase/pairs/convex_shapes.h"
#include "kernels/narrow_phase/pairs/face_points.h"
#include "kernels/narrow_phase/pairs/manifold.h"
#include "kernels/narrow_phase/pairs/middle_contact.h"

namespace scree {

/// Features of two cores: their nearest points; or of a reference, A or B: a point of the other, a point of its own, or
/// where an edge of the other passes one of its sides. Edges are named by their first point.
struct ConvexFeature {
  static constexpr int kBits = 8;
  static constexpr std::uint32_t kNearest = 0;
  static constexpr std::uint32_t kMiddle = (1u << kBits) - 1;  ///< see MiddleContact
  static constexpr int kNames = ConvexCore::kNames;
  static constexpr int kOwn = kNames, kSides = 2 * kNames, kPoints = 2 * kNames + kNames * kNames;

  SCREE_HD static std::uint32_t of(int reference, int point) {
    return static_cast<std::uint32_t>(1 + reference * kPoints + point);
  }
};
static_assert(1 + 2 * ConvexFeature::kPoints <= ConvexFeature::kMiddle);

/// A contact of two cores: a point of A, and how far B is from it along the normal.
struct CoreContact {
  Vec3d on_a;       ///< [m]
  double gap = 0;   ///< [m]
  bool is = false;  ///< there is one
};

/// The plane of a facet, or of an edge with whatever is beside it.
struct FacetPlane {
  Vec3d at;         ///< a point of it [m]
  Vec3d gradient;   ///< of way_from()
  bool is = false;  ///< the direction crosses it

  /// @param direction  unit, in which ways are measured
  SCREE_HD void set(const CoreFacet& f, const Vec3d& direction) {
    at = f.point[0];
    if (f.count < 2) return;
    const Vec3d along = f.point[1] - at;
    if (f.count == 2) {
      gradient = (dot(along, direction) / norm2(along)) * along - direction;
      is = true;
      return;
    }
    const Vec3d n = cross(along, f.point[2] - at);
    const double steep = dot(n, direction);
    gradient = (-1 / steep) * n;
    is = std::abs(steep) > 1e-9 * norm(n);
  }
  /// From a point along the direction to the plane [m].
  SCREE_HD double way_from(const Vec3d& x) const { return dot(gradient, x - at); }
};

/// How two cores meet, and the contacts that this gives.
struct CoreMeeting {
  /// Sine of the largest angle by which edges are parallel.
  static constexpr double kParallel = 1e-2;

  const ConvexCore& a;
  const ConvexCore& b;
  CoreDistance distance;
  int reference = -1;  ///< 0: A, 1: B, -1: the nearest points are all
  double tie = 0;      ///< [m]
  CoreFacet own;       ///< of the reference
  CoreFacet other;
  FacetPlane own_plane, other_plane;
  Vec3d out;                   ///< unit, out of the reference
  std::uint32_t top_a, top_b;  ///< of the cores along the normal

  /// @param found  of these cores, or another normal that is to hold them apart
  [[gnu::noinline]] SCREE_HD CoreMeeting(const ConvexCore& first, const ConvexCore& second,
                                         const CoreDistance& found)
      : a(first),
        b(second),
        distance(found),
        top_a(first.top(found.normal)),
        top_b(second.top(-found.normal)) {
    const double size_a = a.size(), size_b = b.size();
    tie = 1e-5 * (size_a < size_b ? size_a : size_b);
    const Vec3d n = distance.normal;
    // Triangles come first: what their neighbors hold is known by their points.
    const int first_side = b.form == ConvexCore::Form::triangle ? 1 : 0;
    for (int turn = 0; turn < 2 && reference < 0; ++turn) {
      const int side = turn == 0 ? first_side : 1 - first_side;
      const ConvexCore& core = side == 0 ? a : b;
      const Vec3d toward = side == 0 ? n : -n;
      const std::uint32_t top = side == 0 ? top_a : top_b;
      for (int k = 0; k < core.normal_count(); ++k) {
        if (dot(core.face_normal(k, toward, top), toward) >= kFaceCosine) reference = side;
      }
    }
    if (reference >= 0) {
      out = reference == 0 ? n : -n;
      a.facing(n, top_a, reference == 0 ? own : other);
      b.facing(-n, top_b, reference == 0 ? other : own);
      measure();
      return;
    }
    const CoreEdge p = a.edge_toward(n, kParallel, top_a), q = b.edge_toward(-n, kParallel, top_b);
    out = n;
    if (p.count < 2 || q.count < 2) return;
    const Vec3d u = normalized(p.to - p.from), v = normalized(q.to - q.from);
    if (norm(cross(u, v)) >= kParallel) return;
    reference = 0;
    own.set(p);
    other.set(q);
    measure();
  }

  /// The contact that a feature names.
  SCREE_HD CoreContact contact(std::uint32_t feature) const {
    CoreContact c;
    if (feature != ConvexFeature::kNearest && reference >= 0) {
      const int number = static_cast<int>(feature) - 1 - reference * ConvexFeature::kPoints;
      if (number >= 0 && number < ConvexFeature::kPoints) c = contact_of(number);
    }
    return c.is ? c : nearest();
  }

  /// Calls take(point, contact) for those of the reference, see ConvexFeature. All are found before any is taken: what
  /// threads beside each other find in different places, they take together.
  /// @param reaches  reaches(x): whether the reference also has a point x of the other that is not over it
  template <class Reaches, class Take>
  SCREE_HD void visit(Reaches&& reaches, Take&& take) const {
    std::uint8_t found[ConvexFeature::kPoints];
    int count = 0;
    find_points(reaches, [&](int number) { found[count++] = static_cast<std::uint8_t>(number); });
    for (int k = 0; k < count; ++k) {
      const CoreContact c = contact_of(found[k]);
      if (c.is) take(static_cast<int>(found[k]), c);
    }
  }

  /// Whether the deepest point is on the sliver between a round rim, or a face of many corners, and the eight points that
  /// stand for it.
  /// @param least  gap of the contacts [m]
  SCREE_HD bool is_cut_off(double least) const {
    if (own.count < CoreFacet::kMaxPoints && other.count < CoreFacet::kMaxPoints) return false;
    return least > distance.separation - a.rounding - b.rounding + 100 * tie;
  }

  /// The nearest points; of cores that overlap, where the other is deepest in a face, or the edges or points that are deepest.
  [[gnu::noinline]] SCREE_HD CoreContact nearest() const {
    CoreContact c;
    c.is = true;
    if (distance.is_apart) {
      c.on_a = distance.on_a;
      c.gap = dot(distance.on_b - distance.on_a, distance.normal);
      return c;
    }
    if (reference >= 0 && own.count > 2 && own_plane.is) return deepest_in_face();
    const CoreEdge p = a.edge_toward(distance.normal, 1e-6, top_a);
    const CoreEdge q = b.edge_toward(-distance.normal, 1e-6, top_b);
    const Vec3d u = p.to - p.from, v = q.to - q.from, w = q.from - p.from;
    const auto limited = [](double x) { return x > 0 ? (x < 1 ? x : 1.0) : 0.0; };
    const double uu = norm2(u), vv = norm2(v), uv = dot(u, v);
    const double wu = dot(w, u), wv = dot(w, v), det = uu * vv - uv * uv;
    double s = det > 1e-12 * uu * vv ? limited((wu * vv - wv * uv) / det) : 0;
    double t = vv > 0 ? limited((s * uv - wv) / vv) : 0;
    s = uu > 0 ? limited((t * uv + wu) / uu) : 0;
    c.on_a = p.from + s * u;
    c.gap = dot(q.from + t * v - c.on_a, distance.normal);
    return c;
  }

 private:
  /// Where the other core is deepest in the face of the reference. Where it lies flat on it, that may be a point which is not over
  /// the face: then it is one as deep where their facets lie over each other.
  SCREE_HD CoreContact deepest_in_face() const {
    const ConvexCore& core = reference == 0 ? b : a;
    Vec3d x = core.center + core.support(-out);
    double height = distance.separation;
    if (!own.is_under(x, out, tie)) {
      Vec3d y;
      const bool has_common = common_point(y);
      const double found = has_common ? -own_plane.way_from(y) : 0;
      if (has_common && found < height + 100 * tie) {
        x = y;
        height = found;
      }
    }
    CoreContact c;
    c.is = true;
    c.gap = height;
    c.on_a = reference == 0 ? x - height * out : x;
    return c;
  }
  /// A point of the other facet over the reference, where one of them is a disc, whose rim no polygon has. @return  whether there is
  /// one
  SCREE_HD bool common_point(Vec3d& y) const {
    if (own.radius > 0 && other.radius > 0) {
      const Vec3d way = own.from_middle(other.middle, out);
      const double length = norm(way), r = own.radius;
      const double from = length - other.radius, to = length + other.radius;
      if (from > r) return false;
      const double t = 0.5 * ((from > -r ? from : -r) + (to < r ? to : r));
      y = own.middle + (length > 0 ? t / length : 0) * way;
    } else if (own.radius > 0) {
      y = other.nearest_seen(own.middle, out);
      if (!own.is_under(y, out, tie)) return false;
    } else if (other.radius > 0) {
      y = own.nearest_seen(other.middle, out);
      if (!other.is_under(y, out, tie)) return false;
    } else {
      return false;
    }
    if (!other_plane.is) return false;
    y += other_plane.way_from(y) * out;
    return true;
  }
  SCREE_HD void measure() {
    own.set_sides(out);
    other.set_sides(-out);
    own_plane.set(own, out);
    other_plane.set(other, out);
  }
  /// Calls offer(point) for those of the reference.
  template <class Reaches, class Offer>
  SCREE_HD void find_points(Reaches&& reaches, Offer&& offer) const {
    for (int k = 0; k < other.count; ++k) {
      const Vec3d& x = other.point[k];
      if (own.is_under(x, out, tie) || reaches(x)) offer(other.name[k]);
    }
    for (int k = 0; k < own.count; ++k) {
      if (own.count > 2 && other.count < 3) break;
      if (other.is_under(own.point[k], out, tie)) offer(ConvexFeature::kOwn + own.name[k]);
    }
    if (own.count < 3) return;
    const int edges = other.count < 3 ? other.count - 1 : other.count;
    for (int e = 0; e < edges; ++e) {
      for (int k = 0; k < own.count; ++k) {
        const Vec3d from = other.point[e], to = other.point[other.after(e)];
        const double before = own.beyond(k, from), after = own.beyond(k, to);
        if (!((before > tie && after < -tie) || (before < -tie && after > tie))) continue;
        const Vec3d x = from + (before / (before - after)) * (to - from);
        if (!own.is_under(x, out, tie, k)) continue;
        offer(ConvexFeature::kSides + other.name[e] * ConvexFeature::kNames + own.name[k]);
      }
    }
  }

  [[gnu::noinline]] SCREE_HD CoreContact contact_of(int number) const {
    CoreContact c;
    Vec3d x;
    double height = 0;  // of the other above the reference
    if (number >= ConvexFeature::kOwn && number < ConvexFeature::kSides) {
      const int k = own.find(number - ConvexFeature::kOwn);
      if (k < 0 || !other_plane.is) return c;
      x = own.point[k];
      height = other_plane.way_from(x);
    } else {
      if (number < ConvexFeature::kOwn) {
        const int k = other.find(number);
        if (k < 0) return c;
        x = other.point[k];
      } else {
        const int pair = number - ConvexFeature::kSides;
        const int e = other.find(pair / ConvexFeature::kNames);
        const int k = own.find(pair % ConvexFeature::kNames);
        if (e < 0 || k < 0) return c;
        const Vec3d from = other.point[e], to = other.point[other.after(e)];
        const double before = own.beyond(k, from), after = own.beyond(k, to);
        if (before == after) return c;
        x = from + (before / (before - after)) * (to - from);
      }
      if (!own_plane.is) return c;
      height = -own_plane.way_from(x);
      x -= height * out;
    }
    c.is = true;
    c.gap = height;
    c.on_a = reference == 0 ? x : x + height * out;
    return c;
  }
};

/// A contact of two rounded bodies.
/// @param d  center of body A, from which the cores are placed, to that of body B [m]
SCREE_HD inline ContactGeometry rounded_contact(const CoreMeeting& m, const CoreContact& c,
                                                const Vec3d& d) {
  ContactGeometry g;
  g.normal = m.distance.normal;
  g.gap = c.gap - m.a.rounding - m.b.rounding;
  g.arm_a = c.on_a + m.a.rounding * g.normal;
  g.arm_b = g.arm_a + g.gap * g.normal - d;
  return g;
}

/// Asks for all contacts of two bodies, see convex_contacts().
struct AllWanted {
  SCREE_HD bool has(std::uint32_t) const { return true; }
  SCREE_HD bool reaches(const Vec3d&) const { return false; }
  SCREE_HD bool has_middle(bool is_met) const { return is_met; }
};

/// Calls emit(feature, contact) for the contacts that are wanted, four at most, features ascending.
/// @param is_nearest  whether the nearest points are a contact where a face has none
/// @param wanted      wanted.has(feature): whether those of the reference are asked for; wanted.reaches(x): see CoreMeeting::visit()
/// @param listed      listed(contact): whether it is
template <class Wanted, class Listed, class Emit>
SCREE_HD void convex_contacts(const CoreMeeting& meeting, const Vec3d& d, bool is_nearest,
                              const Wanted& wanted, Listed&& listed, Emit&& emit) {
  int kept[Manifold::kMaxContacts];
  int count = 0;
  double least = 1e300;
  if (meeting.reference >= 0) {
    const Vec3d u = any_orthogonal(meeting.distance.normal);
    const Vec3d v = cross(meeting.distance.normal, u);
    FacePoints points;
    const auto reaches = [&](const Vec3d& x) { return wanted.reaches(x); };
    meeting.visit(reaches, [&](int number, const CoreContact& c) {
      if (!wanted.has(ConvexFeature::of(meeting.reference, number))) {
        is_nearest = false;
        return;
      }
      const double pu = dot(c.on_a, u), pv = dot(c.on_a, v);
      if (points.has(pu, pv, meeting.tie)) return;
      const ContactGeometry g = rounded_contact(meeting, c, d);
      if (listed(g)) points.add(number, pu, pv, g.gap);
    });
    count = reduced(points, meeting.tie, kept, least);
  }
  if (is_nearest && (count == 0 || meeting.is_cut_off(least))) {
    const ContactGeometry g = rounded_contact(meeting, meeting.nearest(), d);
    if (listed(g)) {
      if (count == Manifold::kMaxContacts) --count;
      emit(ConvexFeature::kNearest, g);
    }
  }
  for (int k = 0; k < count; ++k) {
    const std::uint32_t feature = ConvexFeature::of(meeting.reference, kept[k]);
    emit(feature, rounded_contact(meeting, meeting.contact(feature), d));
  }
}

/// What convex_contacts() finds, and a contact of the middle where bodies are fast, see MiddleContact: the last one then makes room.
/// @param way     of the second body relative to the first in the step [m]
/// @param moved   what of it the second has gone already [m]
/// @param wanted  wanted.has_middle(is_met), too: whether that contact is asked for, where others are or are not
template <class Wanted, class Listed, class Emit>
SCREE_HD void fast_contacts(const CoreMeeting& meeting, const Vec3d& d, const Vec3d& way,
                            const Vec3d& moved, bool is_nearest, const Wanted& wanted,
                            Listed&& listed, Emit&& emit) {
  const Vec3d& normal = meeting.distance.normal;
  const bool is_fast = MiddleContact::is_wanted(meeting.a, meeting.b, normal, way);
  int count = 0;
  bool is_met = false;
  convex_contacts(
      meeting, d, is_nearest, wanted,
      [&](const ContactGeometry& g) {
        is_met = true;
        return listed(at_start(g, moved));
      },
      [&](std::uint32_t feature, const ContactGeometry& g) {
        if (is_fast && count == Manifold::kMaxContacts - 1) return;
        ++count;
        emit(feature, at_start(g, moved));
      });
  // Of a body that spins all points may part, and the middle still comes.
  if (!is_fast || !wanted.has_middle(is_met)) return;
  const ContactGeometry g =
      at_start(MiddleContact::geometry(meeting.a, meeting.b, normal, d), moved);
  if (listed(g)) emit(ConvexFeature::kMiddle, g);
}

/// The contact of two bodies that a feature names, as fast_contacts() found it.
SCREE_HD inline ContactGeometry fast_contact(const CoreMeeting& meeting, const Vec3d& d,
                                             const Vec3d& moved, std::uint32_t feature) {
  return at_start(feature == ConvexFeature::kMiddle
                      ? MiddleContact::geometry(meeting.a, meeting.b, meeting.distance.normal, d)
                      : rounded_contact(meeting, meeting.contact(feature), d),
                  moved);
}

/// The contact of two bodies that a feature names.
/// @param way  of the second relative to the first in the step [m]
SCREE_HD inline ContactGeometry convex_contact(const ConvexCore& first, ConvexCore second,
                                               const Vec3d& d, const Vec3d& way,
                                               std::uint32_t feature) {
  CoreSearch search = whole_search(first, second, 1e300);
  if (may_pass(first, second, way, search)) look_ahead(first, second, way, search);
  const Vec3d moved = search.is_ahead ? way : Vec3d{};
  second.center += moved;
  return fast_contact(CoreMeeting(first, second, search.distance()), d + moved, moved, feature);
}

/// The contacts of two bodies that are listed, see fast_contacts().
/// @param way     of the second relative to the first in the step [m]
/// @param search  has ended
/// @param most    bodies that are farther apart have none [m]
template <class Listed, class Emit>
SCREE_HD void convex_manifold(const ConvexCore& first, ConvexCore second, const Vec3d& d,
                              const Vec3d& way, const CoreSearch& search, double most,
                              Listed&& listed, Emit&& emit) {
  if (search.separation > most + first.rounding + second.rounding && !search.is_ahead) return;
  const Vec3d moved = search.is_ahead ? way : Vec3d{};
  second.center += moved;
  fast_contacts(CoreMeeting(first, second, search.distance()), d + moved, way, moved, true,
                AllWanted{}, listed, emit);
}

/// Pair functions by cores, see InParts. @tparam Cores  its of_a(a) and of_b(b, d) give them
template <class Cores>
struct ConvexParts {
  static constexpr int kFeatureBits = ConvexFeature::kBits;
  using Search = CoreSearch;

  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t feature) {
    return convex_contact(Cores::of_a(a), Cores::of_b(b, d), d, b.way, feature);
  }
  SCREE_HD static Search search(const PairSide& a, const PairSide& b, const Vec3d& d, double most,
                                const Search* before) {
    const ConvexCore first = Cores::of_a(a), second = Cores::of_b(b, d);
    const double farthest = most + first.rounding + second.rounding;
    if (before != nullptr && before->holds(farthest)) return *before;
    return search_distance(first, second, farthest);
  }
  SCREE_HD static void finish(const PairSide& a, const PairSide& b, const Vec3d& d,
                              Search& search) {
    const ConvexCore first = Cores::of_a(a), second = Cores::of_b(b, d);
    finish_distance(first, second, search);
    search.may_pass = may_pass(first, second, b.way, search);
  }
  SCREE_HD static void pass(const PairSide& a, const PairSide& b, const Vec3d& d, Search& search) {
    look_ahead(Cores::of_a(a), Cores::of_b(b, d), b.way, search);
  }
  template <class Listed, class Emit>
  SCREE_HD static void contacts(const PairSide& a, const PairSide& b, const Vec3d& d,
                                const Search& search, double most, Listed&& listed, Emit&& emit) {
    convex_manifold(Cores::of_a(a), Cores::of_b(b, d), d, b.way, search, most, listed, emit);
  }
  template <class Listed>
  SCREE_HD static Manifold manifold(const PairSide& a, const PairSide& b, const Vec3d& d,
                                    double most, Listed&& listed) {
    return manifold_in_parts<ConvexParts>(a, b, d, most, listed);
  }
};

template <class ShapeA, class ShapeB>
struct CoresOf {
  SCREE_HD static ConvexCore of_a(const PairSide& a) { return core_of<ShapeA>(a, {}); }
  SCREE_HD static ConvexCore of_b(const PairSide& b, const Vec3d& d) {
    return core_of<ShapeB>(b, d);
  }
};

struct ConvexProgram;

/// Two bodies whose shapes give cores: what pair functions of convex shapes have in common. Where they run, one program
/// serves all of them: cores tell their forms apart anyway.
template <class ShapeA, class ShapeB>
struct ConvexPair : ConvexParts<CoresOf<ShapeA, ShapeB>> {
  using A = ShapeA;
  using B = ShapeB;
  using Program = ConvexProgram;
};

}  // namespace scree
