// Scenes on the GPUs of ranks, and how these exchange data: mpirun -n 2 scree run SCENE --transport nccl.

#include "host/io/checkpoint.h"
#include "host/ranks/nccl_messages.h"
#include "tests/cli/rank_runs.h"
#include "tests/frame_bytes.h"
#include "tests/steps_file.h"

namespace scree::test {
namespace {

TEST(CliTransport, IsForGpusAndOneOfFour) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, grains());
  const Arguments on_cpu{"--backend", "cpu", "--transport"};
  const auto refusal = [&](const std::string& name) {
    Arguments more = on_cpu;
    more.push_back(name);
    const Result result = scree(scratch, run_arguments(scene, scratch / "a", more));
    EXPECT_EQ(result.code, 2) << result.err;
    return result.err;
  };
  EXPECT_NE(refusal("smoke").find(
                "--transport: \"smoke\" is not allowed: expected auto, peer, nccl or hosts"),
            std::string::npos);
  EXPECT_NE(refusal("hosts").find("--transport hosts: is for the backend cuda, this is cpu"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

/// Two ranks with a GPU each.
class CliRankGpus : public CliRanks {
 protected:
  void SetUp() override {
    std::string reason;
    if (!backend_available(BackendKind::cuda, &reason, 1))
      GTEST_SKIP() << "there is no second GPU: " << reason;
    CliRanks::SetUp();
  }

  Arguments on_gpus(const fs::path& out, const std::string& transport,
                    const std::string& precision) const {
    return run_arguments(scene, out,
                         {"--backend", "cuda", "--precision", precision, "--transport", transport,
                          "--set", "solver.stop=1e-4"});
  }

  bool have_peer_access() const {
    return on_ranks(2, on_gpus(scratch / "trial", "peer", "float")).code == 0;
  }

  /// The end of a run over a transport.
  WorldState end_over(const std::string& transport, const std::string& precision) const {
    const fs::path out = scratch / (transport + "_" + precision);
    const Result result = on_ranks(2, on_gpus(out, transport, precision));
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(count_of(result.err, "2 ranks, transport " + transport + ";"), 1u) << result.err;
    EXPECT_EQ(json_file(out / "run.json").value("transport", ""), transport);
    return result.code == 0 ? read_checkpoint(out / "checkpoint.h5").state : WorldState{};
  }

  /// States of all bodies, to the last bit.
  static void expect_same_bits(const WorldState& a, const WorldState& b) {
    ASSERT_GT(a.step, 0);
    EXPECT_EQ(a.step, b.step);
    for (const char* name : {"body/position", "body/velocity", "body/angular_velocity"}) {
      const auto& x = a.at<Vec3d>(name);
      const auto& y = b.at<Vec3d>(name);
      ASSERT_EQ(x.size(), y.size());
      ASSERT_FALSE(x.empty());
      EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(Vec3d)), 0) << name;
    }
  }
};

/// A transport carries numbers, and changes none. (In float GPUs that write into each other's memory meet in their kernels, and
/// add sums up in another order.)
TEST_F(CliRankGpus, EveryTransportGivesTheSameBits) {
  const WorldState over_hosts = end_over("hosts", "double");
  if (have_peer_access()) expect_same_bits(over_hosts, end_over("peer", "double"));
  if (nccl_version().empty()) GTEST_SKIP() << "this scree was built without NCCL";
  expect_same_bits(over_hosts, end_over("nccl", "double"));
  expect_same_bits(end_over("hosts", "float"), end_over("nccl", "float"));
}

/// One rank has no body, and neither shows the other any.
TEST_F(CliRankGpus, OneBodyTakesEveryTransport) {
  nlohmann::json one = grains();
  one["particles"][0]["count"] = 1;
  one["bodies"].push_back(
      {{"shape", "sphere"}, {"radius", 0.01}, {"position", {0.1, 0, 0.01}}, {"density", 2500}});
  scene = put_scene(scratch, one);
  const WorldState over_hosts = end_over("hosts", "double");
  if (have_peer_access()) expect_same_bits(over_hosts, end_over("peer", "double"));
  if (!nccl_version().empty()) expect_same_bits(over_hosts, end_over("nccl", "double"));
}

/// GPUs of one host that can write into each other's memory do so.
TEST_F(CliRankGpus, TheFastestIsTakenWithoutAWord) {
  if (!have_peer_access()) GTEST_SKIP() << "these GPUs have no access to each other's memory";
  const Result result = on_ranks(2, on_gpus(scratch / "a", "auto", "float"));
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(count_of(result.err, "2 ranks, transport peer;"), 1u) << result.err;
}

/// An error of rank 0 alone: the others end what they share with it.
TEST_F(CliRankGpus, AFailedRunEndsAllWithOneMessage) {
  for (const char* transport : {"auto", "nccl", "hosts"}) {
    if (transport == std::string("nccl") && nccl_version().empty()) continue;
    SCOPED_TRACE(transport);
    Arguments command = on_gpus(scratch / transport, transport, "float");
    command.insert(command.end(), {"--require-convergence", "--quiet", "--set",
                                   "solver.max_iterations=1", "--set", "solver.stop=1e-9"});
    const auto begin = std::chrono::steady_clock::now();
    expect_one_message(on_ranks(2, command), 1, "iteration cap");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(30));
  }
}

