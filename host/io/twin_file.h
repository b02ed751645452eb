#pragma once
// An HDF5 file that grows piece by piece and can be read, whole, at any moment.
//
// Kill safety without copying the whole file for each piece. HDF5 rewrites its own metadata in
// place, so a file being appended to is unreadable if the writer dies. Two copies are kept instead:
// the published file and a spare beside it (".next") that is one piece behind. append() brings the
// spare up to date (the piece it lacks comes from the published file), adds the new piece, syncs
// it, and renames it over the published name, whose old contents become the next spare. What
// carries the published name is always complete, and no reader ever sees it change under its name.
// The price is twice the writing and, while the run lasts, twice the disk space: a constant factor,
// where a copy per piece would be quadratic. Files of small scenes spend most of their time on that, so pieces of a second
// at most may wait in the spare for the next one, until publishing takes a tenth of the time; a run that is killed loses those.
// Other ways that were weighed: one file per piece
// behind virtual datasets reads back zeros when moved without its parts; SWMR files of a killed
// writer need a repair tool before ParaView opens them.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/io/h5.h"

namespace scree {

/// A dataset that grows, and the rows it has when the file is filled so far.
struct Growing {
  std::string name;
  std::uint64_t rows;
};

/// What is in the file now.
struct Filled {
  std::int64_t frames = 0;
  std::vector<Growing> datasets;
};

class TwinFile {
 public:
  using Write = std::function<void(h5::Group root)>;

  /// Removes what a killed run left beside the file. @param path  published name
  explicit TwinFile(std::filesystem::path path);
  ~TwinFile();  ///< publishes what it can of what waits, and removes the spare copy
  TwinFile(const TwinFile&) = delete;
  TwinFile& operator=(const TwinFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Begins a new file, published with the first append(); an existing one is removed.
  /// @throws RunError naming the file and the reason
  void start(const Write& write_empty);

  /// Adds a frame and publishes it, or lets it wait. @param before  what the file holds, with frames that wait
  /// @throws RunError; the file keeps the frames that were published
  void append(const Filled& before, const Write& write_frame);

  /// From now on a frame may wait for the next one, until publishing takes a tenth of the time; frames of a second at most.
  void publish_seldom() { is_seldom_ = true; }

  /// Publishes the frames that wait. @throws RunError; the file keeps those that were published
  void publish();

  /// Drops the rows beyond those that are kept. @param write  changes the rest of the file
  /// @throws RunError; the file is then as it was
  void cut(const Filled& kept, const Write& write);

 private:
  using Clock = std::chrono::steady_clock;
  static constexpr int kMostShare = 10;  ///< one part in so many of the time for publishing
  static constexpr std::chrono::seconds kLongestWait{1};

  void open_spare(const Filled& filled);
  void close_spare();
  template <class Change>
  void change_spare(const Change& change);
  void prepare_spare(const Filled& filled);
  void exchange_names(bool keep_previous);
  void remove_spare() noexcept;

  std::filesystem::path path_;
  std::filesystem::path spare_;     ///< gets the next frame, then the published name
  std::filesystem::path previous_;  ///< the published file while names are exchanged
  std::optional<h5::File> open_;    ///< the spare while it has frames that wait
  std::int64_t published_ = 0;      ///< frames of the published file when the spare was opened
  bool is_seldom_ = false;
  Clock::time_point published_at_;
  Clock::duration publishing_{};  ///< what it took the last time
};

}  // namespace scree
