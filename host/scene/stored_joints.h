#pragma once
// Which joints files of contact problems hold.

#include <string>

#include "host/scene.h"

namespace scree {

/// Files hold rows that take any impulse, as those of joints that hold bodies. A row that is driven
/// has a law of its own, for which there is no place in them.
/// @param where  begins the message
/// @throws InputError naming the joint, what drives it and what is expected
void require_storable_joints(const std::string& where, const Scene& scene);

}  // namespace scree
