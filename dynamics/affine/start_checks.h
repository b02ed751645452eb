#pragma once
// Whether the bodies of a scene of affine ones are apart at the start.

#include <string>

#include "dynamics/affine/affine_setup.h"
#include "kernels/affine/near_pair.h"

namespace scree::affine {

/// Looks at all bodies that may touch, where they are at time zero. @throws InputError naming two that intersect, and a triangle of each
void require_no_crossing(const AffineSetup& setup, const BodyNames& name);

/// What is nearer than this touches, but for rounding [m]: 1e-12 of the size of the scene, or of its largest coordinate. That is some
/// thousand times what a place is rounded by, and far below any gap that somebody gave.
double touching_gap(const AffineSetup& setup);

/// A scene that starts with bodies that touch. @param near  of their features  @throws InputError naming the bodies and a triangle of each
[[noreturn]] void throw_touching(const AffineSetup& setup, const NearPair& near,
                                 const BodyPair& bodies, double separation, const BodyNames& name);

/// Of two bodies that the barrier acts on at the start. @param speed  that it may give a body [m/s]
std::string throw_warning(const std::string& first, const std::string& second, double gap,
                          double reach, double speed);

}  // namespace scree::affine
