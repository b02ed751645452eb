// Entries of `particles` with shapes: what they become, and what is refused_set.

#include "host/scene/particle_shapes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "host/body_constants.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"
#include "shapes/box.h"
#include "shapes/capsule.h"
#include "shapes/cylinder.h"
#include "shapes/sphere.h"
#include "tests/host/input_files.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

using test::parsed;
using test::refusal;
using test::with_particles;
using testing::StartsWith;

/// An entry that fills a wide region; further keys after it.
std::string entry(const std::string& keys, const std::string& layout = "lattice",
                  int count = 1000) {
  return R"({"layout": ")" + layout + R"(", "density": 1000, "count": )" + std::to_string(count) +
         R"(, "region": {"min": [0, 0, 0], "max": [9, 9, 9]}, )" + keys + "}";
}
ParticleSet set_of(const std::string& keys, const std::string& layout = "lattice",
                   int count = 1000) {
  return parsed(with_particles(entry(keys, layout, count))).particles.at(0);
}
const std::string kBox = R"("shape": "box", "size": [0.1, 0.2, 0.3])";
const std::string kMix = R"("shapes": [
  {"shape": "box", "size": [0.1, 0.2, 0.3]},
  {"shape": "capsule", "radius": 0.05, "length": 0.2, "weight": 2},
  {"shape": "sphere", "radius": 0.1, "weight": 1}])";

TEST(ParticleShapes, VelocitiesAreSpreadAboutTheirMean) {
  const ParticleSet set =
      set_of(R"("radius": 0.1, "velocity": [1, 2, -3], "velocity_spread": 0.5)");
  EXPECT_FALSE(set.velocity.uniform());
  const double count = static_cast<double>(set.position.size());
  Vec3d mean, square, product;
  for (std::size_t i = 0; i < set.position.size(); ++i) {
    const Vec3d d = set.velocity[i] - Vec3d{1, 2, -3};
    mean += (1 / count) * d;
    square += (1 / count) * hadamard(d, d);
    product += (1 / count) * hadamard(d, {d.y, d.z, d.x});
  }
  EXPECT_LT(norm(mean), 1e-14);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(square[k], 0.25, 0.05);
    EXPECT_NEAR(product[k], 0, 0.05) << "components are independent";
  }
  EXPECT_EQ(set_of(R"("radius": 0.1, "velocity_spread": 0.5)").velocity[7],
            set_of(R"("radius": 0.1, "velocity_spread": 0.5)").velocity[7]);
  EXPECT_EQ(set_of(R"("radius": 0.1, "velocity_spread": 0.5)").position[7],
            set_of(R"("radius": 0.1)").position[7]);
  EXPECT_TRUE(
      set_of(R"("radius": 0.1, "velocity": [1, 0, 0], "velocity_spread": 0)").velocity.uniform());
  EXPECT_THAT(refusal([] { set_of(R"("radius": 0.1, "velocity_spread": -1)"); }),
              testing::HasSubstr("velocity_spread"));
}

TEST(ParticleShapes, OneShapeOfOneSizeIsStoredOnce) {
  const ParticleSet set = set_of(kBox);
  EXPECT_TRUE(set.shape.uniform());
  EXPECT_TRUE(set.radius.uniform());
  EXPECT_EQ(set.shape[0].kind, shapes::Box::kind);
  EXPECT_EQ(set.shape[0].half_extents, Vec3d(0.05, 0.1, 0.15));
  EXPECT_EQ(set.radius[0], norm(Vec3d(0.05, 0.1, 0.15)));
  EXPECT_EQ(set.orientation[0].w, 1);
  EXPECT_EQ(particle_body(set, 7).mass, 1000 * 8 * 0.05 * 0.1 * 0.15);
}

