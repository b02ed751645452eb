// Smaller parts of the output: atomic files, run.json, pictures, walls, progress, signals, threads.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <png.h>

#include <atomic>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/forces_csv.h"
#include "host/io/h5.h"
#include "host/io/png_file.h"
#include "host/io/progress.h"
#include "host/io/run_record.h"
#include "host/io/signals.h"
#include "host/io/walls.h"
#include "host/io/writer_thread.h"
#include "host/version.h"
#include "shapes/box.h"
#include "shapes/container.h"
#include "shapes/half_space.h"
#include "shapes/mesh.h"
#include "shapes/sphere.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/host/scene_texts.h"

namespace scree {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using test::contents;
using test::put;
using test::ScratchDirectory;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(AtomicFileTest, KeepsTheOldFileUntilCommit) {
  const ScratchDirectory scratch;
  const fs::path path = scratch / "a.txt";
  put(path, "old");
  {
    AtomicFile file(path);
    file.write("new ");
    file.write("text");
    EXPECT_EQ(contents(path), "old");
  }  // not committed
  EXPECT_EQ(contents(path), "old");
  EXPECT_FALSE(fs::exists(temporary_name(path)));
  write_file_atomically(path, "new text");
  EXPECT_EQ(contents(path), "new text");
  write_file_atomically(path, "");
  EXPECT_EQ(contents(path), "");
  EXPECT_FALSE(fs::exists(temporary_name(path)));
}

TEST(AtomicFileTest, SaysWhatFailedAndWhatIsKept) {
  const ScratchDirectory scratch;
  try {
    write_file_atomically(scratch / "missing" / "a.txt", "x");
    FAIL();
  } catch (const RunError& error) {
    EXPECT_THAT(error.what(), HasSubstr((scratch / "missing" / "a.txt").string()));
    EXPECT_THAT(error.what(), HasSubstr("No such file or directory"));
  }
  EXPECT_EQ(
      io_message("cannot write", "f", ENOSPC, "the previous file is kept"),
      "cannot write f: No space left on device (the disk is full); the previous file is kept");
}

TEST(AtomicFileTest, AFullDiskKeepsTheOldFile) {
  const ScratchDirectory scratch;
  const fs::path path = scratch / "a.txt";
  put(path, "old");
  const int code = test::with_full_disk(1000, [&] {
    try {
      write_file_atomically(path, std::string(5000, 'x'));
    } catch (const RunError&) {
      return 1;
    }
    return 0;
  });
  EXPECT_EQ(code, 1);
  EXPECT_EQ(contents(path), "old");
  EXPECT_FALSE(fs::exists(temporary_name(path)));
}

TEST(H5Test, MessagesNameFileObjectAndReason) {
  const ScratchDirectory scratch;
  const fs::path path = scratch / "a.h5";
  h5::File file = h5::File::create(path);
  h5::Group group = file.root().create_group("g");
  group.write("x", std::span<const double>(std::vector<double>{1, 2, 3}));
  const auto message = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const h5::Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(message([&] { group.read<double>("y"); }), path.string() + ": /g/y: no such dataset");
  EXPECT_THAT(message([&] { group.read<float>("x"); }), HasSubstr("expected 32-bit float values"));
  EXPECT_THAT(message([&] { group.attribute<double>("t"); }), HasSubstr(": attribute t of /g: "));
  std::vector<double> four(4);
  EXPECT_THAT(message([&] { group.read("x", std::span<double>(four)); }),
              HasSubstr("expected at least 4 rows, found 3"));
  EXPECT_THAT(message([&] { group.write("x", std::span<const double>(four)); }), HasSubstr("/g/x"));
  EXPECT_THAT(message([&] { group.write("z", std::span<const double>(four), 3); }),
              HasSubstr("4 values are no rows of 3"));
  EXPECT_THAT(message([&] { h5::File::open(scratch / "none.h5"); }), HasSubstr("No such file"));
}

TEST(RunRecordTest, HoldsWhatWasRun) {
  const ScratchDirectory scratch;
  RunRecord record(dynamics_card("rigid"));
  record.scene_name = "bed";
  record.scene_text = "{ \"name\": \"bed\" /* comment */ }";
  record.command_line = {"scree", "run", "b\xff.json"};  // not UTF-8
  record.device = "a processor";
  record.seed = 0xffffffffffffffffu;
  record.start_time = utc_now();
  write_run_record(scratch / "run.json", record);
  auto json = nlohmann::json::parse(contents(scratch / "run.json"));
  EXPECT_EQ(json["status"], "running");
  EXPECT_EQ(json["version"], version());
  EXPECT_EQ(json["commit"], commit());
  EXPECT_EQ(json["scene"]["name"], "bed");
  EXPECT_EQ(json["seed"], 0xffffffffffffffffu);
  EXPECT_TRUE(json["end_time"].is_null());
  EXPECT_EQ(json["totals"]["steps"], 0);
  EXPECT_THAT(json["start_time"].get<std::string>(),
              testing::MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9:]{8}Z"));

  for (int step = 1; step <= 4; ++step) {
    StepReport report;
    report.step = step;
    report.time = step * 0.5;
    report.iterations = 10 * step;
    report.converged = step != 2;
    report.max_penetration = step == 3 ? 0.25 : 0.125;
    report.ms.solve = step;
    record.totals.add(report);
  }
  record.status = RunStatus::failed;
  record.message = "disk full";
  record.end_time = utc_now();
  record.scene_text = "not JSON";
  record.resumed_from_step = 2;
  write_run_record(scratch / "run.json", record);
  json = nlohmann::json::parse(contents(scratch / "run.json"));
  EXPECT_EQ(json["status"], "failed");
  EXPECT_EQ(json["message"], "disk full");
  EXPECT_EQ(json["scene"], "not JSON");
  EXPECT_EQ(json["resumed_from_step"], 2);
  EXPECT_EQ(json["totals"]["steps"], 4);
  EXPECT_EQ(json["totals"]["steps_not_converged"], 1);
  EXPECT_EQ(json["totals"]["mean_iterations"], 25);
  EXPECT_EQ(json["totals"]["mean_ms"]["solve"], 2.5);
  EXPECT_EQ(json["totals"]["max_penetration_m"], 0.25);
  EXPECT_EQ(json["totals"]["simulated_time_s"], 2.0);
}

TEST(PngTest, ComesBackPixelByPixel) {
  const ScratchDirectory scratch;
  for (const auto& [width, height] : {std::pair{1, 1}, {33, 7}, {300, 200}}) {
    Image image{width, height, {}};
    for (int i = 0; i < width * height * 3; ++i)
      image.rgb.push_back(static_cast<std::uint8_t>(i * 37 % 251));
    write_png(scratch / "a.png", image);

    png_image png;
    std::memset(&png, 0, sizeof png);
    png.version = PNG_IMAGE_VERSION;
    ASSERT_NE(png_image_begin_read_from_file(&png, (scratch / "a.png").c_str()), 0);
    EXPECT_EQ(png.format, static_cast<png_uint_32>(PNG_FORMAT_RGB));
    EXPECT_EQ(png.width, static_cast<png_uint_32>(width));
    EXPECT_EQ(png.height, static_cast<png_uint_32>(height));
    std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(png));
    ASSERT_NE(png_image_finish_read(&png, nullptr, rgb.data(), 0, nullptr), 0);
    EXPECT_EQ(rgb, image.rgb);
  }
}

