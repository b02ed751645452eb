// walls.vtkhdf: the surfaces of walls at the times of the frames.

#include "host/io/wall_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "host/error.h"
#include "shapes/box.h"
#include "shapes/mesh.h"
#include "shapes/sphere.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/host/io/vtkhdf_rows.h"

namespace scree {
namespace {

using test::for_each_frame;
using test::number;
using test::rows;
using test::ScratchDirectory;
using testing::HasSubstr;

/// One frame as a reader of the format finds it (VTKHDF 2.0, PolyData with steps).
struct WallFrame {
  double time = 0;
  std::vector<double> points;
  std::vector<std::int64_t> offsets, connectivity, id;
  std::vector<std::int32_t> group;
  std::vector<std::uint8_t> kind;
};

std::vector<WallFrame> read_wall_frames(const std::filesystem::path& path) {
  std::vector<WallFrame> frames;
  for_each_frame(path, "Polygons", [&](const h5::Group& vtk, std::int64_t step, std::int64_t part) {
    const auto data = [&](const std::string& name) {
      return number(vtk, "Steps/CellDataOffsets/" + name, step);
    };
    const auto of_polygons = [&](const std::string& name) {
      return rows<std::int64_t>(vtk, name, step, 1)[2];
    };
    const std::int64_t points = number(vtk, "NumberOfPoints", part);
    const std::int64_t cells = number(vtk, "Polygons/NumberOfCells", part);
    const std::int64_t ids = number(vtk, "Polygons/NumberOfConnectivityIds", part);
    WallFrame frame;
    frame.time = rows<double>(vtk, "Steps/Values", step, 1)[0];
    frame.points = rows<double>(vtk, "Points", number(vtk, "Steps/PointOffsets", step), points);
    frame.offsets =
        rows<std::int64_t>(vtk, "Polygons/Offsets", of_polygons("Steps/CellOffsets"), cells + 1);
    frame.connectivity = rows<std::int64_t>(vtk, "Polygons/Connectivity",
                                            of_polygons("Steps/ConnectivityIdOffsets"), ids);
    frame.id = rows<std::int64_t>(vtk, "CellData/id", data("id"), cells);
    frame.group = rows<std::int32_t>(vtk, "CellData/group", data("group"), cells);
    frame.kind = rows<std::uint8_t>(vtk, "CellData/kind", data("kind"), cells);
    frames.push_back(frame);
  });
  return frames;
}

/// A free sphere, a fixed triangle and a kinematic box of 2 x 4 x 6.
Scene scene_with_walls() {
  Scene scene;
  scene.groups = {"bodies", "walls"};
  scene.bodies.resize(3);
  scene.bodies[0].shape.kind = shapes::Sphere::kind;
  scene.bodies[0].shape.radius = 0.1;
  scene.meshes.push_back({"m", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, false});
  scene.bodies[1].kind = BodyKind::fixed;
  scene.bodies[1].shape.kind = shapes::Mesh::kind;
  scene.bodies[1].shape.mesh = 0;
  scene.bodies[2].kind = BodyKind::kinematic;
  scene.bodies[2].shape.kind = shapes::Box::kind;
  scene.bodies[2].shape.half_extents = {1, 2, 3};
  scene.bodies[2].group = 1;
  return scene;
}

/// The box stands on x = `x`, turned about z by an angle.
BodyStates states_at(double x, double angle) {
  BodyStates states;
  states.position = {{9, 9, 9}, {0, 0, -5}, {x, 0, 0}};
  states.orientation.resize(3);
  states.orientation[2] = {std::cos(0.5 * angle), 0, 0, std::sin(0.5 * angle)};
  states.velocity.resize(3);
  states.angular_velocity.resize(3);
  return states;
}

/// The mean of the corners of one body's faces.
Vec3d middle(const WallFrame& frame, std::int64_t body, double* largest_x = nullptr) {
  Vec3d sum;
  double count = 0;
  for (std::size_t face = 0; face < frame.id.size(); ++face) {
    if (frame.id[face] != body) continue;
    for (std::int64_t k = frame.offsets[face]; k < frame.offsets[face + 1]; ++k) {
      const auto p = static_cast<std::size_t>(frame.connectivity[static_cast<std::size_t>(k)]);
      const Vec3d corner{frame.points[3 * p], frame.points[3 * p + 1], frame.points[3 * p + 2]};
      sum += corner;
      count += 1;
      if (largest_x != nullptr) *largest_x = std::max(*largest_x, corner.x);
    }
  }
  return (1 / count) * sum;
}

class WallFramesTest : public testing::Test {
 protected:
  std::uint64_t stored_points() { return h5::File::open(file).root().shape("VTKHDF/Points").rows; }
  ScratchDirectory directory;
  std::filesystem::path file = directory / "walls.vtkhdf";
  Scene scene = scene_with_walls();
};

TEST_F(WallFramesTest, WallsStandWhereTheyAreAtTheTimeOfTheFrame) {
  WallFrameWriter writer(file, scene);
  writer.append(0.0, states_at(0, 0));
  writer.append(0.5, states_at(7, 0));
  writer.append(1.0, states_at(7, std::numbers::pi / 2));
  const std::vector<WallFrame> frames = read_wall_frames(file);  // while the writer lives
  ASSERT_EQ(frames.size(), 3u);
  const double box_x[]{0, 7, 7}, box_end[]{1, 8, 9};  // turned, its longer side lies along x
  for (std::size_t k = 0; k < 3; ++k) {
    const WallFrame& frame = frames[k];
    EXPECT_EQ(frame.time, 0.5 * static_cast<double>(k));
    EXPECT_EQ(frame.id, (std::vector<std::int64_t>{1, 2, 2, 2, 2, 2, 2}));
    EXPECT_EQ(frame.group, (std::vector<std::int32_t>{0, 1, 1, 1, 1, 1, 1}));
    EXPECT_EQ(frame.kind, (std::vector<std::uint8_t>{1, 2, 2, 2, 2, 2, 2}));
    EXPECT_NEAR(norm(middle(frame, 1) - Vec3d{1.0 / 3, 1.0 / 3, -5}), 0, 1e-15);
    double largest_x = -1e300;
    EXPECT_NEAR(norm(middle(frame, 2, &largest_x) - Vec3d{box_x[k], 0, 0}), 0, 1e-14);
    EXPECT_NEAR(largest_x, box_end[k], 1e-14);
  }
}

TEST_F(WallFramesTest, FramesInWhichNothingMovesShareTheirCorners) {
  WallFrameWriter writer(file, scene);
  const double x[]{0, 0, 0, 1, 1, 0};
  for (int frame = 0; frame < 6; ++frame) writer.append(frame, states_at(x[frame], 0));
  writer.append(5, states_at(99, 0));  // the same time: not written again
  EXPECT_EQ(stored_points(), 3u * (3 + 8));
  const std::vector<WallFrame> frames = read_wall_frames(file);
  ASSERT_EQ(frames.size(), 6u);
  for (std::size_t frame = 0; frame < 6; ++frame)
    EXPECT_NEAR(middle(frames[frame], 2).x, x[frame], 1e-14) << frame;
}

TEST_F(WallFramesTest, ResumeDropsFramesAfterTheCheckpointAndGoesOn) {
  const auto position = [](int frame) { return frame < 4 ? 0.0 : 1.0 * frame; };
  for (const double time : {-1.0, 0.0, 2.5, 3.0, 5.0, 100.0}) {
    {
      WallFrameWriter writer(file, scene);
      for (int frame = 0; frame < 7; ++frame) writer.append(frame, states_at(position(frame), 0));
    }
    WallFrameWriter writer(file, scene, time);
    const int kept = time < 0 ? 0 : std::min(7, static_cast<int>(time) + 1);
    EXPECT_EQ(writer.frame_count(), kept);
    for (int frame = kept; frame < 9; ++frame) writer.append(frame, states_at(position(frame), 0));
    EXPECT_EQ(stored_points(), 11u * 6) << "the poses of 0, 4, 5, 6, 7 and 8 s";
    const std::vector<WallFrame> frames = read_wall_frames(file);
    ASSERT_EQ(frames.size(), 9u);
    for (int frame = 0; frame < 9; ++frame)
      EXPECT_NEAR(middle(frames[static_cast<std::size_t>(frame)], 2).x, position(frame), 1e-13);
  }
}

TEST_F(WallFramesTest, ResumeRefusesOtherFiles) {
  const auto refusal = [&](const Scene& other) -> std::string {
    try {
      WallFrameWriter writer(file, other, 1.0);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  test::put(file, "not HDF5");
  EXPECT_THAT(refusal(scene), HasSubstr(file.string()));
  {
    WallFrameWriter writer(file, scene);
    writer.append(0.0, states_at(0, 0));
  }
  EXPECT_EQ(refusal(scene), "");
  Scene other = scene;
  other.bodies[2].shape = {};
  other.bodies[2].shape.kind = shapes::Sphere::kind;
  other.bodies[2].shape.radius = 1;
  EXPECT_THAT(refusal(other), HasSubstr("other walls"));
}

TEST_F(WallFramesTest, ASceneWithoutWallsGetsNoFile) {
  scene.bodies.resize(1);
  WallFrameWriter writer(file, scene);
  writer.append(0.0, states_at(0, 0));
  EXPECT_FALSE(std::filesystem::exists(file));
}

}  // namespace
}  // namespace scree