TEST(ParticleShapes, SpheresByShapeAreThoseByRadius) {
  const ParticleSet by_shape =
      set_of(R"("shape": "sphere", "radius": 0.1, "scale": {"min": 0.5, "max": 1})", "random");
  const ParticleSet by_radius = set_of(R"("radius": {"min": 0.05, "max": 0.1})", "random");
  EXPECT_TRUE(are_spheres(by_shape));
  EXPECT_TRUE(by_shape.shape.uniform());
  for (std::size_t i = 0; i < 1000; ++i) {
    ASSERT_NEAR(by_shape.radius[i], by_radius.radius[i], 1e-15);
    ASSERT_NEAR(norm(by_shape.position[i] - by_radius.position[i]), 0, 1e-12);
  }
}

/// The scale multiplies lengths, so masses grow with its third power and moments with its fifth.
TEST(ParticleShapes, ScalesMultiplyAllLengths) {
  for (const char* layout : {"lattice", "random"}) {
    const ParticleSet set = set_of(
        R"("shape": "cylinder", "radius": 0.1, "length": 0.3, "scale": {"min": 0.5, "max": 1.5})",
        layout, 800);
    const ParticleSet one = set_of(R"("shape": "cylinder", "radius": 0.1, "length": 0.3)");
    const BodyDescription whole = particle_body(one, 0);
    double sum = 0, squares = 0;
    for (std::size_t i = 0; i < 800; ++i) {
      const BodyDescription body = particle_body(set, i);
      const double scale = body.shape.half_extents.x / 0.1;
      EXPECT_GE(scale, 0.5);
      EXPECT_LE(scale, 1.5);
      ASSERT_EQ(body.shape.kind, shapes::Cylinder::kind);
      ASSERT_NEAR(body.shape.half_extents.z, 0.15 * scale, 1e-15);
      ASSERT_EQ(set.radius[i], shapes::Cylinder::bounding_radius(body.shape, nullptr));
      ASSERT_NEAR(body.mass, whole.mass * std::pow(scale, 3), 1e-12 * whole.mass);
      ASSERT_EQ(body.mass, particle_mass(set, i));
      for (int k = 0; k < 3; ++k)
        ASSERT_NEAR(body.inertia[k], whole.inertia[k] * std::pow(scale, 5),
                    1e-12 * whole.inertia[k]);
      sum += scale;
      squares += scale * scale;
    }
    // Four standard deviations of the mean and of the second moment of a uniform law.
    EXPECT_NEAR(sum / 800, 1, 4 * std::sqrt(1.0 / 12 / 800));
    EXPECT_NEAR(squares / 800, 1 + 1.0 / 12, 4 * 0.58 / std::sqrt(800.0));
  }
}

TEST(ParticleShapes, OfAMixAreDrawnByTheirWeights) {
  for (const char* layout : {"lattice", "random"}) {
    const ParticleSet set = set_of(kMix, layout, 4000);
    const auto counts = particle_shape_counts(set);
    ASSERT_EQ(counts.size(), 3u);
    // Four standard deviations of a draw with probability 1/4 and of one with 1/2.
    EXPECT_NEAR(static_cast<double>(counts.at(shapes::Box::kind)), 1000, 4 * 27.4);
    EXPECT_NEAR(static_cast<double>(counts.at(shapes::Capsule::kind)), 2000, 4 * 31.6);
    for (std::size_t i = 0; i < 4000; ++i) {
      const Shape shape = particle_shape(set, i);
      const double radius = shape.kind == shapes::Sphere::kind    ? 0.1
                            : shape.kind == shapes::Capsule::kind ? 0.15
                                                                  : norm(Vec3d(0.05, 0.1, 0.15));
      ASSERT_NEAR(set.radius[i], radius, 1e-15);
    }
    // Neighbors know nothing of each other.
    int runs = 0;
    if (std::string(layout) == "lattice") {
      for (std::size_t i = 1; i < 4000; ++i)
        runs += particle_kind(set, i) != particle_kind(set, i - 1);
      EXPECT_NEAR(runs, 3999 * 0.625, 4 * 31);
    }
  }
}

