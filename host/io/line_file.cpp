#include "host/io/line_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "host/error.h"
#include "host/io/atomic_file.h"

namespace scree {
namespace {

/// The line up to and with its end; shortens the text to what follows.
std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n') + 1);
  text.remove_prefix(line.size());
  return line;
}

}  // namespace

LineFile::LineFile(std::filesystem::path path, std::uint64_t kept_bytes, std::string header)
    : path_(std::move(path)), last_flush_(std::chrono::steady_clock::now()) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor_ < 0) throw RunError(io_message("cannot write", path_, errno));
  if (::ftruncate(descriptor_, static_cast<off_t>(kept_bytes)) != 0) {
    const int reason = errno;
    ::close(descriptor_);
    throw RunError(io_message("cannot shorten", path_, reason));
  }
  if (kept_bytes > 0) return;
  pending_ = std::move(header);
  try {
    flush();
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

LineFile::~LineFile() {
  try {
    flush();
  } catch (const RunError&) {
    // Nothing can be done here; the file ends with a whole line.
  }
  ::close(descriptor_);
}

void LineFile::line_done() {
  pending_lines_ += 1;
  if (pending_lines_ >= 100 ||
      std::chrono::steady_clock::now() - last_flush_ >= std::chrono::seconds(1))
    flush();
}

void LineFile::flush() {
  last_flush_ = std::chrono::steady_clock::now();
  pending_lines_ = 0;
  const std::string lines = std::exchange(pending_, {});
  if (lines.empty()) return;
  for (std::string_view rest = lines; !rest.empty();) write_line(take_line(rest));
  struct stat state {};
  if (::fstat(descriptor_, &state) == 0 && state.st_nlink == 0)
    throw RunError(fmt::format("{} was removed during the run", path_.string()));
}

void LineFile::write_line(std::string_view line) {
  const off_t start = ::lseek(descriptor_, 0, SEEK_END);
  while (!line.empty()) {
    const ssize_t written = ::write(descriptor_, line.data(), line.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int reason = errno;
      // When even this fails, readers leave the torn line out.
      [[maybe_unused]] const int cut = ::ftruncate(descriptor_, start);
      throw RunError(io_message("cannot write", path_, reason, "the earlier lines are kept"));
    }
    line.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace scree
