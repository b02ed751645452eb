#pragma once
// Where the stored contact problem of a step comes from.

#include <cstdint>
#include <string>
#include <type_traits>

#include "host/problems/body_problem.h"
#include "host/scene.h"
#include "host/version.h"

namespace scree {

/// @param step       its number  @param time  at its start [s]
/// @param reference  speed that residuals are relative to [m/s]
template <class B, class Real>
ProblemSource problem_source(const Scene& scene, std::int64_t step, double time, double reference) {
  ProblemSource s;
  s.scene = scene.name;
  s.program = std::string("scree ") + version() + " (" + commit() + ")";
  s.backend = B::kName;
  s.precision = std::is_same_v<Real, double> ? "double" : "float";
  s.step = step;
  s.time = time;
  s.time_step = scene.stepping.time_step;
  s.reference_speed = reference;
  return s;
}

}  // namespace scree
