// scree run on several ranks: mpirun -n 3 scree run SCENE.

#include <cmath>

#include "host/io/checkpoint.h"
#include "host/ranks/nccl_messages.h"
#include "tests/cli/frame_count.h"
#include "tests/cli/rank_runs.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

TEST_F(CliRanks, ARunWritesAllFilesOnce) {
  for (const int ranks : {2, 3, 4}) {
    SCOPED_TRACE(ranks);
    const fs::path out = scratch / std::to_string(ranks);
    const Result result = on_ranks(ranks, run_arguments(scene, out));
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(count_of(result.err, "results in"), 1u) << result.err;
    const std::vector<StepReport> steps = read_steps_csv(out / "steps.csv");
    ASSERT_EQ(steps.size(), 20u);
    EXPECT_EQ(steps.back().body_count, 300);
    EXPECT_EQ(frame_count(out / "frames.vtkhdf"), 5);  // 0, 5, 10, 15 and 20 ms
    const Checkpoint checkpoint = read_checkpoint(out / "checkpoint.h5");
    EXPECT_EQ(checkpoint.state.step, 20);
    EXPECT_EQ(checkpoint.state.at<Vec3d>("body/position").size(), 300u);
    const nlohmann::json record = json_file(out / "run.json");
    EXPECT_EQ(record.at("status"), "done");
    EXPECT_EQ(record.at("ranks"), ranks);
  }
}

TEST_F(CliRanks, TheFirstStepIsThatOfOneRank) {
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "one")).code, 0);
  const Result result = on_ranks(3, run_arguments(scene, scratch / "three"));
  ASSERT_EQ(result.code, 0) << result.err;
  const StepReport one = read_steps_csv(scratch / "one/steps.csv").front();
  const StepReport three = read_steps_csv(scratch / "three/steps.csv").front();
  EXPECT_GT(one.contact_count, 100);
  EXPECT_EQ(one.contact_count, three.contact_count);
  EXPECT_NEAR(three.kinetic_energy, one.kinetic_energy, 1e-3 * one.kinetic_energy);
  EXPECT_EQ(json_file(scratch / "one/run.json").count("ranks"), 0u);
}

TEST_F(CliRanks, OneRankIsAnOrdinaryRun) {
  ASSERT_EQ(scree(scratch, run_arguments(scene, scratch / "alone")).code, 0);
  const Result result = on_ranks(1, run_arguments(scene, scratch / "launched"));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(steps_without_times(scratch / "alone/steps.csv"),
            steps_without_times(scratch / "launched/steps.csv"));
}

TEST_F(CliRanks, ARunOfRanksIsResumedByAnyNumberOfRanks) {
  const fs::path out = scratch / "a";
  ASSERT_EQ(on_ranks(2, run_arguments(scene, out, {"--steps", "8"})).code, 0);
  for (const int ranks : {3, 1}) {
    const int steps = ranks == 3 ? 12 : 16;
    const Result result =
        on_ranks(ranks, run_arguments(scene, out, {"--resume", "--steps", std::to_string(steps)}));
    ASSERT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(read_checkpoint(out / "checkpoint.h5").state.step, steps);
  }
  EXPECT_EQ(read_steps_csv(out / "steps.csv").size(), 16u);
  const Result done = on_ranks(2, run_arguments(scene, out, {"--resume", "--steps", "16"}));
  EXPECT_EQ(done.code, 0) << done.err;
  EXPECT_EQ(count_of(done.err, "nothing to do"), 1u) << done.err;
}

TEST_F(CliRanks, BadInputIsToldOnceAndEndsAll) {
  const fs::path out = scratch / "a";
  expect_one_message(on_ranks(3, {"run", "missing.json"}), 2, "scree: missing.json: no such file");
  expect_one_message(on_ranks(2, run_arguments(scene, out, {"--set", "time_step=-1"})), 2,
                     "time_step");
  expect_one_message(on_ranks(2, run_arguments(scene, out, {"--resume", "--force"})), 2,
                     "exclude each other");
  expect_one_message(on_ranks(3, {"run", "--no-such-option"}), 2, "see scree run --help");
  expect_one_message(on_ranks(2, run_arguments(scene, out, {"--memory", "0.001"})), 2, "memory");
  nlohmann::json with_mesh = grains();
  with_mesh["bodies"].push_back({{"shape", "mesh"}, {"file", "missing.obj"}});
  const fs::path other = put(scratch / "mesh.json", with_mesh.dump());
  expect_one_message(on_ranks(2, run_arguments(other, out)), 2, "missing.obj");
  EXPECT_FALSE(fs::exists(out));
}

/// What rank 0 alone looks at: the others wait for it, and end with it.
TEST_F(CliRanks, AFolderThatIsNotEmptyIsRefused) {
  const fs::path out = scratch / "a";
  fs::create_directory(out);
  put(out / "notes.txt", "mine");
  expect_one_message(on_ranks(3, run_arguments(scene, out)), 2, "not empty");
  EXPECT_FALSE(fs::exists(out / "steps.csv"));
}

