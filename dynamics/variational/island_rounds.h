#pragma once
// The impacts of a step: islands are made of bodies that meet, run, and joined where one needs a body of another, until
// none does.

#include <algorithm>

#include "kernels/variational/islands.h"

namespace scree {

/// What a step did beside free flight.
struct ImpactReport {
  std::int64_t impacts = 0;
  std::int64_t grazing = 0;
  int rounds = 0;
  int active = 0;  ///< bodies in islands
  double identity_error = 0;
  IslandFaults faults;
  bool is_done = true;  ///< else the step must begin again
};

/// Memory: 16 bytes a body, and for each that may be in an island 24 and a member: 152 of a sphere.
/// @tparam M  what a member of an island is
template <class B, class M>
class IslandRounds {
 public:
  IslandRounds(B& b, Index bodies)
      : slot_(b, static_cast<Offset>(bodies) + 1),
        is_active_(b, bodies),
        partner_(b, bodies),
        place_(b, bodies),
        body_(b),
        parent_(b),
        order_(b),
        key_(b),
        member_(b),
        link_(b, std::max<Offset>(1024, bodies / 8)),
        link_count_(b, 1),
        changed_(b, 1),
        faults_(b, 1),
        sums_(b, 1),
        sort_(b) {}

  /// What the pass of free flight writes.
  Span<Index> partner() { return partner_.view(); }
  Span<Index> is_active() { return is_active_.view(); }
  Span<Index> place() { return place_.view(); }

  /// @param stage   what its programs read; RunOf names that which works through islands
  /// @param active  bodies that meet something
  /// @param finish  finish(members): the program that writes where bodies in islands are after the step
  template <class OwnStage, class Finish>
  ImpactReport run(B& b, const OwnStage& stage, Index active, Finish&& finish) {
    ImpactReport report;
    const Index n = stage.bodies.owned_count;
    Index linked = 0;
    fill(b, link_count_.view(), Index(0));
    for (;;) {
      ++report.rounds;
      exclusive_scan(b, Span<const Index>(is_active_.view(n)),
                     slot_.view(static_cast<Offset>(n) + 1));
      if (report.rounds > 1) active = fetch(b, slot_.data() + n);
      make_islands(b, n, active, linked);
      const Span<M> member = member_.view(active);
      fill(b, faults_.view(), IslandFaults{});
      for_each(
          b, active,
          typename RunOf<OwnStage>::Type{stage, member, place_.view(n), links(), faults_.data()});
      for_each(b, active, CheckIslands<OwnStage, M>{stage, member, place_.view(n), links()});
      report.faults = fetch(b, faults_.data());
      const Index wanted = fetch(b, link_count_.data());
      if (report.faults.left != IslandFaults::kNone) return not_done(report);
      if (wanted > link_.capacity()) {
        link_.reserve_discard(2 * static_cast<Offset>(wanted));
        return not_done(report);
      }
      if (wanted == linked) break;
      linked = wanted;
      for_each(b, linked, DrawIn{links(), partner_.view(n), is_active_.view(n)});
    }
    report.active = active;
    reduce<IslandSums>(b, active, finish(Span<const M>(member_.view(active))),
                       StoreResult<IslandSums>{sums_.data()});
    const IslandSums sums = fetch(b, sums_.data());
    report.impacts = sums.half_impacts / 2;
    report.grazing = sums.grazing;
    report.identity_error = sums.identity_error;
    return report;
  }

 private:
  static ImpactReport not_done(ImpactReport report) {
    report.is_done = false;
    return report;
  }
  LinkList links() { return {link_.view(), link_count_.data()}; }

  /// Room for so many members, and some more, so that it seldom grows.
  void reserve(Index active) {
    if (active <= member_.capacity()) return;
    const Offset room = active + active / 2 + 64;
    body_.reserve_discard(room), parent_.reserve_discard(room), order_.reserve_discard(room);
    key_.reserve_discard(room), member_.reserve_discard(room);
  }

  void make_islands(B& b, Index n, Index active, Index linked) {
    reserve(active);
    const Span<std::uint32_t> parent = parent_.view(active);
    for_each(b, n, ListActive{is_active_.view(n), slot_.view(n), body_.view(active), parent});
    const ConnectIslands connect{
        body_.view(active), slot_.view(n),  partner_.view(n), active, n, links(),
        parent.data,        changed_.data()};
    do {
      constexpr int kPasses = 4;  // between host reads
      for (int k = 0; k < kPasses; ++k) {
        if (k + 1 == kPasses) fill(b, changed_.view(), std::uint8_t(0));
        for_each(b, active + linked, connect);
      }
    } while (fetch(b, changed_.data()) != 0);
    const Span<std::uint64_t> key = key_.view(active);
    const Span<Index> order = order_.view(active);
    for_each(b, active, KeyMembers{parent, key, order});
    sort_pairs(b, sort_, key, order, 32 + bits_for(static_cast<std::uint64_t>(active)));
    for_each(
        b, active,
        PlaceMembers<M>{order, body_.view(active), parent, member_.view(active), place_.view(n)});
  }

  Buffer<B, Index> slot_, is_active_, partner_, place_;
  Buffer<B, Index> body_;
  Buffer<B, std::uint32_t> parent_;
  Buffer<B, Index> order_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, M> member_;
  Buffer<B, Link> link_;
  Buffer<B, Index> link_count_;
  Buffer<B, std::uint8_t> changed_;
  Buffer<B, IslandFaults> faults_;
  Buffer<B, IslandSums> sums_;
  SortSpace<B> sort_;
};

}  // namespace scree
