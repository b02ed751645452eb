// Overlaps that a scene begins with: which bodies, how deep, how many.

#include "host/scene/overlaps.h"

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/scene/body_name.h"
#include "shapes/sphere.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using test::parsed;

Overlaps overlaps_of(const Scene& scene) {
  return find_overlaps(scene, {BackendKind::cpu, Precision::single_precision, 1, 0});
}

std::string warning_of(const Scene& scene) {
  return overlap_warning(overlaps_of(scene), BodyConstants(scene));
}

/// Bodies by number in the file: a floor, a ball_at that comes later, and what is given.
std::string text_of(const std::string& bodies, const std::string& particles = "") {
  return R"({"time_step": 1e-3, "duration": 1, "bodies": [
    {"shape": "half_space"},
    {"shape": "sphere", "radius": 0.1, "density": 1000, "position": [0, 0, 1], "insert_at": 0.5})" +
         (bodies.empty() ? "" : ", " + bodies) + R"(], "particles": [)" + particles + "]}";
}
std::string ball_at(double x, double z) {
  return R"({"shape": "sphere", "radius": 0.1, "density": 1000, "position": [)" +
         std::to_string(x) + ", 0, " + std::to_string(z) + "]}";
}

TEST(Overlaps, NoneAmongBodiesThatTouchOrComeLater) {
  // Each rests on the floor and touches the next one; the one at 1 m stands where a later one will.
  const Scene scene =
      parsed(text_of(ball_at(0, 0.1) + ", " + ball_at(0.2, 0.1) + ", " + ball_at(0, 1)));
  const Overlaps found = overlaps_of(scene);
  EXPECT_EQ(found.pairs, 0);
  EXPECT_EQ(found.not_looked_for, "");
  EXPECT_EQ(warning_of(scene), "");
}

TEST(Overlaps, AreCountedAndTheDeepestIsNamedAsInTheFile) {
  const Scene scene = parsed(text_of(ball_at(0, 0.09) + ", " + ball_at(0.15, 0.2)));
  const Overlaps found = overlaps_of(scene);
  EXPECT_EQ(found.pairs, 2);  // with the floor and with each other
  EXPECT_EQ(found.body_a, 1);
  EXPECT_EQ(found.body_b, 2);
  const double distance = std::hypot(0.15, 0.11);
  EXPECT_NEAR(found.depth, 0.2 - distance, 1e-8);
  EXPECT_NEAR(found.fraction, (0.2 - distance) / 0.2, 1e-7);
  EXPECT_EQ(warning_of(scene),
            "2 pairs of bodies overlap at the start; deepest: bodies[2] (id 1) and bodies[3] (id "
            "2) by 0.014 m, 6.99 % of the thickness of the thinner one");
}

// Plates of a millimeter and rods of two, nine tenths and all of their thickness in each other.
TEST(Overlaps, AreMeasuredByHowThinBodiesAre) {
  const auto plate = [](double z) {
    return R"({"shape": "box", "size": [1, 1, 0.001], "mass": 1, "position": [0, 0, )" +
           std::to_string(z) + "]}";
  };
  const auto rod = [](double x) {
    return R"({"shape": "cylinder", "radius": 0.001, "length": 4, "mass": 1, "position": [)" +
           std::to_string(x) + ", 0, 3]}";
  };
  const Overlaps plates = overlaps_of(parsed(text_of(plate(0.5) + ", " + plate(0.5001))));
  EXPECT_EQ(plates.pairs, 1);
  EXPECT_NEAR(plates.fraction, 0.9, 1e-3);
  const Overlaps rods = overlaps_of(parsed(text_of(rod(0) + ", " + rod(0.0001))));
  EXPECT_EQ(rods.pairs, 1);
  EXPECT_GT(rods.fraction, 0.9);
}

