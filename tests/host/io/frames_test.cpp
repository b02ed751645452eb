#include "host/io/frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <random>
#include <thread>

#include "host/error.h"
#include "host/io/h5.h"
#include "shapes/box.h"
#include "shapes/capsule.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/host/io/vtkhdf_rows.h"

namespace scree {
namespace {

using test::for_each_frame;
using test::number;
using test::rows;
using test::scene_with;
using test::ScratchDirectory;
using test::states_of;
using testing::HasSubstr;

constexpr Precision single = Precision::single_precision;

/// One frame as a reader of the format finds it.
struct Frame {
  double time = 0;
  std::vector<double> points;
  std::vector<float> velocity;
  std::vector<float> speed;
  std::vector<std::int64_t> id;
  std::vector<double> mass;
  std::vector<std::int64_t> offsets;
  std::vector<std::int64_t> connectivity;
};

std::vector<Frame> read_frames(const std::filesystem::path& path) {
  std::vector<Frame> frames;
  for_each_frame(path, "Vertices", [&](const h5::Group& vtk, std::int64_t step, std::int64_t part) {
    const auto data_offset = [&](const std::string& name) {
      return number(vtk, "Steps/PointDataOffsets/" + name, step);
    };
    const std::int64_t points = number(vtk, "NumberOfPoints", part);
    const std::int64_t cells = number(vtk, "Vertices/NumberOfCells", part);
    const std::int64_t ids = number(vtk, "Vertices/NumberOfConnectivityIds", part);
    Frame frame;
    frame.time = rows<double>(vtk, "Steps/Values", step, 1)[0];
    frame.points = rows<double>(vtk, "Points", number(vtk, "Steps/PointOffsets", step), points);
    frame.velocity = rows<float>(vtk, "PointData/velocity", data_offset("velocity"), points);
    frame.speed = rows<float>(vtk, "PointData/speed", data_offset("speed"), points);
    frame.id = rows<std::int64_t>(vtk, "PointData/id", data_offset("id"), points);
    frame.mass = rows<double>(vtk, "PointData/mass", data_offset("mass"), points);
    // The offsets of a part begin one entry later for each part before it.
    frame.offsets = rows<std::int64_t>(vtk, "Vertices/Offsets",
                                       number(vtk, "Steps/CellOffsets", step) + part, cells + 1);
    frame.connectivity = rows<std::int64_t>(vtk, "Vertices/Connectivity",
                                            number(vtk, "Steps/ConnectivityIdOffsets", step), ids);
    frames.push_back(frame);
  });
  return frames;
}

void expect_frame(const Frame& frame, int number, int bodies) {
  EXPECT_EQ(frame.time, number * 0.5);
  ASSERT_EQ(frame.points.size(), 3u * static_cast<unsigned>(bodies));
  ASSERT_EQ(frame.connectivity.size(), static_cast<unsigned>(bodies));
  ASSERT_EQ(frame.offsets.size(), static_cast<unsigned>(bodies) + 1);
  EXPECT_EQ(frame.offsets[0], 0);
  for (int i = 0; i < bodies; ++i) {
    const auto k = static_cast<std::size_t>(i);
    ASSERT_EQ(frame.points[3 * k], number + 0.25);
    ASSERT_EQ(frame.points[3 * k + 1], i + 0.125);
    ASSERT_EQ(frame.velocity[3 * k + 2], static_cast<float>(4.0 * number));
    ASSERT_EQ(frame.speed[k], static_cast<float>(5.0 * number));
    ASSERT_EQ(frame.id[k], i);
    ASSERT_EQ(frame.mass[k], i == 1 ? 0.0 : 2.0 + i);
    ASSERT_EQ(frame.connectivity[k], i);
    ASSERT_EQ(frame.offsets[k + 1], i + 1);
  }
}

/// Bodies of frame f: some at the start, and a batch now and then.
int growing_count(int frame) { return 5 + 3 * (frame / 2); }

class FramesTest : public testing::Test {
 protected:
  void append(FrameWriter& writer, int frame) {
    writer.append(frame * 0.5, states_of(frame, growing_count(frame)));
  }
  std::size_t file_count() {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(directory.path()), {}));
  }
  ScratchDirectory directory;
  std::filesystem::path file = directory / "frames.vtkhdf";
  Scene scene = scene_with(5, 10, 3);
};

