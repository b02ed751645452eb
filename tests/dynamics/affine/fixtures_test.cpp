// The public scenes of rigid-ipc and of Autodesk's Affine Body Dynamics, which are not part of the source tree: after every step no
// triangles touch, without rounding, and the search finds what a plain one finds.

#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <set>
#include <thread>

#include "dynamics/affine/affine_card.h"
#include "host/error.h"
#include "host/scene_reader.h"
#include "kernels/backend/cpu.h"
#include "tests/box_mesh.h"
#include "tests/dynamics/affine/brute_pairs.h"
#include "tests/dynamics/affine/exact_surfaces.h"
#include "tests/dynamics/affine_scenes.h"
#include "tests/physics/long_tests.h"
#include "tests/physics/shared_data.h"
#include "tests/refused_scenes.h"

namespace scree::affine {
namespace {

/// Below the folder of both.
constexpr const char* kFixtures[] = {
    "fixtures/3D/blender/blender-1.json",
    "fixtures/3D/blender/blender-10.json",
    "fixtures/3D/blender/blender-100.json",
    "fixtures/3D/chain/10-links.json",
    "fixtures/3D/chain/3-links.json",
    "fixtures/3D/chain/chain-net/chain-net-16x16-ball.json",
    "fixtures/3D/chain/chain-net/chain-net-4x4.json",
    "fixtures/3D/chain/chain-net/chain-net-8x8.json",
    "fixtures/3D/chain/wrecking-ball.json",
    "fixtures/3D/examples/concave.json",
    "fixtures/3D/examples/example.json",
    "fixtures/3D/examples/kinematic.json",
    "fixtures/3D/examples/kinematically-scripted.json",
    "fixtures/3D/examples/split-components.json",
    "fixtures/3D/fracture/cube.json",
    "fixtures/3D/friction/arch/arch-101-stones.json",
    "fixtures/3D/friction/arch/arch-25-stones.json",
    "fixtures/3D/friction/incline-plane/incline-plane-15°.json",
    "fixtures/3D/friction/incline-plane/incline-plane-45°.json",
    "fixtures/3D/friction/incline-plane/slopeTest_highSchoolPhysics_mu=0.49.json",
    "fixtures/3D/friction/incline-plane/slopeTest_highSchoolPhysics_mu=0.5.json",
    "fixtures/3D/friction/rolling/oloid.json",
    "fixtures/3D/friction/sliding.json",
    "fixtures/3D/friction/spolling-coin.json",
    "fixtures/3D/friction/turntable/turntable-mu=0.0.json",
    "fixtures/3D/friction/turntable/turntable-mu=0.5.json",
    "fixtures/3D/mechanisms/507-movements/092-piston.json",
    "fixtures/3D/mechanisms/507-movements/140-punching-press.json",
    "fixtures/3D/mechanisms/bolt.json",
    "fixtures/3D/mechanisms/gears/chain.json",
    "fixtures/3D/mechanisms/gears/single.json",
    "fixtures/3D/minimum-separation/cube-falling-on-edge.json",
    "fixtures/3D/pendulum/double-pendulum.json",
    "fixtures/3D/pendulum/pendulum.json",
    "fixtures/3D/piles/cone.json",
    "fixtures/3D/piles/plane.json",
    "fixtures/3D/scalability/weak/01threads.json",
    "fixtures/3D/scalability/weak/08threads.json",
    "fixtures/3D/unit-tests/5-cubes.json",
    "fixtures/3D/unit-tests/edge-edge.json",
    "fixtures/3D/unit-tests/erleben/cliff-edges.json",
    "fixtures/3D/unit-tests/erleben/internal-edges.json",
    "fixtures/3D/unit-tests/erleben/sliding-spike.json",
    "fixtures/3D/unit-tests/erleben/spike-in-hole.json",
    "fixtures/3D/unit-tests/erleben/wedges.json",
    "fixtures/3D/unit-tests/face-vertex.json",
    "fixtures/3D/unit-tests/large-mass-ratio.json",
    "fixtures/3D/unit-tests/rotation/dzhanibekov.json",
    "fixtures/3D/unit-tests/rotation/rotating-cube.json",
    "fixtures/3D/unit-tests/rotation/rotating-sphere.json",
    "fixtures/3D/unit-tests/rotation/torque-test.json",
    "fixtures/3D/unit-tests/spinning-cube-over-plane.json",
    "fixtures/3D/unit-tests/tessellated-plane/two-triangles.json",
    "fixtures/3D/unit-tests/tet-corner.json",
    "fixtures/3D/unit-tests/tunnel/2-walls.json",
    "fixtures/3D/unit-tests/tunneling.json",
    "fixtures/3D/unit-tests/vertex-face.json",
    "autodesk_abd/inputs/cube_drop/cube_drop.json",
    "autodesk_abd/inputs/gear_assembly_offset/gear_offset_rotating.json",
    "autodesk_abd/inputs/peg/peg_insertion.json",
    "autodesk_abd/inputs/simple_joint/simple_joint.json",
    "autodesk_abd/inputs/simple_tets/tets.json",
    "autodesk_abd/inputs/slope/slope.json",
    "autodesk_abd/inputs/wreck_ball/wreck_ball.json",
};

std::filesystem::path fixture_file(const std::string& name) {
  return physics::shared_file("rigid_ipc/" + name);
}

int triangle_count(const AffineSetup& setup) {
  std::size_t count = 0;
  for (const int surface : setup.surface_of_body)
    count += setup.surfaces[static_cast<std::size_t>(surface)]->triangles.size();
  return static_cast<int>(count);
}

/// Ten of the first steps, or all where there are less.
std::set<long> ten_of(long steps) {
  std::mt19937 random(11);
  std::set<long> chosen;
  while (std::ssize(chosen) < std::min(10L, steps))
    chosen.insert(std::uniform_int_distribution<long>(0, steps - 1)(random));
  return chosen;
}

/// How far a run goes: all steps in a long test, or for so many seconds where the variable says so; else some that
/// take a second or two.
struct FixtureLength {
  long steps = 0;
  double seconds = 1e300;
  std::set<long> searched;  ///< steps whose search is held against a plain one