TEST(ParticleShapes, WithWeightZeroAreNotDrawn) {
  const ParticleSet set = set_of(R"("shapes": [{"shape": "box", "size": [1, 1, 1], "weight": 0},
    {"shape": "box", "size": [0.1, 0.1, 0.1]}, {"shape": "sphere", "radius": 0.1, "weight": 0}],
    "spacing": 1.8)",
                                 "lattice", 100);
  for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(particle_shape(set, i).half_extents.x, 0.05);
}

TEST(ParticleShapes, OfAMixMayHaveGroups) {
  const std::string some = R"("group": "stones", "shapes": [
    {"shape": "box", "size": [0.1, 0.1, 0.1], "group": "boxes"}, {"shape": "sphere", "radius": 0.1}])";
  const Scene scene = parsed(with_particles(entry(some)));
  const ParticleSet& set = scene.particles[0];
  std::set<std::string> names;
  for (std::size_t i = 0; i < 1000; ++i) {
    const std::string& group = scene.groups[static_cast<std::size_t>(set.group[i])];
    ASSERT_EQ(group, particle_kind(set, i) == shapes::Box::kind ? "boxes" : "stones");
    names.insert(group);
  }
  EXPECT_EQ(names.size(), 2u);
  const Scene one = parsed(with_particles(
      entry(R"("shapes": [{"shape": "box", "size": [0.1, 0.1, 0.1], "group": "boxes"}])")));
  EXPECT_TRUE(one.particles[0].group.uniform());
  EXPECT_EQ(one.groups[static_cast<std::size_t>(one.particles[0].group[0])], "boxes");
}

TEST(ParticleShapes, BoundingSpheresDoNotOverlap) {
  for (const char* layout : {"lattice", "random"}) {
    const ParticleSet set = set_of(kMix + R"(, "scale": {"values": [1, 2]})", layout, 500);
    for (std::size_t i = 0; i < 500; ++i)
      for (std::size_t j = 0; j < i; ++j)
        ASSERT_GE(norm(set.position[i] - set.position[j]), set.radius[i] + set.radius[j] - 1e-12);
  }
}

TEST(ParticleShapes, RandomOrientationsAreUniform) {
  const ParticleSet set =
      set_of(R"("shape": "box", "size": [0.1, 0.2, 0.3], "orientation": "random",
    "spacing": 0.4)",
             "lattice", 10000);
  ASSERT_FALSE(set.orientation.uniform());
  const double n = 10000;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d e;
    e[axis] = 1;
    Vec3d mean, fourth;
    double second[3][3] = {};
    for (std::size_t i = 0; i < 10000; ++i) {
      const Vec3d v = rotate(set.orientation[i], e);
      ASSERT_NEAR(norm(v), 1, 1e-12);
      mean += v;
      for (int a = 0; a < 3; ++a) {
        fourth[a] += v[a] * v[a] * v[a] * v[a];
        for (int b = 0; b < 3; ++b) second[a][b] += v[a] * v[b];
      }
    }
    // Four standard deviations: moments of a uniform direction are 0, 1/3 and 1/5.
    for (int a = 0; a < 3; ++a) {
      EXPECT_NEAR(mean[a] / n, 0, 4 * std::sqrt(1.0 / 3 / n));
      EXPECT_NEAR(fourth[a] / n, 1.0 / 5, 4 * std::sqrt((1.0 / 9 - 1.0 / 25) / n));
      for (int b = 0; b < 3; ++b)
        EXPECT_NEAR(second[a][b] / n, a == b ? 1.0 / 3 : 0, 4 * std::sqrt(4.0 / 45 / n));
    }
  }
  // The angle of a uniform rotation has the mean pi/2 + 2/pi.
  double angle = 0;
  for (std::size_t i = 0; i < 10000; ++i)
    angle += 2 * std::acos(std::min(1.0, std::abs(set.orientation[i].w)));
  EXPECT_NEAR(angle / n, std::acos(-1.0) / 2 + 2 / std::acos(-1.0), 4 * 0.65 / std::sqrt(n));
}