// Affine bodies have no list of contacts. What lies inside of a solid, or below a floor, crosses no surface and is not refused.
TEST(Overlaps, OfAffineBodiesAreFoundAsThoseOfRigidOnes) {
  Scene scene =
      parsed(R"({"time_step": 0.01, "duration": 1, "dynamics": {"type": "affine"}, "bodies": [
    {"shape": "box", "kind": "fixed", "size": [1, 1, 1]},
    {"shape": "sphere", "radius": 0.1, "density": 1000, "position": [0, 0, 0]},
    {"shape": "half_space", "point": [0, 0, -3]},
    {"shape": "sphere", "radius": 0.1, "density": 1000, "position": [3, 0, -3.3]}]})");
  EXPECT_EQ(overlaps_of(scene).pairs, 2);
  EXPECT_NEAR(overlaps_of(scene).depth, 0.6, 1e-6);
  EXPECT_TRUE(overlaps_of(scene).warnings.empty());
  scene.dynamics.parameters["stiffness"] = 1e14;
  EXPECT_EQ(overlaps_of(scene).warnings.size(), 1u) << "too stiff to turn";
  scene.bodies[1].position = {0.45, 0, 0};  // through a side of the box
  EXPECT_THROW(overlaps_of(scene), InputError) << "as a run does";
}

TEST(Overlaps, WithWallsAndAmongParticleSets) {
  const std::string low = R"({"layout": "lattice", "radius": 0.1, "density": 1, "count": 4,
    "spacing": 0.2, "region": {"min": [5, 0, -0.05], "max": [5.8, 0.2, 0.2]}})";
  const Scene sunk = parsed(text_of("", low));
  EXPECT_EQ(warning_of(sunk),
            "4 pairs of bodies overlap at the start; deepest: particles[0] #0 (id 1) and bodies[0] "
            "(id 0) by 0.05 m, 25 % of the thickness of the thinner one");
  const auto set = [](const char* x) {
    return std::string(R"({"layout": "lattice", "radius": 0.1, "density": 1, "count": 1,
      "spacing": 0.2, "region": {"min": [)") +
           x + R"(, 0, 1], "max": [9, 0.2, 1.2]}})";
  };
  const Scene twice = parsed(text_of("", set("8.8") + ", " + set("8.7")));
  const Overlaps found = overlaps_of(twice);
  EXPECT_EQ(found.pairs, 1);
  EXPECT_EQ(body_name(BodyConstants(twice), found.body_a), "particles[0] #0");
  EXPECT_EQ(body_name(BodyConstants(twice), found.body_b), "particles[1] #0");
}

/// Boxes and meshes touch in several places, which are one pair.
TEST(Overlaps, AreCountedByPairs) {
  const Scene scene = parsed(text_of(R"({"shape": "box", "size": [0.2, 0.2, 0.2], "density": 1000,
    "position": [0, 0, 0.05]})"));
  const Overlaps found = overlaps_of(scene);
  EXPECT_EQ(found.pairs, 1);
  EXPECT_NEAR(found.depth, 0.05, 1e-7);
}

TEST(Overlaps, ACrowdInOnePlaceTakesNoTime) {
  Scene scene = parsed(text_of(ball_at(0, 2)));
  ParticleSet crowd;
  crowd.position.assign(200'000, {3, 0, 3});  // two hundred thousand squared are too many pairs
  crowd.radius = 0.1;
  crowd.density = 1000.0;
  crowd.entry = 0;
  scene.particles.push_back(crowd);
  const Overlaps found = overlaps_of(scene);
  EXPECT_TRUE(found.has_more);
  EXPECT_GT(found.pairs, 1'000'000);
  EXPECT_EQ(found.depth, 0.2);
}

TEST(Overlaps, ThoseOfBodiesWithoutAFileAreNamedById) {
  Scene scene;
  BodyDescription body;
  body.shape.kind = shapes::Sphere::kind;
  body.shape.radius = 1;
  set_mass_from_density(body, 1);
  scene.bodies = {body, body};
  EXPECT_EQ(body_name(BodyConstants(scene), 1), "body 1");
  EXPECT_EQ(body_name(BodyConstants(scene), 1, {{"lid", 1}, {"pot", 0}}), "body 1 \"lid\"");
}

}  // namespace
}  // namespace scree
