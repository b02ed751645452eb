#pragma once
// Element programs of contact coloring: contacts that share an owned body get different colors.
//
// The coloring is the greedy one in priority order: every contact takes the smallest color that no
// contact of higher priority on its two bodies has. That fixes the result, whatever runs first.
// Each body holds its contacts sorted by priority and a head; a contact is colored when it is the
// head of both its bodies (Jones & Plassmann, SIAM J. Sci. Comput. 14(3), 1993). So a round costs
// O(1) per body however many contacts it has, and reads only the state of the round before.
//
// Colors are handed out in batches of 64, one mask per body. What finds no free color in a batch,
// because a body has used all 64, waits for the next batch; its smallest free color lies there.
//
// Contacts that bring a color along keep it, and the others are colored around them in the same
// way. Contacts of the last color are among the others when they are few: where contacts come and
// go, that keeps the number of colors as low as that of a coloring from scratch.

#include "kernels/backend/backend.h"
#include "kernels/contact/contact_problem.h"

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

/// A color is rare when at most one contact in so many has it.
inline constexpr Index kRareShare = 16;

/// Position of the lowest set bit; mask is not 0.
inline SCREE_HD int lowest_bit(std::uint64_t mask) {
#ifdef __CUDA_ARCH__
  return __ffsll(static_cast<long long>(mask)) - 1;
#else
  return __builtin_ctzll(mask);
#endif
}

/// The last of the colors that contacts bring along, and how many have it.
struct LastColor {
  Index color = -1;
  Index count = 0;
  SCREE_HD void combine(const LastColor& o) {
    if (o.color > color) {
      *this = o;
    } else if (o.color == color) {
      count += o.count;
    }
  }
};

struct FindLastColor {
  static constexpr const char* name = "find_last_color";
  Span<const Index> color;
  SCREE_HD LastColor operator()(Index c) const { return {color[c], 1}; }
};

/// Contacts to be colored.
struct ToColor {
  Index count = 0;
  SCREE_HD void combine(const ToColor& o) { count += o.count; }
};

/// flag[c] = 1 when contact c is to be colored: it has no color yet, or the last one and that is
/// rare. Counts them.
struct FlagToColor {
  static constexpr const char* name = "flag_to_color";
  Span<const Index> color;
  const LastColor* last;
  Span<Index> flag;
  SCREE_HD ToColor operator()(Index c) const {
    const bool is_rare = last->count <= color.size / kRareShare;
    flag[c] = color[c] < 0 || (is_rare && color[c] == last->color) ? 1 : 0;
    return {flag[c]};
  }
};

/// Where a body stands in the coloring of its contacts. Its list holds those that had no color when
/// the batch began.
struct BodyColors {
  std::uint64_t used = 0;  ///< colors of the batch taken by its contacts
  Offset begin = 0;        ///< of its list
  Offset head = 0;         ///< first entry of its list that is undecided in this batch
  Offset end = 0;          ///< of its list
};

/// Work that is left: bodies with undecided contacts, and the longest of their lists.
struct ColoringWork {
  Index bodies = 0;
  Index longest = 0;
  Index exhausting = 0;  ///< bodies with the last color of the batch
  SCREE_HD void combine(const ColoringWork& o) {
    bodies += o.bodies;
    if (o.longest > longest) longest = o.longest;
    exhausting += o.exhausting;
  }
};

/// Entries 2k and 2k + 1 of the list to sort: contact listed[k] (contact k when the list is empty)
/// as seen by its bodies. A stable sort by (body, priority) then lists each body's contacts by
/// (priority, index); fixed bodies go to the end.
struct ColoringEntries {
  static constexpr const char* name = "coloring_entries";
  Span<const Index> body_a;
  Span<const Index> body_b;
  Index owned_count;
  Span<const Index> listed;
  Span<std::uint64_t> key;
  Span<Index> contact;
  Span<Index> color;
  SCREE_HD void operator()(Index k) const {
    const Index c = listed.empty() ? k : listed[k];
    const std::uint32_t priority = contact_priority(c);
    for (int side = 0; side < 2; ++side) {
      const Index i = side == 0 ? body_a[c] : body_b[c];
      const auto body = static_cast<std::uint64_t>(i < owned_count ? i : owned_count);
      const Offset e = 2 * static_cast<Offset>(k) + side;
      key[e] = body << kPriorityBits | priority;
      contact[e] = c;
    }
    color[c] = -1;
  }
};

/// Finds the lists of the bodies in the sorted entries; the states start out empty. Element k reads
/// entries 2k and 2k + 1.
struct ColoringLists {
  static constexpr const char* name = "coloring_lists";
  Span<const std::uint64_t> key;
  Index owned_count;
  Span<BodyColors> state;
  SCREE_HD Index body(Offset e) const { return static_cast<Index>(key[e] >> kPriorityBits); }
  SCREE_HD void operator()(Index k) const {
    const Offset first = 2 * static_cast<Offset>(k);
    for (Offset e = first; e < first + 2; ++e) {
      const Index i = body(e);
      if (i >= owned_count) return;
      if (e == 0 || body(e - 1) != i) state[i].begin = e;
      if (e + 1 == key.size || body(e + 1) != i) state[i].end = e + 1;
    }
  }
};

