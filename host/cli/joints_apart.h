#pragma once
// Joints that did not hold in a run.

#include <string>
#include <vector>

#include "host/body_constants.h"
#include "host/io/run_record.h"

namespace scree {

/// Whether joints are farther off than any that hold: a few hundredths of the smallest body.
/// @param error  of joints [m]
bool are_joints_apart(double error, const BodyConstants& bodies);

/// Whether a step left a joint with a residual that says that it is contradicted: above v* where there is one, and such that
/// it takes the joint apart by more than a millionth of the smallest body a step.
bool are_joints_contradicted(const StepReport& report, double time_step,
                             const BodyConstants& bodies);

/// "joints[2] (hinge) of A and B".
std::string joint_with_number(int number, const std::vector<Joint>& joints,
                              const BodyConstants& bodies);

/// What a user is told of joints that were off, a sentence; empty when all held.
std::string joints_apart(const RunTotals& totals, const std::vector<Joint>& joints,
                         const BodyConstants& bodies);

}  // namespace scree
