#pragma once
// Where the points of a body are in a frame.

#include <cstddef>
#include <optional>

#include "host/world.h"
#include "kernels/affine/affine_state.h"
#include "kernels/math/quat.h"

namespace scree {

class BodyPoints {
 public:
  BodyPoints(const BodyStates& states, std::size_t id) : position_(states.position.at(id)) {
    if (!states.axes.empty()) {
      const auto& [a, b, c] = states.axes.at(id);
      affine_ = affine::AffineVec{{position_, a, b, c}};
    } else if (!states.orientation.empty()) {  // models may have none
      turn_ =
          normalized(states.orientation.at(id));  // those of float runs are unit to rounding only
    }
  }

  /// In the world. @param own  in the frame of the body [m]
  Vec3d operator()(const Vec3d& own) const {
    return affine_ ? point_of(*affine_, own) : position_ + rotate(turn_, own);
  }

 private:
  Vec3d position_;
  Quatd turn_;
  std::optional<affine::AffineVec> affine_;
};

}  // namespace scree
