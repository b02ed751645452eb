// Parts of states, and states and contacts on their way to another rank.

#include "dynamics/ranks/state_parts.h"

#include <gtest/gtest.h>

#include "dynamics/ranks/state_bytes.h"
#include "host/error.h"

namespace scree {
namespace {

WorldState contacts(std::vector<std::int32_t> a, std::vector<std::int32_t> b,
                    std::vector<std::uint64_t> feature, std::vector<Vec3d> impulse) {
  WorldState s;
  s.add("contact/body_a", std::move(a));
  s.add("contact/body_b", std::move(b));
  s.add("contact/feature", std::move(feature));
  s.add("contact/impulse", std::move(impulse));
  s.add("contact/mark", std::vector<std::int32_t>{});
  return s;
}

TEST(StateBytes, BringBackEveryArray) {
  WorldState state = contacts({1, 2}, {-1, 7}, {0, 5}, {{1, 2, 3}, {4, 5, 6}});
  state.dynamics = "rigid";
  state.step = 17;
  state.time = 0.25;
  state.insertions_done = 3;
  state.add("body/orientation", std::vector<Quatd>{{1, 0, 0, 0}});
  state.add("solver/memory", std::vector<double>{});
  const WorldState back = state_from(to_bytes(state));
  EXPECT_EQ(back.dynamics, "rigid");
  EXPECT_EQ(back.step, 17);
  EXPECT_EQ(back.time, 0.25);
  EXPECT_EQ(back.insertions_done, 3u);
  ASSERT_EQ(back.arrays.size(), state.arrays.size());
  EXPECT_EQ(back.at<std::int32_t>("contact/body_b"), (std::vector<std::int32_t>{-1, 7}));
  EXPECT_EQ(back.at<Vec3d>("contact/impulse")[1].z, 6);
  EXPECT_EQ(back.at<Quatd>("body/orientation")[0].w, 1);
}

TEST(StateBytes, RefuseWhatIsCut) {
  const Bytes whole = to_bytes(contacts({1, 2}, {-1, 7}, {0, 5}, {{1, 2, 3}, {4, 5, 6}}));
  for (std::size_t size = 0; size < whole.size(); size += 7)
    EXPECT_THROW(state_from(Bytes(whole.begin(), whole.begin() + static_cast<long>(size))),
                 RunError)
        << size;
}

TEST(SharedContacts, KeepTheirSignWhenTheBodiesExchangeTheirRoles) {
  // Owned: 4, 9; ghost: 2; fixed: 11. The contact of 2 and 9 was found by the owner of 2.
  WorldState s = contacts({4, 2, 2, 9, 4, 30}, {9, 9, 5, 2, 11, 4}, {0, 0, 0, 0, 3, 0},
                          {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}, {5, 0, 0}, {6, 0, 0}});
  keep_known_contacts({4, 9, 2, -1, 11}, 2, s);
  EXPECT_EQ(s.at<std::int32_t>("contact/body_a"), (std::vector<std::int32_t>{4, 9, 4}));
  EXPECT_EQ(s.at<std::int32_t>("contact/body_b"), (std::vector<std::int32_t>{9, 2, 11}));
  const auto& impulse = s.at<Vec3d>("contact/impulse");
  ASSERT_EQ(impulse.size(), 3u);
  EXPECT_EQ(impulse[0].x, 1);
  EXPECT_EQ(impulse[1].x, -2);  // the first of the two that name it
  EXPECT_EQ(impulse[2].x, 5);
}

/// Contacts belong to the owners of the bodies whose parts touch.
TEST(SharedContacts, AreThoseOfTheBodiesThatHaveTheParts) {
  const PartNames names{5, {0, 0, 0, 3, 3}};  // parts 6 and 7 of body 0, and 9 of body 3
  WorldState s =
      contacts({6, 9, 4, 7, 1, 12}, {-1, 1, 2, 9, 2, 4}, {0, 0, 0, 0, 0, 0}, std::vector<Vec3d>(6));
  s.add("body/id", std::vector<std::int32_t>{0, 1, 2, 3, 4});
  s.add("body/position", std::vector<Vec3d>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  const auto rows_of = [&](auto&& owns) {
    return shared_part(s, owns, names).template at<std::int32_t>("contact/body_a");
  };
  using Rows = std::vector<std::int32_t>;
  EXPECT_EQ(rows_of([](const Vec3d& x) { return x.x < 1; }), (Rows{6, 7}));
  EXPECT_EQ(rows_of([](const Vec3d& x) { return x.x == 3; }), (Rows{9, 7}));
  EXPECT_EQ(rows_of([](const Vec3d& x) { return x.x == 4; }), (Rows{4, 12}));
}

TEST(SharedContacts, TravelWithAllTheirVectors) {
  const WorldState from =
      contacts({1, 2}, {3, -1}, {7, 8}, {{1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
  WorldState to = no_contacts();
  append_contacts(packed_contacts(from, {1, 0}), to);
  append_contacts(packed_contacts(from, {}), to);
  EXPECT_EQ(to.at<std::int32_t>("contact/body_a"), (std::vector<std::int32_t>{2, 1}));
  EXPECT_EQ(to.at<std::uint64_t>("contact/feature"), (std::vector<std::uint64_t>{8, 7}));
  ASSERT_EQ(to.at<Vec3d>("contact/impulse").size(), 4u);
  EXPECT_EQ(to.at<Vec3d>("contact/impulse")[3].x, 2);
}

}  // namespace
}  // namespace scree
