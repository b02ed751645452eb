#pragma once
// Islands: bodies whose impacts in a step depend on each other. Each is worked through alone, one impact after the
// other in the order of their times, from the state at the start of the step, which nobody changes. So islands run side
// by side, and one may be run again with more members.

#include "kernels/backend/atomic.h"
#include "kernels/backend/backend.h"
#include "kernels/variational/impact.h"
#include "kernels/variational/stage.h"

namespace scree {

/// Two bodies that belong to one island.
struct Link {
  Index a = 0, b = 0;
};

/// Links that were asked for, in any order; those beyond the room are asked for again.
struct LinkList {
  Span<Link> link;
  Index* count;
  SCREE_HD void add(Index a, Index b) const {
    const Index at = atomic_add(count, 1);
    if (at < link.size) link[at] = {a, b};
  }
  SCREE_HD Index size() const {
    return *count < link.size ? *count : static_cast<Index>(link.size);
  }
};

/// Draws bodies of links in that met nothing by themselves.
struct DrawIn {
  static constexpr const char* name = "draw_in";
  LinkList links;
  Span<Index> partner;
  Span<Index> is_active;
  SCREE_HD void operator()(Index k) const {
    const Link l = links.link[k];
    for (const Index body : {l.a, l.b}) {
      if (is_active[body] != 0) continue;
      is_active[body] = 1;
      partner[body] = kDrawnIn;
    }
  }
};

/// Lists the active bodies; each is a node of its own.
struct ListActive {
  static constexpr const char* name = "list_active";
  Span<const Index> is_active;
  Span<const Index> slot;      ///< scan of is_active
  Span<Index> body;            ///< [active] out
  Span<std::uint32_t> parent;  ///< [active] out
  SCREE_HD void operator()(Index i) const {
    if (is_active[i] == 0) return;
    body[slot[i]] = i;
    parent[slot[i]] = static_cast<std::uint32_t>(slot[i]);
  }
};

/// Connects the ends of each link: parents only fall, and a pass that changes none ends it. Then the parent of each node
/// is the lowest one of its island. Elements: active bodies, with a link to their partner each, then the links of the list.
struct ConnectIslands {
  static constexpr const char* name = "connect_islands";
  Span<const Index> body, slot, partner;
  Index active, owned;
  LinkList links;
  std::uint32_t* parent;
  std::uint8_t* changed;

