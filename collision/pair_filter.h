#pragma once
// Leaves contacts out between bodies that joints hold together.

#include <algorithm>
#include <array>
#include <vector>

#include "kernels/contact/field_buffers.h"
#include "kernels/narrow_phase/ignored_pairs.h"

namespace scree {

template <class B>
class PairFilter {
 public:
  /// @param pairs  of ids, in any order
  PairFilter(B& b, const std::vector<std::array<int, 2>>& pairs) : pair_(b) {
    std::vector<std::uint64_t> sorted;
    for (const std::array<int, 2>& ids : pairs) {
      const auto [low, high] = std::minmax(ids[0], ids[1]);
      sorted.push_back(make_key(low, static_cast<std::uint32_t>(high)));
    }
    std::sort(sorted.begin(), sorted.end());
    sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
    upload(b, sorted, pair_);
  }

  bool is_used() const { return pair_.capacity() > 0; }
  IgnoredPairs pairs() const { return {pair_.view(pair_.capacity())}; }

  /// Takes contacts of the pairs out of a list, whose order stays. One host read.
  /// @param id  of bodies by storage index
  /// @return    number of contacts that are left
  template <class Real>
  Index apply(B& b, Span<const Index> id, Index count, FoundContacts<B, Real>& contacts) const {
    Buffer<B, Index> keep(b, count);
    Buffer<B, Offset> place(b, static_cast<Offset>(count) + 1);
    for_each(b, count,
             MarkKept{contacts.body_a.view(count), contacts.body_b.view(count), id, pairs(),
                      keep.view()});
    exclusive_scan(b, Span<const Index>(keep.view()), place.view());
    const Offset left = fetch(b, place.data() + count);
    if (left == count) return count;
    contacts.visit([&](const ContactField&,
                       auto& array) { close_gaps(b, keep.view(), place.view(), left, array); },
                   contacts);
    return static_cast<Index>(left);
  }

 private:
  template <class T>
  static void close_gaps(B& b, Span<const Index> keep, Span<const Offset> place, Offset left,
                         Buffer<B, T>& array) {
    if (array.capacity() == 0) return;
    Buffer<B, T> kept(b, left);
    for_each(b, static_cast<Index>(keep.size),
             CloseGaps<T>{keep, place, array.view(keep.size), kept.view()});
    swap(array, kept);
  }

  Buffer<B, std::uint64_t> pair_;
};

}  // namespace scree
