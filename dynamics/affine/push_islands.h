#pragma once
// Bodies that a push may reach: those that are near each other, and so on, and those that joints hold together.

#include <functional>
#include <vector>

#include "dynamics/affine/affine_setup.h"

namespace scree::affine {

/// Sets of bodies that pass a push on to each other.
struct PushIslands {
  std::vector<Index> island;  ///< by body: the lowest body of its set, -1 of what no push reaches
  std::vector<bool>
      is_held;  ///< by that body: something that passes nothing on touches or holds one of the set
};

/// @param near  pairs of bodies that may touch. @param begins  which bodies are pushed
/// @param passes  which pass a push on; others are not reached. Fixed bodies never pass one on
PushIslands reached_by_push(const AffineSetup& setup, const std::vector<BodyPair>& near,
                            const std::function<bool(std::size_t body)>& begins,
                            const std::function<bool(std::size_t body)>& passes);

/// Bodies that prescribed ones may push.
std::vector<bool> bodies_near_led(const AffineSetup& setup, const std::vector<BodyPair>& near);

/// Bodies that share the momentum of an impact. @param is_hit  by row, those that were hit
PushIslands islands_of_hit(const AffineSetup& setup, const std::vector<BodyPair>& near,
                           const std::vector<Index>& is_hit);

/// By row, what bodies of a set that nothing else touches or holds go faster by, so that together they get some momentum [m/s].
/// @param momentum  by row [kg m/s]
std::vector<Vec3d> shared_velocities(const AffineSetup& setup, const PushIslands& pushed,
                                     const std::vector<Vec3d>& momentum);

}  // namespace scree::affine