  FixtureLength(const Scene& scene, int triangles, bool compares) {
    const long all = std::lround(scene.stepping.duration / scene.stepping.time_step);
    const long some = std::min(all, std::clamp(100000L / triangles, 10L, 200L));
    if (compares) searched = ten_of(some);
    steps = some;
    if (!physics::runs_long_tests()) return;
    steps = all;
    if (compares) searched.merge(ten_of(all));
    if (const char* limit = std::getenv("SCREE_FIXTURE_SECONDS")) seconds = std::atof(limit);
  }
};

/// Where runs step: on a GPU where the variable says so, whose search its own tests hold to that of a processor.
bool steps_on_gpu() { return std::getenv("SCREE_FIXTURES_ON_GPU") != nullptr; }

class AffineFixtures : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(fixture_file(GetParam())))
      GTEST_SKIP() << fixture_file(GetParam()).string() << " is not there: " << GetParam()
                   << " is not run";
  }
};

/// Holds the search of a step against a plain one, and its least gap. @return how many pairs it found
std::size_t compare_search(const AffineSetup& setup, const std::vector<AffineVec>& from,
                           const std::vector<AffineVec>& to, double distance, double gap) {
  const SearchedBodies bodies{setup.surfaces, setup.surface_of_body, setup.collision_group,
                              setup.held_pairs};
  Cpu cpu(1);
  const SurfaceTables<Cpu> tables(cpu, setup.surfaces, setup.surface_of_body, setup.collision_group,
                                  setup.held_pairs);
  NearPairs<Cpu> near(cpu);
  Buffer<Cpu, AffineVec> at(cpu), there(cpu);
  upload(cpu, from, at), upload(cpu, to, there);
  const auto n = static_cast<Offset>(from.size());
  near.build(cpu, tables, std::as_const(at).view(n), std::as_const(there).view(n), distance);
  const std::vector<NamedPair> found = named_pairs(cpu, near.view(), bodies);
  const ExpectedPairs expected = expected_pairs(bodies, from, to, distance);
  expect_pairs(found, expected);
  if (expected.gap < distance) {
    EXPECT_NEAR(gap, expected.gap, 1e-6 * expected.gap + 1e-14 * setup.farthest);
  }
  return found.size();
}

