#pragma once
// What the variational model says of itself.

#include <array>

#include "dynamics/rigid/rigid_card.h"

namespace scree {

inline constexpr SolverParameter kMostImpacts{
    .key = "max_impacts",
    .description = "most impacts of one body in a step; more end the run [-].",
    .standard = 100,
    .low = 0,
    .high = 1e9,
    .is_whole = true};
inline constexpr std::array kVariationalParameters{kMostImpacts};

/// Place of the energy in StepReport::own.
inline constexpr std::size_t kEnergyColumn = 4;

inline constexpr std::array kImpactColumns{
    ReportColumn{"impacts", Own{0}},
    ReportColumn{"grazing_impacts", Own{1}},
    ReportColumn{"rounds", Own{2}},
    ReportColumn{"bodies_in_islands", Own{3}},
    ReportColumn{"max_penetration_m", &StepReport::max_penetration},
    ReportColumn{"kinetic_energy_J", &StepReport::kinetic_energy},
    ReportColumn{"energy_J", Own{kEnergyColumn}}};
inline constexpr std::array kFlightTimes{ReportColumn{"identity_error_m", Own{11}},
                                         ReportColumn{"collision_ms", &StageTimes::collision},
                                         ReportColumn{"solve_ms", &StageTimes::solve},
                                         ReportColumn{"integrate_ms", &StageTimes::integrate},
                                         ReportColumn{"total_ms", &StageTimes::total}};
inline constexpr auto kVariationalReport =
    followed_by(followed_by(kStepColumns, kImpactColumns),
                followed_by(momentum_columns(kEnergyColumn + 1), kFlightTimes));
inline constexpr auto kVariationalState = followed_by(kBodyState, kGravityState);

/// Whether free bodies have other shapes than spheres: then all of them turn as they fly.
bool has_convex_bodies(const Scene& scene);
/// @throws InputError for gravity along a periodic axis, where energy would differ from period to period
void require_gravity_of_periods(const Periodicity& periodicity, const Vec3d& gravity);
/// @throws InputError naming what of the scene the model does not have
void check_variational(const Scene& scene);
double variational_bytes_per_body(const Scene& scene, const WorldOptions& options);

constexpr DynamicsCard variational_card() {
  return {.name = "variational",
          .description =
              "bodies of any shape that bounce without friction, by a variational collision "
              "integrator",
          .parameters = kVariationalParameters,
          .report = kVariationalReport,
          .frame = kRigidFrame,
          .state = kVariationalState,
          .check = check_variational,
          .bytes_per_body = variational_bytes_per_body};
}

}  // namespace scree
