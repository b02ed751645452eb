#pragma once
// surfaces.vtkhdf: the surfaces of all free bodies at the times of the frames, as ParaView shows them without a recipe
// (transient VTKHDF, PolyData).
//
// Corners are stored for each frame, in float, with the speed of their body [m/s] as point data. Faces, and the cell
// data id and group, are stored once, for all bodies of the scene; a frame uses those of the bodies that had been
// inserted by then. Round shapes are polyhedra of some hundred faces whose corners lie on them; compounds are their
// parts. Walls are in walls.vtkhdf. The file is a TwinFile: complete at every moment. Bodies are written block by
// block, so memory does not grow with their number.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>

#include "host/io/twin_file.h"
#include "host/world.h"

namespace scree {

/// How much there is of some bodies.
struct SurfaceSize {
  std::uint64_t bodies = 0;  ///< those that have surfaces here
  std::uint64_t corners = 0;
  std::uint64_t faces = 0;
  std::uint64_t face_corners = 0;

  /// Of a frame that holds them [bytes]: corners and speed.
  double frame_bytes() const { return 16.0 * static_cast<double>(corners); }
};

/// Of all free bodies that the scene ever has.
SurfaceSize surface_size(const Scene& scene);

/// Corners that a frame may have.
inline constexpr std::uint64_t kMostSurfaceCorners = 2'000'000'000;

/// @throws InputError when a frame would have more than kMostSurfaceCorners
void require_surface_size(const SurfaceSize& size);

/// How much of the file is filled. A part is a list of cells; frames with as many bodies share one.
struct SurfaceExtent {
  std::int64_t frames = 0;
  std::uint64_t points = 0;  ///< of all frames
  std::int64_t parts = 0;
  std::uint64_t cells = 0;  ///< of all parts
  SurfaceSize last;         ///< of the bodies of the last frame
};

class ShapeSurfaces;

class SurfaceFrameWriter {
 public:
  /// Starts a new file, published with the first frame, or continues the one a checkpoint belongs
  /// to. A scene without free bodies gets no file.
  /// @param resume_time  simulated time of the checkpoint [s]: frames after it are dropped. No file
  ///                     there counts as an empty one. Not set: an existing file is removed
  /// @throws InputError when the file to continue is unreadable or of other bodies, or frames would
  ///         be too large
  /// @throws RunError when the file cannot be written
  SurfaceFrameWriter(std::filesystem::path path, const Scene& scene,
                     std::optional<double> resume_time = {});
  ~SurfaceFrameWriter();

  /// Adds a frame and publishes it, unless it may wait. One at the time of the last frame is not written again, and one
  /// without free bodies is left out.
  /// @param time    simulated time [s], not before the last frame
  /// @param states  bodies inserted so far, by id; never fewer than before
  /// @throws RunError naming the file and the reason; the file keeps the earlier frames
  void append(double time, const BodyStates& states);

  /// From now on frames may wait for each other until they are published, see TwinFile.
  void publish_seldom() {
    if (file_) file_->publish_seldom();
  }
  /// Publishes the frames that wait. @throws RunError as append()
  void publish() {
    if (file_) file_->publish();
  }

  std::int64_t frame_count() const { return extent_.frames; }

 private:
  void start();
  void resume(double time);
  void write_faces(h5::Group& vtk);
  void write_part(h5::Group& vtk, const SurfaceSize& size, std::size_t end);
  void write_frame(h5::Group vtk, const SurfaceExtent& after, double time,
                   const BodyStates& states);

  std::unique_ptr<ShapeSurfaces> surfaces_;
  SurfaceSize whole_;               ///< of the scene
  std::unique_ptr<TwinFile> file_;  ///< none without free bodies
  SurfaceExtent extent_;
  std::size_t last_states_ = 0;  ///< bodies, of all kinds, that `extent_.last` was counted for
  std::optional<double> last_time_;
};

}  // namespace scree
