// scree solve: tables, files and refusals.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/io/h5.h"
#include "host/io/problem_file.h"
#include "host/plot/draw.h"
#include "tests/cli/program.h"
#include "tests/rolling_samples.h"

namespace scree::test {
namespace {

using nlohmann::json;

/// Contacts side by side that each press and slide: W is a diagonal.
StoredProblem simple_problem(int dimension, int contact_count) {
  LocalProblem p;
  p.dimension = dimension;
  const int rows = dimension * contact_count;
  std::vector<MatrixEntry> entries;
  entries.reserve(static_cast<std::size_t>(rows));
  for (int k = 0; k < rows; ++k) entries.push_back({k, k, 2});
  p.W = compress(rows, rows, entries);
  for (int c = 0; c < contact_count; ++c) {
    for (int k = 0; k < dimension; ++k) p.q.push_back(k == 0 ? -1.0 : 0.5 * (c + k));
    p.mu.push_back(0.3);
  }
  StoredProblem stored;
  stored.form = p;
  return stored;
}

fs::path put_problem(const fs::path& path, const StoredProblem& problem) {
  write_problem(path, problem);
  return path;
}

json solve_json(const Scratch& scratch, const Arguments& more) {
  Arguments all{"solve", "--json"};
  all.insert(all.end(), more.begin(), more.end());
  const Result result = scree(scratch, all);
  EXPECT_EQ(result.code, 0) << result.err;
  const bool says_no_charts = result.err.find("built without Cairo") != std::string::npos;
  EXPECT_EQ(line_count(result.err), says_no_charts && !can_draw() ? 1u : 0u) << result.err;
  return json::parse(result.out);
}

TEST(CliSolve, PrintsOneLineASolver) {
  const Scratch scratch;
  const fs::path file = put_problem(scratch / "a.hdf5", simple_problem(3, 4));
  const Result result = scree(scratch, {"solve", file.string(), "--solver", "all"});
  EXPECT_EQ(result.code, 0) << result.err;
  for (const char* word : {"a: 4 contacts in 3-D, on cpu", "residual", "objective", "status",
                           "auto", "nlgs", "newton", "proximal", "extragradient", "converged"})
    EXPECT_NE(result.out.find(word), std::string::npos) << word << " in " << result.out;
}

TEST(CliSolve, SolvesRollingFrictionByWhatCan) {
  const Scratch scratch;
  StoredProblem stored;
  stored.form = fixtures::rolling_pile(3, 2, 0.4, 0.01, 5);
  const fs::path file = put_problem(scratch / "rolls.hdf5", stored);
  for (const char* model : {"convex", "exact"}) {
    const json out = solve_json(scratch, {file.string(), "--solver", "all", "--model", model});
    const json& problem = out.at("problems").at(0);
    EXPECT_EQ(problem.at("contacts"), 42);
    ASSERT_EQ(problem.at("runs").size(), 4u);
    for (const json& run : problem.at("runs")) EXPECT_TRUE(run.at("converged")) << run.dump(1);
    // What it reached is a file and a reference for others.
    const std::string found = (scratch / (std::string(model) + ".hdf5")).string();
    const Result best =
        scree(scratch, {"solve", file.string(), "--model", model, "--solution", found});
    ASSERT_EQ(best.code, 0) << best.err;
    EXPECT_NE(best.out.find("rolls: 42 contacts with rolling friction"), std::string::npos);
    EXPECT_NE(best.out.find("auto "), std::string::npos) << best.out;
    EXPECT_EQ(h5::File::open(found).root().read<double>("solution/r").size(), 210u);
    EXPECT_EQ(h5::File::open(found).root().read<double>("solution/u").size(), 210u);
    const json again = solve_json(
        scratch, {file.string(), "--solver", "nlgs", "--model", model, "--reference", found});
    EXPECT_TRUE(again.at("problems").at(0).at("runs").at(0).at("converged"));
  }
  const Result other = scree(scratch, {"solve", file.string(), "--solver", "nlgs,newton"});
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("solver \"newton\" does not solve problems with rolling friction; those "
                           "that do: auto, nlgs, apgd, proximal"),
            std::string::npos)
      << other.err;
}

TEST(CliSolve, AFolderMayMixProblemsWithAndWithoutRollingFriction) {
  const Scratch scratch;
  fs::create_directories(scratch / "mixed");
  StoredProblem stored;
  stored.form = fixtures::rolling_sphere(0.5, 0.01);
  put_problem(scratch / "mixed/a.hdf5", stored);
  put_problem(scratch / "mixed/b.hdf5", simple_problem(3, 3));
  const Result all = scree(scratch, {"solve", "mixed", "--solver", "all", "--out", "out"});
  EXPECT_EQ(all.code, 0) << all.err;
  EXPECT_NE(all.out.find("newton                         1"), std::string::npos) << all.out;
  EXPECT_NE(all.out.find("nlgs                           2"), std::string::npos) << all.out;
  const std::string header = contents(scratch / "out/profile_seconds.csv");
  EXPECT_NE(header.substr(0, header.find('\n')).find("newton"), std::string::npos) << header;
  const Result one = scree(scratch, {"solve", "mixed", "--solver", "newton"});
  EXPECT_EQ(one.code, 1);
  EXPECT_NE(one.err.find("skipped: a: solver \"newton\" does not"), std::string::npos) << one.err;
}

TEST(CliSolve, AllSolversAgreeInBothDimensionsAndModels) {
  const Scratch scratch;
  for (const int dimension : {2, 3}) {
    const fs::path file = put_problem(scratch / "a.hdf5", simple_problem(dimension, 5));
    for (const char* model : {"convex", "exact"}) {
      const json out = solve_json(scratch, {file.string(), "--solver", "all", "--model", model});
      EXPECT_EQ(out.at("model"), model);
      const json& problem = out.at("problems").at(0);
      EXPECT_EQ(problem.at("contacts"), 5);
      EXPECT_EQ(problem.at("dimension"), dimension);
      const double objective = problem.at("runs").at(0).at("objective");
      for (const json& run : problem.at("runs")) {
        if (run.at("friction") != "cone") continue;  // another law, with another solution
        EXPECT_TRUE(run.at("converged")) << run.dump(1);
        EXPECT_LE(run.at("residual"), 1e-8);
        EXPECT_NEAR(run.at("objective"), objective, 1e-6 * std::abs(objective)) << run.dump(1);
      }
    }
  }
}

TEST(CliSolve, WritesResultsAndCurves) {
  const Scratch scratch;
  const fs::path file = put_problem(scratch / "a.hdf5", simple_problem(3, 4));
  const fs::path out = scratch / "out";
  const Arguments arguments{"solve",         file.string(), "--solver", "nlgs,jacobi",
                            "--check-every", "1",           "--out",    out.string()};
  const Result result = scree(scratch, arguments);
  ASSERT_EQ(result.code, 0) << result.err;
  const std::string results = contents(out / "results.csv");
  EXPECT_TRUE(results.starts_with("problem,contacts,dimension,solver,status,iterations,"));
  EXPECT_EQ(line_count(results), 3u);
  EXPECT_NE(results.find("a,4,3,jacobi,converged,"), std::string::npos) << results;
  EXPECT_EQ(json_file(out / "results.json").at("problems").at(0).at("runs").size(), 2u);
  const std::string curve = contents(out / "curves/a_jacobi.csv");
  EXPECT_TRUE(curve.starts_with("iteration,applications,seconds,residual,"));
  EXPECT_GT(line_count(curve), 3u);
  EXPECT_FALSE(fs::exists(out / "profile_seconds.csv"));
  if (can_draw()) {
    EXPECT_TRUE(contents(out / "curves_a.png").starts_with("\x89PNG"));
  } else {
    EXPECT_NE(result.err.find("built without Cairo"), std::string::npos) << result.err;
    EXPECT_EQ(line_count(result.err), 1u);
  }
  EXPECT_FALSE(fs::exists(out / "profile_seconds.png"));
  // Not over results that are there, unless told.
  const Result again = scree(scratch, arguments);
  EXPECT_EQ(again.code, 2);
  EXPECT_NE(again.err.find("not empty"), std::string::npos);
  Arguments forced = arguments;
  forced.push_back("--force");
  EXPECT_EQ(scree(scratch, forced).code, 0);
}

TEST(CliSolve, RunsAFolderAndWritesProfiles) {
  const Scratch scratch;
  fs::create_directories(scratch / "folder");
  put_problem(scratch / "folder/two.hdf5", simple_problem(2, 3));
  put_problem(scratch / "folder/three.h5", simple_problem(3, 3));
  put(scratch / "folder/readme.txt", "not a problem");
  const Result result = scree(scratch, {"solve", (scratch / "folder").string(), "--solver",
                                        "nlgs,extragradient", "--out", (scratch / "out").string()});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("2 problems"), std::string::npos) << result.out;
  for (const char* name : {"profile_seconds.csv", "profile_applications.csv"}) {
    const std::string profile = contents(scratch / "out" / name);
    EXPECT_TRUE(profile.starts_with("ratio,nlgs,extragradient\n1,")) << profile;
    const fs::path picture = (scratch / "out" / name).replace_extension("png");
    EXPECT_EQ(fs::exists(picture), can_draw()) << picture;
  }
  for (const char* name : {"two_nlgs", "three_nlgs", "two_extragradient"})
    EXPECT_TRUE(fs::exists(scratch / "out/curves" / (std::string(name) + ".csv"))) << name;
}

