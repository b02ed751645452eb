#pragma once
// Whether bodies fit the memory of a backend.

#include "host/world.h"

namespace scree {

/// As require_memory(), for so many bodies of so many bytes, which ranks divide.
void require_memory_for(double bodies, double bytes_per_body, const WorldOptions& options);

/// Memory of a body of the scene at the fullest, without what only makes steps faster [bytes].
double least_bytes_per_body(const Scene& scene, const WorldOptions& options);

}  // namespace scree
