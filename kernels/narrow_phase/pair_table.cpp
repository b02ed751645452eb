#include "kernels/narrow_phase/pair_table.h"

#include "kernels/narrow_phase/pairs/pair_list.h"

namespace scree {

const std::vector<PairEntry>& pair_table() {
  static const std::vector<PairEntry> table = [] {
    std::vector<PairEntry> entries;
    PairList::for_each([&](auto pair) {
      using P = decltype(pair);
      entries.push_back({P::A::kind, P::B::kind, feature_bits_of<P>()});
    });
    return entries;
  }();
  return table;
}

const PairEntry* find_pair(ShapeKind a, ShapeKind b) {
  for (const PairEntry& pair : pair_table())
    if ((pair.a == a && pair.b == b) || (pair.a == b && pair.b == a)) return &pair;
  return nullptr;
}

}  // namespace scree
