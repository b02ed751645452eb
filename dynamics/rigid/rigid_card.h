#pragma once
// What the model of rigid bodies says of itself.

#include <array>

#include "dynamics/dynamics_card.h"
#include "dynamics/rigid/rigid_memory.h"

namespace scree {

inline constexpr std::array kRigidReport{
    ReportColumn{"step", &StepReport::step},
    ReportColumn{"time_s", &StepReport::time},
    ReportColumn{"bodies", &StepReport::body_count},
    ReportColumn{"contacts", &StepReport::contact_count},
    ReportColumn{"iterations", &StepReport::iterations},
    ReportColumn{"applications", &StepReport::applications},
    ReportColumn{"converged", &StepReport::converged},
    ReportColumn{"residual_rms_m_per_s", &StepReport::residual_rms},
    ReportColumn{"residual_max_m_per_s", &StepReport::residual_max},
    ReportColumn{"residual_max_body_a", &StepReport::residual_max_body_a},
    ReportColumn{"residual_max_body_b", &StepReport::residual_max_body_b},
    ReportColumn{"residual_relative", &StepReport::residual_relative},
    ReportColumn{"exact_residual_rms_m_per_s", &StepReport::exact_residual_rms},
    ReportColumn{"objective_J", &StepReport::objective},
    ReportColumn{"max_penetration_m", &StepReport::max_penetration},
    ReportColumn{"max_joint_error_m", &StepReport::max_joint_error},
    ReportColumn{"max_cone_violation_N_s", &StepReport::max_cone_violation},
    ReportColumn{"kinetic_energy_J", &StepReport::kinetic_energy},
    ReportColumn{"collision_ms", &StageTimes::collision},
    ReportColumn{"setup_ms", &StageTimes::setup},
    ReportColumn{"solve_ms", &StageTimes::solve},
    ReportColumn{"integrate_ms", &StageTimes::integrate},
    ReportColumn{"total_ms", &StageTimes::total}};

inline constexpr std::array kRigidFrame{
    FrameField{"velocity", 3, &BodyStates::velocity},
    FrameField{"angular_velocity", 3, &BodyStates::angular_velocity},
    FrameField{"orientation", 4, &BodyStates::orientation},
    FrameField{.name = "speed", .columns = 1, .values = &BodyStates::velocity, .length = true}};

/// Positions [m] and speeds [m/s, rad/s] of runs are far below this, and those far above it are no
/// place where contacts could be found in float.
inline constexpr double kLargestOfState = 1e15;
inline constexpr double kLargestFloat = 3.4028234663852886e38;

inline constexpr std::array kRigidState{
    StateField{.name = "body/id", .type = StateField::Type::int32},
    StateField{.name = "body/position",
               .type = StateField::Type::vector,
               .rows_of = "body/id",
               .largest = kLargestOfState},
    StateField{.name = "body/orientation",
               .type = StateField::Type::quaternion,
               .rows_of = "body/id",
               .largest = 2},
    StateField{.name = "body/velocity",
               .type = StateField::Type::vector,
               .rows_of = "body/id",
               .largest = kLargestOfState},
    StateField{.name = "body/angular_velocity",
               .type = StateField::Type::vector,
               .rows_of = "body/id",
               .largest = kLargestOfState},
    // Names of contacts in places of storage, which is how they were saved at first.
    StateField{.name = "contact/key", .type = StateField::Type::uint64, .last_version = 1},
    StateField{.name = "contact/body_a", .type = StateField::Type::int32, .first_version = 2},
    StateField{.name = "contact/body_b",
               .type = StateField::Type::int32,
               .rows_of = "contact/body_a",
               .first_version = 2},
    StateField{.name = "contact/feature",
               .type = StateField::Type::uint64,
               .rows_of = "contact/body_a",
               .first_version = 2},
    StateField{.name = "contact/impulse",
               .type = StateField::Type::vector,
               .rows_of = "contact/body_a",
               .most_rows = 2,
               .largest = kLargestFloat,
               .first_version = 2},
    StateField{.name = "contact/impulse",
               .type = StateField::Type::vector,
               .rows_of = "contact/key",
               .most_rows = 2,
               .largest = kLargestFloat,
               .last_version = 1},
    StateField{.name = "contact/mark",
               .type = StateField::Type::int32,
               .rows_of = "contact/body_a",
               .may_be_empty = true,
               .first_version = 2},
    StateField{.name = "solver/memory", .type = StateField::Type::number, .largest = kLargestFloat},
    StateField{.name = "joint/impulse",
               .type = StateField::Type::vector,
               .may_be_absent = true,
               .largest = kLargestFloat,
               .first_version = 2},
    StateField{.name = "force/sum",
               .type = StateField::Type::vector,
               .may_be_absent = true,
               .largest = kLargestFloat,
               .first_version = 2},
    StateField{.name = "force/steps",
               .type = StateField::Type::number,
               .may_be_absent = true,
               .largest = 1e15,
               .first_version = 2},
    StateField{.name = "joint/position",
               .type = StateField::Type::number,
               .may_be_absent = true,
               .largest = kLargestOfState,
               .first_version = 2},
    StateField{.name = "joint/broken",
               .type = StateField::Type::int32,
               .may_be_absent = true,
               .first_version = 2}};

constexpr DynamicsCard rigid_card() {
  return {.name = "rigid",
          .description = "rigid bodies in hard contact with friction, one cone program a step",
          .has_contacts = true,
          .has_joints = true,
          .report = kRigidReport,
          .frame = kRigidFrame,
          .state = kRigidState,
          .bytes_per_body = rigid_bytes_per_body,
          .least_bytes_per_body = least_rigid_bytes_per_body};
}

}  // namespace scree