/// Values of a column of a CSV text without quotes.
std::vector<std::string> column(const std::string& text, const std::string& name) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  const auto found = std::find(rows.at(0).begin(), rows.at(0).end(), name);
  EXPECT_NE(found, rows.at(0).end()) << name;
  std::vector<std::string> values;
  for (std::size_t k = 1; k < rows.size(); ++k)
    values.push_back(rows[k].at(found - rows[0].begin()));
  return values;
}

TEST(CliSolve, MeasuresVelocitiesAgainstAReference) {
  const Scratch scratch;
  const std::string file = put_problem(scratch / "a.hdf5", simple_problem(3, 4)).string();
  for (const char* model : {"convex", "exact"}) {
    const fs::path out = scratch / model;
    const json document =
        solve_json(scratch, {file, "--model", model, "--solver", "jacobi", "--reference",
                             "interior_point", "--out", out.string()});
    const json& reference = document.at("problems").at(0).at("reference");
    EXPECT_EQ(reference.at("solver"), "interior_point");
    EXPECT_LE(reference.at("residual"), 1e-12);
    const std::string curve = contents(out / "curves/a_jacobi.csv");
    const auto velocity = column(curve, "velocity_error"),
               energy = column(curve, "kinetic_error_J");
    EXPECT_GT(std::stod(velocity.front()), 0.01);
    EXPECT_LE(std::stod(velocity.back()), 1e-7);
    EXPECT_GT(std::stod(energy.front()), 0.01);
    EXPECT_LE(std::stod(energy.back()), 1e-14);
  }
  ASSERT_EQ(scree(scratch, {"solve", file, "--out", (scratch / "none").string()}).code, 0);
  const std::string curve = contents(scratch / "none/curves/a_auto.csv");
  EXPECT_EQ(column(curve, "velocity_error").front(), "");
  EXPECT_EQ(column(curve, "kinetic_error_J").front(), "");
}