/// NCCL knows no two ranks on one GPU.
TEST_F(CliRankGpus, NcclIsRefusedForRanksThatShareAGpu) {
  if (nccl_version().empty()) GTEST_SKIP() << "this scree was built without NCCL";
  Arguments shared = on_gpus(scratch / "a", "nccl", "float");
  shared.insert(shared.end(), {"--device", "0"});
  expect_one_message(on_ranks(2, shared), 1, "transport nccl: ranks share a GPU");
}

/// The other rank waits in a kernel for one that is no more.
TEST_F(CliRankGpus, ARankThatIsKilledEndsTheOtherOverNccl) {
  if (nccl_version().empty()) GTEST_SKIP() << "this scree was built without NCCL";
  const fs::path out = scratch / "a";
  put(scratch / "gpu_rank.sh",
      "#!/bin/sh\necho $$ > pid.$OMPI_COMM_WORLD_RANK\nexec " SCREE_PROGRAM " \"$@\"\n");
  Arguments command{"sh", (scratch / "gpu_rank.sh").string()};
  const Arguments endless = on_gpus(out, "nccl", "double");
  command.insert(command.end(), endless.begin(), endless.end());
  command.insert(command.end(), {"--set", "duration=1000"});
  Program program = start(2, command);
  expect_all_end_without(1, 2, program, out);
}

/// Dumbbells that fall on a floor and each other.
nlohmann::json dumbbells() {
  nlohmann::json scene = grains();
  scene["particles"][0] = nlohmann::json::parse(R"({
    "layout": "lattice", "count": 200, "density": 2500, "spacing": 0.04, "orientation": "random",
    "shapes": [{"shape": "compound", "parts": [
      {"shape": "sphere", "radius": 0.008, "position": [0, 0, 0.008]},
      {"shape": "box", "size": [0.01, 0.01, 0.016], "position": [0, 0, -0.006]}]}],
    "velocity": [0, 0, -2], "region": {"min": [-0.13, -0.13, 0], "max": [0.13, 0.13, 0.3]}
  })");
  scene["solver"]["stop"] = 1e-10;
  scene["solver"]["max_iterations"] = 100000;
  return scene;
}

TEST_F(CliRankGpus, CompoundsStepAsOnOneGpuAndTheirFramesComeInPieces) {
  const fs::path file = put(scratch / "dumbbells.json", dumbbells().dump());
  const auto run = [&](int ranks, const std::string& out, Arguments more) {
    more.insert(more.begin(), {"--backend", "cuda"});
    const Result result = on_ranks(ranks, run_arguments(file, scratch / out, more));
    EXPECT_EQ(result.code, 0) << result.err;
  };
  run(1, "one", {"--steps", "19"});
  fs::copy(scratch / "one", scratch / "two", fs::copy_options::recursive);
  run(1, "one", {"--resume", "--steps", "20"});
  run(2, "two", {"--resume", "--steps", "20"});
  const WorldState one = read_checkpoint(scratch / "one/checkpoint.h5").state;
  const WorldState two = read_checkpoint(scratch / "two/checkpoint.h5").state;
  const auto by_id = [](const WorldState& state) {
    const auto& id = state.at<std::int32_t>("body/id");
    const auto& velocity = state.at<Vec3d>("body/velocity");
    std::map<std::int32_t, Vec3d> of;
    for (std::size_t i = 0; i < id.size(); ++i) of[id[i]] = velocity[i];
    return of;
  };
  const std::map<std::int32_t, Vec3d> v = by_id(one), w = by_id(two);
  ASSERT_EQ(v.size(), 200u);
  ASSERT_EQ(w.size(), v.size());
  EXPECT_GT(read_steps_csv(scratch / "one/steps.csv").back().contact_count, 20);
  for (const auto& [id, velocity] : v) EXPECT_LT(norm(w.at(id) - velocity), 1e-7) << "body " << id;

  run(2, "whole", {});
  run(2, "pieces", {"--set", "output.frame_pieces=true"});
  expect_same_frames(scratch / "pieces/frames.vtkhdf", scratch / "whole/frames.vtkhdf");
}

}  // namespace
}  // namespace scree::test
