// Cards that lean against each other: a tent, whose floor must hold its feet, and houses.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/physics/long_tests.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

/// Material 0: between cards. A card touches the floor, of material 1, by the friction `floor`.
Scene table(double friction, double floor, Model model) {
  Scene scene = empty_scene(1e-3, friction, model);
  solve_to(scene, 1e-6);
  Material wood = scene.materials[0];
  wood.friction = floor;
  scene.materials.push_back(wood);
  scene.material_pairs.push_back({0, 1, wood});
  add_plane(scene).material = 1;
  return scene;
}

struct CardSize {
  double length = 0, width = 0, thickness = 0;
};

/// Two cards that lean by `lean` [rad] from the vertical and touch with their upper inner edges; they stand at the height z.
void add_tent(Scene& scene, const CardSize& card, double lean, double x, double z) {
  const double c = std::cos(lean), s = std::sin(lean);
  const double out = (card.length * s + card.thickness * c) / 2;
  const double up = (card.length * c + card.thickness * s) / 2;
  for (const double side : {-1.0, 1.0}) {
    BodyDescription& body = add_box(scene, {x + side * out, 0, z + up},
                                    {card.thickness / 2, card.width / 2, card.length / 2},
                                    2000 * card.length * card.width * card.thickness);
    body.orientation = exp_map(Vec3d{0, -side * lean, 0});
  }
}
double height_of_tent(const CardSize& card, double lean) {
  return card.length * std::cos(lean) + card.thickness * std::sin(lean);
}

/// How far the body that moved most is from its start [m].
double farthest_move(const World& world, const Scene& scene) {
  const BodyStates s = world.states();
  double farthest = 0;
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (scene.bodies[i].kind == BodyKind::free)
      farthest = std::max(farthest, norm(s.position[i] - scene.bodies[i].position));
  return farthest;
}

class Cards : public testing::TestWithParam<Model> {};
INSTANTIATE_TEST_SUITE_P(Models, Cards, testing::Values(Model::convex, Model::exact),
                         [](const auto& info) { return std::string(name_of(info.param)); });

// The feet are the inner lower edges, L sin - t cos behind the upper ones and L cos below. Each card has its weight W on its foot, and the other
// card pushes it by H = W (tan(lean) - t / L) / 2, which the floor has to hold.
TEST_P(Cards, A62_TentStandsWhereTheFloorHoldsItsFeet) {
  constexpr CardSize kCard{1, 0.6, 0.01};
  for (const double degrees : {15.0, 25.0}) {
    const double lean = radians(degrees);
    const double least = (std::tan(lean) - kCard.thickness / kCard.length) / 2;
    for (const double share : {1.03, 0.97}) {
      Scene scene = table(1, share * least, GetParam());
      add_tent(scene, kCard, lean, 0, 0);
      World world = reference_world(scene);
      run_for(world, scene, 2);
      const double moved = farthest_move(world, scene);
      if (share > 1) {
        EXPECT_LT(moved, 1e-4) << degrees;
      } else {
        EXPECT_GT(moved, 0.3) << degrees;
      }
    }
  }
}

/// Three stories, 15 cards: three tents, two cards on them, two tents, one card, one tent.
Scene house(double friction, double lean, Model model) {
  constexpr CardSize kCard{0.088, 0.063, 0.002};
  constexpr double kGap = 4e-4;  // between tents [m]
  Scene scene = table(friction, friction, model);
  const double spacing =
      2 * (kCard.length * std::sin(lean) + kCard.thickness * std::cos(lean)) + kGap;
  const double height = height_of_tent(kCard, lean);
  const double cover = std::min(kCard.length, spacing - kGap);  // of steep tents they would overlap
  double z = 0;
  for (int tents = 3; tents > 0; --tents) {
    for (int k = 0; k < tents; ++k)
      add_tent(scene, kCard, lean, spacing * (k - 0.5 * (tents - 1)), z);
    z += height;
    if (tents == 1) break;
    for (int k = 0; k + 1 < tents; ++k)
      add_box(scene, {spacing * (k - 0.5 * (tents - 2)), 0, z + kCard.thickness / 2},
              {cover / 2, kCard.width / 2, kCard.thickness / 2},
              2000 * cover * kCard.width * kCard.thickness);
    z += kCard.thickness;
  }
  return scene;
}

// The values of the catalog.
TEST_P(Cards, A63_HouseOfSteepCardsStands) {
  if (!runs_long_tests()) GTEST_SKIP() << kLongTest;
  const Scene rough = house(0.5, radians(20), GetParam());
  World stands = reference_world(rough);
  run_for(stands, rough, 10);
  EXPECT_LT(farthest_move(stands, rough), 1e-4);
  const Scene smooth = house(0.1, radians(20), GetParam());
  World falls = reference_world(smooth);
  run_for(falls, smooth, 2);
  EXPECT_GT(farthest_move(falls, smooth), 0.05);
}

TEST_P(Cards, A63_HouseStandsOrFallsByItsFriction) {
  Scene rough = house(0.6, radians(28.7), GetParam());
  World stands = reference_world(rough);
  run_for(stands, rough, 10);
  EXPECT_LT(farthest_move(stands, rough), 1e-4);

  const Scene smooth = house(0.1, radians(28.7), GetParam());
  World falls = reference_world(smooth);
  run_for(falls, smooth, 2);
  EXPECT_GT(farthest_move(falls, smooth), 0.05);
}

}  // namespace
}  // namespace scree::physics