/// They have a sequence of their own: places and sizes are those without them.
TEST(ParticleShapes, RandomOrientationsLeaveTheLayoutAsItIs) {
  const std::string size = R"("radius": {"min": 0.05, "max": 0.1})";
  for (const char* layout : {"lattice", "random"}) {
    const ParticleSet plain = set_of(size + R"(, "angular_velocity": [0, 0, 1])", layout);
    const ParticleSet turned = set_of(size + R"(, "orientation": "random")", layout);
    EXPECT_EQ(plain.position, turned.position);
    for (std::size_t i = 0; i < 1000; ++i) ASSERT_EQ(plain.radius[i], turned.radius[i]);
  }
}

TEST(ParticleShapes, RandomOrientationsFollowTheSeedAndTheEntry) {
  const auto first = [](const std::string& more, std::size_t set) {
    const std::string one = entry(kBox + R"(, "orientation": "random")", "lattice", 3);
    const Scene scene = parsed(with_particles(one + ", " + one), {more});
    return scene.particles.at(set).orientation[0].w;
  };
  EXPECT_EQ(first("seed=1", 0), first("seed=1", 0));
  EXPECT_NE(first("seed=1", 0), first("seed=2", 0));
  EXPECT_NE(first("seed=1", 0), first("seed=1", 1));
}

TEST(ParticleShapes, OneOrientationForAll) {
  const ParticleSet by_axis =
      set_of(kBox + R"(, "rotation_deg": {"axis": [0, 0, 1], "angle": 90})");
  const ParticleSet by_numbers = set_of(kBox + R"(, "orientation": [0, 1, 0, 0])");
  EXPECT_NEAR(norm(rotate(by_axis.orientation[5], Vec3d{1, 0, 0}) - Vec3d{0, 1, 0}), 0, 1e-12);
  EXPECT_EQ(by_numbers.orientation[5].x, 1);
  EXPECT_TRUE(by_axis.orientation.uniform());
}

TEST(ParticleShapes, RainDrawsOnFromBatchToBatch) {
  const Scene scene = parsed(with_particles(entry(
      kMix + R"(, "orientation": "random", "layers": 4, "interval": 2, "velocity": [0, 0, -9])",
      "rain", 400)));
  ASSERT_EQ(scene.insertions.size(), 4u);
  const ParticleSet& first = scene.insertions[0].particles.at(0);
  const ParticleSet& second = scene.insertions[1].particles.at(0);
  ASSERT_EQ(first.position.size(), 100u);
  EXPECT_EQ(particle_shape_counts(second).size(), 3u);
  EXPECT_NE(first.orientation[0].w, second.orientation[0].w);
}

TEST(ParticleShapes, AreConstantsOfBodies) {
  const Scene scene =
      parsed(with_particles(entry(kMix + R"(, "scale": {"min": 0.5, "max": 1})", "lattice", 50)));
  const BodyConstants constants(scene);
  for (std::size_t id = 0; id < 50; ++id) {
    const BodyDescription body = particle_body(scene.particles[0], id);
    EXPECT_EQ(constants[id].shape, body.shape.kind);
    EXPECT_EQ(constants[id].mass, body.mass);
    EXPECT_EQ(constants[id].radius, bounding_radius(scene, body));
    EXPECT_TRUE(constants[id].is_particle);
  }
}

std::string refused_set(const std::string& keys, const std::string& layout = "lattice") {
  const std::string message = refusal([&] { parsed(with_particles(entry(keys, layout, 5))); });
  const std::string start = "x.json: particles[0]";
  EXPECT_THAT(message, StartsWith(start));
  return message.substr(std::min(start.size(), message.size()));
}