TEST(PngTest, RefusesAPictureWithoutPixels) {
  const ScratchDirectory scratch;
  EXPECT_THROW(write_png(scratch / "a.png", Image{}), RunError);
  EXPECT_THROW(write_png(scratch / "a.png", Image{2, 2, std::vector<std::uint8_t>(11)}), RunError);
  EXPECT_FALSE(fs::exists(scratch / "a.png"));
}

TEST(WallsTest, AllFacesOfABoxPointOutward) {
  const ScratchDirectory scratch;
  Scene scene;
  BodyDescription box;
  box.kind = BodyKind::fixed;
  box.shape.kind = shapes::Container::kind;
  box.shape.half_extents = {1, 2, 3};
  box.shape.open_faces = 1u << 5;
  BodyDescription ball;
  ball.shape.kind = shapes::Sphere::kind;
  scene.bodies = {ball, box};
  ASSERT_TRUE(write_walls(scratch / "walls.obj", scene));
  std::ifstream in(scratch / "walls.obj");
  std::vector<Vec3d> vertices;
  int faces = 0;
  for (std::string word; in >> word;) {
    if (word == "v") {
      Vec3d v;
      in >> v.x >> v.y >> v.z;
      vertices.push_back(v);
    } else if (word == "f") {
      std::size_t a = 0, b = 0, c = 0, d = 0;
      in >> a >> b >> c >> d;
      const Vec3d normal =
          cross(vertices.at(b - 1) - vertices.at(a - 1), vertices.at(c - 1) - vertices.at(a - 1));
      EXPECT_GT(dot(normal, vertices.at(a - 1)), 0);
      EXPECT_EQ(dot(normal, vertices.at(d - 1) - vertices.at(a - 1)), 0);
      EXPECT_FALSE(normal.z > 0) << "the top is open";
      faces += 1;
    }
  }
  EXPECT_EQ(vertices.size(), 8u);
  EXPECT_EQ(faces, 5);
}