/// What is written is what the solver found, and a reference for others, in the law that it is of.
TEST(CliSolve, ASolutionFileIsAReferenceInBothModels) {
  const Scratch scratch;
  for (const int dimension : {2, 3}) {
    const std::string file = put_problem(scratch / "a.hdf5", simple_problem(dimension, 4)).string();
    for (const std::string model : {"convex", "exact"}) {
      const std::string solution = (scratch / (model + std::to_string(dimension))).string();
      solve_json(scratch, {file, "--model", model, "--solver", "nlgs", "--tolerance", "1e-13",
                           "--solution", solution});
      const h5::File stored = h5::File::open(solution);
      const auto r = stored.root().read_converted<double>("solution/r"),
                 u = stored.root().read_converted<double>("solution/u");
      ASSERT_EQ(r.size(), 4u * dimension);
      const auto& problem = simple_problem(dimension, 4);
      const std::vector<double>& q = std::get<LocalProblem>(problem.form).q;
      for (std::size_t k = 0; k < r.size(); ++k) EXPECT_NEAR(u[k], 2 * r[k] + q[k], 1e-14);
      EXPECT_GT(r[0], 0.1);
      const fs::path out = scratch / (model + "_out" + std::to_string(dimension));
      solve_json(scratch, {file, "--model", model, "--solver", "jacobi", "--reference", solution,
                           "--out", out.string()});
      const auto error = column(contents(out / "curves/a_jacobi.csv"), "velocity_error");
      EXPECT_GT(std::stod(error.front()), 0.01);
      EXPECT_LE(std::stod(error.back()), 1e-7);
      const Result other = scree(scratch, {"solve", file, "--reference", solution, "--model",
                                           model == "exact" ? "convex" : "exact"});
      EXPECT_EQ(other.code, 2);
      EXPECT_NE(other.err.find("solution of the " + model + " law"), std::string::npos)
          << other.err;
    }
  }
}

