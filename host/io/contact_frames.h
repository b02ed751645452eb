#pragma once
// contacts.vtkhdf: the contacts at the times of the frames, as ParaView reads them (transient VTKHDF,
// PolyData).
//
// One point per contact: where it acts, in double. Point data: normal (unit, from body_a to body_b), force (on body_b, mean
// of the step) [N], force_magnitude [N], gap at the start of the step [m] in the precision of the run, body_a and body_b
// (ids). A frame without contacts is left out. The file is a TwinFile: complete at every moment.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "host/io/twin_file.h"
#include "host/world.h"

namespace scree {

/// How much of the file is filled; a frame is a part.
struct ContactExtent {
  std::int64_t frames = 0;
  std::uint64_t points = 0;  ///< of all frames
  std::uint64_t most = 0;    ///< contacts of a frame
};

class ContactFrameWriter {
 public:
  /// Starts a new file, published with the first frame, or continues the one a checkpoint belongs
  /// to.
  /// @param time_step    [s]
  /// @param precision    of the run
  /// @param resume_time  simulated time of the checkpoint [s]: frames after it are dropped. No file
  ///                     there counts as an empty one. Not set: an existing file is removed
  /// @throws InputError when the file to continue is unreadable or of another precision
  /// @throws RunError when the file cannot be written
  ContactFrameWriter(std::filesystem::path path, double time_step, Precision precision,
                     std::optional<double> resume_time = {});

  /// Adds a frame and publishes it, unless it may wait. One at the time of the last frame is not written again.
  /// @param time      simulated time [s], not before the last frame
  /// @param contacts  of the step that ended then
  /// @throws RunError naming the file and the reason; the file keeps the earlier frames
  void append(double time, const std::vector<ContactRecord>& contacts);

  /// From now on frames may wait for each other until they are published, see TwinFile.
  void publish_seldom() { file_.publish_seldom(); }
  /// Publishes the frames that wait. @throws RunError as append()
  void publish() { file_.publish(); }

  std::int64_t frame_count() const { return extent_.frames; }

 private:
  void start();
  void resume(double time);
  Filled filled() const;
  template <class Real>
  void write_frame(h5::Group vtk, double time, const std::vector<ContactRecord>& contacts) const;

  TwinFile file_;
  double time_step_;
  Precision precision_;
  ContactExtent extent_;
  std::optional<double> last_time_;
};

}  // namespace scree
