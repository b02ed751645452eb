#pragma once
// Distance of two cores, or the least way by which they leave each other.
//
// M, the set of differences of points of B and A, holds the origin when the cores overlap. GJK finds its point nearest to
// the origin (Gilbert, Johnson, Keerthi, 1988). When that is the origin, a polytope grows from the tetrahedron about it that
// GJK ends with, where its surface is nearest to the origin, until no plane of it can be moved out (van den Bergen,
// Proximity queries, 2001).
// Every direction that is tried on the way is a true upper bound of the depth, and the least of them counts, so a
// polytope that rounding or its capacity stops early still gives a sound answer.

#include "kernels/narrow_phase/pairs/ahead.h"
#include "kernels/narrow_phase/pairs/convex_core.h"

namespace scree {

/// How two cores lie.
struct CoreDistance {
  Vec3d normal{0, 0, 1};  ///< unit, from A to B
  double separation = 0;  ///< along it [m]; negative is overlap
  bool is_apart = false;
  Vec3d on_a, on_b;  ///< the nearest points of cores that are apart [m]
};

/// How far the search for that has come. It has two parts, since the second is for fewer pairs, and takes much memory for some.
struct alignas(16) CoreSearch {
  enum class State : std::uint8_t {
    beyond,  ///< they are farther apart than was asked for; `separation` is at most their distance
    apart,   ///< it has ended
    overlapping,  ///< it has ended, too
    parted,       ///< open: they are apart, and it is not known whether by a face
    touching,     ///< open: the surface of M passes through the origin, but for rounding
    inside        ///< open: the origin is inside of M
  };
  State state = State::beyond;
  bool has_facet = false;       ///< the normal is that of a face, but for kFaceCosine
  bool is_ahead = false;        ///< of a face that parts the cores longer, see look_ahead()
  bool may_pass = false;        ///< it has ended, but for look_ahead()
  std::uint8_t unused[4] = {};  ///< a device reads first what it writes in parts
  double separation = 0;        ///< [m]
  Vec3d point[4];  ///< normal and nearest points; inside: corners of a tetrahedron about the origin

  SCREE_HD bool is_beyond() const { return state == State::beyond; }
  SCREE_HD bool is_open() const { return state == State::parted || is_deep(); }
  /// Open, and the second part takes a polytope.
  SCREE_HD bool is_deep() const { return state == State::touching || state == State::inside; }
  /// Whether it also tells what a search within that distance would [m].
  SCREE_HD bool holds(double most) const { return !is_beyond() || separation > most; }
  SCREE_HD CoreDistance distance() const {
    return {point[0], separation, state == State::apart, point[1], point[2]};
  }
};

namespace convex_parts {

/// A point of M, and the point of A that it comes from.
struct DifferencePoint {
  Vec3d w, a;
};

SCREE_HD inline DifferencePoint farthest(const ConvexCore& a, const ConvexCore& b, const Vec3d& n) {
  DifferencePoint p;
  p.a = a.center + a.support(-n);
  p.w = b.center + b.support(n) - p.a;
  return p;
}

/// Up to four points and the weights of their point nearest to the origin. Places are known when this is compiled, so
/// that all of it stays in registers.
class Simplex {
 public:
  static constexpr int kMost = 4;

  SCREE_HD explicit Simplex(const DifferencePoint& p) : count_(1) {
    point_[0] = p;
    weight_[0] = 1;
  }
  SCREE_HD const DifferencePoint& operator[](int k) const { return point_[k]; }

  SCREE_HD DifferencePoint nearest() const {
    DifferencePoint x;
    for (int k = 0; k < kMost; ++k) {
      if (k >= count_) break;
      x.w += weight_[k] * point_[k].w;
      x.a += weight_[k] * point_[k].a;
    }
    return x;
  }

  SCREE_HD void add(const DifferencePoint& p) {
    for (int k = 1; k < kMost; ++k) {
      if (k == count_) point_[k] = p;
    }
    ++count_;
  }

