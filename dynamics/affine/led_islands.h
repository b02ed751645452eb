#pragma once
// Bodies that prescribed ones may push: those that are near one, or near one that is, and so on, and those that joints hold to them.

#include <vector>

#include "dynamics/affine/affine_setup.h"

namespace scree::affine {

/// @param near  pairs of bodies that may touch
/// @return  by body, whether a led one may push it; fixed bodies pass nothing on
std::vector<bool> bodies_near_led(const AffineSetup& setup, const std::vector<BodyPair>& near);

}  // namespace scree::affine
