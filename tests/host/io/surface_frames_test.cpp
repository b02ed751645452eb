// surfaces.vtkhdf: the surfaces of free bodies at the times of the frames.

#include "host/io/surface_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include "host/compounds.h"
#include "host/error.h"
#include "host/hulls.h"
#include "shapes/rounded.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/host/io/vtkhdf_rows.h"
#include "tests/host/scene/shape_samples.h"

namespace scree {
namespace {

using test::for_each_frame;
using test::number;
using test::rows;
using test::ScratchDirectory;
using testing::HasSubstr;

/// One frame as a reader of the format finds it (VTKHDF 2.0, PolyData with steps).
struct SurfaceFrame {
  double time = 0;
  std::vector<float> points, speed;
  std::vector<std::int64_t> offsets, connectivity, id;
  std::vector<std::int32_t> group;
};

std::vector<SurfaceFrame> read_surface_frames(const std::filesystem::path& path) {
  std::vector<SurfaceFrame> frames;
  for_each_frame(path, "Polygons", [&](const h5::Group& vtk, std::int64_t step, std::int64_t part) {
    const auto of_polygons = [&](const std::string& name) {
      return rows<std::int64_t>(vtk, name, step, 1)[2];
    };
    const std::int64_t points = number(vtk, "NumberOfPoints", part);
    const std::int64_t cells = number(vtk, "Polygons/NumberOfCells", part);
    const std::int64_t ids = number(vtk, "Polygons/NumberOfConnectivityIds", part);
    SurfaceFrame frame;
    frame.time = rows<double>(vtk, "Steps/Values", step, 1)[0];
    frame.points = rows<float>(vtk, "Points", number(vtk, "Steps/PointOffsets", step), points);
    frame.speed = rows<float>(vtk, "PointData/speed",
                              number(vtk, "Steps/PointDataOffsets/speed", step), points);
    frame.offsets = rows<std::int64_t>(vtk, "Polygons/Offsets",
                                       of_polygons("Steps/CellOffsets") + part, cells + 1);
    frame.connectivity = rows<std::int64_t>(vtk, "Polygons/Connectivity",
                                            of_polygons("Steps/ConnectivityIdOffsets"), ids);
    frame.id = rows<std::int64_t>(vtk, "CellData/id", number(vtk, "Steps/CellDataOffsets/id", step),
                                  cells);
    frame.group = rows<std::int32_t>(vtk, "CellData/group",
                                     number(vtk, "Steps/CellDataOffsets/group", step), cells);
    frames.push_back(frame);
  });
  return frames;
}

/// What the faces of one body enclose, and its center of mass.
struct Inside {
  double volume = 0;
  Vec3d center;
  float speed = -1;
  std::int32_t group = -1;
};

std::map<std::int64_t, Inside> insides(const SurfaceFrame& frame) {
  std::map<std::int64_t, Inside> all;
  EXPECT_EQ(frame.offsets.front(), 0);
  EXPECT_EQ(frame.offsets.back(), std::ssize(frame.connectivity));
  for (std::size_t face = 0; face < frame.id.size(); ++face) {
    Inside& inside = all[frame.id[face]];
    const auto first = static_cast<std::size_t>(frame.offsets[face]);
    const auto end = static_cast<std::size_t>(frame.offsets[face + 1]);
    const auto corner = [&](std::size_t k) {
      const auto p = static_cast<std::size_t>(frame.connectivity[k]);
      inside.speed = frame.speed.at(p);
      return Vec3d{frame.points.at(3 * p), frame.points.at(3 * p + 1), frame.points.at(3 * p + 2)};
    };
    for (std::size_t k = first + 2; k < end; ++k) {
      const Vec3d a = corner(first), b = corner(k - 1), c = corner(k);
      const double volume = dot(a, cross(b, c)) / 6;
      inside.volume += volume;
      inside.center += volume / 4 * (a + b + c);
    }
    inside.group = frame.group[face];
  }
  for (auto& [id, inside] : all) inside.center = (1 / inside.volume) * inside.center;
  return all;
}

/// A wall, a free body of every shape, a set of three balls and one of two boxes, and a capsule and
/// two balls that join later.
class SurfaceFramesTest : public testing::Test {
 protected:
  SurfaceFramesTest() {
    scene.groups = {"bodies", "walls", "grains"};
    add(test::box_of({5, 5, 1}), 0).kind = BodyKind::fixed;
    volume.erase(0);
    add(test::ball_of(0.5), 4 * std::numbers::pi / 3 * 0.125);
    add(test::box_of({0.3, 0.2, 0.4}), 8 * 0.3 * 0.2 * 0.4);
    add(test::round_of("capsule", 0.3, 0.8),
        std::numbers::pi * 0.09 * 1 + 4 * std::numbers::pi / 3 * 0.027);
    add(test::round_of("cylinder", 0.3, 0.5), std::numbers::pi * 0.09);
    add(test::round_of("cone", 0.4, 0.6),
        std::numbers::pi * 0.16 * 0.8 / 3);  // 0.6 m above its center of mass
    add(test::ellipsoid_of({0.2, 0.3, 0.6}), 4 * std::numbers::pi / 3 * 0.036);
    BodyDescription& hull = add({}, 1.0 / 6);  // a corner of a cube, about its center of mass
    set_hull(scene, hull, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    BodyDescription& pair = add({}, 2 * 0.216 + 0.001);  // two cubes and a small one, apart
    set_compound(scene, pair,
                 {test::part(test::box_of({0.3, 0.3, 0.3}), {-0.5, 0, 0}),
                  test::part(test::box_of({0.3, 0.3, 0.3}), {0.5, 0, 0}),
                  test::part(test::box_of({0.05, 0.05, 0.05}), {0, 1, 0})});
    ParticleSet balls;
    balls.position.resize(3);
    balls.radius = PerParticle<double>(std::vector<double>{0.1, 0.2, 0.3});
    balls.group = PerParticle<int>(std::vector<int>{0, 2, 0});
    for (const double r : {0.1, 0.2, 0.3}) volume[ids++] = 4 * std::numbers::pi / 3 * r * r * r;
    ParticleSet boxes;
    boxes.position.resize(2);
    boxes.shape = test::box_of({0.1, 0.2, 0.3});
    boxes.group = 2;
    for (int k = 0; k < 2; ++k) volume[ids++] = 8 * 0.006;
    scene.particles = {balls, boxes};
    Insertion later;
    later.time = 1;
    later.bodies.push_back(scene.bodies[3]);
    volume[ids++] = volume[3];
    later.particles.push_back(balls);
    for (const double r : {0.1, 0.2, 0.3}) volume[ids++] = 4 * std::numbers::pi / 3 * r * r * r;
    scene.insertions = {later};
  }

  BodyDescription& add(const Shape& shape, double its_volume) {
    BodyDescription body;
    body.shape = shape;
    scene.bodies.push_back(body);
    volume[ids++] = its_volume;
    return scene.bodies.back();
  }

  /// Everything somewhere, turned somehow. @param bodies  that have been inserted
  static BodyStates states_at(unsigned seed, std::size_t bodies) {
    std::mt19937 random(seed);
    std::normal_distribution<double> x;
    BodyStates states;
    for (std::size_t i = 0; i < bodies; ++i) {
      states.position.push_back({x(random), x(random), x(random)});
      states.orientation.push_back(normalized(Quatd{x(random), x(random), x(random), x(random)}));
      states.velocity.push_back({x(random), x(random), x(random)});
    }
    states.angular_velocity.resize(bodies);
    return states;
  }

  /// Bodies of frame k: the last four join before the third.
  std::size_t bodies_of(int k) const { return static_cast<std::size_t>(k < 2 ? ids - 4 : ids); }
  void append(SurfaceFrameWriter& writer, int first, int end) const {
    for (int k = first; k < end; ++k)
      writer.append(k, states_at(static_cast<unsigned>(k), bodies_of(k)));
  }

  ScratchDirectory directory;
  std::filesystem::path file = directory / "surfaces.vtkhdf";
  Scene scene;
  std::map<std::int64_t, double> volume;  ///< of free bodies by id [m^3]
  int ids = 0;
};

TEST_F(SurfaceFramesTest, EveryFreeBodyIsWhereItIsWithItsVolume) {
  SurfaceFrameWriter writer(file, scene);
  append(writer, 0, 5);
  const std::vector<SurfaceFrame> frames = read_surface_frames(file);  // while the writer lives
  ASSERT_EQ(frames.size(), 5u);
  for (int k = 0; k < 5; ++k) {
    const SurfaceFrame& frame = frames[static_cast<std::size_t>(k)];
    EXPECT_EQ(frame.time, k);
    const BodyStates states = states_at(static_cast<unsigned>(k), bodies_of(k));
    const auto found = insides(frame);
    EXPECT_EQ(found.size(), bodies_of(k) - 1) << "all but the wall";
    for (const auto& [id, inside] : found) {
      SCOPED_TRACE(testing::Message() << "frame " << k << " body " << id);
      const auto i = static_cast<std::size_t>(id);
      const double ratio = inside.volume / volume.at(id);
      // Flat faces are exact but for the rounding of float; corners of others lie on the surface.
      const bool is_flat = id == 2 || id == 7 || id == 8 || id == 12 || id == 13;
      EXPECT_LT(ratio, 1 + 2e-6);
      EXPECT_GT(ratio, is_flat ? 1 - 2e-6 : 0.9);
      EXPECT_LT(norm(inside.center - states.position[i]), is_flat ? 1e-6 : 4e-3);
      EXPECT_FLOAT_EQ(inside.speed, static_cast<float>(norm(states.velocity[i])));
      EXPECT_EQ(inside.group, id == 10 || id == 12 || id == 13 || id == 16 ? 2 : 0);
    }
  }
}

TEST_F(SurfaceFramesTest, RoundedBodiesOfOneOuterSizeHaveSurfacesOfTheirOwn) {
  scene.particles.clear();
  scene.insertions.clear();
  scene.bodies.resize(3);
  const Vec3d outer{0.3, 0.2, 0.4};
  const auto core = [&](double radius) { return outer - Vec3d{radius, radius, radius}; };
  scene.bodies[0].shape = shapes::Rounded::of(test::box_of(core(0.02)), 0.02);
  scene.bodies[1].shape = shapes::Rounded::of(test::box_of(core(0.1)), 0.1);
  scene.bodies[2].shape = shapes::Rounded::of(test::ellipsoid_of(core(0.02)), 0.02);
  scene.bodies.emplace_back();
  set_hull(scene, scene.bodies[3], {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0.05);
  for (BodyDescription& body : scene.bodies) body.kind = BodyKind::free;
  SurfaceFrameWriter writer(file, scene);
  writer.append(0, states_at(1, scene.bodies.size()));
  const auto found = insides(read_surface_frames(file).at(0));
  ASSERT_EQ(found.size(), scene.bodies.size());
  for (const auto& [id, inside] : found) {
    const double ratio = inside.volume / scene.bodies[static_cast<std::size_t>(id)].shape.volume;
    EXPECT_LT(ratio, 1 + 1e-5) << id;
    EXPECT_GT(ratio, 0.9) << id;
  }
  // The sharper box is the larger one, by more than that.
  EXPECT_GT(found.at(0).volume, 1.05 * found.at(1).volume);
  EXPECT_GT(found.at(1).volume, 1.3 * found.at(2).volume);
}

TEST_F(SurfaceFramesTest, BodiesThatGiveWayAreAsTheyAre) {
  SurfaceFrameWriter writer(file, scene);
  BodyStates states = states_at(1, bodies_of(0));
  const double turned = 0.3, cosine = std::cos(turned), sine = std::sin(turned);
  states.axes.assign(states.position.size(),
                     {{{1.1 * cosine, 1.1 * sine, 0}, {-sine, cosine, 0}, {0.2, 0, 0.9}}});
  writer.append(0, states);
  const SurfaceFrame frame = read_surface_frames(file).at(0);
  std::set<std::array<int, 3>> corners;  // of the box, by the sides that they are on
  for (std::size_t face = 0; face < frame.id.size(); ++face) {
    if (frame.id[face] != 2) continue;
    for (std::int64_t k = frame.offsets[face]; k < frame.offsets[face + 1]; ++k) {
      const auto p = static_cast<std::size_t>(frame.connectivity[static_cast<std::size_t>(k)]);
      const Vec3d x = Vec3d{frame.points[3 * p], frame.points[3 * p + 1], frame.points[3 * p + 2]} -
                      states.position[2];
      // x = A X, from its last row on.
      const double own_z = x.z / 0.9;
      const Vec3d flat = x - own_z * states.axes[2][2];
      const double own_x = (cosine * flat.x + sine * flat.y) / 1.1;
      const double own_y = cosine * flat.y - sine * flat.x;
      EXPECT_NEAR(std::abs(own_x), 0.3, 1e-6);
      EXPECT_NEAR(std::abs(own_y), 0.2, 1e-6);
      EXPECT_NEAR(std::abs(own_z), 0.4, 1e-6);
      corners.insert({own_x > 0, own_y > 0, own_z > 0});
    }
  }
  EXPECT_EQ(corners.size(), 8u);
  states.axes.pop_back();
  EXPECT_THROW(writer.append(1, states), RunError);
}

TEST_F(SurfaceFramesTest, BodiesTurn) {
  SurfaceFrameWriter writer(file, scene);
  BodyStates states = states_at(1, bodies_of(0));
  states.position[2] = {};
  states.orientation[2] = {std::cos(std::numbers::pi / 4), 0, 0,
                           std::sin(std::numbers::pi / 4)};  // a quarter about z
  writer.append(0, states);
  const SurfaceFrame frame = read_surface_frames(file).at(0);
  Vec3d most;
  for (std::size_t face = 0; face < frame.id.size(); ++face) {
    if (frame.id[face] != 2) continue;
    for (std::int64_t k = frame.offsets[face]; k < frame.offsets[face + 1]; ++k) {
      const auto p = static_cast<std::size_t>(frame.connectivity[static_cast<std::size_t>(k)]);
      for (int axis = 0; axis < 3; ++axis)
        most[axis] =
            std::max<double>(most[axis], frame.points[3 * p + static_cast<std::size_t>(axis)]);
    }
  }
  EXPECT_LT(norm(most - Vec3d{0.2, 0.3, 0.4}), 1e-6);
}

TEST_F(SurfaceFramesTest, SizeIsThatOfTheFile) {
  const SurfaceSize size = surface_size(scene);
  EXPECT_EQ(size.bodies, volume.size());
  SurfaceFrameWriter writer(file, scene);
  append(writer, 0, 3);
  const SurfaceFrame frame = read_surface_frames(file).back();
  EXPECT_EQ(size.corners, frame.speed.size());
  EXPECT_EQ(size.faces, frame.id.size());
  EXPECT_EQ(size.face_corners, frame.connectivity.size());
}

TEST_F(SurfaceFramesTest, ResumeDropsFramesAfterTheCheckpointAndGoesOn) {
  {
    SurfaceFrameWriter writer(file, scene);
    append(writer, 0, 7);
  }
  const std::vector<SurfaceFrame> whole = read_surface_frames(file);
  const auto stored = [&] { return h5::File::open(file).root().shape("VTKHDF/Points").rows; };
  const std::uint64_t points = stored();
  for (const double time : {-1.0, 0.0, 1.0, 2.5, 3.0, 100.0}) {
    SCOPED_TRACE(time);
    {
      SurfaceFrameWriter writer(file, scene);
      append(writer, 0, 5);
    }
    SurfaceFrameWriter writer(file, scene, time);
    const int kept = time < 0 ? 0 : std::min(5, static_cast<int>(time) + 1);
    EXPECT_EQ(writer.frame_count(), kept);
    append(writer, kept, 7);
    append(writer, 6, 7);  // the same time: not written again
    EXPECT_EQ(stored(), points);
    const std::vector<SurfaceFrame> frames = read_surface_frames(file);
    ASSERT_EQ(frames.size(), whole.size());
    for (std::size_t k = 0; k < frames.size(); ++k) {
      EXPECT_EQ(frames[k].points, whole[k].points) << k;
      EXPECT_EQ(frames[k].speed, whole[k].speed) << k;
      EXPECT_EQ(frames[k].connectivity, whole[k].connectivity) << k;
      EXPECT_EQ(frames[k].offsets, whole[k].offsets) << k;
      EXPECT_EQ(frames[k].id, whole[k].id) << k;
    }
  }
}

TEST_F(SurfaceFramesTest, ResumeRefusesOtherFiles) {
  const auto refusal = [&](const Scene& other) -> std::string {
    try {
      SurfaceFrameWriter writer(file, other, 1.0);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  test::put(file, "not HDF5");
  EXPECT_THAT(refusal(scene), HasSubstr(file.string()));
  {
    SurfaceFrameWriter writer(file, scene);
    append(writer, 0, 2);
  }
  EXPECT_EQ(refusal(scene), "");
  Scene other = scene;
  other.bodies[1].shape = test::box_of({1, 1, 1});
  EXPECT_THAT(refusal(other), HasSubstr("other bodies"));
}

TEST_F(SurfaceFramesTest, AFrameBeforeTheFirstFreeBodyIsLeftOut) {
  scene.bodies.resize(1);
  scene.particles.clear();
  ids = 5;
  SurfaceFrameWriter writer(file, scene);
  writer.append(0, states_at(0, 1));
  EXPECT_FALSE(std::filesystem::exists(file));
  writer.append(2, states_at(0, 5));
  EXPECT_EQ(read_surface_frames(file).size(), 1u);
}

TEST_F(SurfaceFramesTest, ASceneWithoutFreeBodiesGetsNoFile) {
  scene.bodies.resize(1);
  scene.particles.clear();
  scene.insertions.clear();
  SurfaceFrameWriter writer(file, scene);
  writer.append(0, states_at(0, 1));
  EXPECT_FALSE(std::filesystem::exists(file));
}

TEST(SurfaceSizes, TooManyAreRefused) {
  require_surface_size({.bodies = 1, .corners = kMostSurfaceCorners});
  try {
    require_surface_size({.bodies = 7, .corners = kMostSurfaceCorners + 1});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "output.surface_frames: true is not allowed: 7 bodies have 2000000001 corners, "
                 "must be 2000000000 at most");
  }
}

}  // namespace
}  // namespace scree