TEST(ParticleShapes, AreRefusedByPathAndExpectation) {
  EXPECT_THAT(refused_set(R"("shape": "bxo", "size": [1, 1, 1])"),
              StartsWith(".shape: \"bxo\" is not allowed: must be one of \"sphere\", \"box\""));
  EXPECT_THAT(refused_set(R"("shape": "half_space")"),
              StartsWith(".shape: \"half_space\" is not allowed: must be one of"));
  EXPECT_THAT(refused_set(R"("shape": "box")"),
              StartsWith(".size: missing: must be three full edge"));
  EXPECT_THAT(refused_set(R"("shape": "box", "size": [1, 0, 1])"),
              StartsWith(".size: [1,0,1] is not allowed: must be positive [m]"));
  EXPECT_EQ(refused_set(kBox + R"(, "radius": 0.1)"), ".radius: a box has no such key");
  EXPECT_EQ(refused_set(kBox + R"(, "length": 0.1)"), ".length: a box has no such key");
  EXPECT_EQ(refused_set(kBox + R"(, "file": "box.stl")"), ".file: a box has no such key");
  EXPECT_THAT(refused_set(R"("shape": "sphere", "radius": {"min": 1, "max": 2})"),
              StartsWith(".radius: {\"min\":1,\"max\":2} is not allowed: must be"));
  EXPECT_EQ(refused_set(R"("radius": 0.1, "size": [1, 1, 1])"),
            ".size: this key goes with a shape, and none is given; spheres have a radius");
  EXPECT_EQ(refused_set(R"("radius": 0.1, "scale": 2)"),
            ".scale: this key goes with a shape, and none is given; spheres have a radius");
  EXPECT_EQ(refused_set(R"("velocity": [0, 0, 1])"), ".radius: missing: must be positive [m]");
  EXPECT_EQ(refused_set(kBox + ", " + kMix), ".shapes: give either shape or shapes");
  EXPECT_THAT(refused_set(R"("shapes": [])"),
              StartsWith(".shapes: [] is not allowed: must hold one shape or more"));
  EXPECT_THAT(refused_set(kMix + R"(, "radius": 0.1)"),
              StartsWith(".radius: give it in the entries of shapes"));
  EXPECT_THAT(refused_set(kMix + R"(, "size": [1, 1, 1])"),
              StartsWith(".size: give it in the entries of shapes"));
  EXPECT_THAT(refused_set(R"("shapes": [{"shape": "box", "size": [1, 1, 1], "density": 1}])"),
              StartsWith(".shapes[0].density: unknown key"));
  EXPECT_THAT(refused_set(R"("shapes": [{"shape": "box", "size": [1, 1, 1], "weight": -1}])"),
              StartsWith(".shapes[0].weight: -1 is not allowed: must be zero or positive"));
  EXPECT_THAT(refused_set(R"("shapes": [{"shape": "box", "size": [1, 1, 1], "weight": 0}])"),
              StartsWith(".shapes: "));
  EXPECT_THAT(refused_set(R"("shapes": [{"size": [1, 1, 1]}])"),
              StartsWith(".shapes[0].shape: missing: must be one of"));
  EXPECT_EQ(refused_set(R"("shapes": [{"shape": "box", "size": [1, 1, 1], "length": 1}])"),
            ".shapes[0].length: a box has no such key");
}

TEST(ParticleShapes, ScalesAreRefusedByPathAndExpectation) {
  EXPECT_THAT(refused_set(kBox + R"(, "scale": 0)"),
              StartsWith(".scale: 0 is not allowed: must be positive [-]"));
  EXPECT_THAT(
      refused_set(kBox + R"(, "scale": "big")"),
      StartsWith(".scale: \"big\" is not allowed: must be a positive number [-] or one of"));
  EXPECT_THAT(refused_set(kBox + R"(, "scale": {"min": 2, "max": 1})"),
              StartsWith(".scale.max: 1 is not allowed: must not be below min [-]"));
  EXPECT_THAT(refused_set(kBox + R"(, "scale": {"values": []})"),
              StartsWith(".scale.values: [] is not allowed: must hold one scale or more [-]"));
  EXPECT_THAT(refused_set(kBox + R"(, "scale": 1e-13)"),
              StartsWith(".scale: a scale of 1e-13 makes the half_extents of a box 5"));
  EXPECT_THAT(refused_set(kBox + R"(, "scale": 30)"),
              StartsWith(".count: 5 is not allowed: the region holds 0 spheres"));
  EXPECT_THAT(refused_set(kBox + R"(, "scale": {"min": 1, "max": 2}, "spacing": 0.5)"),
              StartsWith(".spacing: 0.5 is not allowed: must be at least the largest diameter, "
                         "0.748331 [m]"));
}

