// Ranks on several hosts. The hosts are names that one machine goes by: the launcher starts its daemons by a script that
// takes the place of ssh and gives each a host name of its own, so that ranks share no memory and talk over TCP.

#include "host/io/checkpoint.h"
#include "host/ranks/nccl_messages.h"
#include "tests/cli/frame_count.h"
#include "tests/cli/rank_runs.h"
#include "tests/frame_bytes.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

class CliRankHosts : public CliRanks {
 protected:
  void SetUp() override {
    CliRanks::SetUp();
    if (IsSkipped()) return;
    put(scratch / "as_host.sh",
        "#!/bin/sh\n"
        "host=$1\n"
        "shift\n"
        "export NCCL_SOCKET_IFNAME=lo\n"
        "case $host in\n"
        "  alpha) export CUDA_VISIBLE_DEVICES=0 ;;\n"
        "  beta) export CUDA_VISIBLE_DEVICES=1 ;;\n"
        "esac\n"
        "exec unshare -u sh -c \"hostname $host && exec sh -c '$*'\"\n");
    fs::permissions(scratch / "as_host.sh", fs::perms::owner_all);
    const Result trial = start_on_hosts(2, {"hostname"}).wait();
    if (trial.code != 0 || count_of(trial.out, "alpha") != 1 || count_of(trial.out, "beta") != 1)
      GTEST_SKIP() << "host names cannot be given here: " << trial.out << trial.err;
    // Networks of containers may not carry what ranks say.
    const Result talk =
        start_on_hosts(2, {"timeout", "-k", "1", "20", SCREE_PROGRAM, "run", "missing.json"})
            .wait();
    if (talk.code != 2) GTEST_SKIP() << "ranks of two host names do not reach each other here";
  }

  /// Two hosts that have half of the ranks each, and a GPU.
  Program start_on_hosts(int ranks, const Arguments& command) const {
    const std::string slots = std::to_string(ranks / 2);
    Arguments all = launcher(ranks);
    all.insert(all.end(),
               {"--mca", "plm", "rsh", "--mca", "plm_rsh_agent", (scratch / "as_host.sh").string(),
                "--mca", "btl_tcp_if_include", "lo", "--mca", "oob_tcp_if_include", "lo", "--host",
                "alpha:" + slots + ",beta:" + slots});
    all.insert(all.end(), command.begin(), command.end());
    return Program(scratch.path(), all, 0, prepare, "/usr/bin/env");
  }
};

TEST_F(CliRankHosts, ARunIsThatOfOneHost) {
  const Arguments in_pieces{"--set", "output.frame_pieces=true"};
  const fs::path here = scratch / "here", apart = scratch / "apart";
  const Result one = on_ranks(4, run_arguments(scene, here, in_pieces));
  ASSERT_EQ(one.code, 0) << one.err;
  Arguments command{SCREE_PROGRAM};
  for (const std::string& each : run_arguments(scene, apart, in_pieces)) command.push_back(each);
  const Result result = start_on_hosts(4, command).wait();
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(count_of(result.err, "results in"), 1u) << result.err;
  EXPECT_EQ(steps_without_times(apart / "steps.csv"), steps_without_times(here / "steps.csv"));
  EXPECT_EQ(frame_count(apart / "frames.vtkhdf"), 5);
  expect_same_frames(apart / "frames.vtkhdf", here / "frames.vtkhdf");
}

TEST_F(CliRankHosts, ARankThatIsKilledEndsThoseOfTheOtherHost) {
  const fs::path out = scratch / "a";
  const Arguments endless{"--quiet", "--set", "duration=1000", "--out", out.string()};
  Program program = start_on_hosts(2, by_rank(scene, scene, endless));
  expect_all_end_without(1, 2, program, out);
}

/// GPUs of two hosts cannot write into each other's memory.
TEST_F(CliRankHosts, TheirGpusExchangeByNcclOrThroughThem) {
  std::string reason;
  if (!backend_available(BackendKind::cuda, &reason, 1))
    GTEST_SKIP() << "there is no second GPU: " << reason;
  std::vector<Checkpoint> ends;
  for (const char* transport : {"auto", "hosts"}) {
    const fs::path out = scratch / transport;
    Arguments command{SCREE_PROGRAM};
    for (const std::string& each : run_arguments(
             scene, out,
             {"--backend", "cuda", "--transport", transport, "--set", "solver.stop=1e-4"}))
      command.push_back(each);
    const Result result = start_on_hosts(2, command).wait();
    ASSERT_EQ(result.code, 0) << result.err;
    const bool by_nccl = transport == std::string("auto") && !nccl_version().empty();
    EXPECT_EQ(count_of(result.err, by_nccl ? "transport nccl;" : "transport hosts;"), 1u)
        << result.err;
    ends.push_back(read_checkpoint(out / "checkpoint.h5"));
  }
  EXPECT_EQ(ends[0].state.at<Vec3d>("body/position"), ends[1].state.at<Vec3d>("body/position"));
}

}  // namespace
}  // namespace scree::test
