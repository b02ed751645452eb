#include "host/io/twin_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "host/error.h"
#include "host/io/atomic_file.h"

namespace scree {
namespace {

std::string write_failure(const std::filesystem::path& path, const std::string& reason,
                          std::int64_t frames) {
  return fmt::format("cannot write frames {}: {}; the {} earlier frames are kept", path.string(),
                     reason, frames);
}

void remove_file(const std::filesystem::path& path) noexcept { ::unlink(path.c_str()); }

}  // namespace

TwinFile::TwinFile(std::filesystem::path path)
    : path_(std::move(path)), spare_(path_), previous_(path_) {
  spare_ += ".next";
  previous_ += ".previous";
  finish();
}

TwinFile::~TwinFile() { finish(); }

void TwinFile::finish() noexcept {
  remove_file(spare_);
  remove_file(previous_);
}

void TwinFile::start(const Write& write_empty) {
  remove_file(path_);
  try {
    h5::File file = h5::File::create(spare_);
    write_empty(file.root());
    file.close();
  } catch (const h5::Error& error) {
    remove_file(spare_);
    throw RunError(write_failure(path_, error.what(), 0));
  }
}

void TwinFile::append(const Filled& before, const Write& write_frame) {
  prepare_spare(before);
  change_spare(before.frames, write_frame);
  publish(/*keep_previous=*/true);
}

void TwinFile::cut(const Filled& kept, const Write& write) {
  prepare_spare(kept);
  change_spare(kept.frames, [&](h5::Group root) {
    for (const Growing& dataset : kept.datasets) root.truncate(dataset.name, dataset.rows);
    write(std::move(root));
  });
  publish(/*keep_previous=*/false);
}

void TwinFile::change_spare(std::int64_t frames, const Write& write) {
  try {
    h5::File file = h5::File::open_for_append(spare_);
    write(file.root());
    file.close();
  } catch (const h5::Error& error) {
    remove_file(spare_);
    throw RunError(write_failure(path_, error.what(), frames));
  }
}

/// Makes the spare a complete copy of the published file, by what it lacks where it can.
void TwinFile::prepare_spare(const Filled& filled) {
  if (filled.frames == 0) return;  // start() wrote it
  if (std::filesystem::exists(spare_)) {
    try {
      h5::File spare = h5::File::open_for_append(spare_);
      {
        const h5::File published = h5::File::open(path_);
        const h5::Group from = published.root();
        h5::Group to = spare.root();
        for (const Growing& dataset : filled.datasets) to.append_missing_rows(from, dataset.name);
      }
      spare.close();
      return;
    } catch (const h5::Error&) {
      // Somebody still reads this copy, which was the published one (HDF5 locks it), or it is
      // damaged. It stays theirs; a new one is made.
      remove_file(spare_);
    }
  }
  try {
    copy_file_atomically(path_, spare_);
  } catch (const RunError& error) {
    throw RunError(write_failure(path_, error.what(), filled.frames));
  }
}

/// Gives the spare the published name, and the published file the spare's when it is kept.
void TwinFile::publish(bool keep_previous) {
  sync_file(spare_);
  // A second name keeps the old file. Where links do not exist, the next append copies the file.
  const bool kept = keep_previous && ::link(path_.c_str(), previous_.c_str()) == 0;
  if (::rename(spare_.c_str(), path_.c_str()) != 0) {
    const int reason = errno;
    finish();
    throw RunError(io_message("cannot replace frames", path_, reason));
  }
  sync_directory_of(path_);
  if (kept && ::rename(previous_.c_str(), spare_.c_str()) != 0) remove_file(previous_);
}

}  // namespace scree
