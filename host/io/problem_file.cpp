#include "host/io/problem_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "host/io/atomic_file.h"
#include "host/io/body_problem_layout.h"
#include "host/io/seal.h"
#include "host/io/trial.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

std::string message_of(const fs::path& path, std::string what) {
  const std::string prefix = path.string() + ": ";  // of messages about the file's contents
  if (what.starts_with(prefix)) what.erase(0, prefix.size());
  return fmt::format("cannot read contact problem {}: {}", path.string(), what);
}

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw InputError(message_of(path, what));
}

StoredProblem read_contents(const fs::path& path) {
  const h5::File file = h5::File::open_foreign(path);
  const h5::Group root = file.root();
  if (is_body_problem(root)) {
    StoredProblem problem;
    problem.form = read_body_problem(root);
    return problem;
  }
  if (is_fclib(root)) return read_fclib(root);
  throw NoProblemInFile(
      "it holds no contact problem, expected the attribute format (scree) or one of the groups "
      "fclib_local, fclib_global and fclib_global_rolling (FCLIB)");
}

/// Seconds that reading a file may take: many times what it does take.
unsigned seconds_for(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(path, error);
  return 20 + static_cast<unsigned>(error ? 0 : bytes / 5'000'000);
}

/// Refuses what a file that HDF5 cannot be trusted with is found to be.
void require_harmless(const fs::path& path) {
  if (has_seal(path, problem_format_name)) {
    const std::string fault = check_seal(path, problem_format_name, problem_format_version);
    if (!fault.empty()) refuse(path, fault);
    return;
  }
  const std::string end = trial([&] { read_contents(path); }, seconds_for(path));
  if (!end.empty()) refuse(path, fmt::format("it is damaged: reading it was tried, and {}", end));
}

}  // namespace

StoredProblem read_problem(const fs::path& path) try {
  std::error_code error;
  const auto status = fs::status(path, error);
  if (!fs::exists(status)) refuse(path, "there is no such file");
  if (!fs::is_regular_file(status)) refuse(path, "it is not a file");
  if (::access(path.c_str(), R_OK) != 0)
    refuse(path, "it cannot be read: " + std::generic_category().message(errno));
  if (!h5::is_hdf5(path)) refuse(path, "it is not an HDF5 file");
  require_harmless(path);
  try {
    StoredProblem problem = read_contents(path);
    validate(problem);
    return problem;
  } catch (const NoProblemInFile& fault) {
    throw NoProblemInFile(message_of(path, fault.what()));
  } catch (const InputError& fault) {
    refuse(path, fault.what());
  } catch (const h5::Error& fault) {
    refuse(path, fault.what());
  }
} catch (const std::bad_alloc&) {
  refuse(path, "its arrays do not fit in memory");
} catch (const std::length_error&) {
  refuse(path, "its arrays do not fit in memory");
}

void write_problem(const fs::path& path, const StoredProblem& problem) {
  const bool is_global = std::holds_alternative<GlobalProblem>(problem.form);
  write_problem(path, problem, is_global ? FclibStorage::triplets : FclibStorage::rows);
}

void write_problem(const fs::path& path, const StoredProblem& problem, FclibStorage storage) {
  validate(problem);
  AtomicFile target(path);
  const auto* bodies = std::get_if<BodyProblem>(&problem.form);
  try {
    h5::File file = h5::File::create(target.temporary(), bodies != nullptr ? seal_bytes : 0);
    {
      h5::Group root = file.root();
      if (bodies != nullptr) {
        write_body_problem(root, *bodies);
      } else {
        write_fclib(root, problem, storage);
      }
    }
    file.close();
  } catch (const h5::Error& error) {
    throw RunError(fmt::format("cannot write contact problem {}: {}", path.string(), error.what()));
  }
  if (bodies != nullptr)
    write_seal(target.temporary(), problem_format_name, problem_format_version);
  target.commit();
}

}  // namespace scree
