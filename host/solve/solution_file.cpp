#include "host/solve/solution_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/h5.h"
#include "host/io/seal.h"
#include "host/io/trial.h"
#include "host/problems/assembled_form.h"
#include "host/version.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

constexpr const char* solution_format = "scree contact solution";
constexpr int format_version = 1;

std::vector<double> finite_rows(const h5::Group& group, const char* name) {
  std::vector<double> rows =
      group.has(name) ? group.read_converted<double>(name) : std::vector<double>{};
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (!std::isfinite(rows[k]))
      throw InputError(
          fmt::format("solution/{}[{}] is {}, expected a finite number", name, k, rows[k]));
  return rows;
}

Solution solution_in(const fs::path& path) {
  const h5::File file = h5::File::open_foreign(path);
  const h5::Group root = file.root();
  Solution s;
  const bool own = root.has_attribute("format") && root.text_attribute("format") == solution_format;
  if (own) {
    const auto version = root.attribute<std::int64_t>("format_version");
    if (version != format_version)
      throw InputError(
          fmt::format("attribute format_version is {}, expected {}", version, format_version));
    s.problem = root.text_attribute("problem");
    s.solver = root.text_attribute("solver");
    s.residual = root.attribute<double>("residual");
    const std::string model = root.text_attribute("model");
    if (model != "exact" && model != "convex")
      throw InputError(fmt::format("attribute model is \"{}\", expected exact or convex", model));
    if (model == "convex") s.model = AssembledModel::convex;
  }
  if (!root.has("solution/u"))
    throw InputError("it holds no solution, expected the dataset solution/u");
  const h5::Group group = root.open_group("solution");
  s.u = finite_rows(group, "u");
  // In FCLIB files of others impulses of solutions are not what they say.
  if (own) s.r = finite_rows(group, "r");
  if (own && s.r.size() != s.u.size())
    throw InputError(
        fmt::format("solution/r has {} values, expected {} as solution/u", s.r.size(), s.u.size()));
  return s;
}

[[noreturn]] void refuse(const fs::path& path, std::string what) {
  const std::string prefix = path.string() + ": ";
  if (what.starts_with(prefix)) what.erase(0, prefix.size());
  throw InputError(fmt::format("cannot read solution {}: {}", path.string(), what));
}

}  // namespace

const SolverRun& best_run(const std::vector<SolverRun>& runs) {
  const auto worse = [](const SolverRun& run) {
    const double residual = run.result.residual.relative;
    return std::pair(run.friction != "cone", std::isfinite(residual) ? residual : HUGE_VAL);
  };
  return *std::min_element(runs.begin(), runs.end(), [&](const SolverRun& a, const SolverRun& b) {
    return worse(a) < worse(b);
  });
}

Solution solution_of(const ReadyProblem& problem, const SolverRun& run, AssembledModel model) {
  const std::vector<double> u = velocity_of(problem, model, run.result.r);
  const int dimension = problem.problem.dimension;
  Solution s;
  s.problem = problem.name;
  s.solver = run.solver;
  s.model = model;
  s.residual = run.result.residual.relative;
  s.r = from_three_rows(dimension, run.result.r);
  s.u = from_three_rows(dimension, u);
  if (problem.problem.held) s.l = problem.problem.held->impulses(run.result.r);
  return s;
}

void write_solution(const fs::path& path, const Solution& s) {
  AtomicFile target(path);
  try {
    h5::File file = h5::File::create(target.temporary(), seal_bytes);
    {
      h5::Group root = file.root();
      root.write_text_attribute("format", solution_format);
      root.write_attribute<std::int64_t>("format_version", format_version);
      root.write_text_attribute("program", fmt::format("scree {} ({})", version(), commit()));
      root.write_text_attribute("problem", s.problem);
      root.write_text_attribute("solver", s.solver);
      root.write_text_attribute("model", name_of(s.model));
      root.write_attribute<double>("residual", s.residual);
      h5::Group group = root.create_group("solution");
      group.write("r", std::span<const double>(s.r));
      group.write("u", std::span<const double>(s.u));
      if (!s.l.empty()) group.write("l", std::span<const double>(s.l));
    }
    file.close();
  } catch (const h5::Error& error) {
    throw RunError(fmt::format("cannot write solution {}: {}", path.string(), error.what()));
  }
  write_seal(target.temporary(), solution_format, format_version);
  target.commit();
}

Solution read_solution(const fs::path& path) try {
  if (!fs::exists(path)) refuse(path, "there is no such file");
  if (!h5::is_hdf5(path)) refuse(path, "it is not an HDF5 file");
  if (has_seal(path, solution_format)) {
    const std::string fault = check_seal(path, solution_format, format_version);
    if (!fault.empty()) refuse(path, fault);
  } else if (const std::string end = trial([&] { solution_in(path); }, 60); !end.empty()) {
    refuse(path, fmt::format("it is damaged: reading it was tried, and {}", end));
  }
  try {
    return solution_in(path);
  } catch (const InputError& fault) {
    refuse(path, fault.what());
  }
} catch (const h5::Error& fault) {
  refuse(path, fault.what());
}

void use_reference(ReadyProblem& problem, const Solution& reference, AssembledModel model) {
  if (reference.model != model)
    throw InputError(fmt::format("the reference is a solution of the {} law, expected the {} one",
                                 name_of(reference.model), name_of(model)));
  const int dimension = problem.problem.dimension;
  const std::size_t rows =
      static_cast<std::size_t>(dimension) * static_cast<std::size_t>(problem.problem.contact_count);
  if (reference.u.size() != rows)
    throw InputError(fmt::format("the reference has {} velocities, expected {} ({} contacts)",
                                 reference.u.size(), rows, problem.problem.contact_count));
  problem.reference_velocity = to_three_rows(dimension, reference.u);
  problem.reference_impulse =
      reference.r.empty() ? std::vector<double>{} : to_three_rows(dimension, reference.r);
  problem.reference_model = model;
}

}  // namespace scree
