#pragma once
// Tests that take longer than CI has time for.

#include <cstdlib>

namespace scree::physics {

/// They run where SCREE_LONG_TESTS is set, and are told as skipped elsewhere.
inline bool runs_long_tests() { return std::getenv("SCREE_LONG_TESTS") != nullptr; }
inline constexpr const char* kLongTest = "takes long: set SCREE_LONG_TESTS to run it";

}  // namespace scree::physics