TEST(WallsTest, HasEveryKindOfWallAndNoFreeBodies) {
  const ScratchDirectory scratch;
  Scene scene;
  scene.bodies.resize(5);
  for (BodyDescription& body : scene.bodies) body.shape.kind = shapes::Sphere::kind;
  EXPECT_FALSE(write_walls(scratch / "walls.obj", scene));
  EXPECT_FALSE(fs::exists(scratch / "walls.obj"));
  const ShapeKind kinds[]{shapes::Sphere::kind, shapes::Box::kind, shapes::HalfSpace::kind,
                          shapes::Mesh::kind};
  scene.meshes.push_back({"m", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}, false});
  for (std::size_t i = 0; i < 4; ++i) {
    scene.bodies[i + 1].kind = i == 0 ? BodyKind::kinematic : BodyKind::fixed;
    scene.bodies[i + 1].shape.kind = kinds[i];
    scene.bodies[i + 1].shape.radius = i == 0 ? 1 : 0;
    scene.bodies[i + 1].shape.mesh = i == 3 ? 0 : -1;
  }
  ASSERT_TRUE(write_walls(scratch / "walls.obj", scene));
  const std::string text = contents(scratch / "walls.obj");
  for (const char* name : {"body_1_kinematic", "body_2_box", "body_3_half_space", "body_4_mesh"})
    EXPECT_THAT(text, HasSubstr(name));
  EXPECT_THAT(text, Not(HasSubstr("body_0")));
}

TEST(WallsTest, WhatMovesIsWhereItsMotionBegins) {
  const ScratchDirectory scratch;
  Scene scene;
  BodyDescription box;
  box.kind = BodyKind::kinematic;
  box.shape.kind = shapes::Box::kind;
  box.shape.half_extents = {1, 1, 1};
  Motion motion;
  motion.kind = Motion::Kind::sampled;
  motion.times = {0, 1};
  motion.positions = {{5, 0, 0}, {6, 0, 0}};
  box.motion = motion;
  scene.bodies = {box};
  ASSERT_TRUE(write_walls(scratch / "walls.obj", scene));
  const std::string text = contents(scratch / "walls.obj");
  EXPECT_THAT(text, AllOf(HasSubstr("\nv 4 "), HasSubstr("\nv 6 ")));
  EXPECT_THAT(text, Not(HasSubstr("\nv -1 ")));
}

TEST(WriterThreadTest, RunsTasksInOrderBesideTheCaller) {
  std::vector<int> order;
  WriterThread writer(3);
  for (int i = 0; i < 100; ++i) writer.post([&order, i] { order.push_back(i); });
  writer.finish();
  ASSERT_EQ(order.size(), 100u);
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
  const auto caller = std::this_thread::get_id();
  writer.post([caller] { EXPECT_NE(std::this_thread::get_id(), caller); });
  writer.finish();
}

TEST(WriterThreadTest, WaitsWhenTheQueueIsFull) {
  std::atomic<int> done{0};
  WriterThread writer(2);
  for (int i = 0; i < 6; ++i) {
    writer.post([&done] {
      std::this_thread::sleep_for(10ms);
      done += 1;
    });
    EXPECT_GE(done, i + 1 - 3);  // one running, two waiting
  }
  writer.finish();
  EXPECT_EQ(done, 6);
}

TEST(WriterThreadTest, TheFirstExceptionReachesTheCallerAndLaterTasksAreDropped) {
  std::atomic<int> ran{0};
  WriterThread writer(8);
  writer.post([] {
    std::this_thread::sleep_for(20ms);
    throw RunError("disk full");
  });
  writer.post([&ran] { ran += 1; });
  writer.post([] { throw std::logic_error("second"); });
  EXPECT_THROW(writer.finish(), RunError);
  EXPECT_THROW(writer.post([&ran] { ran += 1; }), RunError);
  EXPECT_THROW(writer.check(), RunError);
  EXPECT_EQ(ran, 0);
}

