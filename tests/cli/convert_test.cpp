// scree convert: contact problems as FCLIB files.
#include <hdf5.h>
#include <sys/stat.h>

#include <cmath>

#include "host/io/h5.h"
#include "host/io/problem_file.h"
#include "tests/cli/program.h"
#include "tests/rolling_samples.h"

namespace scree::test {
namespace {

/// The contact problem of a step of the small scene.
fs::path put_dump(const Scratch& scratch) {
  const fs::path scene = put_scene(scratch, small_scene());
  const Result run = scree(
      scratch, run_arguments(scene, scratch / "a", {"--steps", "12", "--dump-problem", "12"}));
  EXPECT_EQ(run.code, 0) << run.err;
  return scratch / "a/problem_12.hdf5";
}

double objective_of(const Scratch& scratch, const fs::path& problem, const Arguments& more = {}) {
  Arguments all{"solve",    problem.string(), "--json",      "--model", "convex",
                "--solver", "apgd,proximal",  "--tolerance", "1e-9"};
  all.insert(all.end(), more.begin(), more.end());
  const Result result = scree(scratch, all);
  EXPECT_EQ(result.code, 0) << result.err;
  const nlohmann::json run =
      nlohmann::json::parse(result.out).at("problems").at(0).at("runs").at(1);
  EXPECT_TRUE(run.at("converged")) << run.dump(1);
  return run.at("objective");
}

TEST(CliConvert, ARunsProblemHasTheSameMinimumInBothKinds) {
  const Scratch scratch;
  const fs::path dump = put_dump(scratch);
  const double objective = objective_of(scratch, dump);
  for (const char* kind : {"local", "global"}) {
    const fs::path out = scratch / (std::string(kind) + ".hdf5");
    const Result result = scree(scratch, {"convert", dump.string(), out.string(), "--kind", kind});
    EXPECT_EQ(result.code, 0) << result.err;
    EXPECT_EQ(line_count(result.out), 1u) << result.out;
    EXPECT_NE(result.out.find(kind), std::string::npos) << result.out;
    EXPECT_EQ(read_problem(out).guesses.size(), 1u);
    EXPECT_NEAR(objective_of(scratch, out), objective, 1e-8 * std::abs(objective)) << kind;
    EXPECT_NEAR(objective_of(scratch, out, {"--warm-start"}), objective,
                1e-8 * std::abs(objective));
  }
  EXPECT_TRUE(std::holds_alternative<LocalProblem>(read_problem(scratch / "local.hdf5").form));
  EXPECT_TRUE(std::holds_alternative<GlobalProblem>(read_problem(scratch / "global.hdf5").form));
}

TEST(CliConvert, AGlobalFileBecomesALocalOneInTheStorageAskedFor) {
  const Scratch scratch;
  const std::string dump = put_dump(scratch).string();
  const std::string global = (scratch / "global.hdf5").string();
  ASSERT_EQ(scree(scratch, {"convert", dump, global, "--kind", "global"}).code, 0);
  ASSERT_EQ(scree(scratch, {"convert", dump, (scratch / "direct.hdf5").string()}).code, 0);
  const StoredProblem direct = read_problem(scratch / "direct.hdf5");
  const auto& expected = std::get<LocalProblem>(direct.form);
  for (const auto& [storage, nz] :
       {std::pair{"rows", -2}, std::pair{"columns", -1}, std::pair{"triplets", 0}}) {
    const fs::path out = scratch / (std::string(storage) + ".hdf5");
    const Result result = scree(scratch, {"convert", global, out.string(), "--storage", storage});
    ASSERT_EQ(result.code, 0) << result.err;
    const auto stored_nz =
        h5::File::open(out).root().read_converted<std::int64_t>("fclib_local/W/nz").at(0);
    if (nz < 0) {
      EXPECT_EQ(stored_nz, nz);
    } else {
      EXPECT_GT(stored_nz, 0);
    }
    const StoredProblem read = read_problem(out);
    const auto& local = std::get<LocalProblem>(read.form);
    EXPECT_EQ(local.mu, expected.mu);
    ASSERT_EQ(local.q.size(), expected.q.size());
    for (std::size_t k = 0; k < local.q.size(); ++k)
      EXPECT_NEAR(local.q[k], expected.q[k], 1e-9) << k;
    ASSERT_EQ(read.guesses.size(), 1u);
    EXPECT_TRUE(read.guesses[0].v.empty());
    EXPECT_EQ(read.guesses[0].r, direct.guesses.at(0).r);
    EXPECT_EQ(read.info, direct.info);
  }
}

TEST(CliConvert, RollingFrictionStays) {
  const Scratch scratch;
  StoredProblem stored;
  stored.form = fixtures::rolling_pile(2, 2, 0.4, 0.01, 3);
  const fs::path global = scratch / "global.hdf5", local = scratch / "local.hdf5";
  write_problem(global, stored);
  const Result result = scree(scratch, {"convert", global.string(), local.string()});
  ASSERT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("local, 16 contacts with rolling friction"), std::string::npos)
      << result.out;
  const StoredProblem read = read_problem(local);
  const auto& p = std::get<LocalProblem>(read.form);
  EXPECT_EQ(p.dimension, 5);
  EXPECT_EQ(p.mu_r, std::vector<double>(16, 0.01));
  EXPECT_NEAR(objective_of(scratch, local), objective_of(scratch, global), 1e-12);
}

TEST(CliConvert, AFileThatIsThereIsReplacedWhenTold) {
  const Scratch scratch;
  const std::string dump = put_dump(scratch).string();
  const fs::path out = put(scratch / "out.hdf5", "mine");
  const Result refused = scree(scratch, {"convert", dump, out.string()});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--force"), std::string::npos) << refused.err;
  EXPECT_EQ(contents(out), "mine");
  EXPECT_EQ(scree(scratch, {"convert", dump, out.string(), "--force"}).code, 0);
  EXPECT_GT(std::get<LocalProblem>(read_problem(out).form).contact_count(), 0);
}

TEST(CliConvert, NothingOfAnotherFileGetsIntoTheOutput) {
  const Scratch scratch;
  const fs::path dump = put_dump(scratch);
  const std::string secret = (scratch / "secret.hdf5").string();
  const std::string link = (scratch / "link.hdf5").string();
  ASSERT_EQ(scree(scratch, {"convert", dump.string(), secret}).code, 0);
  const hid_t file = H5Fcreate(link.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  H5Lcreate_external("secret.hdf5", "fclib_local", file, "fclib_local", H5P_DEFAULT, H5P_DEFAULT);
  H5Fclose(file);
  for (const Arguments& arguments :
       {Arguments{"convert", link, "out.hdf5"}, Arguments{"solve", link}}) {
    const Result result = scree(scratch, arguments);
    EXPECT_EQ(result.code, 2) << result.out;
    EXPECT_NE(result.err.find("external link to the file \"secret.hdf5\""), std::string::npos)
        << result.err;
  }
  EXPECT_FALSE(fs::exists(scratch / "out.hdf5"));
}

TEST(CliConvert, WhatIsNoOrdinaryFileIsNotReplaced) {
  const Scratch scratch;
  const std::string dump = put_dump(scratch).string();
  const fs::path pipe = scratch / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const Result result = scree(scratch, {"convert", dump, pipe.string(), "--force"});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("no ordinary file"), std::string::npos) << result.err;
  EXPECT_TRUE(fs::is_fifo(pipe));
}

TEST(CliConvert, BadUseIsOneLineAndLeavesNothing) {
  const Scratch scratch;
  LocalProblem p;
  p.W = compress(3, 3, {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}});
  p.q = {-1, 0, 0};
  p.mu = {0.3};
  StoredProblem stored;
  stored.form = p;
  write_problem(scratch / "local.hdf5", stored);
  put(scratch / "text.hdf5", "not a problem");
  const struct {
    Arguments arguments;
    std::vector<std::string> words;
  } uses[] = {
      {{"local.hdf5", "out.hdf5", "--kind", "both"}, {"--kind", "\"both\"", "local or global"}},
      {{"local.hdf5", "out.hdf5", "--kind", "global"}, {"local.hdf5", "M and H"}},
      {{"local.hdf5", "out.hdf5", "--storage", "dense"}, {"--storage", "\"dense\"", "triplets"}},
      {{"nothing.hdf5", "out.hdf5"}, {"nothing.hdf5", "no such file"}},
      {{"text.hdf5", "out.hdf5"}, {"text.hdf5", "not an HDF5 file"}},
      {{"local.hdf5", "no/out.hdf5"}, {"no/out.hdf5", "no folder"}},
      {{"local.hdf5", "."}, {"is a directory"}},
      {{"local.hdf5"}, {"out is required"}},
  };
  for (const auto& use : uses) {
    Arguments all{"convert"};
    all.insert(all.end(), use.arguments.begin(), use.arguments.end());
    const Result result = scree(scratch, all);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(line_count(result.err), 1u) << result.err;
    for (const std::string& word : use.words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
    EXPECT_FALSE(fs::exists(scratch / "out.hdf5"));
  }
}

}  // namespace
}  // namespace scree::test
