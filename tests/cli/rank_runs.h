#pragma once
// Runs the program scree on several ranks, as `mpirun -n 3 scree run SCENE` does.

#include "host/io/checkpoint.h"
#include "host/ranks/mpi_ranks.h"
#include "tests/cli/program.h"

namespace scree::test {

/// Spheres that fall on a floor, some of which touch it and each other from the first step on.
inline nlohmann::json grains() {
  return nlohmann::json::parse(R"({
    "name": "grains", "time_step": 1e-3, "duration": 0.02, "precision": "double",
    "materials": {"m": {"friction": 0.4}},
    "solver": {"name": "apgd", "stop": 1e-6, "max_iterations": 2000},
    "bodies": [{"shape": "half_space", "normal": [0, 0, 1]}],
    "particles": [
      {"layout": "lattice", "count": 300, "radius": {"min": 0.009, "max": 0.01}, "density": 2500,
       "velocity": [0, 0, -2], "region": {"min": [-0.1, -0.1, 0], "max": [0.1, 0.1, 0.3]}}
    ],
    "output": {"frame_interval": 0.005, "checkpoint_interval": 0.005, "picture": false}
  })");
}

/// What the launcher needs where tests run: as root, on few processors, in a container. Five minutes end it and its ranks.
class CliRanks : public testing::Test {
 protected:
  void SetUp() override {
    if (mpi_version().empty()) GTEST_SKIP() << "this scree was built without MPI";
    if (std::system("command -v mpirun >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no mpirun";
    if (!mpi_version().starts_with("Open MPI"))
      GTEST_SKIP() << "these tests know the launcher of Open MPI, this is " << mpi_version();
    const Result trial = start(2, {"true"}).wait();
    if (trial.code != 0) GTEST_SKIP() << "mpirun starts no two processes here: " << trial.err;
    put(scratch / "rank.sh",
        "#!/bin/sh\n"
        "echo $$ > pid.$OMPI_COMM_WORLD_RANK\n"
        "case $OMPI_COMM_WORLD_RANK in\n"
        "  0) scene=$1 ;;\n"
        "  *) scene=$2 ;;\n"
        "esac\n"
        "shift 2\n"
        "exec " SCREE_PROGRAM " run \"$scene\" --backend cpu \"$@\"\n");
  }

  static Arguments launcher(int ranks) {
    return {"timeout",
            "-k",
            "10",
            "300",
            "mpirun",
            "--allow-run-as-root",
            "--oversubscribe",
            "-n",
            std::to_string(ranks)};
  }

  static void prepare() {
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    ::setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 1);
    ::setenv("OMPI_MCA_mpi_yield_when_idle", "1", 1);
    ::setenv("OMPI_MCA_pml", "ob1", 1);  // a look for other networks takes half of a short run
    ::setenv("OMP_NUM_THREADS", "1", 1);
    ::setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // Open MPI keeps memory of unloaded modules
  }

  Program start(int ranks, const Arguments& command) const {
    Arguments all = launcher(ranks);
    all.insert(all.end(), command.begin(), command.end());
    return Program(scratch.path(), all, 0, prepare, "/usr/bin/env");
  }

  /// scree with these arguments on some ranks.
  Result on_ranks(int ranks, const Arguments& arguments) const {
    Arguments command{SCREE_PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return start(ranks, command).wait();
  }

  /// `scree run` whose rank 0 is given one scene and the others another one; each leaves its number of process in pid.RANK.
  Arguments by_rank(const fs::path& first, const fs::path& others, const Arguments& more) const {
    Arguments command{"sh", (scratch / "rank.sh").string(), first.string(), others.string()};
    command.insert(command.end(), more.begin(), more.end());
    return command;
  }

  pid_t process(int rank) const {
    return static_cast<pid_t>(std::stol(contents(scratch / ("pid." + std::to_string(rank)))));
  }

  /// Kills a rank once its run has a checkpoint and some steps: all end within 30 s, with an error, and the checkpoint stays.
  void expect_all_end_without(int killed, int ranks, Program& program, const fs::path& out) const {
    ASSERT_TRUE(eventually([&] {
      return fs::exists(out / "checkpoint.h5") && line_count(contents(out / "steps.csv")) > 5;
    }));
    const auto begin = std::chrono::steady_clock::now();
    ::kill(process(killed), SIGKILL);
    const Result result = program.wait();
    EXPECT_NE(result.code, 0) << result.err;
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
    for (int rank = 0; rank < ranks; ++rank)
      EXPECT_TRUE(eventually([&] { return ::kill(process(rank), 0) != 0; })) << rank;
    EXPECT_GT(read_checkpoint(out / "checkpoint.h5").state.step, 0);
  }

  Scratch scratch;
  fs::path scene = put_scene(scratch, grains());
};

inline std::size_t count_of(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++count;
  return count;
}

/// The launcher adds lines of its own when a rank ends with an error.
inline void expect_one_message(const Result& result, int code, const std::string& part) {
  EXPECT_EQ(result.code, code) << result.err;
  EXPECT_EQ(count_of(result.err, "scree: "), 1u) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
}

}  // namespace scree::test
