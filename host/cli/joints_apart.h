#pragma once
// Joints that did not hold in a run.

#include <string>
#include <vector>

#include "host/body_constants.h"
#include "host/io/run_record.h"

namespace scree {

/// What a user is told of them, a sentence; empty when all held.
std::string joints_apart(const RunTotals& totals, const std::vector<Joint>& joints,
                         const BodyConstants& bodies);

}  // namespace scree