TEST_P(AffineFixtures, NoTrianglesTouchAndNoPairIsMissed) {
  const Scene scene = read_scene(fixture_file(GetParam()), {});
  const AffineSetup setup = affine_setup(scene);
  const FixtureLength length(scene, triangle_count(setup), !steps_on_gpu());
  WorldOptions options = test::cpu_options();
  if (steps_on_gpu()) options.backend = BackendKind::cuda;
  World world(scene, options);
  const int threads =
      steps_on_gpu() ? std::max(1, static_cast<int>(std::thread::hardware_concurrency())) : 1;
  std::vector<AffineVec> places = places_of(setup, world);
  ASSERT_TRUE(touching_bodies(setup, places).empty()) << "at the start";
  const double reach =
      kReach.of(scene.dynamics.parameters) + kSeparation.of(scene.dynamics.parameters);
  double least_gap = 1e300, tried = 0;  // [m], [s]
  long step = 0, above_tolerance = 0, in_reach = 0;
  std::size_t frames = 0, pairs = 0, largest = 0;
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  for (; step < length.steps && seconds() < length.seconds; ++step) {
    const StepReport report = world.step();
    const std::vector<AffineVec> before = std::exchange(places, places_of(setup, world));
    const double gap = report.own[kMinGapColumn];
    ASSERT_GT(gap, 0) << "step " << step;
    const double stepped = seconds();
    ASSERT_EQ(touching_bodies(setup, places, threads), (std::vector<std::array<Index, 2>>{}))
        << "step " << step;
    tried += seconds() - stepped;
    least_gap = std::min(least_gap, gap);
    if (!report.converged) ++above_tolerance;
    if (report.contact_count > 0) ++in_reach;
    if (length.searched.count(step) == 0) continue;
    const std::size_t found = compare_search(setup, before, places, reach, gap);
    ASSERT_FALSE(HasFailure()) << "step " << step;
    ++frames, pairs += found, largest = std::max(largest, found);
  }
  std::printf(
      "[ fixture  ] %s: %ld of %ld steps, %ld with contacts, 0 touch, least gap %.2g m, %ld above "
      "tolerance; %zu searches as the plain one, %zu pairs, at most %zu; %.0f s, %.0f of them to "
      "try triangles\n",
      GetParam(), step, std::lround(scene.stepping.duration / scene.stepping.time_step), in_reach,
      least_gap, above_tolerance, frames, pairs, largest, seconds(), tried);
  if (!steps_on_gpu()) {
    EXPECT_EQ(frames < 10, step < 10);
  }
}

std::string test_name(const ::testing::TestParamInfo<const char*>& info) {
  std::string name = std::filesystem::path(info.param).stem().string();
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return std::to_string(info.index) + "_" + name;
}
INSTANTIATE_TEST_SUITE_P(Public, AffineFixtures, ::testing::ValuesIn(kFixtures), test_name);

class AffineRefusedFixtures : public AffineFixtures {};

TEST_P(AffineRefusedFixtures, AreRefusedByName) {
  try {
    World(read_scene(fixture_file(GetParam()), {}), test::cpu_options());
    FAIL() << "not refused";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find(std::filesystem::path(GetParam()).filename().string() +
                        ": rigid_body_problem.rigid_bodies["),
              std::string::npos)
        << error.what();
  }
}
INSTANTIATE_TEST_SUITE_P(Public, AffineRefusedFixtures, ::testing::ValuesIn(kRefusedScenes),
                         test_name);

