#pragma once
// Constants that all free bodies of a run have in common.

#include <cstdint>
#include <optional>

#include "host/scene.h"

namespace scree {

/// A value for each constant in which no two free bodies differ, insertions included; such
/// constants take no memory per body on the backend.
struct SharedConstants {
  std::optional<double> radius;  ///< of spheres [m]
  std::optional<double> mass;    ///< [kg]
  std::optional<std::uint8_t> locks;
  std::optional<int> material;
  std::optional<int> group;
  bool spheres = true;  ///< all free bodies are spheres
};

SharedConstants shared_constants(const Scene& scene);

}  // namespace scree
