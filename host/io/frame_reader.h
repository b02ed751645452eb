#pragma once
// Reads frames.vtkhdf (host/io/frames.h) back.

#include <filesystem>
#include <vector>

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

 private:
  std::size_t bodies_ = 0;
  std::vector<double> times_;
  std::vector<double> position_, orientation_, velocity_, angular_velocity_;
};

}  // namespace scree
