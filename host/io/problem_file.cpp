#include "host/io/problem_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/body_problem_layout.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, std::string what) {
  const std::string prefix = path.string() + ": ";  // of messages about the file's contents
  if (what.starts_with(prefix)) what.erase(0, prefix.size());
  throw InputError(fmt::format("cannot read contact problem {}: {}", path.string(), what));
}

StoredProblem read_root(const h5::Group& root) {
  if (is_body_problem(root)) {
    StoredProblem problem;
    problem.form = read_body_problem(root);
    return problem;
  }
  if (is_fclib(root)) return read_fclib(root);
  throw InputError(
      "it holds no contact problem, expected the attribute format (scree) or one of the groups "
      "fclib_local and fclib_global (FCLIB)");
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
  try {
    const h5::File file = h5::File::open(path);
    StoredProblem problem = read_root(file.root());
    validate(problem);
    return problem;
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

bool may_hold_problem(const fs::path& path) {
  std::error_code error;
  if (!fs::is_regular_file(path, error) || !h5::is_hdf5(path)) return true;
  try {
    const h5::File file = h5::File::open(path);
    return is_body_problem(file.root()) || is_fclib(file.root());
  } catch (const h5::Error&) {
    return true;
  }
}

void write_problem(const fs::path& path, const StoredProblem& problem) {
  const bool is_global = std::holds_alternative<GlobalProblem>(problem.form);
  write_problem(path, problem, is_global ? FclibStorage::triplets : FclibStorage::rows);
}

void write_problem(const fs::path& path, const StoredProblem& problem, FclibStorage storage) {
  validate(problem);
  AtomicFile target(path);
  try {
    h5::File file = h5::File::create(target.temporary());
    {
      h5::Group root = file.root();
      if (const auto* bodies = std::get_if<BodyProblem>(&problem.form)) {
        write_body_problem(root, *bodies);
      } else {
        write_fclib(root, problem, storage);
      }
    }
    file.close();
  } catch (const h5::Error& error) {
    throw RunError(fmt::format("cannot write contact problem {}: {}", path.string(), error.what()));
  }
  target.commit();
}

}  // namespace scree
