#pragma once
// Reads frames.vtkhdf (host/io/frames.h) back, also where ranks wrote pieces (host/io/frame_index.h).

#include <array>
#include <cstddef>
#include <filesystem>
#include <vector>

#include "host/io/h5.h"
#include "host/world.h"

namespace scree {

/// The frames of a run whose bodies are all there from the start. Holds the file in memory.
class FrameReader {
 public:
  /// @throws InputError naming the file and what is wrong with it
  explicit FrameReader(const std::filesystem::path& path);

  const std::vector<double>& times() const { return times_; }  ///< of all frames [s]
  std::size_t body_count() const { return bodies_; }
  /// Positions, orientations and velocities of all bodies, by id.
  BodyStates states(std::size_t frame) const;

  /// Positions, orientations, velocities and angular velocities, frame by frame, body by body.
  using Arrays = std::array<std::vector<double>, 4>;

 private:
  void read_one(const h5::Group& vtk);
  void read_pieces(const h5::Group& root, const std::filesystem::path& path);

  std::size_t bodies_ = 0;
  std::vector<double> times_;
  Arrays arrays_;
};

}  // namespace scree