TEST_F(FramesTest, ReadBackWithGrowingBodyCounts) {
  std::optional<FrameWriter> writer(std::in_place, file, scene, single);
  for (int frame = 0; frame < 9; ++frame) append(*writer, frame);
  const std::vector<Frame> frames = read_frames(file);  // while the writer lives
  ASSERT_EQ(frames.size(), 9u);
  for (int frame = 0; frame < 9; ++frame)
    expect_frame(frames[static_cast<std::size_t>(frame)], frame, growing_count(frame));
  writer.reset();
  EXPECT_EQ(file_count(), 1u);
}

TEST_F(FramesTest, MayWaitUntilTheyArePublished) {
  constexpr int kFrames = 60;
  const std::filesystem::path killed = directory / "killed.vtkhdf";
  const auto count = [](int frame) { return std::min(growing_count(frame), 18); };
  const auto add = [&](FrameWriter& writer, int frame) {
    writer.append(frame * 0.5, states_of(frame, count(frame)));
  };
  const auto expect_frames = [&](std::size_t least) {
    const std::vector<Frame> frames = read_frames(file);
    EXPECT_GE(frames.size(), least);
    for (std::size_t k = 0; k < frames.size(); ++k)
      expect_frame(frames[k], static_cast<int>(k), count(static_cast<int>(k)));
    return frames.size();
  };
  {
    FrameWriter writer(file, scene, single);
    writer.publish_seldom();
    for (int frame = 0; frame < kFrames; ++frame) {
      add(writer, frame);
      if (frame % 7 == 0) expect_frames(1);  // what is there is whole
      if (frame != 20) continue;
      writer.publish();
      EXPECT_EQ(expect_frames(21), 21u);
      std::filesystem::copy_file(file, killed);  // what a killed run leaves at the least
    }
    EXPECT_EQ(writer.frame_count(), kFrames);
  }
  EXPECT_EQ(expect_frames(kFrames), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(file_count(), 2u);
  std::filesystem::rename(killed, file);
  FrameWriter resumed(file, scene, single, 7.0);
  EXPECT_EQ(resumed.frame_count(), 15);
  resumed.publish_seldom();
  for (int frame = 15; frame < kFrames; ++frame) add(resumed, frame);
  resumed.publish();
  EXPECT_EQ(expect_frames(kFrames), static_cast<std::size_t>(kFrames));
}

TEST_F(FramesTest, OneBodyAndManyBodies) {
  for (const int bodies : {1, 33, 200000}) {  // the last spans several chunks
    FrameWriter writer(file, scene_with(bodies, 0, 0), single);
    for (int frame = 0; frame < 3; ++frame) writer.append(frame * 0.5, states_of(frame, bodies));
    const std::vector<Frame> frames = read_frames(file);
    ASSERT_EQ(frames.size(), 3u);
    for (int frame = 0; frame < 3; ++frame)
      expect_frame(frames[static_cast<std::size_t>(frame)], frame, bodies);
  }
}

TEST_F(FramesTest, TopologyIsStoredOncePerBodyCount) {
  FrameWriter writer(file, scene_with(100, 0, 0), single);
  for (int frame = 0; frame < 20; ++frame) writer.append(frame, states_of(frame, 100));
  const h5::File h5 = h5::File::open(file);
  EXPECT_EQ(h5.root().shape("VTKHDF/Vertices/Offsets").rows, 101u);
}

TEST_F(FramesTest, DoubleRunsKeepAllDigits) {
  BodyStates states = states_of(1, 5);
  const double third = 1.0 / 3;
  states.velocity[2] = {third, 0, 0};
  states.angular_velocity[2] = {0, third, 0};
  states.orientation[2] = {third, 0, 0, std::sqrt(1 - third * third)};
  Scene spheres = scene_with(5, 0, 0);
  spheres.bodies[2].shape.radius = third;
  {
    FrameWriter writer(file, spheres, Precision::double_precision);
    writer.append(0.5, states);
  }
  {
    const h5::File h5 = h5::File::open(file);
    const h5::Group data = h5.root().open_group("VTKHDF/PointData");
    EXPECT_EQ(data.read<double>("velocity").at(6), third);
    EXPECT_EQ(data.read<double>("angular_velocity").at(7), third);
    EXPECT_EQ(data.read<double>("orientation").at(8), third);
    EXPECT_EQ(data.read<double>("speed").at(2), third);
    EXPECT_EQ(data.read<double>("radius").at(2), third);
  }
  EXPECT_NO_THROW(FrameWriter(file, spheres, Precision::double_precision, 1.0));
  EXPECT_THROW(FrameWriter(file, spheres, single, 1.0), InputError);
}

/// Sizes of particles are where those of bodies are.
TEST_F(FramesTest, ParticlesHaveTheConstantsOfTheSameBodies) {
  ParticleSet set;
  set.position = {{0, 0, 1}, {0, 0, 5}, {0, 0, 9}};
  std::vector<Shape> shapes(3);
  shapes[0].kind = shapes::Box::kind;
  shapes[0].half_extents = {1, 2, 2};
  shapes[2].kind = shapes::Capsule::kind;
  shapes[2].half_extents = {0.5, 0.5, 2};
  set.shape = PerParticle(shapes);
  set.radius = PerParticle(std::vector<double>{3, 0.25, 2});
  set.density = 10.0;
  Scene sets, bodies;
  sets.particles = {set};
  for (std::size_t i = 0; i < 3; ++i) bodies.bodies.push_back(particle_body(set, i));
  const auto written = [&](const Scene& from, const char* name) {
    FrameWriter writer(directory / name, from, single);
    writer.append(0, states_of(0, 3));
    return h5::File::open(directory / name);
  };
  const h5::File a = written(sets, "sets.vtkhdf"), b = written(bodies, "bodies.vtkhdf");
  const h5::Group of_sets = a.root().open_group("VTKHDF/PointData");
  const h5::Group of_bodies = b.root().open_group("VTKHDF/PointData");
  EXPECT_EQ(of_sets.read<float>("half_extents"),
            (std::vector<float>{1, 2, 2, 0, 0, 0, 0.5, 0.5, 2}));
  EXPECT_EQ(of_sets.read<float>("radius"), (std::vector<float>{0, 0.25, 0}));
  EXPECT_EQ(of_sets.read<std::uint8_t>("shape"), of_bodies.read<std::uint8_t>("shape"));
  EXPECT_EQ(of_sets.read<double>("mass"), of_bodies.read<double>("mass"));
}

TEST_F(FramesTest, NothingIsPublishedBeforeTheFirstFrame) {
  FrameWriter writer(file, scene, single);
  EXPECT_FALSE(std::filesystem::exists(file));
  writer.append(0, {});  // a frame without bodies is left out
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(writer.frame_count(), 0);
}

TEST_F(FramesTest, AFrameAtTheSameTimeIsNotRepeated) {
  FrameWriter writer(file, scene, single);
  append(writer, 0);
  append(writer, 0);
  append(writer, 1);
  EXPECT_EQ(writer.frame_count(), 2);
  EXPECT_EQ(read_frames(file).size(), 2u);
  EXPECT_THROW(append(writer, 0), RunError);
  EXPECT_THROW(writer.append(99, states_of(1, 1)), RunError);    // fewer than before
  EXPECT_THROW(writer.append(99, states_of(1, 999)), RunError);  // more than the scene has
  EXPECT_EQ(read_frames(file).size(), 2u);
}

TEST_F(FramesTest, ResumeDropsFramesAfterTheCheckpointAndGoesOn) {
  for (const double time : {-1.0, 0.0, 1.9, 2.0, 3.0, 100.0}) {
    {
      FrameWriter writer(file, scene, single);
      for (int frame = 0; frame < 7; ++frame) append(writer, frame);
    }
    FrameWriter writer(file, scene, single, time);
    const int kept = time < 0 ? 0 : std::min(7, static_cast<int>(time / 0.5) + 1);
    EXPECT_EQ(writer.frame_count(), kept);
    if (kept > 0) {
      EXPECT_EQ(writer.last_time(), (kept - 1) * 0.5);
      EXPECT_EQ(read_frames(file).size(), static_cast<std::size_t>(kept));
    }
    for (int frame = kept; frame < 10; ++frame) append(writer, frame);
    const std::vector<Frame> frames = read_frames(file);
    ASSERT_EQ(frames.size(), 10u);
    for (int frame = 0; frame < 10; ++frame)
      expect_frame(frames[static_cast<std::size_t>(frame)], frame, growing_count(frame));
  }
}

TEST_F(FramesTest, ResumeWithoutAFileStartsOne) {
  FrameWriter writer(file, scene, single, 3.0);
  EXPECT_EQ(writer.frame_count(), 0);
  append(writer, 7);
  EXPECT_EQ(read_frames(file).size(), 1u);
}

TEST_F(FramesTest, ResumeRefusesOtherFiles) {
  const auto refusal = [&](const Scene& other) -> std::string {
    try {
      FrameWriter writer(file, other, single, 1.0);
    } catch (const InputError& error) {
      return error.what();
    }
    return {};
  };
  test::put(file, "not HDF5");
  EXPECT_THAT(refusal(scene), HasSubstr(file.string()));
  h5::File::create(file).close();
  EXPECT_THAT(refusal(scene), HasSubstr("VTKHDF"));
  {
    FrameWriter writer(file, scene, single);
    append(writer, 0);
  }
  EXPECT_THAT(refusal(scene_with(6, 0, 0)), HasSubstr("35 bodies, this one 6"));
}

TEST_F(FramesTest, AFileInUseByAReaderStaysAsItIs) {
  FrameWriter writer(file, scene, single);
  append(writer, 0);
  append(writer, 1);
  const h5::File reader = h5::File::open(file);  // takes a lock on what is published now
  const h5::Group vtk = reader.root().open_group("VTKHDF");
  for (int frame = 2; frame < 6; ++frame) append(writer, frame);
  EXPECT_EQ(vtk.open_group("Steps").attribute<std::int64_t>("NSteps"), 2);
  EXPECT_EQ(vtk.read<double>("Steps/Values"), (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(read_frames(file).size(), 6u);
}

TEST_F(FramesTest, ADamagedSpareIsReplaced) {
  FrameWriter writer(file, scene, single);
  append(writer, 0);
  append(writer, 1);
  test::put(file.string() + ".next", "damaged");
  append(writer, 2);
  EXPECT_EQ(read_frames(file).size(), 3u);
}

TEST_F(FramesTest, ReadableAfterAKillAtAnyMoment) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> delay_us(0, 100000);
  const int bodies = 500;
  int known_frames = 0;
  int files_read = 0;
  for (int round = 0; round < 25; ++round) {
    const pid_t child = ::fork();
    if (child == 0) {
      // Goes on where the last child was killed; every other time from one frame earlier.
      int frame = known_frames - (known_frames > 1 ? round % 2 : 0);
      const std::optional<double> resume =
          frame > 0 ? std::optional((frame - 1) * 0.5) : std::nullopt;
      FrameWriter writer(file, scene_with(bodies, 0, 0), single, resume);
      for (;; ++frame) writer.append(frame * 0.5, states_of(frame, bodies));
    }
    std::this_thread::sleep_for(std::chrono::microseconds(delay_us(random)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
        << "the writer failed by itself";
    if (!std::filesystem::exists(file)) continue;
    const std::vector<Frame> frames = read_frames(file);
    ASSERT_GE(std::ssize(frames) + 1, known_frames);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      expect_frame(frames[i], static_cast<int>(i), bodies);
      if (HasFatalFailure()) return;
    }
    known_frames = static_cast<int>(frames.size());
    files_read += 1;
  }
  EXPECT_GT(files_read, 0);
}

TEST_F(FramesTest, AFullDiskLeavesTheEarlierFrames) {
  const int bodies = 1000;
  const int code = test::with_full_disk(400000, [&] {
    std::int64_t frames = 0;
    try {
      FrameWriter writer(file, scene_with(bodies, 0, 0), single);
      for (int frame = 0; frame < 100; ++frame) {
        writer.append(frame * 0.5, states_of(frame, bodies));
        frames = writer.frame_count();
      }
    } catch (const RunError& error) {
      const std::string what = error.what();
      return frames > 0 && what.find(file.string()) != std::string::npos &&
                     what.find("earlier frames are kept") != std::string::npos
                 ? 1
                 : 3;
    }
    return 0;
  });
  EXPECT_EQ(code, 1);
  const std::vector<Frame> frames = read_frames(file);
  ASSERT_FALSE(frames.empty());
  for (std::size_t i = 0; i < frames.size(); ++i)
    expect_frame(frames[i], static_cast<int>(i), bodies);
  EXPECT_EQ(file_count(), 1u);
}

}  // namespace
}  // namespace scree
