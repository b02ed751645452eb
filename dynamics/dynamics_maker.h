#pragma once
// Makes the dynamics that a scene names. What names there are is in lists that CMake writes.

#include <span>
#include <stdexcept>

#include "dynamics/dynamics.h"

namespace scree {

/// Makes a model in a precision; it makes its own backend from the options.
using MakeModel = std::unique_ptr<Dynamics> (*)(Scene, const WorldOptions&);

struct DynamicsMaker {
  const char* name;
  MakeModel in_float;
  MakeModel in_double;
};

inline std::unique_ptr<Dynamics> make_one_of(std::span<const DynamicsMaker> makers, Scene scene,
                                             const WorldOptions& options) {
  for (const DynamicsMaker& maker : makers) {
    if (scene.dynamics.type != maker.name) continue;
    const bool in_double = options.precision == Precision::double_precision;
    return (in_double ? maker.in_double : maker.in_float)(std::move(scene), options);
  }
  throw std::logic_error("no maker of dynamics " + scene.dynamics.type);
}

}  // namespace scree