  /// As it is now, while others lower it.
  SCREE_HD std::uint32_t parent_of(std::uint32_t node) const {
    return *const_cast<const volatile std::uint32_t*>(parent + node);
  }
  SCREE_HD void operator()(Index e) const {
    auto a = static_cast<std::uint32_t>(e), b = a;
    if (e < active) {
      const Index other = partner[body[e]];
      if (other >= 0 && other < owned) b = static_cast<std::uint32_t>(slot[other]);
    } else {
      a = static_cast<std::uint32_t>(slot[links.link[e - active].a]);
      b = static_cast<std::uint32_t>(slot[links.link[e - active].b]);
    }
    const std::uint32_t pa = parent_of(a), pb = parent_of(b);
    if (pa != pb) {
      atomic_min(&parent[pa > pb ? pa : pb], pa > pb ? pb : pa);
      atomic_min(&parent[a], pb), atomic_min(&parent[b], pa);
      atomic_mark(changed);
    }
    const std::uint32_t above = parent_of(pa);
    if (above != pa) {
      atomic_min(&parent[a], above);
      atomic_mark(changed);
    }
  }
};

/// Keys that sort members by island, then by their place in storage.
struct KeyMembers {
  static constexpr const char* name = "key_members";
  Span<const std::uint32_t> parent;
  Span<std::uint64_t> key;
  Span<Index> order;
  SCREE_HD void operator()(Index s) const {
    key[s] = static_cast<std::uint64_t>(parent[s]) << 32 | static_cast<std::uint32_t>(s);
    order[s] = s;
  }
};

/// A body of an island, on its way through the step. 128 bytes.
struct Member {
  Node node;
  Event next;
  Vec3d normal;  ///< of its last impact
  double way =
      -1;  ///< farthest from where it started, when the island is done [m]; negative: it is not
  Index body = 0;  ///< in storage
  Index island = 0;
  Index impacts = 0;
  Index of_walls = 0;  ///< impacts with walls and fixed spheres
  Index grazing = 0;
};

/// Puts members into order. @tparam M  what a member is
template <class M>
struct PlaceMembers {
  static constexpr const char* name = "place_members";
  Span<const Index> order, body;
  Span<const std::uint32_t> parent;
  Span<M> member;
  Span<Index> place;  ///< [owned]
  SCREE_HD void operator()(Index p) const {
    const Index s = order[p];
    member[p].body = body[s];
    member[p].island = static_cast<Index>(parent[s]);
    place[body[s]] = p;
  }
};

/// What ends a run, or a step: the lowest id of a body that did it.
struct IslandFaults {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  std::uint32_t left = kNone;     ///< neighbors are not all listed
  std::uint32_t crowded = kNone;  ///< too many impacts
  std::uint32_t resting = kNone;  ///< came to rest on a wall
  std::uint32_t stuck = kNone;    ///< touches, and neither approaches nor leaves
};

/// Works through the islands. Elements: members; the first one of an island does the work.
/// @tparam Program   what is its own with these members: set_out(m), find(p), meet(p, q, time), meet_walls(p, event), end_of(m),
///                   is_stuck(p)
/// @tparam OwnStage  what it reads
/// @tparam M         what a member is
template <class Program, class OwnStage, class M>
struct WorkThroughIslands {
  static constexpr Index kSerialBelow = 16;
  static constexpr int kBlockThreads = 64;
  OwnStage stage;
  Span<M> member;           ///< in: body and island; out: the rest
  Span<const Index> place;  ///< [owned] of members
  LinkList links;           ///< out: bodies that an island needs
  IslandFaults* faults;     ///< out

  SCREE_HD void operator()(Index first) const {
    const Program& own = static_cast<const Program&>(*this);
    const Index island = member[first].island;
    if (first > 0 && member[first - 1].island == island) return;
    Index end = first;
    for (; end < member.size && member[end].island == island; ++end) own.set_out(member[end]);
    for (Index p = first; p < end; ++p) own.find(p);
    for (;;) {
      const Index p = earliest(first, end);
      const Event event = member[p].next;
      if (event.partner == kNobody) break;
      if (event.partner >= 0 && stage.is_free(event.partner)) {
        const Index q = member_of(event.partner, island);
        if (q < 0) return links.add(member[p].body, event.partner);
        own.meet(p, q, event.time);
      } else {
        own.meet_walls(p, event);
      }
      if (member[p].impacts > stage.most_impacts) return atomic_min(&faults->crowded, id(p));
      if (own.is_stuck(p)) return atomic_min(&faults->stuck, id(p));
    }
    for (Index p = first; p < end; ++p) {
      M& m = member[p];
      pass(m, own.end_of(m));
      m.way += 0.125 * stage.h * stage.h * norm(stage.gravity);
    }
  }

  SCREE_HD std::uint32_t id(Index p) const {
    return static_cast<std::uint32_t>(stage.bodies.id[member[p].body]);
  }
  /// Place of a body that is in the island; negative: it is not.
  SCREE_HD Index member_of(Index body, Index island) const {
    const Index p = stage.is_free(body) ? place[body] : -1;
    return p >= 0 && member[p].island == island ? p : -1;
  }
  SCREE_HD Index earliest(Index first, Index end) const {
    Index best = first;
    for (Index p = first + 1; p < end; ++p) {
      const double t = member[p].next.time, least = member[best].next.time;
      if (t < least || (t == least && id(p) < id(best))) best = p;
    }
    return best;
  }
  /// Notes that a member comes to a place.
  SCREE_HD void pass(M& m, const Vec3d& x) const {
    const double way = norm(x - stage.bodies.position[m.body]);
    if (way > m.way) m.way = way;
    if (!stage.is_covered(m.body, x)) atomic_min(&faults->left, std::uint32_t(0));
  }
};

/// The same with spheres.
template <bool kSolids>
struct RunIslands : WorkThroughIslands<RunIslands<kSolids>, Stage<kSolids>, Member> {
  static constexpr const char* name = "run_islands";
  using Base = WorkThroughIslands<RunIslands<kSolids>, Stage<kSolids>, Member>;
  using Base::faults;
  using Base::id;
  using Base::member;
  using Base::member_of;
  using Base::stage;

