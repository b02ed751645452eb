#pragma once
// Element programs of contact coloring: contacts that share a free body get different colors.
//
// The coloring is the greedy one in priority order: every contact takes the smallest color that no
// contact of higher priority on its two bodies has. That fixes the result, whatever runs first.
// Each body holds its contacts sorted by priority and a head; a contact is colored when it is the
// head of both its bodies (Jones & Plassmann, SIAM J. Sci. Comput. 14(3), 1993). So a round costs
// O(1) per body however many contacts it has, and reads only the state of the round before.
//
// Colors are handed out in batches of 64, one mask per body. What finds no free color in a batch,
// because a body has used all 64, waits for the next batch; its smallest free color lies there.

#include "kernels/backend/backend.h"
#include "kernels/contact_problem.h"

namespace scree {

inline constexpr int kColorsPerBatch = 64;
inline constexpr std::uint64_t kAllColors = ~std::uint64_t{0};

/// Bits of a contact's priority. Few bits make the sort short; ties go to the lower index.
inline constexpr int kPriorityBits = 12;

/// The contact that goes first has the lowest value. A hash: neighbors in storage must not form
/// long chains of waiting. Final mix of MurmurHash3.
inline SCREE_HD std::uint32_t contact_priority(Index c) {
  auto h = static_cast<std::uint32_t>(c);
  h = (h ^ (h >> 16)) * 0x85ebca6bU;
  h = (h ^ (h >> 13)) * 0xc2b2ae35U;
  return (h ^ (h >> 16)) >> (32 - kPriorityBits);
}

/// Position of the lowest set bit; mask is not 0.
inline SCREE_HD int lowest_bit(std::uint64_t mask) {
#ifdef __CUDA_ARCH__
  return __ffsll(static_cast<long long>(mask)) - 1;
#else
  return __builtin_ctzll(mask);
#endif
}

/// Where a body stands in the coloring of its contacts.
struct BodyColors {
  std::uint64_t used = 0;  ///< colors of the batch taken by its contacts
  Offset head = 0;         ///< first undecided entry of its list
  Offset end = 0;          ///< of its list
};

/// Work that is left: bodies with undecided contacts, and the longest of their lists.
struct ColoringWork {
  Index bodies = 0;
  Index longest = 0;
  SCREE_HD void combine(const ColoringWork& o) {
    bodies += o.bodies;
    if (o.longest > longest) longest = o.longest;
  }
};

inline SCREE_HD ColoringWork coloring_work(const BodyColors& s) {
  return {s.head < s.end ? 1 : 0, static_cast<Index>(s.end - s.head)};
}

/// Entries 2c and 2c + 1 of the list to sort: contact c as seen by its bodies. A stable sort by
/// (body, priority) then lists each body's contacts by (priority, index); fixed bodies go to the
/// end.
struct ColoringEntries {
  static constexpr const char* name = "coloring_entries";
  Span<const Index> body_a;
  Span<const Index> body_b;
  Index free_count;
  Span<std::uint64_t> key;
  Span<Index> contact;
  Span<Index> color;
  SCREE_HD void operator()(Index c) const {
    const std::uint32_t priority = contact_priority(c);
    for (int side = 0; side < 2; ++side) {
      const Index i = side == 0 ? body_a[c] : body_b[c];
      const auto body = static_cast<std::uint64_t>(i < free_count ? i : free_count);
      const Offset k = 2 * static_cast<Offset>(c) + side;
      key[k] = body << kPriorityBits | priority;
      contact[k] = c;
    }
    color[c] = -1;
  }
};

/// Starts a batch for body active[k] (body k when the list is empty): drops colored contacts from
/// its list and clears its mask.
struct ColoringBatch {
  static constexpr const char* name = "coloring_batch";
  Span<const Index> a_start;
  Span<const Index> b_start;
  Span<const Index> active;
  Span<const Index> color;
  Span<Index> incident;  ///< contacts of all bodies, by (body, priority, index)
  Span<BodyColors> state;
  bool is_first;
  SCREE_HD ColoringWork operator()(Index k) const {
    const Index i = active.empty() ? k : active[k];
    const Offset begin = static_cast<Offset>(a_start[i]) + b_start[i];
    Offset end = is_first ? static_cast<Offset>(a_start[i + 1]) + b_start[i + 1] : state[i].end;
    if (!is_first) {
      Offset kept = begin;
      for (Offset e = begin; e < end; ++e) {
        const Index c = incident[e];
        if (color[c] < 0) incident[kept++] = c;
      }
      end = kept;
    }
    state[i] = {0, begin, end};
    return coloring_work(state[i]);
  }
};

/// One round for body active[k]: its head contact is colored when it is the head of the other body
/// too. Both bodies see the same two old states and come to the same color; body A writes it down.
struct ColoringRound {
  static constexpr const char* name = "coloring_round";
  Span<const Index> body_a;
  Span<const Index> body_b;
  Index free_count;
  Span<const Index> active;
  Span<const Index> incident;
  Span<const BodyColors> from;
  Span<BodyColors> to;
  Span<Index> color;
  Index first_color;  ///< of the batch
  SCREE_HD void operator()(Index k) const {
    const Index i = active.empty() ? k : active[k];
    BodyColors s = from[i];
    if (s.head < s.end) {
      const Index c = incident[s.head];
      const Index other = body_a[c] == i ? body_b[c] : body_a[c];
      const BodyColors o = other < free_count ? from[other] : BodyColors{};
      const bool is_ready = other >= free_count || (o.head < o.end && incident[o.head] == c);
      if (o.used == kAllColors) {
        ++s.head;  // the other body gives no more colors in this batch
      } else if (is_ready) {
        ++s.head;
        const std::uint64_t unused = ~(s.used | o.used);
        if (unused != 0) {
          const int bit = lowest_bit(unused);
          s.used |= std::uint64_t{1} << bit;
          if (body_a[c] == i) color[c] = first_color + bit;
        }
        if (s.used == kAllColors) s.head = s.end;
      }
    }
    to[i] = s;
  }
};

/// Counts what is left after some rounds.
struct ColoringLeft {
  static constexpr const char* name = "coloring_left";
  Span<const Index> active;
  Span<const BodyColors> state;
  SCREE_HD ColoringWork operator()(Index k) const {
    return coloring_work(state[active.empty() ? k : active[k]]);
  }
};

/// flag[k] = 1 when body active[k] still has undecided contacts.
struct ColoringActiveFlag {
  static constexpr const char* name = "coloring_active_flag";
  Span<const Index> active;
  Span<const BodyColors> state;
  Span<Index> flag;
  SCREE_HD void operator()(Index k) const {
    flag[k] = coloring_work(state[active.empty() ? k : active[k]]).bodies;
  }
};

/// Packs the flagged bodies, in order.
struct ColoringActivePack {
  static constexpr const char* name = "coloring_active_pack";
  Span<const Index> active;
  Span<const Index> flag;
  Span<const Offset> position;
  Span<Index> packed;
  SCREE_HD void operator()(Index k) const {
    if (flag[k] != 0) packed[position[k]] = active.empty() ? k : active[k];
  }
};

/// Number of colors: one more than the largest.
struct ColorCount {
  Index count = 0;
  SCREE_HD void combine(const ColorCount& o) {
    if (o.count > count) count = o.count;
  }
};

/// Sort keys of the final order, and the number of colors on the way.
struct ColorKeys {
  static constexpr const char* name = "color_keys";
  Span<const Index> color;
  Span<std::uint64_t> key;
  Span<Index> contact;
  SCREE_HD ColorCount operator()(Index c) const {
    key[c] = static_cast<std::uint64_t>(color[c]);
    contact[c] = c;
    return {color[c] + 1};
  }
};

/// start[color] = first position of the color in the sorted keys; every color has a contact.
struct ColorStarts {
  static constexpr const char* name = "color_starts";
  Span<const std::uint64_t> key;
  Span<Index> start;
  SCREE_HD void operator()(Index k) const {
    if (k == 0 || key[k] != key[k - 1]) start[static_cast<Offset>(key[k])] = k;
  }
};

}  // namespace scree