/// A solver that does not know the law gives no reference, and its solution has the residual of the guess.
TEST(CliSolve, ASolverThatDidNotRunIsNoReference) {
  const Scratch scratch;
  const std::string file = put_problem(scratch / "a.hdf5", simple_problem(3, 4)).string();
  const Result refused = scree(scratch, {"solve", file, "--model", "convex", "--solver", "jacobi",
                                         "--reference", "pgs_box"});
  EXPECT_EQ(refused.code, 2);
  EXPECT_NE(refused.err.find("--reference: pgs_box gives none for a: the method solves the exact"),
            std::string::npos)
      << refused.err;
  const json run = solve_json(scratch, {file, "--model", "convex", "--solver", "pgs_box"})
                       .at("problems")
                       .at(0)
                       .at("runs")
                       .at(0);
  EXPECT_EQ(run.at("status"), "unsupported");
  EXPECT_GT(run.at("residual"), 1e-3);
}

TEST(CliSolve, ADamagedSolutionIsRefused) {
  const Scratch scratch;
  const std::string file = put_problem(scratch / "a.hdf5", simple_problem(3, 4)).string();
  const fs::path solution = scratch / "s.hdf5";
  ASSERT_EQ(scree(scratch, {"solve", file, "--solution", solution.string()}).code, 0);
  std::string bytes = contents(solution);
  bytes[bytes.size() - 5] = static_cast<char>(bytes[bytes.size() - 5] ^ 1);
  put(solution, bytes);
  const Result result = scree(scratch, {"solve", file, "--reference", solution.string()});
  EXPECT_EQ(result.code, 2);
  EXPECT_NE(result.err.find("s.hdf5: it is damaged"), std::string::npos) << result.err;
}

/// Every measure ends the solve at the first check that is below the tolerance by it.
TEST(CliSolve, TheToleranceIsOnTheMeasureAskedFor) {
  const Scratch scratch;
  StoredProblem stored = simple_problem(3, 4);
  auto& p = std::get<LocalProblem>(stored.form);
  for (std::size_t k = 0; k < 9; ++k) p.W.value[k] *= 1e4;  // light bodies beside a heavy one
  for (double& value : p.q) value *= 50;
  const std::string file = put_problem(scratch / "a.hdf5", stored).string();
  std::vector<double> iterations;
  for (const auto& [measure, key] : {std::pair{"relative", "residual"},
                                     {"absolute", "residual_absolute"},
                                     {"unit-free", "residual_unit_free"}}) {
    const Arguments common{file,  "--solver",    "jacobi", "--measure",     measure, "--relaxation",
                           "0.5", "--tolerance", "1e-6",   "--check-every", "1"};
    const json out = solve_json(scratch, common);
    EXPECT_EQ(out.at("measure"), measure);
    const json run = out.at("problems").at(0).at("runs").at(0);
    EXPECT_TRUE(run.at("converged")) << run.dump(1);
    EXPECT_LE(run.at(key), 1e-6) << measure;
    const int needed = run.at("iterations");
    Arguments fewer = common;
    fewer.insert(fewer.end(), {"--max-iterations", std::to_string(needed - 1)});
    EXPECT_GT(solve_json(scratch, fewer).at("problems").at(0).at("runs").at(0).at(key), 1e-6);
    iterations.push_back(needed);
  }
  EXPECT_NE(iterations[0], iterations[1]);
  EXPECT_NE(iterations[0], iterations[2]);
  const Result automatic = scree(scratch, {"solve", file, "--measure", "unit-free", "--json"});
  const json run = json::parse(automatic.out).at("problems").at(0).at("runs").at(0);
  EXPECT_LE(run.at("residual_unit_free"), 1e-8) << run.dump(1);
}

