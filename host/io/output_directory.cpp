#include "host/io/output_directory.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "host/error.h"
#include "host/io/atomic_file.h"
#include "host/io/directory_checks.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse_folder(const fs::path& path, const std::string& what) {
  throw InputError(fmt::format("output directory {}: {}", path.string(), what));
}

/// Whether a name is begin, digits, end.
bool is_numbered(std::string_view name, std::string_view begin, std::string_view end) {
  if (!name.starts_with(begin) || !name.ends_with(end)) return false;
  if (name.size() <= begin.size() + end.size()) return false;
  const auto digits = name.substr(begin.size(), name.size() - begin.size() - end.size());
  return std::all_of(digits.begin(), digits.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Files that runs write, and what a killed run may leave of one half written.
bool is_own_name(std::string_view name) {
  for (const std::string_view suffix : {".tmp", ".next", ".previous"})
    if (name.ends_with(suffix)) name.remove_suffix(suffix.size());
  constexpr std::array<std::string_view, 9> names{
      "run.json",      "steps.csv", "forces.csv",   "frames.vtkhdf",  "contacts.vtkhdf",
      "checkpoint.h5", "walls.obj", "walls.vtkhdf", "surfaces.vtkhdf"};
  return is_numbered(name, "frames_", ".vtkhdf") || is_numbered(name, "picture_", ".png") ||
         is_numbered(name, "problem_", ".hdf5") ||
         std::find(names.begin(), names.end(), name) != names.end();
}

bool may_change(const std::string& pointer, const std::vector<std::string>& may_differ) {
  return std::any_of(may_differ.begin(), may_differ.end(), [&](const std::string& prefix) {
    return pointer == prefix || pointer.starts_with(prefix + "/");
  });
}

/// The value at a JSON pointer, or "nothing".
std::string value_at(const nlohmann::json& json, const std::string& pointer) {
  const nlohmann::json::json_pointer at(pointer);
  if (!json.contains(at)) return "nothing";
  std::string text = json.at(at).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  constexpr std::size_t longest = 80;
  if (text.size() > longest) text = text.substr(0, longest) + "...";
  return text;
}

/// The first difference of two scenes that matters, as a sentence; empty when there is none.
std::string difference(const std::string& stored, const std::string& given,
                       const std::vector<std::string>& may_differ) {
  if (stored == given) return {};
  const auto parse = [](const std::string& text) {
    return nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false,
                                 /*ignore_comments=*/true);
  };
  const nlohmann::json a = parse(stored);
  const nlohmann::json b = parse(given);
  if (a.is_discarded() || b.is_discarded()) return "the scene texts differ";
  for (const nlohmann::json& change : nlohmann::json::diff(a, b)) {
    const auto pointer = change.at("path").get<std::string>();
    if (may_change(pointer, may_differ)) continue;
    return fmt::format("{} was {} and is now {}", pointer.empty() ? "the scene" : pointer,
                       value_at(a, pointer), value_at(b, pointer));
  }
  return {};
}

}  // namespace

OutputDirectory::OutputDirectory(fs::path path, ExistingOutput existing,
                                 const std::string& scene_text,
                                 const std::vector<std::string>& may_differ)
    : path_(std::move(path)), existing_(existing) {
  if (path_.empty()) throw InputError("output directory: the name is empty");
  std::error_code error;
  const bool is_new = fs::status(path_, error).type() == fs::file_type::not_found;
  if (is_new && resuming())
    refuse_folder(path_, "it does not exist, so there is no checkpoint.h5 to resume from");
  if (const std::string why = why_not_writable(path_); !why.empty()) refuse_folder(path_, why);
  if (is_new) return;
  check_directory();
  try {
    lock();  // refuses early; a failed constructor lets go of it below
    if (resuming()) load_checkpoint(scene_text, may_differ);
  } catch (...) {
    if (lock_ >= 0) ::close(lock_);
    throw;
  }
}

OutputDirectory::~OutputDirectory() {
  if (lock_ >= 0) ::close(lock_);
}

fs::path OutputDirectory::picture(std::int64_t number) const {
  return path_ / fmt::format("picture_{:05}.png", number);
}

fs::path OutputDirectory::problem(std::int64_t step) const {
  return path_ / fmt::format("problem_{}.hdf5", step);
}

void OutputDirectory::check_directory() const {
  if (existing_ == ExistingOutput::refuse && !fs::is_empty(path_))
    refuse_folder(
        path_,
        "it is not empty; give another name, --resume to continue the run in it, or --force "
        "to replace the files of that run");
  for (const fs::path& file : own_files())
    if (fs::is_directory(fs::symlink_status(file)))
      refuse_folder(path_,
                    fmt::format("{} is a directory and in the way of a file", file.string()));
}

std::vector<fs::path> OutputDirectory::own_files() const {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(path_))
    if (is_own_name(entry.path().filename().string())) files.push_back(entry.path());
  return files;
}

/// Locks the directory itself: nothing is left behind when a run is killed.
void OutputDirectory::lock() {
  if (lock_ >= 0) return;
  lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) refuse_folder(path_, reason_of(errno));
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
    refuse_folder(path_, "another run is writing there now");
  // Other errors mean a file system without locks, which is no reason not to run.
}

void OutputDirectory::load_checkpoint(const std::string& scene_text,
                                      const std::vector<std::string>& may_differ) {
  if (!fs::exists(checkpoint_file()))
    refuse_folder(path_, "it holds no checkpoint.h5 to resume from; start again with --force");
  checkpoint_ = read_checkpoint(checkpoint_file());
  const std::string found = difference(checkpoint_->scene_text, scene_text, may_differ);
  if (!found.empty())
    refuse_folder(path_, fmt::format("its checkpoint.h5 is of another scene: {}", found));
}

void OutputDirectory::require_present() const {
  struct stat locked {
  }, found{};
  if (::fstat(lock_, &locked) == 0 && ::stat(path_.c_str(), &found) == 0 &&
      locked.st_dev == found.st_dev && locked.st_ino == found.st_ino)
    return;
  throw RunError(fmt::format("output directory {}: it was removed or replaced during the run",
                             path_.string()));
}

void OutputDirectory::prepare() {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) throw InputError(io_message("cannot create output directory", path_, error.value()));
  lock();
  if (existing_ == ExistingOutput::refuse && !fs::is_empty(path_))
    refuse_folder(path_, "it is not empty any more");
  if (existing_ != ExistingOutput::replace) return;
  for (const fs::path& file : own_files()) {
    fs::remove(file, error);
    if (error) throw RunError(io_message("cannot remove", file, error.value()));
  }
}

}  // namespace scree
