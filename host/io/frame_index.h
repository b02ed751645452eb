#pragma once
// frames.vtkhdf where ranks write pieces: frames of all bodies as one file, whose data are in frames_0.vtkhdf,
// frames_1.vtkhdf and so on beside it.
//
// A piece (host/io/frames.h, FrameBodies::own) is a file of frames of the bodies of one rank, complete at every moment. What
// is here is a table of contents: transient VTKHDF PolyData with a part for each rank that has bodies in a frame, in the
// order of ranks. Points, point data, offsets and connectivity are virtual datasets of HDF5, so that ParaView and h5py read
// pieces as one file; without a piece they find zeros. Group Pieces, for this program, says which piece a part is in.
//
// The file is written anew each time, under another name, and then renamed. Each part takes about 150 bytes and 13 us for
// each array, so the file is not always written for each frame, but as often as it takes a tenth of the time at most.
//
// Parts refer to frames that are on disk in all pieces: pieces go first when there is a new frame, the index when frames go.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/io/frames.h"

namespace scree {

/// The file beside frames.vtkhdf that one rank writes: frames_3.vtkhdf.
std::filesystem::path frame_piece_file(const std::filesystem::path& index, int rank);

/// Its rank, if it is the name of one. @param name  without a folder
std::optional<int> rank_of_frame_piece(const std::string& name);

/// Where the bodies of frames are.
struct FramePieces {
  /// The bodies of one rank in a frame.
  struct Part {
    int rank = 0;
    std::uint64_t bodies = 0;  ///< > 0
  };
  std::vector<double> times;        ///< of frames [s]
  std::vector<std::size_t> begins;  ///< of the parts of each frame, and the end of the last
  std::vector<Part> parts;

  std::span<const Part> of_frame(std::size_t frame) const {
    return {parts.data() + begins[frame], parts.data() + begins[frame + 1]};
  }
};

/// @param root  of an index, which has frame_pieces_group
/// @throws h5::Error; InputError when its numbers disagree, which does not name the file
FramePieces read_frame_pieces(const h5::Group& root);

/// Writes the index, on rank 0.
class FrameIndex {
 public:
  /// Begins an empty one, published with the first frame, or continues the one a checkpoint belongs to: frames after it are
  /// dropped, here and in pieces of ranks that are no more. The other pieces are for FramePiece::begin(), after this.
  /// @param rank_count   ranks that write now
  /// @param resume_time  simulated time of the checkpoint [s]. No file there counts as an empty one. Not set: an
  ///                     existing file is removed
  /// @throws InputError when the file to continue has no pieces, one of them is missing, or they do not fit the run
  /// @throws RunError when a file cannot be written
  FrameIndex(std::filesystem::path path, const Scene& scene, Precision precision, int rank_count,
             std::optional<double> resume_time = {});

  /// Adds a frame whose pieces are on disk, and publishes the index, unless that would take too much of the time. A frame
  /// at the time of the last one, and one without bodies, is left out.
  /// @param bodies  of each rank
  void append(double time, std::span<const std::int64_t> bodies);

  /// Publishes what is not published yet. @throws RunError naming the file and the reason
  void publish();

  std::int64_t frame_count() const { return std::ssize(pieces_.times); }

 private:
  void resume(double time, int rank_count, std::uint64_t body_capacity);
  void add(double time, std::span<const FramePieces::Part> parts);
  template <class Real>
  void write(h5::Group root) const;

  std::filesystem::path path_;
  FrameFormat format_;
  FramePieces pieces_;
  /// Of each part: the piece once its frame is in it.
  std::vector<FrameExtent> extents_;
  std::map<int, FrameExtent> filled_;  ///< pieces, by rank
  bool is_published_ = true;
  std::chrono::steady_clock::time_point published_at_;
  std::chrono::steady_clock::duration publishing_{};  ///< how long it took the last time
};

}  // namespace scree
