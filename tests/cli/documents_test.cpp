// What documents and generators of scenes say, against the program.

#include <regex>

#include "tests/cli/program.h"

namespace scree::test {
namespace {

TEST(CliDocuments, TheReadmeHasAllOptionsOfRun) {
  const Scratch scratch;
  const std::string help = scree(scratch, {"run", "--help"}).out;
  const std::string readme = contents(fs::path(SCREE_SOURCE_DIR) / "README.md");
  const std::string table = readme.substr(readme.find("| option of `run` |"));
  const std::string rows = table.substr(0, table.find("\n\n"));
  const std::regex option("\n  (?:-h,)?(--[a-z-]+)");
  int count = 0;
  for (std::sregex_iterator k(help.begin(), help.end(), option), end; k != end; ++k, ++count) {
    const std::string name = (*k)[1];
    if (name == "--help") continue;
    EXPECT_TRUE(std::regex_search(rows, std::regex("\n\\|[^|]*`" + name + "[` ]"))) << name;
  }
  EXPECT_GT(count, 10);
}

TEST(CliDocuments, GeneratedScenesStartWithoutOverlaps) {
  if (std::system("command -v python3 >/dev/null 2>&1") != 0) GTEST_SKIP() << "no python3";
  const Scratch scratch;
  const fs::path script = fs::path(SCREE_SOURCE_DIR) / "scenes/generators/joined.py";
  for (const std::string name : {"dumbbells", "catch", "cables", "limits"}) {
    const Result made =
        Program(scratch.path(), {"python3", script.string(), name}, 0, {}, "/usr/bin/env").wait();
    ASSERT_EQ(made.code, 0) << made.err;
    const fs::path scene = put(scratch / (name + ".json"), made.out);
    const Result check = scree(scratch, {"check", scene.string(), "--backend", "cpu", "--json"});
    ASSERT_EQ(check.code, 0) << check.err;
    EXPECT_EQ(nlohmann::json::parse(check.out).at("overlaps").at("pairs"), 0) << name;
  }
}

/// OpenMP takes its number of threads from the environment where no option says.
TEST(CliDocuments, RecordsTellTheThreadsOfTheEnvironment) {
  const Scratch scratch;
  const int other = std::thread::hardware_concurrency() == 1 ? 2 : 1;
  const auto environment = [&] { ::setenv("OMP_NUM_THREADS", std::to_string(other).c_str(), 1); };
  const fs::path scene = put_scene(scratch, small_scene());
  const Result run = Program(scratch.path(),
                             {"run", scene.string(), "--backend", "cpu", "--steps", "1", "--out",
                              (scratch / "a").string()},
                             0, environment)
                         .wait();
  ASSERT_EQ(run.code, 0) << run.err;
  EXPECT_EQ(json_file(scratch / "a/run.json").at("threads"), other);
  const Result bench = Program(scratch.path(),
                               {"bench", "step", "--backend", "cpu", "--sizes", "500", "--warmup",
                                "1", "--steps", "1", "--json", "bench.json"},
                               0, environment)
                           .wait();
  ASSERT_EQ(bench.code, 0) << bench.err;
  EXPECT_EQ(json_file(scratch / "bench.json").at("threads"), other);
}

}  // namespace
}  // namespace scree::test
