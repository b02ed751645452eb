#include "dynamics/rigid/contact_names.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "dynamics/model_errors.h"

namespace scree {

PlacedContacts keys_of(const NamedContacts& names, const ContactKeys& rule,
                       const std::vector<Index>& id, Index owned_count) {
  const Index id_end = id.empty() ? 0 : *std::max_element(id.begin(), id.end()) + 1;
  std::vector<Index> place(static_cast<std::size_t>(id_end), -1);
  for (std::size_t i = 0; i < id.size(); ++i)
    if (id[i] >= 0) place[static_cast<std::size_t>(id[i])] = static_cast<Index>(i);
  const auto place_of = [&](std::int32_t body) {
    return body >= 0 && body < id_end ? place[static_cast<std::size_t>(body)] : -1;
  };
  const std::uint64_t feature_end = std::uint64_t{1} << rule.feature_bits;
  const std::uint64_t part_end = std::numeric_limits<std::uint32_t>::max() - rule.wall_begin;
  PlacedContacts placed;
  placed.key.reserve(names.body_a.size());
  placed.is_flipped.reserve(names.body_a.size());
  for (std::size_t c = 0; c < names.body_a.size(); ++c) {
    const bool at_wall = names.body_b[c] < 0;
    Index a = place_of(names.body_a[c]), b = place_of(names.body_b[c]);
    const std::uint64_t group = rule.has_groups ? names.feature[c] & kGeneralGroup : 0;
    const std::uint64_t number = names.feature[c] & ~kGeneralGroup;
    const bool known = a >= 0 && a < owned_count && (at_wall || (b >= 0 && b != a)) &&
                       number < (at_wall ? part_end : feature_end);
    if (!known) throw_unknown_contact(c, names.body_a[c], names.body_b[c], number);
    const auto feature = static_cast<std::uint32_t>(number);
    const bool is_flipped = !at_wall && b < a;
    if (is_flipped) std::swap(a, b);
    placed.key.push_back(
        group | make_key(a, at_wall ? rule.wall_begin + feature : rule.body_element(b, feature)));
    placed.is_flipped.push_back(is_flipped ? 1 : 0);
  }
  return placed;
}

std::vector<std::size_t> ascending_order(const std::vector<std::uint64_t>& key) {
  if (std::is_sorted(key.begin(), key.end())) return {};
  std::vector<std::size_t> order(key.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key[a] < key[b]; });
  return order;
}

}  // namespace scree