TEST(WriterThreadTest, TheDestructorRunsWhatIsQueuedAndDoesNotThrow) {
  std::atomic<int> ran{0};
  {
    WriterThread writer(8);
    for (int i = 0; i < 5; ++i)
      writer.post([&ran] {
        std::this_thread::sleep_for(2ms);
        ran += 1;
      });
  }
  EXPECT_EQ(ran, 5);
  WriterThread writer;
  writer.post([] { throw RunError("nobody looks"); });
}

class ProgressTest : public testing::Test {
 protected:
  StepReport report(int step) {
    StepReport r;
    r.step = step;
    r.time = step * 0.01;
    r.body_count = 1234;
    r.contact_count = 5678;
    r.residual_rms = 1.5e-5;
    r.iterations = 77;
    return r;
  }
  std::string output(ProgressOptions options, int steps, std::chrono::milliseconds pause) {
    std::FILE* out = std::fopen(file.c_str(), "w");
    options.out = out;
    {
      Progress progress(options, 0.0, 1.0);
      for (int step = 1; step <= steps; ++step) {
        std::this_thread::sleep_for(pause);
        progress.update(report(step));
      }
      progress.note("a warning");
    }
    std::fclose(out);
    return contents(file);
  }
  ScratchDirectory scratch;
  fs::path file = scratch / "out.txt";
};

TEST_F(ProgressTest, PlainLinesWhenNotATerminal) {
  const std::string text = output({.plain_interval = 0.02}, 4, 30ms);
  EXPECT_THAT(text,
              HasSubstr("step 1  t 0.01/1 s  bodies 1234  contacts 5678  residual 1.50e-05 m/s"));
  EXPECT_THAT(text, HasSubstr("iterations 77"));
  EXPECT_THAT(text, HasSubstr("steps/s  ETA 0:0"));
  EXPECT_THAT(text, Not(HasSubstr("\r")));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 5);
}

TEST_F(ProgressTest, FewLinesForManySteps) {
  const std::string text = output({}, 1000, 0ms);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 2);  // the warning and the last state
  EXPECT_THAT(text, HasSubstr("step 1000"));
}

TEST_F(ProgressTest, OneLineRewrittenOnATerminal) {
  const auto start = std::chrono::steady_clock::now();
  const std::string text = output({.terminal = true}, 40, 10ms);
  const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
  const auto rewritten = std::count(text.begin(), text.end(), '\r');
  EXPECT_GE(rewritten, 2);
  EXPECT_LE(static_cast<double>(rewritten), 5 * wall.count() + 3);
  EXPECT_THAT(text, HasSubstr("a warning\n"));
}

TEST_F(ProgressTest, QuietShowsNotesOnly) {
  EXPECT_EQ(output({.quiet = true}, 10, 1ms), "a warning\n");
}

TEST(DurationTest, Text) {
  EXPECT_EQ(duration_text(0), "0:00");
  EXPECT_EQ(duration_text(6.1), "0:07");
  EXPECT_EQ(duration_text(754), "12:34");
  EXPECT_EQ(duration_text(12069), "3:21:09");
  EXPECT_EQ(duration_text(2 * 86400 + 10800), "2 d 3:00:00");
  EXPECT_EQ(duration_text(1.0 / 0.0), "?");
}

TEST(SignalTest, TheFirstOneIsARequestAndTheSecondKills) {
  {
    const SignalGuard guard;
    EXPECT_EQ(guard.received(), 0);
    std::raise(SIGTERM);
    EXPECT_EQ(guard.received(), SIGTERM);
  }
  for (const int second : {SIGINT, SIGTERM}) {
    const pid_t child = ::fork();
    if (child == 0) {
      const SignalGuard guard;
      std::raise(SIGINT);
      if (guard.received() != SIGINT) ::_exit(3);
      std::raise(second);
      ::_exit(4);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
    EXPECT_EQ(WTERMSIG(status), second);
  }
}

// Bodies that join later come last in a run, whatever their place in the file.
TEST(ForceTargets, WallsHaveTheNumberOfTheirEntry) {
  const Scene scene = test::parsed(R"({"time_step": 1e-3, "duration": 1, "bodies": [
    {"shape": "half_space"},
    {"shape": "sphere", "radius": 0.1, "density": 1000, "position": [0, 0, 1], "insert_at": 0.5},
    {"shape": "box", "kind": "fixed", "size": [1, 1, 1], "position": [3, 0, 0]},
    {"name": "lid", "shape": "box", "kind": "fixed", "size": [1, 1, 1], "position": [5, 0, 0]}]})");
  EXPECT_THAT(ForceTargets(scene).bodies, testing::ElementsAre("fixed,0", "fixed,2", "fixed,lid"));
}

}  // namespace
}  // namespace scree
