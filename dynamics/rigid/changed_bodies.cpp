#include "dynamics/rigid/changed_bodies.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_set>

#include "dynamics/part_names.h"
#include "kernels/contact/contact_key.h"

namespace scree {
namespace {

/// Keeps the rows for which stays(k) is true. @param per_row  values of a row
template <class T>
void keep_rows(std::vector<T>& values, std::size_t per_row, const std::vector<bool>& stays) {
  std::size_t to = 0;
  for (std::size_t row = 0; row < stays.size(); ++row) {
    if (!stays[row]) continue;
    for (std::size_t k = 0; k < per_row; ++k) values[to++] = values[row * per_row + k];
  }
  values.resize(to);
}

/// Rows of bodies that stay, then those that are new.
template <class T>
void change_rows(const char* name, const std::vector<bool>& stays, const std::vector<bool>& is_new,
                 const WorldState& own, WorldState& s) {
  std::vector<T>& rows = s.at<T>(name);
  keep_rows(rows, 1, stays);
  const std::vector<T>& described = own.at<T>(name);
  for (std::size_t k = 0; k < described.size(); ++k)
    if (is_new[k]) rows.push_back(described[k]);
}

void change_bodies(const std::vector<int>& removed, const WorldState& own, WorldState& s) {
  std::vector<bool> stays, is_new;
  std::unordered_set<int> known;
  for (const int id : s.at<std::int32_t>("body/id")) {
    stays.push_back(!std::binary_search(removed.begin(), removed.end(), id));
    known.insert(id);
  }
  for (const int id : own.at<std::int32_t>("body/id")) is_new.push_back(!known.contains(id));
  change_rows<std::int32_t>("body/id", stays, is_new, own, s);
  for (const char* name : {"body/position", "body/velocity", "body/angular_velocity"})
    change_rows<Vec3d>(name, stays, is_new, own, s);
  change_rows<Quatd>("body/orientation", stays, is_new, own, s);
}

}  // namespace

void leave_naming(const ContactNaming& naming, const std::vector<Index>& part_owner,
                  WorldState& s) {
  s.add("run/naming", std::vector<std::int32_t>{naming.id_count, static_cast<int>(naming.layout)});
  s.add("run/part_owner", part_owner);
}

void change_state(const ContactNaming& naming, const std::vector<int>& removed,
                  const WorldState& own, WorldState& s) {
  change_bodies(removed, own, s);
  const std::vector<std::int32_t>& before = s.at<std::int32_t>("run/naming");
  const PartNames names_before{before[0], s.at<std::int32_t>("run/part_owner")};
  const int more = naming.id_count - names_before.id_count;
  const auto is_gone = [&](int name) {
    return std::binary_search(removed.begin(), removed.end(), names_before.body(name));
  };
  auto& body_a = s.at<std::int32_t>("contact/body_a");
  auto& body_b = s.at<std::int32_t>("contact/body_b");
  auto& feature = s.at<std::uint64_t>("contact/feature");
  auto& impulse = s.at<Vec3d>("contact/impulse");
  auto& mark = s.at<std::int32_t>("contact/mark");
  if (body_a.empty()) return;
  std::vector<bool> stays;
  for (std::size_t c = 0; c < body_a.size(); ++c)
    stays.push_back(!is_gone(body_a[c]) && !is_gone(body_b[c]));
  const std::size_t vectors = impulse.size() / body_a.size();
  if (!mark.empty()) keep_rows(mark, 1, stays);
  keep_rows(impulse, vectors, stays);
  keep_rows(feature, 1, stays);
  keep_rows(body_a, 1, stays);
  keep_rows(body_b, 1, stays);
  for (std::vector<std::int32_t>* names : {&body_a, &body_b})
    for (std::int32_t& name : *names)
      if (name >= names_before.id_count) name += more;
  // Without spheres there was one group: that of contacts with arms.
  const auto layout = static_cast<ContactLayout>(before[1]);
  if (layout == ContactLayout::general && naming.layout == ContactLayout::mixed)
    for (std::uint64_t& number : feature) number |= kGeneralGroup;
}

}  // namespace scree