TEST(ParticleShapes, OrientationsAreRefusedByPathAndExpectation) {
  EXPECT_THAT(
      refused_set(kBox + R"(, "orientation": "any")"),
      StartsWith(".orientation: \"any\" is not allowed: must be \"random\" or a quaternion"));
  EXPECT_THAT(refused_set(kBox + R"(, "orientation": [1, 1, 0, 0])"), StartsWith(".orientation: "));
  EXPECT_EQ(
      refused_set(kBox +
                  R"(, "orientation": "random", "rotation_deg": {"axis": [0, 0, 1], "angle": 9})"),
      ".rotation_deg: give either orientation or rotation_deg");
}

/// Particles of a CSV file of that header and those rows; further keys after it.
Scene of_file(const std::string& text, const std::string& keys) {
  const std::string path = test::write_file("table.csv", text).string();
  return parsed(with_particles(R"({"layout": "file", "density": 1000, "file": ")" + path + "\"" +
                               keys + "}"));
}
const std::string kThree = "x,y,z\n0,0,1\n0,0,2\n0,0,3\n";

TEST(ParticleShapes, OfAFileHaveTheShapeOfTheEntry) {
  const Scene scene =
      of_file("x,y,z,qw,qx,qy,qz,mass\n1,2,3,0,1,0,0,24\n4,5,6,1,0,0,0,6\n", ", " + kBox);
  const ParticleSet& set = scene.particles.at(0);
  EXPECT_TRUE(set.shape.uniform());
  EXPECT_TRUE(set.radius.uniform());
  EXPECT_EQ(set.position[1], Vec3d(4, 5, 6));
  EXPECT_EQ(set.shape[1].half_extents, Vec3d(0.05, 0.1, 0.15));
  EXPECT_EQ(set.radius[0], norm(Vec3d(0.05, 0.1, 0.15)));
  const BodyDescription body = particle_body(set, 0);
  EXPECT_EQ(body.orientation.x, 1);
  EXPECT_NEAR(body.mass, 24, 1e-13);
  EXPECT_NEAR(body.inertia.x, 24 / 3.0 * (0.1 * 0.1 + 0.15 * 0.15), 1e-13);
  EXPECT_NE(
      of_file(kThree, R"(, "radius": 0.1, "orientation": "random")").particles[0].orientation[0].w,
      of_file(kThree, R"(, "radius": 0.1, "orientation": "random")").particles[0].orientation[1].w);
}

TEST(ParticleShapes, OfAFileHaveTheShapesAndScalesOfItsColumns) {
  const Scene scene =
      of_file("x,y,z,shape,scale\n0,0,1,2,0.5\n0,0,2,0,2\n0,0,3,1,1\n", ", " + kMix);
  const ParticleSet& set = scene.particles.at(0);
  EXPECT_EQ(particle_kind(set, 0), shapes::Sphere::kind);
  EXPECT_EQ(set.radius[0], 0.05);
  EXPECT_EQ(particle_kind(set, 1), shapes::Box::kind);
  EXPECT_EQ(set.shape[1].half_extents, Vec3d(0.1, 0.2, 0.3));
  EXPECT_EQ(particle_kind(set, 2), shapes::Capsule::kind);
  // Of balls alone the radius is all.
  const Scene balls =
      of_file("x,y,z,scale\n0,0,1,0.5\n0,0,2,3\n", R"(, "shape": "sphere", "radius": 0.1)");
  EXPECT_TRUE(are_spheres(balls.particles[0]));
  EXPECT_NEAR(balls.particles[0].radius[0], 0.05, 1e-17);
  EXPECT_NEAR(balls.particles[0].radius[1], 0.3, 1e-16);
}