/// Starts a batch for body active[k] (body k when the list is empty): drops colored contacts from
/// its list and sets its mask to the colors that its contacts have brought along.
struct ColoringBatch {
  static constexpr const char* name = "coloring_batch";
  ContactLists lists[1 + kLaterGroups];  ///< of all contacts
  Span<const Index> active;
  Span<const Index> color;
  Span<Index> incident;  ///< contacts to color of all bodies, by (body, priority, index)
  Span<BodyColors> state;
  Index first_color;  ///< of the batch
  bool is_fresh;      ///< no contact has brought a color along
  SCREE_HD ColoringWork operator()(Index k) const {
    const Index i = active.empty() ? k : active[k];
    BodyColors s = state[i];
    if (first_color > 0) {
      Offset left = s.begin;
      for (Offset e = s.begin; e < s.end; ++e) {
        const Index c = incident[e];
        if (color[c] < 0) incident[left++] = c;
      }
      s.end = left;
    }
    const bool has_work = s.begin < s.end;
    s.used = 0;
    if (has_work && !is_fresh) {
      for (const ContactLists& group : lists)
        if (!group.a_start.empty()) s.used |= bits_of(group, i);
    }
    s.head = s.used == kAllColors ? s.end : s.begin;
    state[i] = s;
    return {has_work ? 1 : 0, static_cast<Index>(s.end - s.begin), 0};
  }

 private:
  SCREE_HD std::uint64_t bits_of(const ContactLists& group, Index i) const {
    std::uint64_t bits = 0;
    for (Index k = group.a_start[i]; k < group.a_start[i + 1]; ++k)
      bits |= bit_of(color[group.first + k]);
    for (Index e = group.b_start[i]; e < group.b_start[i + 1]; ++e)
      bits |= bit_of(color[group.first + group.b_contact[e]]);
    return bits;
  }
  SCREE_HD std::uint64_t bit_of(Index c) const {
    const Index bit = c - first_color;
    return bit >= 0 && bit < kColorsPerBatch ? std::uint64_t{1} << bit : 0;
  }
};

/// One round for body active[k]: its head contact is colored when it is the head of the other body
/// too. Both bodies see the same two old states and come to the same color; body A writes it down, or the
/// only one that is owned.
struct ColoringRound {
  static constexpr const char* name = "coloring_round";
  Span<const Index> body_a;
  Span<const Index> body_b;
  Index owned_count;
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
      const BodyColors o = other < owned_count ? from[other] : BodyColors{};
      const bool is_ready = other >= owned_count || (o.head < o.end && incident[o.head] == c);
      if (o.used == kAllColors) {
        ++s.head;  // the other body gives no more colors in this batch
      } else if (is_ready) {
        ++s.head;
        const std::uint64_t unused = ~(s.used | o.used);
        if (unused != 0) {
          const int bit = lowest_bit(unused);
          s.used |= std::uint64_t{1} << bit;
          if (body_a[c] == i || other >= owned_count) color[c] = first_color + bit;
        }
        if (s.used == kAllColors) s.head = s.end;
      }
    }
    to[i] = s;
  }
};

/// Counts what is left of a batch after some rounds.
struct ColoringLeft {
  static constexpr const char* name = "coloring_left";
  Span<const Index> active;
  Span<const BodyColors> state;
  SCREE_HD ColoringWork operator()(Index k) const {
    const BodyColors s = state[active.empty() ? k : active[k]];
    return {s.head < s.end ? 1 : 0, static_cast<Index>(s.end - s.head),
            static_cast<Index>(s.used >> (kColorsPerBatch - 1))};
  }
};

/// flag[k] = 1 when body active[k] had uncolored contacts at the start of the batch.
struct ColoringActiveFlag {
  static constexpr const char* name = "coloring_active_flag";
  Span<const Index> active;
  Span<const BodyColors> state;
  Span<Index> flag;
  SCREE_HD void operator()(Index k) const {
    const BodyColors& s = state[active.empty() ? k : active[k]];
    flag[k] = s.begin < s.end ? 1 : 0;
  }
};

/// Packs the flagged elements of a list (of 0, 1, ... when it is empty), in order.
struct ColoringPack {
  static constexpr const char* name = "coloring_pack";
  Span<const Index> list;
  Span<const Index> flag;
  Span<const Offset> position;
  Span<Index> packed;
  SCREE_HD void operator()(Index k) const {
    if (flag[k] != 0) packed[position[k]] = list.empty() ? k : list[k];
  }
};

/// Sort keys that put elements in the order of colors; returns the number of colors.
struct ColorKeys {
  static constexpr const char* name = "color_keys";
  Span<const Index> color;
  Span<std::uint64_t> key;
  Span<Index> element;
  SCREE_HD Largest<Index> operator()(Index c) const {
    key[c] = static_cast<std::uint64_t>(color[c]);
    element[c] = c;
    return {color[c] + 1};
  }
};

}  // namespace scree
