#pragma once
// A capsule and a solid box: the axis of the capsule as a rounded core.

#include "kernels/narrow_phase/pairs/convex_manifold.h"

namespace scree {

struct CapsuleBox : ConvexPair<shapes::Capsule, shapes::Box> {};

}  // namespace scree