TEST(CliSolve, AFileOfAFolderThatCannotBeReadIsNamedAndSkipped) {
  const Scratch scratch;
  fs::create_directories(scratch / "folder");
  put_problem(scratch / "folder/a.hdf5", simple_problem(3, 3));
  put(scratch / "folder/b.hdf5", "not a problem");
  put_problem(scratch / "folder/c.hdf5", simple_problem(3, 3));
  const Result result = scree(
      scratch, {"solve", "folder", "--solver", "nlgs", "--out", "out", "--solution", "found"});
  EXPECT_EQ(result.code, 1);
  EXPECT_NE(result.out.find("2 problems"), std::string::npos) << result.out;
  for (const char* words : {"b.hdf5: it is not an HDF5 file", "1 of 3 problems skipped"})
    EXPECT_NE(result.err.find(words), std::string::npos) << result.err;
  EXPECT_EQ(line_count(contents(scratch / "out/results.csv")), 3u);
  const json document = json_file(scratch / "out/results.json");
  EXPECT_EQ(document.at("problems").size(), 2u);
  EXPECT_EQ(document.at("skipped").at(0).at("file"), "folder/b.hdf5");
  EXPECT_TRUE(fs::exists(scratch / "found/c.hdf5"));
  fs::remove(scratch / "folder/a.hdf5");
  fs::remove(scratch / "folder/c.hdf5");
  EXPECT_EQ(scree(scratch, {"solve", "folder"}).code, 2);
}

/// The first problem is done and its results are there while the second never ends.
TEST(CliSolve, AKilledRunKeepsWhatIsDone) {
  const Scratch scratch;
  fs::create_directories(scratch / "folder");
  put_problem(scratch / "folder/a.hdf5", simple_problem(3, 2));
  put_problem(scratch / "folder/b.hdf5", simple_problem(3, 300));
  for (const int signal : {SIGKILL, SIGINT}) {
    const std::string out = "out" + std::to_string(signal), found = "found" + out;
    Program program(scratch.path(),
                    {"solve", "folder", "--solver", "nlgs", "--tolerance", "0", "--max-iterations",
                     "1000000000", "--max-seconds", "2", "--out", out, "--solution", found});
    ASSERT_TRUE(eventually([&] {
      return fs::exists(scratch / (out + "/curves_a.png")) ||
             (!can_draw() && line_count(contents(scratch / (out + "/results.csv"))) == 2);
    }));
    program.send(signal);
    program.wait();
    const std::string results = contents(scratch / (out + "/results.csv"));
    EXPECT_EQ(line_count(results), 2u) << results;
    EXPECT_NE(results.find("\na,2,3,nlgs,time limit,"), std::string::npos) << results;
    EXPECT_TRUE(fs::exists(scratch / (out + "/curves/a_nlgs.csv")));
    EXPECT_TRUE(fs::exists(scratch / (found + "/a.hdf5")));
  }
}

TEST(CliSolve, HelpSaysHowManyThreadsThereAre) {
  const Scratch scratch;
  const Result help = scree(scratch, {"solve", "--help"});
  EXPECT_NE(help.out.find("CPU threads (default: 1; all with --matrix-free)"), std::string::npos)
      << help.out;
}

TEST(CliSolve, SolvesAProblemOfARun) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  ASSERT_EQ(
      scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "12", "--dump-problem", "12"}))
          .code,
      0);
  const std::string file = (scratch / "a/problem_12.hdf5").string();
  const json cold = solve_json(scratch, {file});
  const json warm = solve_json(scratch, {file, "--warm-start"});
  for (const json* out : {&cold, &warm})
    EXPECT_TRUE(out->at("problems").at(0).at("runs").at(0).at("converged")) << out->dump(1);
}

