#include "host/io/twin_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
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
  remove_spare();
}

TwinFile::~TwinFile() {
  try {
    publish();
  } catch (const RunError&) {
    // Nothing can be done here; the file keeps what was published.
  }
  remove_spare();
}

void TwinFile::remove_spare() noexcept {
  open_.reset();
  remove_file(spare_);
  remove_file(previous_);
}

void TwinFile::start(const Write& write_empty) {
  remove_spare();
  remove_file(path_);
  published_ = 0;
  change_spare([&] {
    open_.emplace(h5::File::create(spare_));
    write_empty(open_->root());
    close_spare();
  });
}

void TwinFile::append(const Filled& before, const Write& write_frame) {
  const Clock::time_point begin = Clock::now();
  if (!open_) {
    open_spare(before);
    publishing_ = Clock::now() - begin;
  }
  change_spare([&] { write_frame(open_->root()); });
  const Clock::duration longest =
      std::min<Clock::duration>((kMostShare - 1) * publishing_, kLongestWait);
  const bool waits = is_seldom_ && published_ > 0 && Clock::now() - published_at_ < longest;
  if (!waits) publish();
}

void TwinFile::publish() {
  if (!open_) return;
  const Clock::time_point begin = Clock::now();
  change_spare([&] { close_spare(); });
  exchange_names(/*keep_previous=*/true);
  published_at_ = Clock::now();
  publishing_ += published_at_ - begin;
}

void TwinFile::cut(const Filled& kept, const Write& write) {
  publish();
  open_spare(kept);
  change_spare([&] {
    for (const Growing& dataset : kept.datasets) open_->root().truncate(dataset.name, dataset.rows);
    write(open_->root());
    close_spare();
  });
  exchange_names(/*keep_previous=*/false);
}

void TwinFile::open_spare(const Filled& filled) {
  published_ = filled.frames;
  prepare_spare(filled);
  change_spare([&] { open_.emplace(h5::File::open_for_append(spare_)); });
}

void TwinFile::close_spare() {
  open_->close();
  open_.reset();
}

/// A spare that could not be changed is of no use.
template <class Change>
void TwinFile::change_spare(const Change& change) {
  try {
    change();
  } catch (const h5::Error& error) {
    open_.reset();
    remove_file(spare_);
    throw RunError(write_failure(path_, error.what(), published_));
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
void TwinFile::exchange_names(bool keep_previous) {
  sync_file(spare_);
  // A second name keeps the old file. Where links do not exist, the next append copies the file.
  const bool kept = keep_previous && ::link(path_.c_str(), previous_.c_str()) == 0;
  if (::rename(spare_.c_str(), path_.c_str()) != 0) {
    const int reason = errno;
    remove_spare();
    throw RunError(io_message("cannot replace frames", path_, reason));
  }
  sync_directory_of(path_);
  if (kept && ::rename(previous_.c_str(), spare_.c_str()) != 0) remove_file(previous_);
}

}  // namespace scree
