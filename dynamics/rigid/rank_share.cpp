#include "dynamics/rigid/rank_share.h"

#include <cstring>
#include <tuple>

namespace scree {
namespace {

/// A contact on its way; impulses and a mark follow as arrays.
struct ContactRow {
  std::int32_t body_a = 0;
  std::int32_t body_b = 0;
  std::uint64_t feature = 0;
  std::int32_t mark = -1;
  std::int32_t has_mark = 0;
  Vec3d impulse[2];
};

std::size_t vectors_of(const WorldState& contacts) {
  const std::size_t rows = contacts.at<std::int32_t>("contact/body_a").size();
  return rows == 0 ? 1 : contacts.at<Vec3d>("contact/impulse").size() / rows;
}

template <class T>
void keep_rows(const std::vector<std::size_t>& rows, std::size_t group, std::vector<T>& values) {
  if (values.empty()) return;
  std::vector<T> kept;
  kept.reserve(rows.size() * group);
  for (const std::size_t c : rows)
    for (std::size_t v = 0; v < group; ++v) kept.push_back(values[c * group + v]);
  values = std::move(kept);
}

}  // namespace

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
  const std::size_t vectors = vectors_of(contacts);
  const auto& a = contacts.at<std::int32_t>("contact/body_a");
  const auto& b = contacts.at<std::int32_t>("contact/body_b");
  const auto& feature = contacts.at<std::uint64_t>("contact/feature");
  const auto& impulse = contacts.at<Vec3d>("contact/impulse");
  const auto& mark = contacts.at<std::int32_t>("contact/mark");
  std::vector<ContactRow> out;
  out.reserve(rows.size());
  for (const std::size_t c : rows) {
    ContactRow row;
    row.body_a = a[c];
    row.body_b = b[c];
    row.feature = feature[c];
    row.has_mark = mark.empty() ? 0 : 1;
    if (!mark.empty()) row.mark = mark[c];
    for (std::size_t v = 0; v < vectors; ++v) row.impulse[v] = impulse[c * vectors + v];
    out.push_back(row);
  }
  if (out.empty()) return {};
  const auto count = static_cast<std::uint64_t>(vectors);
  Bytes bytes(sizeof count + out.size() * sizeof(ContactRow));
  std::memcpy(bytes.data(), &count, sizeof count);
  std::memcpy(bytes.data() + sizeof count, out.data(), out.size() * sizeof(ContactRow));
  return bytes;
}

void append_contacts(const Bytes& packed, WorldState& contacts) {
  if (packed.empty()) return;
  std::uint64_t vectors = 0;
  std::memcpy(&vectors, packed.data(), sizeof vectors);
  std::vector<ContactRow> rows((packed.size() - sizeof vectors) / sizeof(ContactRow));
  std::memcpy(static_cast<void*>(rows.data()), packed.data() + sizeof vectors,
              rows.size() * sizeof(ContactRow));
  auto& mark = contacts.at<std::int32_t>("contact/mark");
  for (const ContactRow& row : rows) {
    if (row.has_mark != 0) {
      mark.resize(contacts.at<std::int32_t>("contact/body_a").size(), -1);
      mark.push_back(row.mark);
    } else if (!mark.empty()) {
      mark.push_back(-1);
    }
    contacts.at<std::int32_t>("contact/body_a").push_back(row.body_a);
    contacts.at<std::int32_t>("contact/body_b").push_back(row.body_b);
    contacts.at<std::uint64_t>("contact/feature").push_back(row.feature);
    for (std::uint64_t v = 0; v < vectors; ++v)
      contacts.at<Vec3d>("contact/impulse").push_back(row.impulse[v]);
  }
}

void keep_known_contacts(const std::vector<Index>& id, Index owned_count, WorldState& contacts) {
  const std::size_t vectors = vectors_of(contacts);
  auto& a = contacts.at<std::int32_t>("contact/body_a");
  auto& b = contacts.at<std::int32_t>("contact/body_b");
  auto& feature = contacts.at<std::uint64_t>("contact/feature");
  auto& impulse = contacts.at<Vec3d>("contact/impulse");
  const Index id_end = id.empty() ? 0 : *std::max_element(id.begin(), id.end()) + 1;
  std::vector<std::uint8_t> is_here(static_cast<std::size_t>(id_end), 0);  // 2: owned
  for (std::size_t i = 0; i < id.size(); ++i)
    if (id[i] >= 0)
      is_here[static_cast<std::size_t>(id[i])] = static_cast<Index>(i) < owned_count ? 2 : 1;
  const auto state_of = [&](std::int32_t body) {
    return body >= 0 && body < id_end ? is_here[static_cast<std::size_t>(body)] : 0;
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
  keep_rows(rows, vectors, impulse);
  keep_rows(rows, 1, a);
  keep_rows(rows, 1, b);
  keep_rows(rows, 1, feature);
  keep_rows(rows, 1, contacts.at<std::int32_t>("contact/mark"));
}

}  // namespace scree
