#pragma once
// Files that appear whole or not at all: written under a temporary name, synced, then renamed.

#include <filesystem>
#include <string>
#include <string_view>

namespace scree {

/// One file being written beside its final name. Until commit() the final name keeps what it had;
/// without commit() the destructor removes the temporary file.
///
/// Either write() is used, or another library writes the file temporary() and commit() publishes
/// it. The temporary name is fixed (the final name and ".tmp"): one writer per file is assumed, and
/// what a killed run left behind is replaced.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& temporary() const { return temporary_; }

  /// Appends bytes to the temporary file. @throws RunError with the path and the system's reason
  void write(std::string_view bytes);

  /// Syncs the temporary file to disk and gives it the final name. @throws RunError
  void commit();

 private:
  void open(int flags);
  void close();

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
  bool committed_ = false;
};

/// Replaces the file by these bytes. @throws RunError; the previous file is then still there
void write_file_atomically(const std::filesystem::path& path, std::string_view bytes);

/// Name under which path is written before it is renamed.
std::filesystem::path temporary_name(const std::filesystem::path& path);

/// Makes the file a copy of another one. @throws RunError; the previous file is then still there
void copy_file_atomically(const std::filesystem::path& from, const std::filesystem::path& to);

/// Makes the contents of a closed file durable. @throws RunError
void sync_file(const std::filesystem::path& path);

/// Makes renames within the directory of path durable, where the file system can.
void sync_directory_of(const std::filesystem::path& path);

/// "what path: reason", the reason of an errno value; a full disk is called that.
/// @param kept  appended when not empty: what is still on disk
std::string io_message(std::string_view what, const std::filesystem::path& path, int error_number,
                       std::string_view kept = {});

}  // namespace scree
