#include "host/io/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <system_error>
#include <vector>

#include "host/error.h"

namespace scree {
namespace {

[[noreturn]] void fail(std::string_view what, const std::filesystem::path& path, int error_number) {
  std::error_code ignored;
  const bool kept = std::filesystem::exists(path, ignored);
  throw RunError(io_message(what, path, error_number, kept ? "the previous file is kept" : ""));
}

}  // namespace

std::string io_message(std::string_view what, const std::filesystem::path& path, int error_number,
                       std::string_view kept) {
  std::string message =
      fmt::format("{} {}: {}", what, path.string(), std::generic_category().message(error_number));
  if (error_number == ENOSPC || error_number == EDQUOT) message += " (the disk is full)";
  if (error_number == EFBIG) message += " (a limit of this system or account on file sizes)";
  if (!kept.empty()) message += fmt::format("; {}", kept);
  return message;
}

std::filesystem::path temporary_name(const std::filesystem::path& path) {
  std::filesystem::path name = path;
  name += ".tmp";
  return name;
}

AtomicFile::AtomicFile(std::filesystem::path path)
    : path_(std::move(path)), temporary_(temporary_name(path_)) {}

AtomicFile::~AtomicFile() {
  close();
  if (!committed_) ::unlink(temporary_.c_str());
}

void AtomicFile::open(int flags) {
  if (descriptor_ >= 0) return;
  descriptor_ = ::open(temporary_.c_str(), flags | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("cannot write", path_, errno);
}

void AtomicFile::close() {
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

void AtomicFile::write(std::string_view bytes) {
  open(O_WRONLY | O_CREAT | O_TRUNC);
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("cannot write", path_, errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

void AtomicFile::commit() {
  open(O_RDWR);
  if (::fsync(descriptor_) != 0) fail("cannot write", path_, errno);
  close();
  if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot replace", path_, errno);
  committed_ = true;
  sync_directory_of(path_);
}

void write_file_atomically(const std::filesystem::path& path, std::string_view bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

void copy_file_atomically(const std::filesystem::path& from, const std::filesystem::path& to) {
  // The standard library's copy_file calls a full disk an input/output error.
  const int source = ::open(from.c_str(), O_RDONLY | O_CLOEXEC);
  if (source < 0) throw RunError(io_message("cannot read", from, errno));
  try {
    AtomicFile target(to);
    std::vector<char> block(std::size_t{1} << 20);
    for (;;) {
      const ssize_t count = ::read(source, block.data(), block.size());
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) throw RunError(io_message("cannot read", from, errno));
      if (count == 0) break;
      target.write({block.data(), static_cast<std::size_t>(count)});
    }
    target.commit();
  } catch (...) {
    ::close(source);
    throw;
  }
  ::close(source);
}

void sync_file(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
  if (descriptor < 0) throw RunError(io_message("cannot write", path, errno));
  const int failed = ::fsync(descriptor) != 0 ? errno : 0;
  ::close(descriptor);
  if (failed != 0) throw RunError(io_message("cannot write", path, failed));
}

void sync_directory_of(const std::filesystem::path& path) {
  const std::filesystem::path parent = path.has_parent_path() ? path.parent_path() : ".";
  const int descriptor = ::open(parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);  // Some network file systems refuse; the rename itself has happened.
  ::close(descriptor);
}

}  // namespace scree