TEST(ParticleShapes, OfAFileAreDrawnWhereItsColumnsDoNotTell) {
  std::string rows = "x,y,z\n";
  for (int k = 0; k < 400; ++k) rows += std::to_string(k) + ",0,0\n";
  const ParticleSet set =
      of_file(rows, ", " + kMix + R"(, "scale": {"min": 0.5, "max": 1})").particles.at(0);
  const auto counts = particle_shape_counts(set);
  EXPECT_NEAR(static_cast<double>(counts.at(shapes::Box::kind)), 100, 30);
  EXPECT_NEAR(static_cast<double>(counts.at(shapes::Capsule::kind)), 200, 40);
  std::set<double> radii;
  for (std::size_t k = 0; k < 400; ++k) radii.insert(set.radius[k]);
  EXPECT_EQ(radii.size(), 400u);
  EXPECT_GE(*radii.begin(), 0.05);
  EXPECT_LE(*radii.rbegin(), norm(Vec3d(0.05, 0.1, 0.15)));
}

TEST(ParticleShapes, GroupsOfAFileComeBeforeThoseOfShapes) {
  const std::string keys =
      R"(, "shapes": [{"shape": "box", "size": [1, 1, 1], "group": "bricks"}])";
  const Scene scene = of_file("x,y,z,group\n0,0,1,upper\n0,0,2,bricks\n", keys);
  const auto name = [](const Scene& of, std::size_t k) {
    return of.groups.at(static_cast<std::size_t>(of.particles.at(0).group[k]));
  };
  EXPECT_EQ(name(scene, 0), "upper");
  EXPECT_EQ(name(scene, 1), "bricks");
  EXPECT_EQ(name(of_file(kThree, keys), 2), "bricks");
}

TEST(ParticleShapes, OfAFileAreRefusedByWhatIsWrong) {
  const auto message = [](const std::string& text, const std::string& keys) {
    return refusal([&] { of_file(text, keys); });
  };
  using testing::EndsWith;
  EXPECT_THAT(message("x,y,z,radius\n0,0,1,1\n", ", " + kBox),
              EndsWith("table.csv: line 1: the column \"radius\" is of spheres; bodies with a "
                       "shape have a \"scale\""));
  EXPECT_THAT(message("x,y,z,scale\n0,0,1,1\n", R"(, "radius": 1)"),
              EndsWith("the column \"scale\" goes with a shape in the scene, and none is given"));
  EXPECT_THAT(message("x,y,z,shape\n0,0,1,3\n", ", " + kMix),
              EndsWith("table.csv: line 2, column \"shape\": \"3\" is not allowed: must be a whole "
                       "number from 0 to 2, "
                       "that of a shape in the scene"));
  EXPECT_THAT(message("x,y,z,shape\n0,0,1,0.5\n", ", " + kMix),
              testing::HasSubstr("\"0.5\" is not allowed"));
  EXPECT_THAT(message("x,y,z,scale\n0,0,1,0\n", ", " + kBox),
              testing::HasSubstr("must be positive [-]"));
  EXPECT_THAT(message(kThree, R"(, "shape": "hull")"),
              EndsWith("particles[0].shape: the file is that of the particles; give a shape with a "
                       "file of its own in "
                       "the list shapes"));
  EXPECT_THAT(message(kThree, R"(, "radius": 0.1, "size": [1, 1, 1])"),
              EndsWith("particles[0].size: this key goes with a shape, and none is given; spheres "
                       "have a radius"));
  const std::string old = test::write_file("old.h5", "").string();
  EXPECT_THAT(
      refusal([&] {
        parsed(with_particles(R"({"layout": "file", "density": 1, "file": ")" + old + "\", " +
                              kBox + "}"));
      }),
      EndsWith("must be a .csv file: of checkpoints, spheres are read, and a shape is given"));
}

}  // namespace
}  // namespace scree
