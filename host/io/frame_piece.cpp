#include "host/io/frame_piece.h"

#include <limits>
#include <stdexcept>
#include <utility>

namespace scree {
namespace {

/// Rows of the bodies with ids below an end, by id.
BodyStates states_below(const OwnBodies& bodies, std::size_t end) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  BodyStates kept;
  kept.position.resize(end, Vec3d{kNone, kNone, kNone});
  const bool turns = !bodies.states.orientation.empty();  // models may have none
  const bool gives_way = !bodies.states.axes.empty();
  if (gives_way) kept.axes.resize(end);
  if (turns) kept.orientation.resize(end, Quatd{kNone, kNone, kNone, kNone});
  for (std::size_t i = 0; i < bodies.id.size(); ++i) {
    const auto id = static_cast<std::size_t>(bodies.id[i]);
    if (id >= end) break;  // ids rise
    kept.position[id] = bodies.states.position[i];
    if (turns) kept.orientation[id] = bodies.states.orientation[i];
    if (gives_way) kept.axes[id] = bodies.states.axes[i];
  }
  return kept;
}

}  // namespace

FramePiece::FramePiece(std::filesystem::path path, const Scene& scene, Precision precision,
                       std::size_t kept_end)
    : path_(std::move(path)),
      fields_(dynamics_card(scene.dynamics.type).frame),
      precision_(precision),
      kept_end_(kept_end) {}

void FramePiece::begin(const BodyConstants& constants, std::optional<double> resumed_time) {
  writer_.emplace(path_, fields_, precision_, constants.size(), resumed_time);
}

void FramePiece::take(double time, const OwnBodies& bodies, const BodyConstants& constants) {
  if (!writer_) throw std::logic_error("FramePiece::begin() comes first");
  kept_ = states_below(bodies, kept_end_);
  writer_->append(time, bodies, constants);
}

}  // namespace scree