TEST(CliSolve, RunsTheSolversOfStepsOnBodies) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  ASSERT_EQ(
      scree(scratch, run_arguments(scene, scratch / "a", {"--steps", "12", "--dump-problem", "12"}))
          .code,
      0);
  const json out =
      solve_json(scratch, {(scratch / "a/problem_12.hdf5").string(), "--matrix-free", "--solver",
                           "all", "--model", "convex", "--backend", "cpu", "--tolerance", "1e-6"});
  const json& runs = out.at("problems").at(0).at("runs");
  EXPECT_EQ(runs.size(), 5u);
  for (const json& run : runs) {
    EXPECT_TRUE(run.at("converged")) << run.dump(1);
    EXPECT_EQ(run.at("note"), "cpu, double");
    EXPECT_EQ(run.at("friction"), "cone");
  }
}

/// Where there is a GPU the solvers that run on it reach what those of the CPU do, and others are
/// named; where there is none, that is an error.
TEST(CliSolve, RunsOnAGpuWhatCanRunThere) {
  const Scratch scratch;
  const fs::path file = put_problem(scratch / "a.hdf5", simple_problem(3, 4));
  const Result all =
      scree(scratch, {"solve", file.string(), "--solver", "all", "--backend", "cuda"});
  if (all.code != 0) {
    EXPECT_EQ(all.code, 2);
    EXPECT_NE(all.err.find("--backend cuda"), std::string::npos) << all.err;
    return;
  }
  for (const char* word : {"not on cuda: ", "interior_point", "on cuda", "apgd", "nlgs"})
    EXPECT_NE(all.out.find(word), std::string::npos) << word << " in " << all.out;
  const json out =
      solve_json(scratch, {file.string(), "--solver", "apgd,nlgs", "--backend", "cuda"});
  const json reference = solve_json(scratch, {file.string(), "--solver", "nlgs"});
  const double objective = reference.at("problems").at(0).at("runs").at(0).at("objective");
  for (const json& run : out.at("problems").at(0).at("runs")) {
    EXPECT_EQ(run.at("backend"), "cuda");
    EXPECT_TRUE(run.at("converged")) << run.dump(1);
    EXPECT_NEAR(run.at("objective"), objective, 1e-6 * std::abs(objective));
  }
  const Result newton =
      scree(scratch, {"solve", file.string(), "--solver", "nlgs,newton", "--backend", "cuda"});
  EXPECT_EQ(newton.code, 2);
  EXPECT_NE(newton.err.find("newton cannot run on cuda"), std::string::npos) << newton.err;
}

TEST(CliSolve, NotReachingTheToleranceIsAStatus) {
  const Scratch scratch;
  const fs::path file = put_problem(scratch / "a.hdf5", simple_problem(3, 4));
  const json out = solve_json(scratch, {file.string(), "--solver", "jacobi", "--max-iterations",
                                        "2", "--tolerance", "1e-14"});
  const json& run = out.at("problems").at(0).at("runs").at(0);
  EXPECT_EQ(run.at("status"), "iteration limit");
  EXPECT_EQ(run.at("iterations"), 2);
}

TEST(CliSolve, NoSolutionIsAStatus) {
  const Scratch scratch;
  StoredProblem stored = simple_problem(3, 2);
  auto& p = std::get<LocalProblem>(stored.form);
  p.W = compress(6, 6, {{0, 0, 2}, {1, 1, 2}, {2, 2, 2}});  // nothing moves the second contact
  const fs::path file = put_problem(scratch / "a.hdf5", stored);
  const json out = solve_json(scratch, {file.string(), "--solver", "all"});
  for (const json& run : out.at("problems").at(0).at("runs"))
    EXPECT_EQ(run.at("status"), "no solution") << run.dump(1);
}

/// The words are in what is said on the error stream, and nothing of it is an error.
void expect_note(const Scratch& scratch, const Arguments& arguments,
                 const std::vector<std::string>& words) {
  const Result result = scree(scratch, arguments);
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_EQ(line_count(result.err), words.empty() ? 0u : 1u) << result.err;
  for (const std::string& word : words)
    EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
}