  SCREE_HD void set_out(Member& m) const {
    m.node = stage.start(m.body);
    m.next = {};
    m.normal = {};
    m.way = -1;
    m.impacts = m.of_walls = m.grazing = 0;
  }
  SCREE_HD Node node_of(Index body, Index island) const {
    const Index p = member_of(body, island);
    return p < 0 ? stage.start(body) : member[p].node;
  }
  SCREE_HD void find(Index p) const {
    Member& m = member[p];
    const Index island = m.island;
    double least_gap = kNever;
    m.next = stage.next(
        m.body, m.node, [&](Index k) { return node_of(k, island); }, least_gap);
  }
  SCREE_HD static bool is_stuck(Index) { return false; }

  /// After an impact of member p: what it, and those it may meet now, meet next.
  SCREE_HD void find_again(Index p) const {
    find(p);
    const Index i = member[p].body, island = member[p].island;
    for (Offset q = stage.near.begin[i]; q < stage.near.begin[i + 1]; ++q) {
      const Index k = stage.near.other[q];
      const Index at = member_of(k, island);
      if (at < 0) continue;
      Member& other = member[at];
      if (other.next.partner == i) {
        find(at);
        continue;
      }
      const double time = stage.pair_time(k, other.node, i, member[p].node);
      if (time < kNever && stage.comes_before(time, i, other.next)) other.next = {time, i};
    }
  }

  /// Length of the part of the step before an impact, as its energy was set: what was left of the step after the
  /// impact before, which is behind the body by now, or the time since the start of the step.
  SCREE_HD double part_before(const Member& m, double t) const {
    return m.impacts > 0 ? stage.h - m.node.t : t;
  }

  SCREE_HD void go_to(Member& m, double t) const {
    m.node = m.node.at(t, stage.gravity);
    this->pass(m, m.node.x);
  }

  /// Two spheres: an impulse along the line between the centers.
  SCREE_HD void meet(Index p, Index q, double t) const {
    Member &a = member[p], &b = member[q];
    const double wa = stage.bodies.inv_mass[a.body], wb = stage.bodies.inv_mass[b.body];
    const double g = norm(stage.gravity), rest = stage.h - t;
    const double carried = (wa + wb) * (carried_square(g, part_before(a, t), rest) / wa +
                                        carried_square(g, part_before(b, t), rest) / wb);
    go_to(a, t), go_to(b, t);
    const Vec3d n = normalized(stage.between(a.node.x, b.node.x));
    const double approach = -dot(b.node.v - a.node.v, n);
    const Rebound after = rebound(approach > 0 ? approach : 0, carried);
    const double e = stage.restitution_of(a.body, b.body);
    const double push = approach > 0 ? (approach + e * after.speed) / (wa + wb) : 0;
    a.node.v -= (push * wa) * n;
    b.node.v += (push * wb) * n;
    a.normal = b.normal = n;
    ++a.impacts, ++b.impacts;
    a.grazing += after.is_grazing ? 1 : 0;
    find_again(p);
    find_again(q);
  }

