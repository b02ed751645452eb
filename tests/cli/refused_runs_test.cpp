// scree run of scenes that are refused late: no folder is made, and old results stay, --force or not.

#include <map>

#include "dynamics/dynamics_card.h"
#include "host/ranks/mpi_ranks.h"
#include "tests/cli/rank_runs.h"

namespace scree::test {
namespace {

/// All files of a folder with what they hold.
std::map<std::string, std::string> files_in(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    files.emplace(entry.path().filename().string(), contents(entry.path()));
  return files;
}

/// Two affine boxes that intersect, above walls that would be written: only making the World tells.
constexpr const char* kIntersecting = R"({
  "name": "intersecting", "time_step": 0.01, "duration": 0.1, "dynamics": {"type": "affine"},
  "bodies": [
    {"shape": "half_space", "normal": [0, 0, 1], "point": [0, 0, -1]},
    {"shape": "box", "size": [0.1, 0.1, 0.1], "density": 1000},
    {"shape": "box", "size": [0.1, 0.1, 0.1], "density": 1000, "position": [0.05, 0.02, 0.03]}]
})";

TEST(CliRefusedRun, BodiesThatIntersectLeaveOldResults) {
  if (find_dynamics("affine") == nullptr) GTEST_SKIP() << "no dynamics \"affine\"";
  const Scratch scratch;
  const fs::path good = put_scene(scratch, small_scene());
  const fs::path wrong = put(scratch / "wrong.json", kIntersecting);
  const fs::path out = scratch / "a";
  ASSERT_EQ(scree(scratch, run_arguments(good, out, {"--steps", "3"})).code, 0);
  const auto before = files_in(out);
  EXPECT_GT(before.size(), 4u);
  const Result forced = scree(scratch, run_arguments(wrong, out, {"--force"}));
  EXPECT_EQ(forced.code, 2) << forced.err;
  EXPECT_TRUE(holds(forced.err, "intersect at the start")) << forced.err;
  EXPECT_EQ(files_in(out), before);
  const Result fresh = scree(scratch, run_arguments(wrong, scratch / "b/c"));
  EXPECT_EQ(fresh.code, 2) << fresh.err;
  EXPECT_FALSE(fs::exists(scratch / "b"));
}

/// What only one rank can simulate.
TEST_F(CliRanks, ScenesForOneRankAreRefusedBeforeFilesChange) {
  const fs::path out = scratch / "a";
  ASSERT_EQ(scree(scratch, run_arguments(scene, out, {"--steps", "2"})).code, 0);
  const auto before = files_in(out);
  std::vector<std::string> values{"solver.name=gauss_seidel"};
  for (const char* dynamics : {"affine", "variational"})
    if (find_dynamics(dynamics) != nullptr)
      values.push_back(std::string("dynamics.type=") + dynamics);
  nlohmann::json box = grains();
  box.erase("particles");
  box.erase("solver");
  box["materials"]["m"]["friction"] = 0;  // which "variational" asks for
  box["bodies"].push_back(
      {{"shape", "box"}, {"size", {0.1, 0.1, 0.1}}, {"density", 1000}, {"position", {0, 0, 1}}});
  const fs::path one_box = put(scratch / "box.json", box.dump());
  for (const std::string& value : values) {
    SCOPED_TRACE(value);
    const bool is_solver = value.starts_with("solver");
    const fs::path wrong = is_solver ? scene : one_box;
    const std::string said = wrong.string() + ": " + value.substr(0, value.find('=')) +
                             " (overridden): \"" + value.substr(value.find('=') + 1) +
                             "\" is not allowed: runs on one rank only";
    expect_one_message(on_ranks(2, run_arguments(wrong, out, {"--force", "--set", value})), 2,
                       said);
    EXPECT_EQ(files_in(out), before);
    expect_one_message(on_ranks(2, run_arguments(wrong, scratch / "b", {"--set", value})), 2, said);
    EXPECT_FALSE(fs::exists(scratch / "b"));
    expect_one_message(on_ranks(2, {"check", wrong.string(), "--backend", "cpu", "--set", value}),
                       2, said);
    EXPECT_EQ(scree(scratch, {"check", wrong.string(), "--backend", "cpu", "--set", value}).code,
              0);
  }
}

}  // namespace
}  // namespace scree::test
