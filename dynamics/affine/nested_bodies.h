#pragma once
// Bodies that start inside of others without crossing their surfaces.

#include <string>
#include <vector>

#include "dynamics/affine/affine_setup.h"

namespace scree::affine {

/// A body inside of another, or behind a wall, at time zero: ids.
struct Nested {
  int inner = -1, outer = -1;
};

/// Those of which one is elastic. Of stiff bodies the overlaps of the same scene with rigid ones tell.
std::vector<Nested> nested_with_elastic(const AffineSetup& setup);

/// One line for a user. @param nested  one or more
std::string nested_warning(const std::vector<Nested>& nested, const BodyNames& name);

}  // namespace scree::affine