  /// One sphere and all walls that it touches at the time, or a fixed sphere.
  SCREE_HD void meet_walls(Index p, const Event& event) const {
    Member& m = member[p];
    const double g = norm(stage.gravity);
    const double carried = carried_square(g, part_before(m, event.time), stage.h - event.time);
    go_to(m, event.time);
    NormalCone cone;
    double e = 1;
    const auto touch = [&](const Vec3d& n, Index body) {
      cone.add(n);
      const double own = stage.restitution_of(m.body, body);
      if (own < e) e = own;
    };
    if (event.partner == kWall) {
      stage.walls.touched({m.node.x, m.node.v, stage.gravity}, stage.bodies.radius[m.body], touch);
    } else {
      touch(normalized(stage.between(stage.bodies.position[event.partner], m.node.x)),
            event.partner);
    }
    const Vec3d into = cone.project(m.node.v);
    const double approach = norm(into);
    ++m.impacts, ++m.of_walls;
    if (approach > 0) {
      const Rebound after = rebound(approach, carried);
      const Vec3d out = (-1 / approach) * into;
      m.node.v += (approach + e * after.speed) * out;
      m.normal = out;
      m.grazing += after.is_grazing ? 1 : 0;
      // It would be back within the step, slower each time.
      if (e < 1 && e * after.speed < -0.5 * stage.h * dot(stage.gravity, out)) {
        atomic_min(&faults->resting, id(p));
      }
    } else {
      ++m.grazing;
    }
    find_again(p);
  }

  SCREE_HD Vec3d end_of(const Member& m) const { return m.node.at(stage.h, stage.gravity).x; }
};

/// The program that works through the islands of a stage.
template <class OwnStage>
struct RunOf;
template <bool kSolids>
struct RunOf<Stage<kSolids>> {
  using Type = RunIslands<kSolids>;
};

/// Links islands that may have met: bodies of both left their free ways, and came near enough. All other bodies
/// fly freely as far as an island sees, which it has looked at.
template <class OwnStage, class M>
struct CheckIslands {
  static constexpr const char* name = "check_islands";
  OwnStage stage;
  Span<const M> member;
  Span<const Index> place;
  LinkList links;

  SCREE_HD void operator()(Index p) const {
    const M& m = member[p];
    if (!(m.way >= 0) || m.impacts == 0) return;
    const Vec3d x = stage.bodies.position[m.body];
    for (Offset q = stage.near.begin[m.body]; q < stage.near.begin[m.body + 1]; ++q) {
      const Index k = stage.near.other[q];
      if (k < m.body || !stage.is_free(k) || place[k] < 0) continue;
      const M& other = member[place[k]];
      if (other.island == m.island || other.impacts == 0 || !(other.way >= 0)) continue;
      const double gap =
          norm(stage.between(x, stage.bodies.position[k])) - stage.sum_of_radii(m.body, k);
      if (gap <= m.way + other.way) links.add(m.body, k);
    }
  }
};

struct IslandSums {
  Index half_impacts = 0;  ///< each of two bodies has one, a body at a wall two
  Index grazing = 0;
  double identity_error = 0;  ///< largest [m]
  SCREE_HD void combine(const IslandSums& o) {
    half_impacts += o.half_impacts;
    grazing += o.grazing;
    if (o.identity_error > identity_error) identity_error = o.identity_error;
  }
};

/// Writes where members are after the step. Of a body with one impact it also checks the closest-point identity: with the
/// point of the chord q_c = (1 - alpha) q_before + alpha q_after, the impact is at q_c + alpha (1 - alpha) h (v_before -
/// v_after), and what the velocities differ in beside the pull of gravity is along the normal. So the impact is the point of
/// the wall nearest to the chord point, once the fall is taken out.
template <bool kSolids>
struct FinishIslands {
  static constexpr const char* name = "finish_islands";
  Stage<kSolids> stage;
  Span<const Member> member;
  Span<Vec3d> x, v;  ///< [owned] out

  SCREE_HD IslandSums operator()(Index p) const {
    const Member& m = member[p];
    const Node end = m.node.at(stage.h, stage.gravity);
    x[m.body] = end.x;
    v[m.body] = end.v;
    IslandSums sums;
    sums.half_impacts = m.impacts + m.of_walls;
    sums.grazing = m.grazing;
    if (m.impacts == 1) {
      const double h = stage.h, alpha = m.node.t / h;
      const Vec3d start = stage.bodies.position[m.body];
      const Vec3d chord = (1 - alpha) * start + alpha * end.x;
      const Vec3d d = m.node.x - chord + (0.5 * alpha * (1 - alpha) * h * h) * stage.gravity;
      sums.identity_error = norm(d - dot(d, m.normal) * m.normal);
    }
    return sums;
  }
};

}  // namespace scree
