#pragma once
// Colors the contacts of a problem, so that contacts of one color share no free body.

#include <algorithm>
#include <utility>
#include <vector>

#include "kernels/coloring.h"

namespace scree {

/// The same contacts give the same colors on every backend and for every number of threads.
/// Cost: one radix sort of 2 * contact_count pairs, about 20 rounds over the bodies (one more per
/// contact of the most loaded body, then over the few bodies still active), one sort of
/// contact_count pairs; two host reads per 64 colors and three more.
template <class B>
class ContactColoring {
 public:
  explicit ContactColoring(B& b)
      : keys_(b),
        incident_(b),
        color_(b),
        order_(b),
        start_(b),
        state_{Buffer<B, BodyColors>(b), Buffer<B, BodyColors>(b)},
        active_{Buffer<B, Index>(b), Buffer<B, Index>(b)},
        flag_(b),
        position_(b),
        sort_(b),
        work_(b, 1),
        count_(b, 1) {}

  template <class Real>
  void compute(B& b, const ContactProblem<Real>& p) {
    contact_count_ = p.contact_count;
    starts_.assign(1, 0);
    if (p.contact_count == 0) return;
    sort_incident(b, p);
    color_contacts(b, p);
    sort_by_color(b);
  }

  Index color_count() const { return static_cast<Index>(starts_.size()) - 1; }
  /// Color of each contact [contact_count].
  Span<const Index> color() const { return color_.view(contact_count_); }
  /// Contacts sorted by (color, contact) [contact_count].
  Span<const Index> order() const { return order_.view(contact_count_); }
  /// Positions in `order` where colors start, on the host [color_count + 1].
  const std::vector<Index>& starts() const { return starts_; }

 private:
  static constexpr Index kLeastRounds = 8;  ///< rounds between host reads, at least

  template <class Real>
  void sort_incident(B& b, const ContactProblem<Real>& p) {
    const Offset n = 2 * static_cast<Offset>(p.contact_count);
    keys_.reserve_discard(n);
    incident_.reserve_discard(n);
    color_.reserve_discard(p.contact_count);
    for_each(b, p.contact_count,
             ColoringEntries{p.body_a, p.body_b, p.free_count, keys_.view(n), incident_.view(n),
                             color_.view(p.contact_count)});
    const auto bodies = static_cast<std::uint64_t>(p.free_count) + 1;
    sort_pairs(b, sort_, keys_.view(n), incident_.view(n), bits_for(bodies) + kPriorityBits);
  }

  template <class Real>
  void color_contacts(B& b, const ContactProblem<Real>& p) {
    const Span<Index> incident = incident_.view(2 * static_cast<Offset>(p.contact_count));
    const Span<Index> color = color_.view(p.contact_count);
    for (auto& s : state_) s.reserve_discard(p.free_count);
    Span<BodyColors> now = state_[0].view(p.free_count), next = state_[1].view(p.free_count);
    Span<const Index> active;  // empty: all free bodies
    Index body_count = p.free_count;
    for (Index first_color = 0;; first_color += kColorsPerBatch) {
      ColoringWork left = reduce_work(
          b, body_count,
          ColoringBatch{p.a_start, p.b_start, active, color, incident, now, first_color == 0});
      if (left.bodies == 0) break;
      // Later batches concern few bodies; the list is worth a pass when it gets much shorter.
      if (left.bodies < body_count - body_count / 4) {
        active = pack_active(b, active, now, body_count, left.bodies);
        body_count = left.bodies;
      }
      while (left.bodies > 0) {
        const Index rounds = std::clamp(left.longest, kLeastRounds, Index{kColorsPerBatch});
        for (Index r = 0; r < rounds; ++r) {
          for_each(b, body_count,
                   ColoringRound{p.body_a, p.body_b, p.free_count, active, incident, now, next,
                                 color, first_color});
          std::swap(now, next);
        }
        left = reduce_work(b, body_count, ColoringLeft{active, now});
      }
    }
  }

  template <class F>
  ColoringWork reduce_work(B& b, Index body_count, F f) {
    reduce<ColoringWork>(b, body_count, f, StoreResult<ColoringWork>{work_.data()});
    return fetch(b, work_.data());
  }

  /// The bodies of the list that have undecided contacts, as a new list.
  Span<const Index> pack_active(B& b, Span<const Index> active, Span<const BodyColors> state,
                                Index from_count, Index to_count) {
    flag_.reserve_discard(from_count);
    position_.reserve_discard(static_cast<Offset>(from_count) + 1);
    const Span<Index> flag = flag_.view(from_count);
    const Span<Offset> position = position_.view(static_cast<Offset>(from_count) + 1);
    Buffer<B, Index>& target = active_[active.data == active_[0].data() ? 1 : 0];
    target.reserve_discard(to_count);
    for_each(b, from_count, ColoringActiveFlag{active, state, flag});
    exclusive_scan(b, Span<const Index>(flag), position);
    for_each(b, from_count, ColoringActivePack{active, flag, position, target.view(to_count)});
    return std::as_const(target).view(to_count);
  }

  void sort_by_color(B& b) {
    const Index n = contact_count_;
    order_.reserve_discard(n);
    const Span<std::uint64_t> keys = keys_.view(n);
    reduce<ColorCount>(b, n, ColorKeys{color_.view(n), keys, order_.view(n)},
                       StoreResult<ColorCount>{count_.data()});
    const Index colors = fetch(b, count_.data()).count;
    sort_pairs(b, sort_, keys, order_.view(n), bits_for(static_cast<std::uint64_t>(colors)));
    start_.reserve_discard(colors);
    for_each(b, n, ColorStarts{keys, start_.view(colors)});
    starts_ = download(b, start_.view(colors));
    starts_.push_back(n);
  }

  Index contact_count_ = 0;
  std::vector<Index> starts_{0};
  Buffer<B, std::uint64_t> keys_;
  Buffer<B, Index> incident_;
  Buffer<B, Index> color_;
  Buffer<B, Index> order_;
  Buffer<B, Index> start_;
  Buffer<B, BodyColors> state_[2];
  Buffer<B, Index> active_[2];
  Buffer<B, Index> flag_;
  Buffer<B, Offset> position_;
  SortSpace<B> sort_;
  Buffer<B, ColoringWork> work_;
  Buffer<B, ColorCount> count_;
};

}  // namespace scree
