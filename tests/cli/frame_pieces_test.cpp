// Frames that each rank writes of its own bodies: output.frame_pieces.

#include "host/io/checkpoint.h"
#include "host/io/frame_reader.h"
#include "tests/cli/frame_count.h"
#include "tests/cli/rank_runs.h"
#include "tests/frame_bytes.h"

namespace scree::test {
namespace {

/// Grains that fly over borders between ranks.
nlohmann::json flying() {
  nlohmann::json scene = grains();
  scene["duration"] = 0.06;
  scene["particles"][0]["velocity"] = {2, 1, -2};
  return scene;
}

/// Grains of which most come later: at first some ranks have none.
nlohmann::json pouring() {
  nlohmann::json scene = flying();
  nlohmann::json rain = scene["particles"][0];
  scene["particles"][0]["count"] = 1;
  rain.update({{"layout", "rain"}, {"count", 120}, {"layers", 3}, {"interval", 0.015}});
  rain["region"] = {{"min", {-0.1, -0.1, 0.3}}, {"max", {0.1, 0.1, 0.33}}};
  scene["particles"].push_back(rain);
  return scene;
}

using CliFramePieces = CliRanks;
const Arguments in_pieces{"--set", "output.frame_pieces=true"};

Arguments with(Arguments more) {
  more.insert(more.end(), in_pieces.begin(), in_pieces.end());
  return more;
}

std::vector<double> wall_corners(const fs::path& out) {
  return h5::File::open(out / "walls.vtkhdf").root().read<double>("VTKHDF/Points");
}

TEST_F(CliFramePieces, AreTheFramesOfOneFile) {
  const auto compare = [&](const std::string& name, const nlohmann::json& scene, int ranks) {
    SCOPED_TRACE(name);
    const fs::path file = put(scratch / (name + ".json"), scene.dump());
    const fs::path one = scratch / (name + "_one"), pieces = scratch / (name + "_pieces");
    const Result whole = on_ranks(ranks, run_arguments(file, one));
    ASSERT_EQ(whole.code, 0) << whole.err;
    const Result result = on_ranks(ranks, run_arguments(file, pieces, in_pieces));
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(frame_count(pieces / "frames.vtkhdf"), 13);
    expect_same_frames(pieces / "frames.vtkhdf", one / "frames.vtkhdf");
    EXPECT_EQ(wall_corners(pieces), wall_corners(one));
    for (int rank = 0; rank < ranks; ++rank)
      EXPECT_TRUE(fs::exists(pieces / ("frames_" + std::to_string(rank) + ".vtkhdf")));
    for (const auto& entry : fs::directory_iterator(pieces))  // nothing half written stays
      EXPECT_NE(entry.path().extension(), ".next") << entry.path();
  };
  compare("flying", flying(), 3);
  compare("pouring", pouring(), 2);
}

TEST_F(CliFramePieces, OneRankWritesOne) {
  const fs::path file = put(scratch / "pouring.json", pouring().dump());
  ASSERT_EQ(scree(scratch, run_arguments(file, scratch / "one")).code, 0);
  ASSERT_EQ(scree(scratch, run_arguments(file, scratch / "pieces", in_pieces)).code, 0);
  EXPECT_TRUE(fs::exists(scratch / "pieces/frames_0.vtkhdf"));
  expect_same_frames(scratch / "pieces/frames.vtkhdf", scratch / "one/frames.vtkhdf");
}

TEST_F(CliFramePieces, AreContinuedByTheSameRanksAsIfNothingHadBeen) {
  const fs::path whole = scratch / "whole", parts = scratch / "parts";
  const fs::path file = put(scratch / "flying.json", flying().dump());
  ASSERT_EQ(on_ranks(3, run_arguments(file, whole, in_pieces)).code, 0);
  ASSERT_EQ(on_ranks(3, run_arguments(file, parts, with({"--steps", "25"}))).code, 0);
  const Result resumed = on_ranks(3, run_arguments(file, parts, with({"--resume"})));
  ASSERT_EQ(resumed.code, 0) << resumed.err;
  expect_same_frames(parts / "frames.vtkhdf", whole / "frames.vtkhdf");
}

TEST_F(CliFramePieces, AreContinuedByOtherNumbersOfRanks) {
  const fs::path out = scratch / "a";
  const fs::path file = put(scratch / "flying.json", flying().dump());
  int steps = 10;
  std::size_t frames = 3;
  for (const int ranks : {3, 2, 4, 1, 2}) {
    SCOPED_TRACE(ranks);
    Arguments more = with({"--steps", std::to_string(steps)});
    const std::vector<FrameBytes> before =
        steps > 10 ? frame_bytes(out / "frames.vtkhdf") : std::vector<FrameBytes>{};
    if (steps > 10) more.insert(more.begin(), "--resume");
    const Result result = on_ranks(ranks, run_arguments(file, out, more));
    ASSERT_EQ(result.code, 0) << result.err;
    const std::vector<FrameBytes> after = frame_bytes(out / "frames.vtkhdf");
    ASSERT_EQ(after.size(), frames);
    for (std::size_t k = 0; k < before.size(); ++k) EXPECT_TRUE(before[k] == after[k]) << k;
    for (const FrameBytes& frame : after) EXPECT_EQ(frame.ids().size(), 301u);
    EXPECT_EQ(FrameReader(out / "frames.vtkhdf").body_count(), 301u);
    steps += 10, frames += 2;
  }
}

TEST_F(CliFramePieces, ARunThatGoesOnKeepsTheKindOfItsFrames) {
  const fs::path out = scratch / "a";
  ASSERT_EQ(on_ranks(2, run_arguments(scene, out, with({"--steps", "8"}))).code, 0);
  expect_one_message(on_ranks(2, run_arguments(scene, out, {"--resume"})), 2,
                     "frames.vtkhdf: it was written in pieces (output.frame_pieces true), this run "
                     "has false");
  fs::rename(out / "frames_1.vtkhdf", scratch / "kept");
  expect_one_message(on_ranks(2, run_arguments(scene, out, with({"--resume"}))), 2,
                     "its piece " + (out / "frames_1.vtkhdf").string() + " is missing");
  fs::rename(scratch / "kept", out / "frames_1.vtkhdf");
  EXPECT_EQ(on_ranks(2, run_arguments(scene, out, with({"--resume"}))).code, 0);
  // A new run in the folder takes all pieces away.
  ASSERT_EQ(scree(scratch, run_arguments(scene, out, {"--force", "--steps", "8"})).code, 0);
  EXPECT_FALSE(fs::exists(out / "frames_0.vtkhdf"));
  EXPECT_FALSE(fs::exists(out / "frames_1.vtkhdf"));
  expect_one_message(on_ranks(2, run_arguments(scene, out, with({"--resume"}))), 2,
                     "as one file (output.frame_pieces false)");
}

TEST_F(CliFramePieces, SurfaceFramesAreRefused) {
  const Arguments more = with({"--set", "output.surface_frames=true"});
  expect_one_message(on_ranks(2, run_arguments(scene, scratch / "a", more)), 2,
                     "must be false with output.frame_pieces");
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

/// A rank that cannot write ends all, with one message that names its file; what was written stays readable.
TEST_F(CliFramePieces, ARankThatCannotWriteEndsAll) {
  const fs::path out = scratch / "a";
  const Arguments endless = with({"--quiet", "--set", "duration=1000", "--out", out.string()});
  Program program = start(3, by_rank(scene, scene, endless));
  ASSERT_TRUE(eventually([&] { return line_count(contents(out / "steps.csv")) > 40; }));
  const fs::path spare = out / "frames_1.vtkhdf.next";  // what gets the next frame
  std::error_code ignored;
  ASSERT_TRUE(eventually([&] {
    fs::remove(spare, ignored);
    return fs::create_directory(spare, ignored);
  }));
  const Result result = program.wait();
  expect_one_message(result, 1, "frames_1.vtkhdf");
  EXPECT_EQ(json_file(out / "run.json").at("status"), "failed");
  const FrameReader frames(out / "frames.vtkhdf");
  EXPECT_GT(frames.times().size(), 3u);
  const std::vector<FrameBytes> shown = frame_bytes(out / "frames.vtkhdf");
  EXPECT_EQ(shown.size(), frames.times().size());
  EXPECT_EQ(shown.size(), frame_bytes(out / "frames_1.vtkhdf").size());
}

TEST_F(CliFramePieces, ARankThatIsKilledLeavesFramesThatAreContinued) {
  const fs::path out = scratch / "a";
  const Arguments endless = with({"--quiet", "--set", "duration=1000", "--out", out.string()});
  Program program = start(3, by_rank(scene, scene, endless));
  ASSERT_TRUE(eventually([&] {
    return fs::exists(out / "checkpoint.h5") && line_count(contents(out / "steps.csv")) > 40;
  }));
  ::kill(process(1), SIGKILL);
  EXPECT_NE(program.wait().code, 0);
  EXPECT_GT(frame_bytes(out / "frames.vtkhdf").size(), 3u);
  const std::int64_t done = read_checkpoint(out / "checkpoint.h5").state.step;
  const Result resumed = on_ranks(
      2, run_arguments(scene, out, with({"--resume", "--steps", std::to_string(done + 5)})));
  EXPECT_EQ(resumed.code, 0) << resumed.err;
  const std::vector<FrameBytes> frames = frame_bytes(out / "frames.vtkhdf");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_NEAR(frames[k].time, 0.005 * static_cast<double>(k), 1e-9);
    EXPECT_EQ(frames[k].ids().size(), 301u);
  }
}

}  // namespace
}  // namespace scree::test
