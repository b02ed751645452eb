#include "dynamics/ranks/partners.h"

#include <algorithm>
#include <tuple>

namespace scree {
namespace {

/// Where a body is.
struct Owner {
  Index id = -1;
  Index place = 0;
  int rank = -1;
  bool operator<(const Owner& o) const { return id < o.id; }
};

}  // namespace

std::vector<Partner> partners_elsewhere(Ranks& ranks,
                                        const std::vector<std::array<Index, 2>>& joined,
                                        const std::vector<Index>& owned) {
  std::vector<Index> named;  // ids, rising
  for (const auto& [first, second] : joined) named.insert(named.end(), {first, second});
  std::sort(named.begin(), named.end());
  std::vector<Owner> own;
  for (std::size_t i = 0; i < owned.size(); ++i)
    if (std::binary_search(named.begin(), named.end(), owned[i]))
      own.push_back({owned[i], static_cast<Index>(i), ranks.rank()});
  std::vector<Owner> all = gather_values(ranks, own);
  std::sort(all.begin(), all.end());
  const auto owner_of = [&](Index id) {
    const auto found = std::lower_bound(all.begin(), all.end(), Owner{id});
    return found != all.end() && found->id == id ? *found : Owner{};
  };
  std::vector<Partner> out;
  for (const auto& [first, second] : joined) {
    const Owner a = owner_of(first), b = owner_of(second);
    if (a.rank == b.rank || a.rank < 0 || b.rank < 0) continue;
    if (a.rank == ranks.rank()) out.push_back({a.place, b.rank});
    if (b.rank == ranks.rank()) out.push_back({b.place, a.rank});
  }
  std::sort(out.begin(), out.end(), [](const Partner& a, const Partner& b) {
    return std::tie(a.place, a.rank) < std::tie(b.place, b.rank);
  });
  return out;
}

}  // namespace scree
