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
// where a copy per piece would be quadratic. Other ways that were weighed: one file per piece
// behind virtual datasets reads back zeros when moved without its parts; SWMR files of a killed
// writer need a repair tool before ParaView opens them.

#include <cstdint>
#include <filesystem>
#include <functional>
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
  ~TwinFile();  ///< as finish()
  TwinFile(const TwinFile&) = delete;
  TwinFile& operator=(const TwinFile&) = delete;

  const std::filesystem::path& path() const { return path_; }

  /// Begins a new file, published with the first append(); an existing one is removed.
  /// @throws RunError naming the file and the reason
  void start(const Write& write_empty);

  /// Adds a frame and publishes it. @param before  what the file holds
  /// @throws RunError; the file keeps the earlier frames
  void append(const Filled& before, const Write& write_frame);

  /// Drops the rows beyond those that are kept. @param write  changes the rest of the file
  /// @throws RunError; the file is then as it was
  void cut(const Filled& kept, const Write& write);

  /// Removes the spare copy. Every frame is on disk already.
  void finish() noexcept;

 private:
  void change_spare(std::int64_t frames, const Write& write);
  void prepare_spare(const Filled& filled);
  void publish(bool keep_previous);

  std::filesystem::path path_;
  std::filesystem::path spare_;     ///< gets the next frame, then the published name
  std::filesystem::path previous_;  ///< the published file while names are exchanged
};

}  // namespace scree
