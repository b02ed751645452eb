#include "host/io/directory_checks.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace scree {
namespace {

namespace fs = std::filesystem;

/// The closest parent that exists must take a new directory.
std::string why_not_created(const fs::path& folder) {
  if (fs::is_symlink(fs::symlink_status(folder))) return "it is a link to nowhere";
  fs::path parent = fs::absolute(folder).lexically_normal();
  if (!parent.has_filename()) parent = parent.parent_path();
  do parent = parent.parent_path();
  while (!fs::exists(parent) && parent != parent.root_path());
  if (!fs::is_directory(parent))
    return fmt::format("it cannot be created, {} is not a directory", parent.string());
  if (::access(parent.c_str(), W_OK | X_OK) != 0)
    return fmt::format("it cannot be created in {}: {}", parent.string(), reason_of(errno));
  return {};
}

}  // namespace

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

std::string why_not_writable(const fs::path& folder) {
  std::error_code error;
  const fs::file_status status = fs::status(folder, error);
  if (status.type() == fs::file_type::none) return error.message();
  if (!fs::exists(status)) return why_not_created(folder);
  if (!fs::is_directory(status)) return "it is not a directory";
  if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0)
    return fmt::format("it cannot be written: {}", reason_of(errno));
  return {};
}

}  // namespace scree