  /// Keeps what holds the nearest point. @return  whether that is the origin, inside of a tetrahedron
  /// @param size  of the cores, for rounding [m]
  SCREE_HD bool reduce(double size) {
    best2_ = 1e300;
    for (int k = 0; k < kMost; ++k) weight_[k] = 0;
    // What is nearest has the point that came last: without it nothing is nearer than before.
    if (count_ == 2) {
      offer_edge<0, 1>();
    } else if (count_ == 3) {
      if (!offer_face<0, 1, 2>()) offer_edge<0, 2>(), offer_edge<1, 2>();
    } else {
      const int seen = faces_toward_origin(size);
      if (seen == 0) return true;
      bool is_found = false;
      if ((seen & 1) != 0) is_found |= offer_face<1, 2, 3>();
      if ((seen & 2) != 0) is_found |= offer_face<2, 0, 3>();
      if ((seen & 4) != 0) is_found |= offer_face<0, 1, 3>();
      if (!is_found) offer_edge<0, 3>(), offer_edge<1, 3>(), offer_edge<2, 3>();
    }
    int kept = 0;
    for (int k = 0; k < kMost; ++k) {
      if (!(weight_[k] > 0)) continue;
      for (int to = 0; to < k; ++to) {
        if (to != kept) continue;
        point_[to] = point_[k];
        weight_[to] = weight_[k];
      }
      ++kept;
    }
    count_ = kept;
    return false;
  }

 private:
  /// Bit k: the face without corner k, of those with the last, is between the origin and that corner.
  SCREE_HD int faces_toward_origin(double size) const {
    return is_toward_origin<0>(size) | is_toward_origin<1>(size) << 1 |
           is_toward_origin<2>(size) << 2;
  }
  /// 1: that is so, or the tetrahedron is flat; else 0.
  template <int k>
  SCREE_HD int is_toward_origin(double size) const {
    constexpr int i = (k + 1) % 3, j = (k + 2) % 3;
    const Vec3d e = point_[i].w - point_[3].w, f = point_[j].w - point_[3].w, n = cross(e, f);
    const double own = dot(point_[k].w - point_[3].w, n), origin = -dot(point_[3].w, n);
    // One that is flat but for rounding has no inside.
    const double rounding2 = 1e-24 * size * size * norm2(e) * norm2(f);
    return own * origin > 0 && own * own > rounding2 ? 0 : 1;
  }
  template <int i, int j>
  SCREE_HD void offer_edge() {
    const Vec3d &p = point_[i].w, way = point_[j].w - p;
    const double length2 = norm2(way);
    double t = length2 > 0 ? -dot(p, way) / length2 : 0;
    t = t > 0 ? (t < 1 ? t : 1) : 0;
    if (!is_nearer(norm2(p + t * way))) return;
    weight_[i] = 1 - t;
    weight_[j] = t;
  }
  /// @return  whether the origin is over the inside of the triangle
  template <int i, int j, int l>
  SCREE_HD bool offer_face() {
    const Vec3d &a = point_[i].w, &b = point_[j].w, &c = point_[l].w;
    const Vec3d n = cross(b - a, c - a);
    const double wa = dot(cross(b, c), n), wb = dot(cross(c, a), n), wc = dot(cross(a, b), n);
    if (!(wa > 0 && wb > 0 && wc > 0)) return false;
    const double part = 1 / (wa + wb + wc);
    if (!is_nearer(norm2((part * wa) * a + (part * wb) * b + (part * wc) * c))) return true;
    weight_[i] = part * wa;
    weight_[j] = part * wb;
    weight_[l] = part * wc;
    return true;
  }
  SCREE_HD bool is_nearer(double found2) {
    if (!(found2 < best2_)) return false;
    best2_ = found2;
    for (int k = 0; k < kMost; ++k) weight_[k] = 0;
    return true;
  }

  int count_;
  double best2_ = 0;
  DifferencePoint point_[kMost];
  double weight_[kMost] = {};
};

/// The first part of a search. @param most  cores that are farther apart need no exact answer [m]
SCREE_HD inline CoreSearch find_nearest(const ConvexCore& a, const ConvexCore& b, double size,
                                        double most) {
  using State = CoreSearch::State;
  CoreSearch out;
  const Vec3d between = b.center - a.center;
  DifferencePoint v = farthest(a, b, -between);
  const double along = dot(v.w, between), way = norm(between);
  if (along > most * way) {
    out.separation = along / way;
    return out;
  }
  Simplex s(v);
  double length2 = norm2(v.w);
  for (int step = 0; step < 64; ++step) {
    const double length = std::sqrt(length2);
    if (length <= 1e-9 * size) break;
    const DifferencePoint p = farthest(a, b, -v.w);
    const double bound = dot(v.w, p.w);
    if (bound > most * length) {
      out.separation = bound / length;
      return out;
    }
    if (length2 - bound <= 1e-14 * length2 + 4e-16 * size * length) break;
    s.add(p);
    if (s.reduce(size)) {
      out.state = State::inside;
      for (int k = 0; k < 4; ++k) out.point[k] = s[k].w;
      return out;
    }
    const DifferencePoint next = s.nearest();
    const double next2 = norm2(next.w);
    if (!(next2 < length2)) break;
    v = next;
    length2 = next2;
  }
  out.separation = std::sqrt(length2);
  if (out.separation <= 1e-9 * size) {
    out.state = State::touching;
  } else if (!(out.separation > most)) {
    out.state = State::parted;
    out.point[0] = (1 / out.separation) * v.w;
    out.point[1] = v.a;
    out.point[2] = v.a + v.w;
  }
  return out;
}

/// A polytope inside of M.
class Polytope {
 public:
  SCREE_HD Polytope(const ConvexCore& a, const ConvexCore& b, double size)
      : a_(a), b_(b), size_(size) {}

