// How a run on several ranks ends when one of them is told to, or cannot go on.

#include <sys/resource.h>

#include "host/io/checkpoint.h"
#include "tests/cli/rank_runs.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

/// A batch system or a user may know any one of the processes.
TEST_F(CliRanks, ASignalToAnyRankEndsAllWithACheckpoint) {
  for (const int signal : {SIGTERM, SIGINT}) {
    SCOPED_TRACE(signal);
    const fs::path out = scratch / std::to_string(signal);
    const Arguments endless{"--quiet", "--set", "duration=1000", "--out", out.string()};
    Program program = start(3, by_rank(scene, scene, endless));
    ASSERT_TRUE(eventually([&] { return line_count(contents(out / "steps.csv")) > 1; }));
    ::kill(process(signal == SIGTERM ? 1 : 2), signal);
    const auto status = [&] { return json_file(out / "run.json").at("status"); };
    ASSERT_TRUE(eventually([&] { return status() != "running"; }));
    const Result result = program.wait();
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(status(), "interrupted");
    EXPECT_EQ(count_of(result.err, "interrupted: checkpoint written"), 1u) << result.err;
    const std::int64_t done = read_checkpoint(out / "checkpoint.h5").state.step;
    EXPECT_EQ(done, read_steps_csv(out / "steps.csv").back().step);
    const Result resumed =
        on_ranks(2, run_arguments(scene, out, {"--resume", "--steps", std::to_string(done + 2)}));
    EXPECT_EQ(resumed.code, 0) << resumed.err;
  }
}

/// Spheres that never stop coming, so that each step needs more memory than the one before.
nlohmann::json rain() {
  nlohmann::json scene = grains();
  scene["solver"] = {{"stop", "preview"}};
  scene["duration"] = 1;
  scene["output"]["checkpoint_interval"] = 0.5;
  scene["output"]["frame_interval"] = 0.5;
  scene["particles"].push_back({{"layout", "rain"},
                                {"count", 200000},
                                {"radius", 0.004},
                                {"density", 2500},
                                {"velocity", {0, 0, -8}},
                                {"layers", 100},
                                {"interval", 0.003},
                                {"region", {{"min", {-0.5, -0.5, 1}}, {"max", {0.5, 0.5, 1.02}}}}});
  return scene;
}

/// The rank says why, and run.json has the same words, whichever rank it is.
TEST_F(CliRanks, ARankWithoutMemoryTellsRunJson) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers reserve memory without an end";
#endif
  const fs::path growing = put(scratch / "rain.json", rain().dump());
  for (const int rank : {0, 1}) {
    SCOPED_TRACE(rank);
    const fs::path out = scratch / std::to_string(rank);
    Program program = start(2, by_rank(growing, growing, {"--quiet", "--out", out.string()}));
    ASSERT_TRUE(eventually([&] { return line_count(contents(out / "steps.csv")) > 3; }));
    const rlimit nothing_more{1 << 20, 1 << 20};
    ASSERT_EQ(::prlimit(process(rank), RLIMIT_AS, &nothing_more, nullptr), 0);
    const Result result = program.wait();
    EXPECT_NE(result.code, 0);
    const std::string said = "rank " + std::to_string(rank) + ": host memory exhausted";
    EXPECT_TRUE(holds(result.err, "scree: " + said)) << result.err;
    const nlohmann::json record = json_file(out / "run.json");
    EXPECT_EQ(record.at("status"), "failed");
    EXPECT_TRUE(holds(record.at("message").get<std::string>(), said)) << record.at("message");
    EXPECT_FALSE(record.at("end_time").is_null());
    EXPECT_EQ(record.at("scene_name"), "grains");
  }
}

}  // namespace
}  // namespace scree::test