// What says that no triangles touch, against all pairs of triangles one by one.
TEST(AffineExactSurfaces, TouchWhereAnyOfTheirTrianglesDo) {
  const TriangleMesh box = scree::test::box_mesh({0.3, 0.2, 0.1});
  AffineSetup setup;
  setup.surfaces = {std::make_shared<const Surface>(make_surface(box, {}))};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  std::vector<AffineVec> places;
  for (int b = 0; b < 60; ++b) {
    const Quatd turn = exp_map(3 * Vec3d{place(random), place(random), place(random)});
    places.push_back(pose_coordinates({{place(random), place(random), place(random)}, turn}));
    setup.surface_of_body.push_back(0);
    setup.id_of_body.push_back(b);
    setup.collision_group.push_back(b % 10 == 0 ? 1 : -1);
  }
  places[2] = places[1];
  places[2].node[0] += 0.6 * places[1].node[1];  // face to face, or apart by rounding
  std::vector<std::array<Index, 2>> expected;
  const auto triangle = [&](Index body, const std::array<int, 3>& t) {
    exact::Triangle corners;
    for (std::size_t c = 0; c < 3; ++c)
      corners[c] = point_of(places[static_cast<std::size_t>(body)],
                            box.vertices[static_cast<std::size_t>(t[c])]);
    return corners;
  };
  for (Index a = 0; a < std::ssize(places); ++a)
    for (Index b = a + 1; b < std::ssize(places); ++b) {
      bool touch = false;
      for (const auto& s : box.triangles)
        for (const auto& t : box.triangles)
          touch = touch || exact::triangles_touch(triangle(a, s), triangle(b, t));
      if (touch && may_touch(setup, a, b)) expected.push_back({a, b});
    }
  std::vector<std::array<Index, 2>> found = touching_bodies(setup, places);
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found, expected);
  EXPECT_GT(found.size(), 50u);
  EXPECT_LT(found.size(), 1000u);
}

// A corner that is in the plane of a face touches it, and is apart from it one rounding farther.
TEST(AffineExactSurfaces, AreApartByOneRounding) {
  const TriangleMesh box = scree::test::box_mesh({0.5, 0.5, 0.5});
  AffineSetup setup;
  setup.surfaces = {std::make_shared<const Surface>(make_surface(box, {}))};
  setup.surface_of_body = {0, 0}, setup.id_of_body = {0, 1}, setup.collision_group = {-1, -1};
  std::vector<AffineVec> places(2, pose_coordinates({}));
  places[1].node[0] = {1, 0.25, 0.125};
  EXPECT_EQ(touching_bodies(setup, places).size(), 1u);
  places[1].node[0].x = std::nextafter(1.0, 2.0);
  EXPECT_TRUE(touching_bodies(setup, places).empty());
}

// No file of the folder is left out.
TEST(AffineFixtureList, HasAllScenesThatThereAre) {
  std::set<std::string> listed;
  for (const char* name : kFixtures) listed.insert(fixture_file(name).string());
  for (const char* name : kRefusedScenes) listed.insert(fixture_file(name).string());
  if (!std::filesystem::exists(fixture_file("fixtures")))
    GTEST_SKIP() << fixture_file("fixtures").string() << " is not there";
  std::size_t count = 0;
  for (const char* folder : {"fixtures", "autodesk_abd/inputs"})
    for (const auto& entry : std::filesystem::recursive_directory_iterator(fixture_file(folder)))
      if (entry.path().extension() == ".json") {
        EXPECT_EQ(listed.count(entry.path().string()), 1u) << entry.path();
        ++count;
      }
  EXPECT_EQ(count, listed.size());
}

}  // namespace
}  // namespace scree::affine