  /// The direction out of M of least depth. @return  false: M is flat, and the depth is zero
  /// @param corners  of a tetrahedron about the origin; null: there is none
  SCREE_HD void grow(const Vec3d* corners) {
    if (corners != nullptr) {
      start_from(corners);
    } else if (!start()) {
      return;
    }
    while (vertex_count_ < kMaxVertices) {
      int nearest = -1;
      for (int f = 0; f < face_count_; ++f) {
        if (nearest < 0 || face_[f].height < face_[nearest].height) nearest = f;
      }
      const Face face = face_[nearest];
      const Vec3d x = support(face.normal);
      if (dot(x, face.normal) - face.height <= 1e-10 * size_) return;
      if (depth <= face.height + 1e-10 * size_ || !add(x)) return;
    }
  }

  /// Turns the direction to where the depth of curved cores is least, by steps of Newton on the sphere of directions: a
  /// polytope only comes near it. The gradient of the depth is what of the farthest point lies across the direction.
  SCREE_HD void turn() {
    constexpr double kAngle = 1e-5;
    for (int step = 0; step < 12; ++step) {
      const double before = depth;
      const Vec3d n = normal, u = any_orthogonal(n), v = cross(n, u), x = farthest(a_, b_, n).w;
      const Vec3d by_u = support(normalized(n + kAngle * u)) - x;
      const Vec3d by_v = support(normalized(n + kAngle * v)) - x;
      const double uu = dot(by_u, u) / kAngle - before, vv = dot(by_v, v) / kAngle - before;
      const double uv = 0.5 * (dot(by_u, v) + dot(by_v, u)) / kAngle, det = uu * vv - uv * uv;
      if (!(uu > 0 && det > 0)) return;
      const double xu = dot(x, u), xv = dot(x, v);
      support(normalized(n + ((uv * xv - vv * xu) / det) * u + ((uv * xu - uu * xv) / det) * v));
      if (!(depth < before)) return;
    }
  }

  Vec3d normal{0, 0, 1};  ///< unit, out of M
  double depth = 1e300;   ///< [m]
  Vec3d deepest;          ///< the point of M that is farthest along it [m]

 private:
  static constexpr int kMaxVertices = 28;
  static constexpr int kMaxFaces = 2 * kMaxVertices;
  static constexpr int kMaxEdges = kMaxFaces;
  struct Face {
    Vec3d normal;
    double height;
    std::uint8_t corner[3];
  };

