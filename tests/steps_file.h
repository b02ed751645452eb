#pragma once
// steps.csv of runs of rigid bodies.

#include "dynamics/dynamics_card.h"
#include "host/io/steps_csv.h"

namespace scree {

inline std::vector<StepReport> read_steps_csv(const std::filesystem::path& path) {
  return read_steps_csv(path, dynamics_card("rigid").report);
}

}  // namespace scree
