#include "host/cli/convert_command.h"

#include <fmt/format.h>

#include <system_error>
#include <variant>

#include "host/cli/convert_run.h"
#include "host/error.h"
#include "host/io/problem_file.h"
#include "host/problems/matrix_form.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

MatrixForm form_of(const std::string& kind) {
  if (kind == "local") return MatrixForm::local;
  if (kind == "global") return MatrixForm::global;
  throw InputError(fmt::format("--kind: \"{}\" is not allowed: expected local or global", kind));
}

FclibStorage storage_of(const std::string& name, MatrixForm form) {
  if (name.empty()) return form == MatrixForm::global ? FclibStorage::triplets : FclibStorage::rows;
  if (name == "rows") return FclibStorage::rows;
  if (name == "columns") return FclibStorage::columns;
  if (name == "triplets") return FclibStorage::triplets;
  throw InputError(
      fmt::format("--storage: \"{}\" is not allowed: expected rows, columns or triplets", name));
}

void require_writable(const fs::path& out, bool force) {
  std::error_code error;
  if (fs::is_directory(out, error))
    throw InputError(fmt::format("{}: is a directory, expected a file to write", out.string()));
  if (fs::exists(out, error) && !fs::is_regular_file(out, error))
    throw InputError(fmt::format("{}: is no ordinary file, it is not replaced", out.string()));
  if (!force && fs::exists(out, error))
    throw InputError(fmt::format("{}: is there already; add --force to replace it", out.string()));
  const fs::path folder = out.has_parent_path() ? out.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error))
    throw InputError(fmt::format("{}: there is no folder {}", out.string(), folder.string()));
}

std::string contacts_of(int count, int dimension) {
  return dimension == 5 ? fmt::format("{} contacts with rolling friction", count)
                        : fmt::format("{} contacts in {}-D", count, dimension);
}

std::string rows_of(std::size_t bilateral) {
  return bilateral == 0 ? "" : fmt::format(", {} bilateral rows", bilateral);
}

std::string summary_of(const LocalProblem& p) {
  return fmt::format("local, {}{}, W with {} entries", contacts_of(p.contact_count(), p.dimension),
                     rows_of(p.s.size()), p.W.entry_count());
}

std::string summary_of(const GlobalProblem& p) {
  return fmt::format("global, {}{}, {} velocities, H with {} entries",
                     contacts_of(p.contact_count(), p.dimension), rows_of(p.b.size()), p.f.size(),
                     p.H.entry_count());
}

std::string summary_of(const BodyProblem& p) {
  return fmt::format("{} contacts with bodies", p.contact_count());
}

}  // namespace

int convert(const ConvertOptions& options) {
  std::error_code error;
  if (fs::is_directory(options.problem, error)) {
    if (options.kind != "local" || !options.storage.empty())
      throw InputError(
          "--kind and --storage are for contact problems, not for the folder of a run");
    require_writable(options.out, options.force);
    return convert_run(options.problem, options.out);
  }
  const MatrixForm form = form_of(options.kind);
  const FclibStorage storage = storage_of(options.storage, form);
  require_writable(options.out, options.force);
  const StoredProblem stored = read_problem(options.problem);
  StoredProblem matrices;
  try {
    matrices = as_matrices(stored, form);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", options.problem.string(), error.what()));
  }
  write_problem(options.out, matrices, storage);
  fmt::print("{}: {}\n", options.out.string(),
             std::visit([](const auto& p) { return summary_of(p); }, matrices.form));
  return 0;
}

}  // namespace scree
