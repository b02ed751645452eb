#include "host/cli/solve_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "host/error.h"
#include "host/io/directory_checks.h"
#include "host/io/problem_file.h"
#include "host/io/streams.h"
#include "host/solve/matrix_free.h"
#include "host/solve/solve_charts.h"
#include "host/solve/solve_report.h"
#include "solvers/solver.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

AssembledOptions solver_options(const SolveOptions& options) {
  const auto require = [](bool ok, const std::string& what) {
    if (!ok) throw InputError(what);
  };
  AssembledOptions o;
  if (options.model == "convex") {
    o.model = AssembledModel::convex;
  } else if (options.model != "exact") {
    throw InputError(
        fmt::format("--model: \"{}\" is not allowed: expected convex or exact", options.model));
  }
  require(std::isfinite(options.tolerance) && options.tolerance >= 0,
          fmt::format("--tolerance: {} is not allowed: expected a number that is not negative",
                      options.tolerance));
  require(
      options.max_iterations >= 0 && options.max_iterations <= std::numeric_limits<int>::max(),
      fmt::format("--max-iterations: {} is not allowed: expected 1 to {}, or 0 for the solver's "
                  "own",
                  options.max_iterations, std::numeric_limits<int>::max()));
  require(std::isfinite(options.max_seconds) && options.max_seconds >= 0,
          fmt::format("--max-seconds: {} is not allowed: expected a number that is not negative",
                      options.max_seconds));
  require(options.check_every >= 0,
          fmt::format("--check-every: {} is not allowed: expected a positive number",
                      options.check_every));
  require(std::isfinite(options.relaxation) && options.relaxation >= 0 && options.relaxation < 2,
          fmt::format("--relaxation: {} is not allowed: expected a number between 0 and 2",
                      options.relaxation));
  o.tolerance = options.tolerance;
  o.max_iterations = static_cast<int>(options.max_iterations);
  o.max_seconds = options.max_seconds;
  o.check_every = options.check_every;
  o.relaxation = options.relaxation;
  return o;
}

void note(const std::string& text) { say("scree: " + text); }

/// The file, or the HDF5 files of the folder by name.
std::vector<fs::path> problem_files(const fs::path& path) {
  std::error_code error;
  if (!fs::is_directory(path, error)) return {path};
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, error)) {
    const fs::path extension = entry.path().extension();
    if (extension == ".hdf5" || extension == ".h5") files.push_back(entry.path());
  }
  if (error)
    throw InputError(fmt::format("{}: cannot be read: {}", path.string(), error.message()));
  if (files.empty())
    throw InputError(
        fmt::format("{}: holds no problem files, expected *.hdf5 or *.h5", path.string()));
  std::sort(files.begin(), files.end());
  return files;
}

/// Backend and precision: of matrix-free solvers double, and CUDA when it is there; of those of the
/// assembled operator, which are double, the CPU with one thread.
WorldOptions target_options(const SolveOptions& options) {
  Scene defaults;
  defaults.backend = options.matrix_free ? "auto" : "cpu";
  defaults.precision = "double";
  WorldOptions target = resolve_options(options.target, defaults);
  if (options.matrix_free) return target;
  if (target.precision != Precision::double_precision)
    throw InputError("--precision float: is for --matrix-free; assembled operators are double");
  if (target.threads == 0) target.threads = 1;
  return target;
}

/// Names of the solvers to run.
std::vector<std::string> solvers_of(const SolveOptions& options, bool cuda) {
  if (options.matrix_free)
    return parse_solver_list(options.solver == "auto" ? "apgd" : options.solver, solver_names());
  if (!cuda) return parse_solver_list(options.solver);
  if (options.solver == "auto") return {"proximal_krylov"};
  if (options.solver == "all") return assembled_solver_names(true);
  std::vector<std::string> names = parse_solver_list(options.solver);
  const std::vector<std::string> missing = without_cuda_form(names);
  if (!missing.empty())
    throw InputError(fmt::format("--solver: {} cannot run on cuda; those that can: {}",
                                 fmt::join(missing, ", "),
                                 fmt::join(assembled_solver_names(true), ", ")));
  return names;
}

/// Refuses options that would change nothing, and notes those that do for some solvers only. `all`
/// means those that can.
void check_use(const SolveOptions& options, const std::vector<std::string>& solvers, bool cuda) {
  if (options.matrix_free) {
    if (!options.reference.empty())
      throw InputError("--reference: not together with --matrix-free");
    if (options.relaxation > 0) throw InputError("--relaxation: not together with --matrix-free");
    if (options.check_every > 0) throw InputError("--check-every: not together with --matrix-free");
    return;
  }
  const auto without = [&](const std::vector<std::string>& able) {
    std::vector<std::string> rest = solvers;
    std::erase_if(rest, [&](const std::string& name) {
      return std::find(able.begin(), able.end(), name) != able.end();
    });
    return rest;
  };
  if (options.relaxation > 0) {
    const std::vector<std::string> able = with_relaxation(solvers);
    if (able.empty())
      throw InputError(fmt::format("--relaxation: {} has none; solvers that have one: {}",
                                   fmt::join(solvers, ", "),
                                   fmt::join(with_relaxation(assembled_solver_names()), ", ")));
    if (options.solver != "all" && able.size() < solvers.size())
      note(fmt::format("--relaxation: not of {}", fmt::join(without(able), ", ")));
  }
  if (options.target.threads > 1 && options.solver != "all") {
    const std::vector<std::string> one_thread = cuda ? solvers : without_cuda_form(solvers);
    if (!one_thread.empty())
      note(fmt::format("--threads: not of {}{}", fmt::join(one_thread, ", "),
                       cuda ? " on cuda" : ", which take one"));
  }
}

