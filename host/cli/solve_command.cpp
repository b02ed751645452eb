#include "host/cli/solve_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "host/engine/cuda_device.h"
#include "host/error.h"
#include "host/io/directory_checks.h"
#include "host/io/problem_file.h"
#include "host/io/streams.h"
#include "host/solve/matrix_free.h"
#include "host/solve/solution_file.h"
#include "host/solve/solve_charts.h"
#include "host/solve/solve_report.h"
#include "solvers/rolling/rolling_solver.h"
#include "solvers/solver_card.h"

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
  if (options.measure == "absolute") {
    o.measure = AssembledMeasure::absolute;
  } else if (options.measure == "unit-free") {
    o.measure = AssembledMeasure::unit_free;
  } else if (options.measure != "relative") {
    throw InputError(
        fmt::format("--measure: \"{}\" is not allowed: expected relative, absolute or unit-free",
                    options.measure));
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
    return parse_solver_list(options.solver == "auto" ? SolverSettings{}.name : options.solver,
                             solver_names(options.solver == "all" && cuda));
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

namespace {

/// The problems of a command, one after another.
class Session {
 public:
  explicit Session(const SolveOptions& options)
      : options_(options),
        common_(solver_options(options)),
        world_(target_options(options)),
        cuda_(world_.backend == BackendKind::cuda),
        solvers_(solvers_of(options, cuda_)),
        is_folder_(fs::is_directory(options.problem)) {
    check_use(options, solvers_, cuda_);
    find_reference_kind();
    require_free(options.out, options.force);
    require_place_for_solutions();
  }

  int run() {
    const std::vector<fs::path> files = problem_files(options_.problem);
    if (!options_.json && cuda_ && !options_.matrix_free && options_.solver == "all")
      fmt::print("not on cuda: {}\n\n",
                 fmt::join(without_cuda_form(assembled_solver_names()), ", "));
    for (const fs::path& file : files) take(file);
    if (reports_.empty()) {
      if (!skipped_.empty()) throw InputError(skipped_.front().reason);
      throw InputError(fmt::format("{}: holds no problem files: none is in {}",
                                   options_.problem.string(), fmt::join(others_, ", ")));
    }
    if (!others_.empty()) note(fmt::format("skipped, no problems: {}", fmt::join(others_, ", ")));
    if (!options_.json && reports_.size() > 1) fmt::print("\n{}", to_summary(reports_));
    if (options_.json) fmt::print("{}\n", to_json(reports_, skipped_, common_).dump(2));
    if (writer_) {
      writer_->finish(reports_, skipped_, common_);
      const std::string missing = write_profile_charts(options_.out, reports_);
      if (!missing.empty()) note(missing);
    }
    if (skipped_.empty()) return 0;
    note(fmt::format("{} of {} problems skipped, as told above", skipped_.size(),
                     skipped_.size() + reports_.size()));
    return 1;
  }

 private:
  void find_reference_kind() {
    const std::string& r = options_.reference;
    if (r.empty()) return;
    const std::vector<std::string> known = assembled_solver_names();
    reference_is_solver_ = std::find(known.begin(), known.end(), r) != known.end();
    if (!reference_is_solver_ && !fs::exists(r))
      throw InputError(fmt::format(
          "--reference: \"{}\" is not there: expected a file, a folder, or a solver, one of {}", r,
          fmt::join(known, ", ")));
  }

  void require_place_for_solutions() const {
    const fs::path& path = options_.solution;
    if (path.empty()) return;
    const fs::path parent = path.has_parent_path() ? path.parent_path() : fs::path(".");
    const fs::path folder = is_folder_ ? path : parent;
    if (const std::string why = why_not_writable(folder); !why.empty())
      throw InputError(fmt::format("--solution {}: {}", path.string(), why));
    const auto refuse = [&](const char* why) {
      throw InputError(fmt::format("--solution {}: {}", path.string(), why));
    };
    if (is_folder_ && fs::is_regular_file(path))
      refuse("is a file, expected a folder, as the problems may be many");
    if (is_folder_ && !options_.force && fs::exists(path) && !fs::is_empty(path))
      refuse("it is not empty; add --force to write into it");
    if (!is_folder_ && fs::is_directory(path)) refuse("is a folder, expected a file");
    if (!is_folder_ && !options_.force && fs::exists(path))
      refuse("is there already; add --force to replace it");
  }

  /// Reads a file and runs the solvers on it. One of a folder that cannot be is named and skipped.
  void take(const fs::path& file) try { solve(file); } catch (const NoProblemInFile& error) {
    // A run leaves other HDF5 files beside its problems.
    if (!is_folder_) throw;
    others_.push_back(file.filename().string());
  } catch (const InputError& error) {
    if (!is_folder_) throw;
    skip(file, error.what());
  } catch (const std::bad_alloc&) {
    if (!is_folder_) throw;
    skip(file, fmt::format("{}: it does not fit in memory", file.string()));
  }

  void skip(const fs::path& file, const std::string& reason) {
    note(fmt::format("skipped: {}", reason));
    skipped_.push_back({file, reason});
  }

  void solve(const fs::path& file) {
    const StoredProblem stored = read_problem(file);
    const auto* bodies = std::get_if<BodyProblem>(&stored.form);
    if (options_.matrix_free && bodies == nullptr)
      throw InputError(
          fmt::format("{}: holds matrices, but --matrix-free needs bodies", file.string()));
    ReadyProblem p;
    AssembledOptions o = common_;
    ProblemReport report;
    try {
      p = (options_.matrix_free ? ready_matrix_free : ready)(file.stem().string(), stored);
      report = {p.name, file, p.problem.contact_count, p.problem.dimension, p.asymmetry, {}, {}};
      if (p.problem.held) {
        report.bilateral_rows = p.problem.held->row_count();
        report.dependent_rows = p.problem.held->dependent_count();
      }
      if (options_.warm_start && p.guess.empty())
        note(fmt::format("--warm-start: {} holds no guess, from zero then", file.string()));
      if (options_.warm_start) o.guess = p.guess;
      set_reference(p, o, report);
    } catch (const InputError& error) {
      throw InputError(fmt::format("{}: {}", file.string(), error.what()));
    }
    const bool all_rolling = p.rolling && options_.solver == "all";
    const bool all_held = p.problem.held && options_.solver == "all" && !cuda_;
    const std::vector<std::string> names = all_rolling ? rolling_solver_names()
                                           : all_held  ? solvers_that_hold_rows()
                                                       : solvers_;
    report.runs = options_.matrix_free ? run_matrix_free(*bodies, p, names, o, world_)
                                       : run_solvers(p, names, o, {cuda_, world_.threads});
    keep(p, std::move(report));
  }

  void set_reference(ReadyProblem& p, const AssembledOptions& o, ProblemReport& report) const {
    if (options_.reference.empty()) return;
    if (reference_is_solver_) {
      report.reference = find_reference(p, options_.reference, o);
      const AssembledResult& found = report.reference->result;
      if (found.status == AssembledStatus::unsupported)
        throw InputError(fmt::format("--reference: {} gives none for {}: {}", options_.reference,
                                     p.name, found.note));
      return;
    }
    const fs::path path = options_.reference;
    use_reference(p, read_solution(fs::is_directory(path) ? path / (p.name + ".hdf5") : path),
                  o.model);
  }

  /// Prints and writes what is known of a problem, so that it stays whatever comes.
  void keep(const ReadyProblem& p, ProblemReport report) {
    if (!options_.json) fmt::print("{}{}", reports_.empty() ? "" : "\n", to_table(report));
    if (!options_.solution.empty()) write_best(p, report);
    if (!options_.out.empty()) {
      if (!writer_) writer_.emplace(options_.out);
      writer_->add(report);
      write_curves_chart(options_.out, report);
    }
    for (SolverRun& run : report.runs) {  // of thousands of problems
      run.result.r = {};
      run.curve = {};
    }
    if (report.reference) report.reference->result.r = {}, report.reference->curve = {};
    reports_.push_back(std::move(report));
    finish_output();
  }

  void write_best(const ReadyProblem& p, const ProblemReport& report) const {
    if (p.problem.block.empty() && !p.rolling) {
      note(fmt::format("--solution: {} has rolling friction and no rows to write", p.name));
      return;
    }
    if (is_folder_) fs::create_directories(options_.solution);
    write_solution(is_folder_ ? options_.solution / (p.name + ".hdf5") : options_.solution,
                   solution_of(p, best_run(report.runs), common_.model));
  }

  const SolveOptions& options_;
  AssembledOptions common_;
  WorldOptions world_;
  bool cuda_;
#ifdef SCREE_HAS_CUDA
  CudaDeviceScope device_{cuda_ ? world_.device : -1};  ///< of solvers: they take the current one
#endif
  std::vector<std::string> solvers_;
  bool is_folder_;
  bool reference_is_solver_ = false;
  std::optional<ReportWriter> writer_;
  std::vector<ProblemReport> reports_;
  std::vector<SkippedProblem> skipped_;
  std::vector<std::string> others_;  ///< HDF5 files of something else
};

}  // namespace

int solve_problems(const SolveOptions& options) { return Session(options).run(); }

}  // namespace scree
