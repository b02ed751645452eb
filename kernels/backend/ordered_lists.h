#pragma once
// Puts the elements of many short lists, and of a few long ones, in ascending order.
//
// Elements come in any order within their list, by atomics. In a short list each goes where as many
// are lower: one pass, and all it reads is in the caches. That is quadratic in the length, so that
// lists of a body that touches thousands of others are sorted.

#include "kernels/backend/atomic.h"
#include "kernels/backend/backend.h"
#include "kernels/math/pair_key.h"

namespace scree {

/// Elements of a list up to which each is compared with all others.
inline constexpr Index kLongList = 256;

/// First of the ascending elements [from, to) that is not below the value; `to` when all are.
template <class T>
SCREE_HD Index first_not_below(Span<const T> sorted, Index from, Index to, T value) {
  while (from < to) {
    const Index middle = from + (to - from) / 2;
    if (sorted[middle] < value) {
      from = middle + 1;
    } else {
      to = middle;
    }
  }
  return from;
}

/// Lists of different elements that are not in order yet.
/// @tparam ListOf  list_of(k, x): the list of element x at place k
template <class ListOf>
struct UnorderedLists {
  ListOf list_of;
  Span<const Index> element;  ///< [begin[list count]], those of a list beside each other
  Span<const Offset> begin;   ///< [list count + 1]

  SCREE_HD bool is_element(Index k) const { return k < begin[begin.size - 1]; }
};

/// Bytes per element: 8 read, the others of its list from the caches, 4 written.
template <class ListOf>
struct OrderShortLists {
  static constexpr const char* name = "order_short_lists";
  UnorderedLists<ListOf> lists;
  Span<Index> ordered;   ///< out, but for long lists
  Index* long_elements;  ///< in: zero; out: elements of long lists

  SCREE_HD void operator()(Index k) const {
    if (!lists.is_element(k)) return;
    const Index x = lists.element[k], list = lists.list_of(k, x);
    const auto first = static_cast<Index>(lists.begin[list]);
    const auto end = static_cast<Index>(lists.begin[list + 1]);
    if (end - first > kLongList) {
      if (k == first) atomic_add(long_elements, end - first);
      return;
    }
    Index before = 0;
    for (Index q = first; q < end; ++q) before += lists.element[q] < x;
    ordered[first + before] = x;
  }
};

/// Notes the elements of long lists, in any order.
template <class ListOf>
struct NoteLongLists {
  static constexpr const char* name = "note_long_lists";
  UnorderedLists<ListOf> lists;
  Index* noted;              ///< in: zero
  Span<std::uint64_t> keys;  ///< out: keys of list and element

  SCREE_HD void operator()(Index k) const {
    if (!lists.is_element(k)) return;
    const Index x = lists.element[k], list = lists.list_of(k, x);
    if (lists.begin[list + 1] - lists.begin[list] <= kLongList) return;
    keys[atomic_add(noted, 1)] = make_key(list, static_cast<std::uint32_t>(x));
  }
};

/// Puts the elements of long lists in their places.
struct PlaceLongLists {
  static constexpr const char* name = "place_long_lists";
  Span<const std::uint64_t> keys;  ///< ascending
  Span<const Offset> begin;        ///< [list count + 1]
  Span<Index> ordered;             ///< out

  SCREE_HD void operator()(Index e) const {
    const Index list = key_body(keys[e]);
    const Index first = first_not_below(keys, 0, e, make_key(list, 0));
    ordered[begin[list] + e - first] = static_cast<Index>(key_element(keys[e]));
  }
};

/// Puts the elements of each list in ascending order; one host read. The order before does not
/// matter, so the lists are the same on every run.
/// Memory: 24 bytes for each element of a list longer than kLongList while it works.
/// @param count          places to go through, maybe more than there are elements
/// @param long_elements  in backend memory, zero
template <class B, class ListOf>
void order_lists(B& b, Index count, const UnorderedLists<ListOf>& lists, Span<Index> ordered,
                 Index* long_elements) {
  for_each(b, count, OrderShortLists<ListOf>{lists, ordered, long_elements});
  const Index total = fetch(b, static_cast<const Index*>(long_elements));
  if (total == 0) return;
  Buffer<B, std::uint64_t> keys(b, total);
  Buffer<B, Index> noted(b, total);  // counts in its first element; the sort moves it along
  fill(b, noted.view(), Index(0));
  for_each(b, count, NoteLongLists<ListOf>{lists, noted.data(), keys.view()});
  SortSpace<B> space(b);
  const auto list_count = static_cast<std::uint64_t>(lists.begin.size - 1);
  sort_pairs(b, space, keys.view(), noted.view(), 32 + bits_for(list_count));
  for_each(b, total, PlaceLongLists{keys.view(), lists.begin, ordered});
}

}  // namespace scree