TEST(CliSolve, SaysWhichSolversAnOptionIsNotOf) {
  const Scratch scratch;
  const std::string file = put_problem(scratch / "a.hdf5", simple_problem(3, 4)).string();
  expect_note(scratch, {"solve", file, "--relaxation", "1.1", "--solver", "sor,nlgs,apgd"},
              {"--relaxation", "nlgs, apgd"});
  expect_note(scratch, {"solve", file, "--relaxation", "1.1", "--solver", "jacobi,admm"}, {});
  expect_note(scratch, {"solve", file, "--relaxation", "1.1", "--solver", "all"}, {});
  expect_note(scratch, {"solve", file, "--threads", "2", "--solver", "nlgs,newton"},
              {"--threads", "newton, which take one"});
  expect_note(scratch, {"solve", file, "--threads", "2", "--solver", "nlgs"}, {});
  expect_note(scratch, {"solve", file, "--warm-start"}, {"--warm-start", "a.hdf5", "no guess"});
}

TEST(CliSolve, ASolverNamedTwiceRunsOnce) {
  const Scratch scratch;
  const fs::path file = put_problem(scratch / "a.hdf5", simple_problem(3, 4));
  const json out = solve_json(scratch, {file.string(), "--solver", "nlgs,sor,nlgs"});
  const json& runs = out.at("problems").at(0).at("runs");
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs.at(0).at("solver"), "nlgs");
  EXPECT_EQ(runs.at(1).at("solver"), "sor");
}

/// The folder of a run holds a checkpoint beside its problems.
TEST(CliSolve, SolvesTheProblemsOfARunsFolder) {
  const Scratch scratch;
  const fs::path scene = put_scene(scratch, small_scene());
  ASSERT_EQ(scree(scratch,
                  run_arguments(scene, scratch / "a",
                                {"--steps", "12", "--dump-problem", "11", "--dump-problem", "12"}))
                .code,
            0);
  ASSERT_TRUE(fs::exists(scratch / "a/checkpoint.h5"));
  const Result result = scree(scratch, {"solve", (scratch / "a").string(), "--solver", "nlgs"});
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_NE(result.out.find("2 problems"), std::string::npos) << result.out;
  EXPECT_EQ(line_count(result.err), 1u) << result.err;
  EXPECT_NE(result.err.find("checkpoint.h5"), std::string::npos) << result.err;
  for (const char* problem : {"a/problem_11.hdf5", "a/problem_12.hdf5"})
    fs::remove(scratch / problem);
  const Result none = scree(scratch, {"solve", (scratch / "a").string()});
  EXPECT_EQ(none.code, 2);
  EXPECT_EQ(line_count(none.err), 1u) << none.err;
  EXPECT_NE(none.err.find("no problem files"), std::string::npos) << none.err;
}

/// Known before anything is solved.
TEST(CliSolve, AnOutputFolderThatCannotBeMadeIsRefused) {
  const Scratch scratch;
  const std::string file = put_problem(scratch / "a.hdf5", simple_problem(3, 4)).string();
  put(scratch / "afile", "mine");
  fs::create_directories(scratch / "results");
  put(scratch / "results/curves", "mine too");
  for (const char* out : {"afile", "afile/b", "afile/b/c", "results"}) {
    const Result result = scree(scratch, {"solve", file, "--force", "--out", out});
    EXPECT_EQ(result.code, 2) << out;
    EXPECT_EQ(result.out, "") << out;
    EXPECT_EQ(line_count(result.err), 1u) << result.err;
    EXPECT_NE(result.err.find("not a directory"), std::string::npos) << result.err;
  }
}

struct BadUse {
  std::string name;
  Arguments arguments;
  std::vector<std::string> words;
};

class CliSolveRefusals : public testing::TestWithParam<BadUse> {};

TEST_P(CliSolveRefusals, IsOneLineAndLeavesNothing) {
  const Scratch scratch;
  put_problem(scratch / "good.hdf5", simple_problem(3, 2));
  put(scratch / "text.hdf5", "not a problem");
  fs::create_directories(scratch / "empty");
  Arguments all{"solve"};
  all.insert(all.end(), GetParam().arguments.begin(), GetParam().arguments.end());
  all.insert(all.end(), {"--out", (scratch / "out").string()});
  const Result result = scree(scratch, all);
  EXPECT_EQ(result.code, 2) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(line_count(result.err), 1u) << result.err;
  EXPECT_TRUE(result.err.starts_with("scree: ")) << result.err;
  for (const std::string& word : GetParam().words)
    EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
  EXPECT_FALSE(fs::exists(scratch / "out"));
}

