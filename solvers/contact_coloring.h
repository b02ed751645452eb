#pragma once
// Colors the contacts of a problem, so that contacts of one color share no free body.

#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/contact/body_contacts.h"
#include "kernels/solve/coloring.h"

namespace scree {

/// The same contacts give the same colors on every backend and for every number of threads.
///
/// A contact's mark (ContactProblem::mark) is its color. Contacts keep the colors of the step
/// before, which no two of them on a body share, but for those of a rare last color. The others are
/// colored around them, or all from scratch when most are new. Nothing else is remembered, so the
/// marks of a checkpoint give the same colors again.
///
/// Cost from scratch: one radix sort of 2 * contact_count pairs, about 20 rounds over the bodies
/// (one more per contact of the most loaded body, then over the few bodies still active), one sort
/// of contact_count pairs; two host reads per 64 colors and three more. When m contacts are
/// to be colored: two passes over contacts and a scan, the first sort is of 2 m pairs, and the
/// rounds are over their bodies.
template <class B>
class ContactColoring {
 public:
  explicit ContactColoring(B& b)
      : keys_(b),
        incident_(b),
        own_color_(b),
        order_(b),
        start_(b),
        listed_(b),
        state_{Buffer<B, BodyColors>(b), Buffer<B, BodyColors>(b)},
        active_{Buffer<B, Index>(b), Buffer<B, Index>(b)},
        flag_(b),
        position_(b),
        sort_(b),
        last_(b, 1),
        to_color_(b, 1),
        work_(b, 1),
        count_(b, 1) {}

  template <class Real>
  void compute(B& b, const ContactProblem<Real>& p) {
    contact_count_ = p.contact_count;
    starts_.assign(1, 0);
    colored_count_ = 0;
    if (p.contact_count == 0) return;
    if (p.mark.empty()) own_color_.reserve_discard(p.contact_count);
    color_ = (p.mark.empty() ? own_color_.view() : p.mark).first(p.contact_count);
    if (p.mark.empty() || !color_around_kept(b, p)) color_listed(b, p, {}, p.contact_count);
    sort_by_color(b);
  }

  Index color_count() const { return static_cast<Index>(starts_.size()) - 1; }
  /// Contacts that did not keep a color, all when colored from scratch.
  Index colored_count() const { return colored_count_; }
  /// Color of each contact [contact_count].
  Span<const Index> color() const { return color_.first(contact_count_); }
  /// Contacts sorted by (color, contact) [contact_count].
  Span<const Index> order() const { return order_.view(contact_count_); }
  /// Positions in `order` where colors start, on the host [color_count + 1].
  const std::vector<Index>& starts() const { return starts_; }

 private:
  static constexpr Index kLeastRounds = 8;  ///< rounds between host reads, at least

  /// @return whether that was worth it; else nothing is done
  template <class Real>
  bool color_around_kept(B& b, const ContactProblem<Real>& p) {
    const Index n = p.contact_count;
    reduce<LastColor>(b, n, FindLastColor{color_}, StoreResult<LastColor>{last_.data()});
    reduce<ToColor>(b, n, FlagToColor{color_, last_.data(), flags(n)},
                    StoreResult<ToColor>{to_color_.data()});
    const Index count = fetch(b, to_color_.data()).count;
    if (count > n / 2) return false;
    if (count > 0) color_listed(b, p, pack(b, {}, n, listed_, count), count);
    return true;
  }

