#pragma once
// Element programs that find the bodies which other ranks have to know: those whose balls reach the extent of the balls
// of another rank's bodies. See BodyBalls: no other body can have a contact with one of theirs in the step.

#include "kernels/backend/backend.h"
#include "kernels/bodies/parts.h"
#include "kernels/broad_phase/binning.h"

namespace scree {

/// The smallest box that holds balls; empty: there are none.
struct BallExtent {
  double lower[3] = {1e300, 1e300, 1e300};
  double upper[3] = {-1e300, -1e300, -1e300};

  SCREE_HD bool empty() const { return lower[0] > upper[0]; }
  /// An empty one is everywhere.
  SCREE_HD bool is_inside(const BallExtent& o) const {
    bool is = true;
    for (int k = 0; k < 3; ++k) is = is && lower[k] >= o.lower[k] && upper[k] <= o.upper[k];
    return is;
  }
  SCREE_HD void combine(const BallExtent& o) {
    for (int k = 0; k < 3; ++k) {
      if (o.lower[k] < lower[k]) lower[k] = o.lower[k];
      if (o.upper[k] > upper[k]) upper[k] = o.upper[k];
    }
  }
};

/// How far apart the intervals [a, b] and [c, d] are along an axis; images of a periodic one count, with this period [m].
SCREE_HD inline double interval_distance(double a, double b, double c, double d, double period) {
  const auto apart = [&](double shift) {
    const double before = c - (b + shift), behind = (a + shift) - d;
    const double way = before > behind ? before : behind;
    return way > 0 ? way : 0.0;
  };
  double way = apart(0);
  if (period > 0) {
    const double up = apart(period), down = apart(-period);
    if (up < way) way = up;
    if (down < way) way = down;
  }
  return way;
}

/// Square of the distance of a box from another [m^2].
SCREE_HD inline double squared_distance(const BallExtent& a, const BallExtent& b,
                                        const Vec3<double>& period) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    const double d = interval_distance(a.lower[k], a.upper[k], b.lower[k], b.upper[k], period[k]);
    sum += d * d;
  }
  return sum;
}

/// The ball of an owned body with the largest margin that it may get around impacts; empty where its state is out of range.
///
/// That of a compound holds those of its parts. A part at arm a with radius r moves with the velocity of the body and w x a,
/// less what locks take away, so its ball is about a place that is at most |a| + h |w| |a| / 2 from the center of that of the
/// body. With half of its way, h (|v| + |w| |a|) / 2, and h |w| r for turning, all of it is within
/// (|a| + r) (1 + h |w|) + h |v| / 2, which is what a body of radius |a| + r gets.
template <class Real>
struct ReachOfBody {
  BodyBalls<Real> balls;
  PartReach<Real> parts;

  SCREE_HD double radius(Index i) const {
    const double r = balls.radius(i, parts(balls.bodies, i));
    return r > 0 ? r + 2 * balls.range.margin_limit * static_cast<double>(balls.bodies.radius[i])
                 : 0.0;
  }
};

/// Extent of the balls of owned bodies. Bytes a body: 44.
template <class Real>
struct MeasureReach {
  static constexpr const char* name = "measure_reach";
  ReachOfBody<Real> reach;

  SCREE_HD BallExtent operator()(Index i) const {
    BallExtent e;
    const double r = reach.radius(i);
    if (!(r > 0)) return e;
    const Vec3<double> x = reach.balls.center(i);
    for (int k = 0; k < 3; ++k) {
      e.lower[k] = x[k] - r;
      e.upper[k] = x[k] + r;
    }
    return e;
  }
};

/// Which peers, of at most 64, a body is near: a bit for each.
template <class Real>
struct NearPeers {
  ReachOfBody<Real> reach;
  Span<const BallExtent> extent;  ///< promised, of all ranks
  Span<const Index> peer;         ///< their ranks, rising
  double slack = 0;               ///< [m]