INSTANTIATE_TEST_SUITE_P(
    Uses, CliSolveRefusals,
    testing::Values(
        BadUse{"NoFile", {"nothing.hdf5"}, {"nothing.hdf5", "no such file"}},
        BadUse{"NotHdf5", {"text.hdf5"}, {"text.hdf5", "not an HDF5 file"}},
        BadUse{"EmptyFolder", {"empty"}, {"empty", "no problem files", "*.hdf5"}},
        BadUse{"Solver", {"good.hdf5", "--solver", "magic"}, {"\"magic\"", "nlgs", "all"}},
        BadUse{
            "Model", {"good.hdf5", "--model", "soft"}, {"--model", "\"soft\"", "convex or exact"}},
        BadUse{"NoBodies", {"good.hdf5", "--matrix-free"}, {"good.hdf5", "needs bodies"}},
        BadUse{"MatrixFreeSolver",
               {"good.hdf5", "--matrix-free", "--solver", "nlgs"},
               {"\"nlgs\"", "apgd", "jacobi"}},
        BadUse{"AssembledPrecision",
               {"good.hdf5", "--precision", "float"},
               {"--precision float", "--matrix-free"}},
        BadUse{"Backend", {"good.hdf5", "--backend", "tpu"}, {"--backend", "\"tpu\""}},
        BadUse{"Measure",
               {"good.hdf5", "--measure", "loose"},
               {"--measure", "\"loose\"", "relative, absolute or unit-free"}},
        BadUse{"SolutionIsThere",
               {"good.hdf5", "--solution", "text.hdf5"},
               {"--solution text.hdf5", "--force"}},
        BadUse{"ReferenceIsNoSolution",
               {"good.hdf5", "--reference", "good.hdf5"},
               {"good.hdf5", "holds no solution", "solution/u"}},
        BadUse{"Tolerance", {"good.hdf5", "--tolerance", "-1"}, {"--tolerance", "-1"}},
        BadUse{"ToleranceNan", {"good.hdf5", "--tolerance", "nan"}, {"--tolerance", "nan"}},
        BadUse{"Iterations", {"good.hdf5", "--max-iterations", "-3"}, {"--max-iterations", "-3"}},
        BadUse{"TooManyIterations",
               {"good.hdf5", "--max-iterations", "99999999999"},
               {"--max-iterations", "99999999999"}},
        BadUse{"Seconds", {"good.hdf5", "--max-seconds", "-2"}, {"--max-seconds", "-2"}},
        BadUse{"Checks", {"good.hdf5", "--check-every", "-2"}, {"--check-every", "-2"}},
        BadUse{"Relaxation", {"good.hdf5", "--relaxation", "2"}, {"--relaxation", "2"}},
        BadUse{"Reference", {"good.hdf5", "--reference", "magic"}, {"\"magic\"", "nlgs"}},
        BadUse{"References", {"good.hdf5", "--reference", "nlgs,sor"}, {"--reference", "one"}},
        BadUse{"ReferenceOfBodies",
               {"good.hdf5", "--reference", "nlgs", "--matrix-free"},
               {"--reference", "--matrix-free"}},
        BadUse{"RelaxationOfNone",
               {"good.hdf5", "--solver", "nlgs,newton", "--relaxation", "1.1"},
               {"--relaxation", "nlgs, newton", "sor"}},
        BadUse{"RelaxationOfBodies",
               {"good.hdf5", "--relaxation", "1.1", "--matrix-free"},
               {"--relaxation", "--matrix-free"}},
        BadUse{"ChecksOfBodies",
               {"good.hdf5", "--check-every", "2", "--matrix-free"},
               {"--check-every", "--matrix-free"}},
        BadUse{"NoProblem", {}, {"problem"}}),
    [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace scree::test