/// Results are not mixed with those of before, nor with anything else, and have a place to go.
void require_free(const fs::path& out, bool force) {
  if (out.empty()) return;
  for (const fs::path& folder : {out, out / "curves"})
    if (const std::string why = why_not_writable(folder); !why.empty())
      throw InputError(fmt::format("--out {}: {}", folder.string(), why));
  std::error_code error;
  if (!force && fs::exists(out, error) && !fs::is_empty(out, error))
    throw InputError(
        fmt::format("--out {}: it is not empty; add --force to write into it", out.string()));
}

}  // namespace

CLI::App* add_solve_command(CLI::App& app, SolveOptions& options) {
  CLI::App* command = app.add_subcommand("solve", "Solve stored contact problems; compare solvers");
  command
      ->add_option("problem", options.problem, "problem file, or folder of *.hdf5 and *.h5 files")
      ->required();
  command
      ->add_option("--solver", options.solver,
                   "name, names separated by commas, or all (default: auto)")
      ->take_last();
  command->add_option("--model", options.model, "convex or exact (default: exact)")->take_last();
  command
      ->add_option("--tolerance", options.tolerance,
                   "on the error |r - P(r - v)| / |q| (default: 1e-8)")
      ->take_last();
  command
      ->add_option("--max-iterations", options.max_iterations,
                   "most iterations (default: each solver's own)")
      ->take_last();
  command
      ->add_option("--max-seconds", options.max_seconds,
                   "most seconds per solver and problem, 0: no limit (default: 100)")
      ->take_last();
  command
      ->add_option("--check-every", options.check_every,
                   "iterations between looks at the residual (default: each solver's own)")
      ->take_last();
  command
      ->add_option("--relaxation", options.relaxation,
                   "of sor, jacobi, admm and pgs_... (default: their own)")
      ->take_last();
  command->add_flag("--matrix-free", options.matrix_free,
                    "solvers of simulation steps, for problems with bodies");
  add_device_options(*command, options.target, "cpu; auto with --matrix-free", "double");
  command
      ->add_option("--reference", options.reference,
                   "solver whose answer velocity errors are measured against (default: none)")
      ->take_last();
  command->add_flag("--warm-start", options.warm_start, "start from the guess in the file, if any");
  command
      ->add_option("--out", options.out,
                   "folder for CSV, JSON and PNG files (default: none written)")
      ->take_last();
  command->add_flag("--force", options.force, "write into a folder that is not empty");
  command->add_flag("--json", options.json, "print JSON");
  return command;
}

int solve_problems(const SolveOptions& options) {
  const AssembledOptions common = solver_options(options);
  const bool matrix_free = options.matrix_free;
  const WorldOptions world = target_options(options);
  const bool cuda = world.backend == BackendKind::cuda;
  const std::vector<std::string> solvers = solvers_of(options, cuda);
  check_use(options, solvers, cuda);
  if (!options.reference.empty()) {
    if (parse_solver_list(options.reference).size() != 1)
      throw InputError("--reference: expected one solver");
  }
  require_free(options.out, options.force);
  // All files are read before any is solved: bad input starts nothing.
  std::vector<ProblemReport> reports;
  std::vector<ReadyProblem> problems;
  std::vector<BodyProblem> bodies;  // of matrix-free solvers
  std::vector<std::string> others;
  for (const fs::path& file : problem_files(options.problem)) {
    StoredProblem stored;
    try {
      stored = read_problem(file);
    } catch (const NoProblemInFile&) {
      // A run leaves other HDF5 files beside its problems.
      if (file == options.problem) throw;
      others.push_back(file.filename().string());
      continue;
    }
    try {
      problems.push_back((matrix_free ? ready_matrix_free : ready)(file.stem().string(), stored));
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    }
    if (matrix_free) {
      const auto* with_bodies = std::get_if<BodyProblem>(&stored.form);
      if (with_bodies == nullptr)
        throw InputError(
            fmt::format("{}: holds matrices, but --matrix-free needs bodies", file.string()));
      bodies.push_back(*with_bodies);
    }
    const ReadyProblem& p = problems.back();
    if (options.warm_start && p.guess.empty())
      note(fmt::format("--warm-start: {} holds no guess, from zero then", file.string()));
    reports.push_back(
        {p.name, file, p.problem.contact_count, p.problem.dimension, p.asymmetry, {}, {}});
  }
  if (problems.empty())
    throw InputError(fmt::format("{}: holds no problem files: none is in {}",
                                 options.problem.string(), fmt::join(others, ", ")));
  if (!others.empty()) note(fmt::format("skipped, no problems: {}", fmt::join(others, ", ")));
  if (!options.json && cuda && !matrix_free && options.solver == "all")
    fmt::print("not on cuda: {}\n\n", fmt::join(without_cuda_form(assembled_solver_names()), ", "));
  for (std::size_t k = 0; k < problems.size(); ++k) {
    AssembledOptions o = common;
    if (options.warm_start) o.guess = problems[k].guess;
    if (!options.reference.empty())
      reports[k].reference = find_reference(problems[k], options.reference, o);
    reports[k].runs = matrix_free ? run_matrix_free(bodies[k], problems[k], solvers, o, world)
                                  : run_solvers(problems[k], solvers, o, {cuda, world.threads});
    if (!options.json) fmt::print("{}{}", k > 0 ? "\n" : "", to_table(reports[k]));
  }
  if (!options.json && reports.size() > 1) fmt::print("\n{}", to_summary(reports));
  if (options.json) fmt::print("{}\n", to_json(reports, common).dump(2));
  if (!options.out.empty()) {
    write_reports(options.out, reports, common);
    const std::string missing = write_charts(options.out, reports);
    if (!missing.empty()) note(missing);
  }
  return 0;
}

}  // namespace scree