  SCREE_HD Vec3d support(const Vec3d& n) {
    const Vec3d x = farthest(a_, b_, n).w;
    const double found = dot(x, n);
    if (found < depth) {
      depth = found;
      normal = n;
      deepest = x;
    }
    return x;
  }
  SCREE_HD Vec3d farther(const Vec3d& n, const Vec3d& from) {
    const Vec3d x = support(n), y = support(-n);
    return dot(x - from, n) >= dot(from - y, n) ? x : y;
  }
  SCREE_HD bool start() {
    const double least = 1e-9 * size_;
    vertex_[0] = support({1, 0, 0});
    vertex_[1] = farther(normalized(b_.center - a_.center, {1, 0, 0}), vertex_[0]);
    if (norm(vertex_[1] - vertex_[0]) < least) vertex_[1] = farther({0, 1, 0}, vertex_[0]);
    if (norm(vertex_[1] - vertex_[0]) < least) vertex_[1] = farther({0, 0, 1}, vertex_[0]);
    const Vec3d along = normalized(vertex_[1] - vertex_[0]), side = any_orthogonal(along);
    vertex_[2] = farther(side, vertex_[0]);
    if (norm(cross(along, vertex_[2] - vertex_[0])) < least) {
      vertex_[2] = farther(cross(along, side), vertex_[0]);
    }
    const Vec3d up = normalized(cross(along, vertex_[2] - vertex_[0]));
    vertex_[3] = farther(up, vertex_[0]);
    vertex_count_ = 4;
    if (std::abs(dot(vertex_[3] - vertex_[0], up)) < least) return false;
    add_tetrahedron();
    return true;
  }
  SCREE_HD void start_from(const Vec3d* corners) {
    for (int k = 0; k < 4; ++k) vertex_[k] = corners[k];
    vertex_count_ = 4;
    add_tetrahedron();
  }
  SCREE_HD void add_tetrahedron() {
    const Vec3d& from = vertex_[0];
    if (dot(cross(vertex_[1] - from, vertex_[2] - from), vertex_[3] - from) > 0) {
      const Vec3d x = vertex_[1];
      vertex_[1] = vertex_[2];
      vertex_[2] = x;
    }
    add_face(0, 1, 2);
    add_face(0, 2, 3);
    add_face(0, 3, 1);
    add_face(1, 3, 2);
  }
  SCREE_HD void add_face(int i, int j, int k) {
    Face& f = face_[face_count_++];
    f.corner[0] = static_cast<std::uint8_t>(i);
    f.corner[1] = static_cast<std::uint8_t>(j);
    f.corner[2] = static_cast<std::uint8_t>(k);
    const Vec3d n = cross(vertex_[j] - vertex_[i], vertex_[k] - vertex_[i]);
    const double area = norm(n);
    // One without an area is neither seen nor moved out.
    f.normal = area > 0 ? (1 / area) * n : Vec3d{};
    f.height = area > 0 ? dot(f.normal, vertex_[i]) : 1e300;
  }
  /// Puts a corner outside of what it sees. @return  false: there is no room
  SCREE_HD bool add(const Vec3d& x) {
    std::uint8_t from[kMaxEdges], to[kMaxEdges];
    int edges = 0, kept = 0;
    for (int f = 0; f < face_count_; ++f) {
      if (dot(face_[f].normal, x) - face_[f].height <= 1e-12 * size_) {
        face_[kept++] = face_[f];
        continue;
      }
      for (int k = 0; k < 3; ++k) {
        const std::uint8_t i = face_[f].corner[k], j = face_[f].corner[(k + 1) % 3];
        int twin = 0;
        while (twin < edges && !(from[twin] == j && to[twin] == i)) ++twin;
        if (twin < edges) {
          --edges;
          from[twin] = from[edges];
          to[twin] = to[edges];
        } else if (edges < kMaxEdges) {
          from[edges] = i;
          to[edges] = j;
          ++edges;
        } else {
          return false;
        }
      }
    }
    if (kept + edges > kMaxFaces || edges < 3) return false;
    face_count_ = kept;
    vertex_[vertex_count_] = x;
    for (int e = 0; e < edges; ++e) add_face(from[e], to[e], vertex_count_);
    ++vertex_count_;
    return true;
  }

  const ConvexCore& a_;
  const ConvexCore& b_;
  double size_;
  int vertex_count_ = 0, face_count_ = 0;
  Room<Vec3d, kMaxVertices> vertex_;
  Room<Face, kMaxFaces> face_;
};

}  // namespace convex_parts

/// Faces are preferred to other directions of overlap that are better by less than this part of the size. Ellipsoids lie
/// flat on none, and over an edge between faces that are nearly parallel they are deepest along neither normal.
inline constexpr double kFaceBias = 1e-4, kFaceBiasOfEllipsoids = 1e-9;
/// Cosine of the largest angle by which a normal is that of a face.
inline constexpr double kFaceCosine = 1 - 5e-7;

namespace convex_parts {

/// Of the normals of faces, which are what bodies rest on, the one along which cores are farthest apart, without the rounding
/// of a search.
struct BestFace {
  double separation = -1e300;  ///< along it [m]
  Vec3d normal;                ///< unit, from A to B
  bool is_near =
      false;  ///< a normal, this or another, differs from `toward` by less than kFaceCosine tells