  SCREE_HD std::uint64_t operator()(Index i) const {
    const double r = reach.radius(i);
    if (!(r > 0)) return 0;
    const Vec3<double> x = reach.balls.center(i);
    BallExtent at;
    for (int k = 0; k < 3; ++k) at.lower[k] = at.upper[k] = x[k];
    const double limit = (r + slack) * (r + slack);
    std::uint64_t near = 0;
    for (Index q = 0; q < peer.size; ++q)
      if (squared_distance(at, extent[peer[q]], reach.balls.range.period) <= limit)
        near |= std::uint64_t{1} << q;
    return near;
  }
};

/// Notes which peers a body is shown to. Bytes a body: 44 read, 8 written.
template <class Real>
struct ChooseShown {
  static constexpr const char* name = "choose_shown";
  NearPeers<Real> near;
  Span<std::uint64_t> shown;  ///< [owned_count] out
  SCREE_HD void operator()(Index i) const { shown[i] = near(i); }
};

/// Shows some bodies to further peers.
struct ShowToo {
  static constexpr const char* name = "show_too";
  Span<const Index> body;  ///< each once
  Span<const std::uint64_t> peers;
  Span<std::uint64_t> shown;  ///< in and out
  SCREE_HD void operator()(Index k) const { shown[body[k]] |= peers[k]; }
};

/// Stores the extent that the bodies of a rank are promised to stay inside for some steps.
struct StorePromise {
  double slack;  ///< [m] how far they may go
  BallExtent* to;
  SCREE_HD void operator()(BallExtent e) const {
    if (!e.empty()) {
      for (int k = 0; k < 3; ++k) {
        e.lower[k] -= slack;
        e.upper[k] += slack;
      }
    }
    *to = e;
  }
};

/// Bodies that left the promised extent of their rank, or that a peer would have to know but does not. Bytes a body: 52.
template <class Real>
struct CountUnseen {
  static constexpr const char* name = "count_unseen";
  NearPeers<Real> near;
  Span<const std::uint64_t> shown;
  Index rank;  ///< this one
  SCREE_HD Sums<1> operator()(Index i) const {
    const bool has_left = !MeasureReach<Real>{near.reach}(i).is_inside(near.extent[rank]);
    return {{has_left || (near(i) & ~shown[i]) != 0 ? 1.0 : 0.0}};
  }
};

/// Stores what was counted, with what else ranks have to agree on.
struct StoreUnseen {
  Span<const BallExtent> extent;  ///< promised, of all ranks
  Span<const Index> peer;         ///< ranks that bodies were searched for, rising
  Vec3<double> period;
  Index rank;      ///< this one
  double further;  ///< a number to be added up
  Sums<2>* to;

  /// Ranks that came near and are no peers count as a body each.
  SCREE_HD void operator()(const Sums<1>& unseen) const {
    double sum = unseen.value[0];
    const BallExtent& own = extent[rank];
    Index q = 0;
    for (Index r = 0; r < extent.size; ++r) {
      while (q < peer.size && peer[q] < r) ++q;
      const bool is_peer = q < peer.size && peer[q] == r;
      if (r == rank || is_peer || own.empty() || extent[r].empty()) continue;
      if (!(squared_distance(own, extent[r], period) > 0)) sum += 1;
    }
    *to = {{sum, further}};
  }
};

struct FlagShown {
  static constexpr const char* name = "flag_shown";
  Span<const std::uint64_t> shown;
  int peer;
  Span<Index> flag;  ///< out: 0 or 1
  SCREE_HD void operator()(Index i) const { flag[i] = static_cast<Index>(shown[i] >> peer & 1); }
};

struct ListShown {
  static constexpr const char* name = "list_shown";
  Span<const Index> flag;
  Span<const Offset> before;
  Span<Index> list;  ///< out
  SCREE_HD void operator()(Index i) const {
    if (flag[i] != 0) list[before[i]] = i;
  }
};

}  // namespace scree
