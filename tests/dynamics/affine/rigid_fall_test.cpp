// Public scenes of one free body and a fixed one, without friction, against a true rigid body that is stepped as rigid-ipc does: no
// trajectories of rigid-ipc itself come with the scenes. They are not part of the source tree.

#include <gtest/gtest.h>

#include <filesystem>

#include "dynamics/affine/affine_card.h"
#include "host/scene_reader.h"
#include "tests/affine_reference/rigid_among_fixed.h"
#include "tests/dynamics/affine/exact_surfaces.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/physics/long_tests.h"
#include "tests/physics/shared_data.h"

namespace scree::affine {
namespace {

spatial::Vec3 spatial_vector(const Vec3d& v) { return {v.x, v.y, v.z}; }
spatial::Mat3 axes_of(const AffineVec& q) {
  spatial::Mat3 m;
  for (int k = 0; k < 3; ++k) m.col(k) = spatial_vector(q.node[k + 1]);
  return m;
}

/// @param origin  what corners are from
spatial::TriangleSurface spatial_surface(const AffineSetup& setup, std::size_t body,
                                         const Vec3d& origin) {
  const Surface& surface = *setup.surfaces[static_cast<std::size_t>(setup.surface_of_body[body])];
  spatial::TriangleSurface s;
  for (const Vec3d& v : surface.vertices)
    s.corners.push_back(spatial_vector(point_of(setup.position[body], v) - origin));
  s.edges = surface.edges, s.triangles = surface.triangles;
  return s;
}

struct RigidFall {
  double place = 0;             ///< how far both are apart, at most of all steps [m]
  double angle = 0;             ///< [rad]
  double turned = 0;            ///< sum of the turns of all steps of the rigid one [rad]
  spatial::Vec3 went{0, 0, 0};  ///< [m]
};

/// @pre the first body is free, the second fixed
RigidFall fall_beside_a_rigid_one(Scene scene, int steps) {
  scene.dynamics.parameters["tolerance"] = 1e-6;
  const AffineSetup setup = affine_setup(scene);
  const AffineVec& first = setup.position[0];
  const AffineMass& mass = setup.bodies[0].mass;
  const Sym3<double>& s = mass.second;
  spatial::Mat3 second;
  second << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  const spatial::Mat3 axes = axes_of(first);
  spatial::FallingSettings settings;
  settings.h = scene.stepping.time_step;
  settings.gravity = spatial_vector(scene.gravity);
  settings.reach = kReach.of(scene.dynamics.parameters);
  settings.stiffness = spatial::inertial_stiffness(settings, mass.mass, 3);
  spatial::RigidAmongFixed rigid(settings, spatial_surface(setup, 0, first.node[0]), mass.mass,
                                 axes * second * axes.transpose(), spatial_vector(first.node[0]),
                                 spatial_surface(setup, 1, {}));
  World world(scene, test::cpu_options());
  RigidFall fall;
  for (int k = 0; k < steps; ++k) {
    const spatial::Mat3 before = rigid.rotation();
    rigid.step();
    EXPECT_TRUE(world.step().converged) << k;
    const AffineVec at = places_of(setup, world)[0];
    fall.place = std::max(fall.place, (spatial_vector(at.node[0]) - rigid.center()).norm());
    const spatial::Mat3 off = axes_of(at) * axes.transpose() * rigid.rotation().transpose();
    fall.angle = std::max(fall.angle, Eigen::AngleAxisd(off).angle());
    fall.turned += Eigen::AngleAxisd(spatial::Mat3(rigid.rotation() * before.transpose())).angle();
  }
  fall.went = rigid.center() - spatial_vector(first.node[0]);
  return fall;
}

/// A bolt that turns into its nut by its weight.
TEST(AffineRigidFall, OfABoltInItsNut) {
  const auto file = physics::shared_file("rigid_ipc/fixtures/3D/mechanisms/bolt.json");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const bool is_long = physics::runs_long_tests();
  const RigidFall fall = fall_beside_a_rigid_one(read_scene(file, {}), is_long ? 75 : 35);
  EXPECT_LT(fall.place, 3e-6);
  EXPECT_LT(fall.angle, 1e-4);
  EXPECT_GT(fall.turned, is_long ? 7 : 1.5);
  EXPECT_LT(fall.went.y(), is_long ? -0.015 : -3e-3);
}

/// An arm that falls from level on a pin, of which its hole leaves 0.4 mm about and 0.25 mm along, and swings through 2.8 rad.
TEST(AffineRigidFall, OfAPendulumInItsFirstSecond) {
  const auto file = physics::shared_file("rigid_ipc/fixtures/3D/pendulum/pendulum.json");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const RigidFall fall = fall_beside_a_rigid_one(read_scene(file, {}), 100);
  EXPECT_LT(fall.place, 6e-5);
  EXPECT_LT(fall.angle, 2e-4);
  EXPECT_GT(fall.turned, 4);
}

}  // namespace
}  // namespace scree::affine