  /// @param toward  a direction near those that are looked for, unit, from A to B
  /// @param known   a point of M: along no normal are cores farther apart than that is
  /// @param least   normals along which cores are not that far apart do not count [m]
  SCREE_HD BestFace(const ConvexCore& a, const ConvexCore& b, double size, const Vec3d& toward,
                    const Vec3d& known, double least) {
    for (int side = 0; side < 2; ++side) {
      const ConvexCore& core = side == 0 ? a : b;
      const ConvexCore& other = side == 0 ? b : a;
      const double sign = side == 0 ? 1 : -1;
      const std::uint32_t top = core.top(sign * toward);
      for (int k = 0; k < core.normal_count(); ++k) {
        const Vec3d out = core.face_normal(k, sign * toward, top), n = sign * out;
        is_near = is_near || dot(n, toward) >= kFaceCosine;
        if (dot(known, n) < least - 1e-9 * size) continue;
        const double found =
            dot(other.center + other.support(-out) - core.center - core.on_face(out, top), out);
        if (!(found >= least) || found <= separation + 1e-9 * size) continue;
        separation = found;
        normal = n;
      }
    }
  }
  SCREE_HD bool is() const { return separation > -1e300; }
};

}  // namespace convex_parts

/// The first part of a search. Functions of their own on a device: closed forms keep their registers.
/// @param most  cores that are farther apart need no exact answer [m]
[[gnu::noinline]] SCREE_HD inline CoreSearch search_distance(const ConvexCore& a,
                                                             const ConvexCore& b, double most) {
  return convex_parts::find_nearest(a, b, a.size() + b.size(), most);
}

/// The second part, of cores that are apart.
SCREE_HD inline void finish_parted(const ConvexCore& a, const ConvexCore& b, CoreSearch& search) {
  const double gap = search.separation;
  const convex_parts::BestFace face(a, b, a.size() + b.size(), search.point[0],
                                    gap * search.point[0], gap * (1 - 1e-7));
  search.state = CoreSearch::State::apart;
  search.has_facet = face.is_near;
  if (face.is()) search.point[0] = face.normal;
}

/// The second part, of cores that touch or overlap: its arrays are in the stack once.
[[gnu::noinline]] SCREE_HD inline void finish_deep(const ConvexCore& a, const ConvexCore& b,
                                                   CoreSearch& search) {
  const double size_a = a.size(), size_b = b.size();
  const double size = size_a + size_b, least = size_a < size_b ? size_a : size_b;
  convex_parts::Polytope polytope(a, b, size);
  polytope.grow(search.state == CoreSearch::State::inside ? search.point : nullptr);
  if (a.is_curved() || b.is_curved()) polytope.turn();
  // Of two edges, exactly: a polytope only comes near the normal of round sides that cross.
  Vec3d crossing;
  double by_edges = -1e300;
  const auto offer = [&](const Vec3d& across) {
    const double length = norm(across);
    if (!(length > 1e-6)) return;
    for (int sign = -1; sign <= 1; sign += 2) {
      const Vec3d n = (sign / length) * across;
      const double found = separation_along(a, b, n);
      if (found > by_edges) {
        by_edges = found;
        crossing = n;
      }
    }
  };
  for (int i = 0; i < a.edge_count(); ++i) {
    for (int j = 0; j < b.edge_count(); ++j) {
      offer(cross(normalized(a.edge(i)), normalized(b.edge(j))));
    }
  }
  // Round sides that lie along each other, or past a corner.
  const Vec3d between = b.center - a.center;
  for (int side = 0; side < 2; ++side) {
    const ConvexCore& core = side == 0 ? a : b;
    if (core.form != ConvexCore::Form::cylinder) continue;
    offer((1 / size) * (between - dot(between, core.axis[2]) * core.axis[2]));
  }
  search.state = CoreSearch::State::overlapping;
  using Form = ConvexCore::Form;
  const bool has_ellipsoid = a.form == Form::ellipsoid || b.form == Form::ellipsoid;
  const double most_apart = by_edges > -polytope.depth ? by_edges : -polytope.depth;
  const double needed = most_apart - (has_ellipsoid ? kFaceBiasOfEllipsoids : kFaceBias) * least;
  const convex_parts::BestFace face(a, b, size, -polytope.normal, polytope.deepest, needed);
  search.has_facet = face.is() || face.is_near;
  if (face.is()) {
    search.point[0] = face.normal;
    search.separation = face.separation;
  } else if (by_edges >= -polytope.depth - 1e-9 * size) {
    search.point[0] = crossing;
    search.separation = by_edges;
  } else {
    search.point[0] = -polytope.normal;
    search.separation = -polytope.depth;
  }
}

/// The second part.
[[gnu::noinline]] SCREE_HD inline void finish_distance(const ConvexCore& a, const ConvexCore& b,
                                                       CoreSearch& search) {
  if (search.is_deep()) {
    finish_deep(a, b, search);
  } else {
    finish_parted(a, b, search);
  }
}

/// Both parts. @param most  cores that are farther apart need no exact answer, but a separation of more than this [m]
SCREE_HD inline CoreSearch whole_search(const ConvexCore& a, const ConvexCore& b, double most) {
  CoreSearch search = search_distance(a, b, most);
  if (search.is_open()) finish_distance(a, b, search);
  return search;
}
SCREE_HD inline CoreDistance core_distance(const ConvexCore& a, const ConvexCore& b, double most) {
  return whole_search(a, b, most).distance();
}

SCREE_HD inline Passing passing_of(const ConvexCore& a, const ConvexCore& b) {
  const double thick_a = a.thickness(), thick_b = b.thickness();
  return {thick_a < thick_b ? thick_a : thick_b};
}
/// Whether cores go far enough along the normal between them for another plane to part them longer.
/// @param way     of B relative to A in the step [m]
/// @param search  has ended
SCREE_HD inline bool may_pass(const ConvexCore& a, const ConvexCore& b, const Vec3d& way,
                              const CoreSearch& search) {
  const Passing passing = passing_of(a, b);
  const double gap = search.separation - a.rounding - b.rounding;
  const double approach = -dot(search.point[0], way);
  return passing.parts(gap) && gap < approach && passing.goes_far(approach, 0);
}

/// Takes the face that parts cores longest on their way, see ahead.h: `separation` along its normal is that of the end of the step.
/// @param way     of B relative to A in the step [m]
/// @param search  has ended, and may_pass()
[[gnu::noinline]] SCREE_HD inline void look_ahead(const ConvexCore& a, const ConvexCore& b,
                                                  const Vec3d& way, CoreSearch& search) {
  search.may_pass = false;
  const Passing passing = passing_of(a, b);
  const double rounding = a.rounding + b.rounding, gap = search.separation - rounding;
  const Vec3d normal = search.point[0];
  const double approach = -dot(normal, way);
  double latest = passing.time(gap, approach) * Passing::kLater;
  // Corners that look at the other core, beside the contact, and points of the cores that are near it.
  const Vec3d along = b.center - a.center;
  const Vec3d toward = normal + 1e-3 * normalized(along - dot(along, normal) * normal, Vec3d{});
  const std::uint32_t corner_a = a.top(toward), corner_b = b.top(-toward);
  const bool was_apart = search.state == CoreSearch::State::apart;
  const Vec3d near_a = was_apart ? search.point[1] : a.center + a.on_face(toward, corner_a);
  const Vec3d near_b = was_apart ? search.point[2] : b.center + b.on_face(-toward, corner_b);
  for (int side = 0; side < 2; ++side) {
    const ConvexCore& core = side == 0 ? a : b;
    const ConvexCore& other = side == 0 ? b : a;
    const std::uint32_t corner = side == 0 ? corner_a : corner_b;
    for (int k = 0; k < core.normal_count_at(corner); ++k) {
      const Vec3d out = core.normal_at(k, corner), n = side == 0 ? out : -out;
      if (std::abs(dot(n, normal)) > Passing::kSame) continue;
      const Vec3d on_face = core.center + core.on_face(out, corner);
      const double nearer = -dot(n, way);
      const auto is_later = [&](double gap_of_face) {
        return passing.parts(gap_of_face) && passing.time(gap_of_face, nearer) > latest &&
               passing.goes_far(approach, nearer);
      };
      // A point of the other core tells of most faces without a search for the one nearest to them.
      if (!is_later(dot((side == 0 ? near_b : near_a) - on_face, out) - rounding)) continue;
      const double found = dot(other.center + other.support(-out) - on_face, out) - rounding;
      if (!is_later(found)) continue;
      latest = passing.time(found, nearer) * Passing::kLater;
      search.state = CoreSearch::State::overlapping;
      search.has_facet = true;
      search.is_ahead = true;
      search.point[0] = n;
      search.separation = found + rounding + dot(n, way);
    }
  }
}

}  // namespace scree
