#pragma once
// frames_N.vtkhdf: what rank N writes of the frames that host/io/frame_index.h brings together.

#include <cstddef>
#include <filesystem>
#include <optional>

#include "host/io/frames.h"
#include "host/own_bodies.h"

namespace scree {

class FramePiece final : public OwnBodiesSink {
 public:
  /// @param kept_end  states of bodies with ids below are kept for kept_states()
  FramePiece(std::filesystem::path path, const Scene& scene, Precision precision,
             std::size_t kept_end = 0);

  /// As the constructor of FrameWriter.
  void begin(const BodyConstants& constants, std::optional<double> resumed_time) override;
  /// The frame is on disk when it returns. One without bodies is left out. @throws RunError
  void take(double time, const OwnBodies& bodies, const BodyConstants& constants) override;

  /// Positions and orientations by id, of the last frame; not a number of bodies that it did not have.
  const BodyStates& kept_states() const { return kept_; }

 private:
  std::filesystem::path path_;
  std::span<const FrameField> fields_;
  Precision precision_;
  std::size_t kept_end_;
  BodyStates kept_;
  std::optional<FrameWriter> writer_;
};

}  // namespace scree
