#include "dynamics/ranks/state_parts.h"

#include <algorithm>
#include <tuple>
#include <type_traits>
#include <variant>

#include "dynamics/ranks/state_bytes.h"
#include "host/error.h"

namespace scree {
namespace {

bool is_of(const StateArray& array, const char* prefix) { return array.name.starts_with(prefix); }

/// These rows of the arrays whose names begin so. @param count  rows that there are
WorldState rows_of(const WorldState& state, const char* prefix, std::size_t count,
                   const std::vector<std::size_t>& rows) {
  WorldState part;
  for (const StateArray& array : state.arrays) {
    if (!is_of(array, prefix)) continue;
    std::visit(
        [&](const auto& values) {
          // A row may be several values; arrays without values have none of any row.
          const std::size_t of_row = count > 0 ? values.size() / count : 0;
          std::decay_t<decltype(values)> some;
          some.reserve(rows.size() * of_row);
          for (const std::size_t row : rows)
            for (std::size_t v = 0; v < of_row; ++v) some.push_back(values[row * of_row + v]);
          part.add(array.name, std::move(some));
        },
        array.values);
  }
  return part;
}

}  // namespace

WorldState shared_part(const WorldState& state, const std::function<bool(const Vec3d&)>& owns,
                       const PartNames& names) {
  const auto& id = state.at<std::int32_t>("body/id");
  const auto& x = state.at<Vec3d>("body/position");
  const std::int32_t id_end = id.empty() ? 0 : *std::max_element(id.begin(), id.end()) + 1;
  std::vector<std::uint8_t> is_own(static_cast<std::size_t>(id_end), 0);
  std::vector<std::size_t> bodies;
  for (std::size_t i = 0; i < id.size(); ++i) {
    if (!owns(x[i])) continue;
    bodies.push_back(i);
    is_own[static_cast<std::size_t>(id[i])] = 1;
  }
  const auto is_own_part = [&](std::int32_t name) {
    const Index body = names.body(name);
    return body >= 0 && body < id_end && is_own[static_cast<std::size_t>(body)] != 0;
  };
  const auto& a = state.at<std::int32_t>("contact/body_a");
  const auto& b = state.at<std::int32_t>("contact/body_b");
  std::vector<std::size_t> contacts;
  for (std::size_t c = 0; c < std::min(a.size(), b.size()); ++c)
    if (is_own_part(a[c]) || is_own_part(b[c])) contacts.push_back(c);
  WorldState part = rows_of(state, "body/", id.size(), bodies);
  for (StateArray& array : rows_of(state, "contact/", a.size(), contacts).arrays)
    part.arrays.push_back(std::move(array));
  return part;
}

WorldState contacts_of(const WorldState& state) {
  WorldState contacts;
  for (const StateArray& array : state.arrays)
    if (is_of(array, "contact/")) contacts.arrays.push_back(array);
  return contacts;
}

void require_rows(const WorldState& state, std::size_t bodies, std::size_t vectors) {
  const auto require = [](const char* name, std::size_t found, std::size_t expected) {
    if (found != expected)
      throw InputError(std::string("checkpoint: ") + name + " has " + std::to_string(found) +
                       " rows, expected " + std::to_string(expected));
  };
  require("body/position", state.at<Vec3d>("body/position").size(), bodies);
  require("body/orientation", state.at<Quatd>("body/orientation").size(), bodies);
  require("body/velocity", state.at<Vec3d>("body/velocity").size(), bodies);
  require("body/angular_velocity", state.at<Vec3d>("body/angular_velocity").size(), bodies);
  const std::size_t contacts = state.at<std::int32_t>("contact/body_a").size();
  require("contact/body_b", state.at<std::int32_t>("contact/body_b").size(), contacts);
  require("contact/feature", state.at<std::uint64_t>("contact/feature").size(), contacts);
  require("contact/impulse", state.at<Vec3d>("contact/impulse").size(), contacts * vectors);
  const std::size_t marks = state.at<std::int32_t>("contact/mark").size();
  if (marks > 0) require("contact/mark", marks, contacts);
}

WorldState no_contacts() {
  WorldState s;
  s.add("contact/body_a", std::vector<std::int32_t>{});
  s.add("contact/body_b", std::vector<std::int32_t>{});
  s.add("contact/feature", std::vector<std::uint64_t>{});
  s.add("contact/impulse", std::vector<Vec3d>{});
  s.add("contact/mark", std::vector<std::int32_t>{});
  return s;
}

Bytes packed_contacts(const WorldState& contacts, const std::vector<std::size_t>& rows) {
  if (rows.empty()) return {};
  const std::size_t count = contacts.at<std::int32_t>("contact/body_a").size();
  return to_bytes(rows_of(contacts, "contact/", count, rows));
}

void append_contacts(const Bytes& packed, WorldState& contacts) {
  if (packed.empty()) return;
  for (const StateArray& more : state_from(packed).arrays)
    std::visit(
        [&](const auto& values) {
          using T = typename std::decay_t<decltype(values)>::value_type;
          std::vector<T>& to = contacts.at<T>(more.name);
          to.insert(to.end(), values.begin(), values.end());
        },
        more.values);
}

void keep_known_contacts(const std::vector<Index>& name, Index owned_count, WorldState& contacts) {
  auto& a = contacts.at<std::int32_t>("contact/body_a");
  auto& b = contacts.at<std::int32_t>("contact/body_b");
  const auto& feature = contacts.at<std::uint64_t>("contact/feature");
  auto& impulse = contacts.at<Vec3d>("contact/impulse");
  const std::size_t vectors = a.empty() ? 1 : impulse.size() / a.size();
  const Index end = name.empty() ? 0 : *std::max_element(name.begin(), name.end()) + 1;
  std::vector<std::uint8_t> is_here(static_cast<std::size_t>(end), 0);  // 2: owned
  for (std::size_t i = 0; i < name.size(); ++i)
    if (name[i] >= 0)
      is_here[static_cast<std::size_t>(name[i])] = static_cast<Index>(i) < owned_count ? 2 : 1;
  const auto state_of = [&](std::int32_t part) {
    return part >= 0 && part < end ? is_here[static_cast<std::size_t>(part)] : 0;
  };
  struct Name {
    std::int32_t low, high;
    std::uint64_t feature;
    std::size_t row;
    auto key() const { return std::tuple(low, high, feature, row); }
  };
  std::vector<Name> names;
  for (std::size_t c = 0; c < a.size(); ++c) {
    if (state_of(a[c]) != 2) {  // the owned body is A: the impulse acts on B
      if (b[c] < 0 || state_of(b[c]) != 2 || state_of(a[c]) == 0) continue;
      std::swap(a[c], b[c]);
      for (std::size_t v = 0; v < vectors; ++v)
        impulse[c * vectors + v] = -impulse[c * vectors + v];
    } else if (b[c] >= 0 && state_of(b[c]) == 0) {
      continue;
    }
    names.push_back({std::min(a[c], b[c]), std::max(a[c], b[c]), feature[c], c});
  }
  std::sort(names.begin(), names.end(),
            [](const Name& x, const Name& y) { return x.key() < y.key(); });
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const bool is_again = k > 0 && names[k].low == names[k - 1].low &&
                          names[k].high == names[k - 1].high &&
                          names[k].feature == names[k - 1].feature;
    if (!is_again) rows.push_back(names[k].row);
  }
  std::sort(rows.begin(), rows.end());
  std::size_t next = 0;
  WorldState kept = rows_of(contacts, "contact/", a.size(), rows);
  for (StateArray& array : contacts.arrays)
    if (is_of(array, "contact/")) array.values = std::move(kept.arrays[next++].values);
}

}  // namespace scree