  /// Colors the listed contacts, all when the list is empty.
  template <class Real>
  void color_listed(B& b, const ContactProblem<Real>& p, Span<const Index> listed, Index count) {
    colored_count_ = count;
    const Offset n = 2 * static_cast<Offset>(count);
    keys_.reserve_discard(n);
    incident_.reserve_discard(n);
    for (auto& s : state_) s.reserve_discard(p.bodies.owned_count);
    Span<BodyColors> now = state_[0].view(p.bodies.owned_count),
                     next = state_[1].view(p.bodies.owned_count);
    const Span<Index> incident = incident_.view(n);
    for_each(b, count,
             ColoringEntries{p.body_a, p.body_b, p.bodies.owned_count, listed, keys_.view(n),
                             incident, color_});
    const auto bodies = static_cast<std::uint64_t>(p.bodies.owned_count) + 1;
    sort_pairs(b, sort_, keys_.view(n), incident, bits_for(bodies) + kPriorityBits);
    fill(b, now, BodyColors{});
    for_each(b, count, ColoringLists{keys_.view(n), p.bodies.owned_count, now});

    Span<const Index> active;  // empty: all free bodies
    Index body_count = p.bodies.owned_count;
    for (Index first_color = 0;; first_color += kColorsPerBatch) {
      ColoringBatch batch{{}, active, color_, incident, now, first_color, listed.empty()};
      for (int g = 0; g <= kLaterGroups; ++g) batch.lists[g] = p.lists(g);
      ColoringWork left = reduce_work(b, body_count, batch);
      if (left.bodies == 0) return;
      // The list of bodies at work is worth a pass when it gets much shorter.
      if (left.bodies < body_count - body_count / 4) {
        for_each(b, body_count, ColoringActiveFlag{active, now, flags(body_count)});
        Buffer<B, Index>& target = active_[active.data == active_[0].data() ? 1 : 0];
        active = pack(b, active, body_count, target, left.bodies);
        body_count = left.bodies;
      }
      while (left.bodies > 0) {
        const Index rounds = std::clamp(left.longest, kLeastRounds, Index{kColorsPerBatch});
        for (Index r = 0; r < rounds; ++r) {
          for_each(b, body_count,
                   ColoringRound{p.body_a, p.body_b, p.bodies.owned_count, active, incident, now,
                                 next, color_, first_color});
          std::swap(now, next);
        }
        left = reduce_work(b, body_count, ColoringLeft{active, now});
      }
      // A contact is left to the next batch when its bodies together have all colors of this one.
      if (left.exhausting == 0) return;
    }
  }

  template <class F>
  ColoringWork reduce_work(B& b, Index body_count, F f) {
    reduce<ColoringWork>(b, body_count, f, StoreResult<ColoringWork>{work_.data()});
    return fetch(b, work_.data());
  }

  Span<Index> flags(Index count) {
    flag_.reserve_discard(count);
    return flag_.view(count);
  }

  /// The flagged elements of a list (of 0, 1, ... when it is empty), as a new list.
  Span<const Index> pack(B& b, Span<const Index> list, Index from_count, Buffer<B, Index>& target,
                         Index to_count) {
    const Span<const Index> flag = std::as_const(flag_).view(from_count);
    position_.reserve_discard(static_cast<Offset>(from_count) + 1);
    const Span<Offset> position = position_.view(static_cast<Offset>(from_count) + 1);
    target.reserve_discard(to_count);
    exclusive_scan(b, flag, position);
    for_each(b, from_count, ColoringPack{list, flag, position, target.view(to_count)});
    return std::as_const(target).view(to_count);
  }

  void sort_by_color(B& b) {
    const Index n = contact_count_;
    keys_.reserve_discard(n);
    order_.reserve_discard(n);
    const Span<std::uint64_t> keys = keys_.view(n);
    reduce<Largest<Index>>(b, n, ColorKeys{color_, keys, order_.view(n)},
                           StoreResult<Largest<Index>>{count_.data()});
    const Index colors = fetch(b, count_.data()).value;
    sort_pairs(b, sort_, keys, order_.view(n), bits_for(static_cast<std::uint64_t>(colors)));
    start_.reserve_discard(colors + 1);
    for_each(b, n + 1, RunStarts<std::uint64_t>{keys, n, colors, start_.view(colors + 1)});
    starts_ = download(b, start_.view(colors + 1));
  }

  Index contact_count_ = 0;
  Index colored_count_ = 0;
  std::vector<Index> starts_{0};
  Span<Index> color_;
  Buffer<B, std::uint64_t> keys_;
  Buffer<B, Index> incident_;
  Buffer<B, Index> own_color_;  ///< for a problem without marks
  Buffer<B, Index> order_;
  Buffer<B, Index> start_;
  Buffer<B, Index> listed_;
  Buffer<B, BodyColors> state_[2];
  Buffer<B, Index> active_[2];
  Buffer<B, Index> flag_;
  Buffer<B, Offset> position_;
  SortSpace<B> sort_;
  Buffer<B, LastColor> last_;
  Buffer<B, ToColor> to_color_;
  Buffer<B, ColoringWork> work_;
  Buffer<B, Largest<Index>> count_;
};

}  // namespace scree
