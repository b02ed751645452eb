// Problems with bilateral rows on the command line: from a scene with joints to solved FCLIB files.
#include "host/io/h5.h"
#include "host/io/problem_file.h"
#include "tests/cli/program.h"

namespace scree::test {
namespace {

using nlohmann::json;

/// The problem of a step of the scene `pendulum`: a chain on seven joints beside a pile of boxes.
fs::path put_pendulum(const Scratch& scratch) {
  const Result run =
      scree(scratch, {"run", "pendulum", "--backend", "cpu", "--precision", "double", "--steps",
                      "39", "--dump-problem", "39", "--quiet", "--out", (scratch / "a").string()});
  EXPECT_EQ(run.code, 0) << run.err;
  return scratch / "a/problem_39.hdf5";
}

json solved(const Scratch& scratch, const fs::path& problem, const Arguments& more) {
  Arguments all{"solve", problem.string(), "--json"};
  all.insert(all.end(), more.begin(), more.end());
  const Result result = scree(scratch, all);
  EXPECT_EQ(result.code, 0) << result.err;
  return json::parse(result.out).at("problems").at(0);
}

TEST(CliBilateral, AJointedSceneIsSolvedFromAllItsFiles) {
  const Scratch scratch;
  const fs::path dump = put_pendulum(scratch);
  const auto bodies = std::get<BodyProblem>(read_problem(dump).form);
  EXPECT_EQ(bodies.bilateral.size(), 6u * 5 + 3);
  const Arguments options{"--model",     "convex", "--solver", "auto,apgd,interior_point",
                          "--tolerance", "1e-9"};
  const json of_bodies = solved(scratch, dump, options);
  EXPECT_EQ(of_bodies.at("bilateral_rows"), 33);
  const double objective = of_bodies.at("runs").at(0).at("objective");
  ASSERT_LT(objective, 0);
  std::vector<json> all{of_bodies};
  for (const char* kind : {"local", "global"}) {
    const fs::path out = scratch / (std::string(kind) + ".hdf5");
    const Result result = scree(scratch, {"convert", dump.string(), out.string(), "--kind", kind});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_NE(result.out.find("33 bilateral rows"), std::string::npos) << result.out;
    EXPECT_EQ(read_problem(out).guesses.at(0).l.size(), 33u);
    all.push_back(solved(scratch, out, options));
    all.push_back(solved(scratch, out, {"--model", "convex", "--warm-start"}));
  }
  for (const json& problem : all)
    for (const json& run : problem.at("runs")) {
      EXPECT_TRUE(run.at("converged")) << run.dump(1);
      EXPECT_NEAR(run.at("objective"), objective, 1e-7 * std::abs(objective)) << run.dump(1);
    }
}

TEST(CliBilateral, SolutionsHaveTheImpulsesOfTheRows) {
  const Scratch scratch;
  const fs::path dump = put_pendulum(scratch), local = scratch / "local.hdf5";
  ASSERT_EQ(scree(scratch, {"convert", dump.string(), local.string()}).code, 0);
  const fs::path out = scratch / "solution.hdf5";
  ASSERT_EQ(
      scree(scratch, {"solve", local.string(), "--solution", out.string(), "--tolerance", "1e-9"})
          .code,
      0);
  const auto p = std::get<LocalProblem>(read_problem(local).form);
  const h5::File file = h5::File::open(out);
  const auto read = [&](const char* name) {
    return file.root().read_converted<double>(std::string("solution/") + name);
  };
  // 0 = V^T r + R l + s of the file itself.
  std::vector<double> left = multiply(transpose(p.V), read("r"));
  const std::vector<double> by_l = multiply(p.R, read("l"));
  for (std::size_t k = 0; k < left.size(); ++k) EXPECT_NEAR(left[k] + by_l[k] + p.s[k], 0, 1e-10);
}

TEST(CliBilateral, SolversThatDoNotKnowTheRowsAreRefusedByName) {
  const Scratch scratch;
  const fs::path dump = put_pendulum(scratch);
  const Result some = scree(scratch, {"solve", dump.string(), "--solver", "nlgs,pgs_box"});
  EXPECT_EQ(some.code, 2);
  EXPECT_NE(some.err.find("bilateral rows, which pgs_box does not know; these do: jacobi, "),
            std::string::npos)
      << some.err;
  EXPECT_EQ(some.out, "");
  const Result free = scree(scratch, {"solve", dump.string(), "--matrix-free"});
  EXPECT_EQ(free.code, 2);
  EXPECT_NE(free.err.find("--matrix-free does not know"), std::string::npos) << free.err;
  const Result all = scree(scratch, {"solve", dump.string(), "--solver", "all", "--max-iterations",
                                     "3", "--max-seconds", "5"});
  EXPECT_EQ(all.code, 0) << all.err;
  EXPECT_NE(all.out.find("33 bilateral rows"), std::string::npos) << all.out;
  EXPECT_NE(all.out.find("cpg_box"), std::string::npos) << all.out;
  EXPECT_EQ(all.out.find("pgs_"), std::string::npos) << all.out;
}

TEST(CliBilateral, DependentAndContradictoryRowsAreNamed) {
  const Scratch scratch;
  const fs::path dump = put_pendulum(scratch);
  StoredProblem stored = read_problem(dump);
  auto& bodies = std::get<BodyProblem>(stored.form);
  bodies.bilateral.push_back(bodies.bilateral[2]);
  write_problem(scratch / "twice.hdf5", stored);
  const Result twice = scree(scratch, {"solve", (scratch / "twice.hdf5").string()});
  EXPECT_NE(twice.out.find("34 bilateral rows (1 depend on others)"), std::string::npos)
      << twice.out;
  EXPECT_NE(twice.out.find("converged"), std::string::npos) << twice.out;
  bodies.bilateral.back().bias += 0.5;
  write_problem(scratch / "both.hdf5", stored);
  const json both = solved(scratch, scratch / "both.hdf5", {}).at("runs").at(0);
  EXPECT_EQ(both.at("status"), "no solution");
  EXPECT_NE(both.at("note").get<std::string>().find("bilateral rows contradict each other: row "),
            std::string::npos)
      << both.dump(1);
  EXPECT_GT(both.at("residual"), 0.1);
}

TEST(CliBilateral, ScenesWithDrivenJointsAreRefusedBeforeTheFirstStep) {
  const Scratch scratch;
  const Result result = scree(scratch, {"run", "linkage", "--backend", "cpu", "--steps", "2",
                                        "--dump-problem", "1", "--out", (scratch / "a").string()});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("--dump-problem: joints[0] (hinge) has a motor, which files of contact "
                            "problems do not hold; expected joints without limits"),
            std::string::npos)
      << result.err;
  EXPECT_FALSE(fs::exists(scratch / "a"));
}

}  // namespace
}  // namespace scree::test
