#pragma once

namespace scree {

/// Version of the library, "major.minor.patch".
const char* version();

/// Short git hash of the sources at build time, or "unknown" outside a git checkout.
const char* commit();

}  // namespace scree