TEST_F(CliRanks, ASceneThatDiffersNamesTheRank) {
  nlohmann::json heavier = grains();
  heavier["particles"][0]["density"] = 3000;
  const fs::path other = put(scratch / "other.json", heavier.dump());
  const Arguments more{"--out", (scratch / "a").string()};
  expect_one_message(start(2, by_rank(scene, other, more)).wait(), 2, "rank 1 has another scene");
  expect_one_message(start(3, by_rank(scene, scratch / "missing.json", more)).wait(), 2,
                     "rank 1: " + (scratch / "missing.json").string() + ": no such file");
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

TEST_F(CliRanks, OtherCommandsSpeakOnce) {
  const Result check = on_ranks(3, {"check", scene.string()});
  EXPECT_EQ(check.code, 0) << check.err;
  EXPECT_EQ(count_of(check.out, "grains: valid"), 1u) << check.out;
  const Result info = on_ranks(3, {"info"});
  EXPECT_EQ(info.code, 0) << info.err;
  EXPECT_EQ(count_of(info.out, "MPI         " + mpi_version()), 1u) << info.out;
  const Result version = on_ranks(2, {"--version"});
  EXPECT_EQ(version.code, 0) << version.err;
  EXPECT_EQ(line_count(version.out), 1u) << version.out;
  expect_one_message(on_ranks(2, {"no-such-command"}), 2, "expected a command");
}

/// A signal to all ranks, as a terminal or a batch system sends it: rank 0 ends the run, the others wait for it.
TEST_F(CliRanks, AnInterruptWritesACheckpoint) {
  const fs::path out = scratch / "a";
  const Arguments endless{"--quiet", "--set", "duration=1000", "--out", out.string()};
  Program program = start(3, by_rank(scene, scene, endless));
  ASSERT_TRUE(eventually([&] { return line_count(contents(out / "steps.csv")) > 1; }));
  for (const int rank : {2, 1, 0}) ::kill(process(rank), SIGTERM);
  const Result result = program.wait();
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(json_file(out / "run.json").at("status"), "interrupted");
  EXPECT_EQ(read_checkpoint(out / "checkpoint.h5").state.step,
            read_steps_csv(out / "steps.csv").back().step);
}

TEST_F(CliRanks, ARankThatIsKilledEndsAllAndTheCheckpointStays) {
  for (const int killed : {0, 2}) {
    SCOPED_TRACE(killed);
    const fs::path out = scratch / ("killed_" + std::to_string(killed));
    const Arguments endless{"--quiet", "--set", "duration=1000", "--out", out.string()};
    Program program = start(3, by_rank(scene, scene, endless));
    expect_all_end_without(killed, 3, program, out);
    const std::int64_t done = read_checkpoint(out / "checkpoint.h5").state.step;
    const Result resumed = scree(
        scratch, run_arguments(scene, out, {"--resume", "--steps", std::to_string(done + 5)}));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(read_checkpoint(out / "checkpoint.h5").state.step, done + 5);
  }
}

/// Without a launcher nothing of MPI is needed, whatever the build.
TEST(CliInfo, NamesMpiAndNccl) {
  const Scratch scratch;
  const std::string mpi = mpi_version().empty() ? "not built" : mpi_version();
  const Result text = scree(scratch, {"info"});
  EXPECT_NE(text.out.find("MPI         " + mpi + "\n"), std::string::npos) << text.out;
  const Result json = scree(scratch, {"info", "--json"});
  EXPECT_EQ(nlohmann::json::parse(json.out).at("mpi"), mpi);
  const std::string nccl = nccl_version().empty() ? "not built" : nccl_version();
  EXPECT_NE(text.out.find("NCCL        " + nccl + "\n"), std::string::npos) << text.out;
  EXPECT_EQ(nlohmann::json::parse(json.out).at("nccl"), nccl);
}

/// A launcher of several processes, by its variables: each would be a run of its own in the same folder.
TEST(CliInfo, ABuildWithoutMpiRefusesSeveralRanks) {
  if (!mpi_version().empty()) GTEST_SKIP() << "this scree was built with " << mpi_version();
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, grains());
  for (const char* rank : {"0", "1"}) {
    const auto launched = [&] {
      ::setenv("OMPI_COMM_WORLD_RANK", rank, 1);
      ::setenv("OMPI_COMM_WORLD_SIZE", "2", 1);
    };
    const Result result =
        Program(scratch.path(), run_arguments(scene, scratch / "a"), 0, launched).wait();
    const bool speaks = *rank == '0';
    EXPECT_EQ(result.code, speaks ? 2 : 0);
    EXPECT_EQ(result.err.find("built without MPI") != std::string::npos, speaks) << result.err;
    EXPECT_EQ(result.err.empty(), !speaks) << result.err;
  }
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

}  // namespace
}  // namespace scree::test
