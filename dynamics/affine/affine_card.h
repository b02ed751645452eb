#pragma once
// What the model of affine bodies says of itself.

#include <array>

#include "dynamics/rigid/rigid_card.h"

namespace scree {

inline constexpr std::array kStepRules{"implicit_euler", "bdf2", "rotational"};
inline constexpr SolverParameter kStepRule{
    .key = "rule",
    .description =
        "how a step advances: implicit_euler damps, most of all turning; bdf2 is of second order; "
        "rotational is implicit_euler that keeps the spin of free bodies.",
    .standard = 1,
    .choices = kStepRules};
inline constexpr SolverParameter kAffineStiffness{
    .key = "stiffness",
    .description =
        "how stiff bodies are: a body of volume v resists with this times v times the "
        "square of A^T A - I [Pa].",
    .standard = 1e8,
    .low = 0,
    .high = 1e18};
inline constexpr SolverParameter kReach{
    .key = "reach",
    .description =
        "distance up to which bodies push each other away [m]; "
        "0: 0.001 of the diagonal of the "
        "box about all bodies, but no more than a hundredth of that of the smallest free body; "
        "or the least gap at the start where that is less, but at least a hundredth of it.",
    .standard = 0,
    .low = 0,
    .high = 1e6,
    .is_low_allowed = true};
inline constexpr SolverParameter kSeparation{
    .key = "separation",
    .description = "distance that bodies never come near [m].",
    .standard = 0,
    .low = 0,
    .high = 1e6,
    .is_low_allowed = true};
inline constexpr SolverParameter kSlipSpeed{
    .key = "slip_speed",
    .description = "speed below which contacts stick, nearly [m/s].",
    .standard = 1e-3,
    .low = 0,
    .high = 1e6};
inline constexpr SolverParameter kFrictionSolves{
    .key = "friction_solves",
    .description =
        "most minimizations a step, each with the friction of the one before [-]; those after the "
        "first only where contacts slide; 0: until it does not change.",
    .standard = 2,
    .low = 0,
    .high = 1e3,
    .is_low_allowed = true,
    .is_whole = true};
inline constexpr SolverParameter kNewtonTolerance{
    .key = "tolerance",
    .description =
        "a step is done when Newton's method moves no corner faster than this [m/s]; 0: "
        "0.001 of the diagonal of the largest body that moves, a second, or a hundredth of what "
        "gravity "
        "changes a velocity by in a step, or a hundredth of the reach in a step, where that is "
        "less.",
    .standard = 0,
    .low = 0,
    .high = 1e6,
    .is_low_allowed = true};
inline constexpr SolverParameter kNewtonIterations{
    .key = "max_iterations",
    .description = "most iterations of a minimization [-].",
    .standard = 200,
    .low = 0,
    .high = 1e6,
    .is_whole = true};
inline constexpr SolverParameter kBarrierStiffness{
    .key = "barrier_stiffness",
    .description = "factor of the barrier [J/m^4]; 0: about as stiff as bodies are inert.",
    .standard = 0,
    .low = 0,
    .high = 1e60,
    .is_low_allowed = true};
inline constexpr SolverParameter kMaxTurn{
    .key = "max_turn",
    .description =
        "a step in which a stiff body, or a kinematic one, would turn by more is made in equal "
        "parts, 1024 at most [rad]; 0: in one, however far free bodies turn.",
    .standard = 0,
    .low = 0,
    .high = 1e6,
    .is_low_allowed = true};
/// Most that a kinematic body may turn by in a step, or in each part of one [rad]: its way is straight in its coordinates, where a
/// half turn makes it flat.
inline constexpr double kMostLedTurn = 1;
inline constexpr std::array kAffineParameters{
    kStepRule,         kAffineStiffness, kReach,           kSeparation,
    kSlipSpeed,        kFrictionSolves,  kNewtonTolerance, kNewtonIterations,
    kBarrierStiffness, kMaxTurn};

/// Places in StepReport::own.
inline constexpr std::size_t kMinGapColumn = 0, kStrainColumn = 1, kBlockedColumn = 3,
                             kMomentumColumn = 4, kPartsColumn = 10;

inline constexpr std::array kMinimizerColumns{
    ReportColumn{"contacts", &StepReport::contact_count},
    ReportColumn{"iterations", &StepReport::iterations},
    ReportColumn{"linear_iterations", &StepReport::applications},
    ReportColumn{"converged", &StepReport::converged},
    ReportColumn{"residual_m_per_s", &StepReport::residual_max},
    ReportColumn{"min_gap_m", Own{kMinGapColumn}},
    ReportColumn{"max_strain", Own{kStrainColumn}},
    ReportColumn{"barrier_stiffness_J_per_m4", Own{2}},
    ReportColumn{"blocked_bodies", Own{kBlockedColumn}},
    ReportColumn{"parts", Own{kPartsColumn}},
    ReportColumn{"max_turn_rad", &StepReport::max_turn},
    ReportColumn{"kinetic_energy_J", &StepReport::kinetic_energy}};
inline constexpr std::array kMinimizerTimes{ReportColumn{"collision_ms", &StageTimes::collision},
                                            ReportColumn{"setup_ms", &StageTimes::setup},
                                            ReportColumn{"solve_ms", &StageTimes::solve},
                                            ReportColumn{"integrate_ms", &StageTimes::integrate},
                                            ReportColumn{"total_ms", &StageTimes::total}};
inline constexpr auto kAffineReport =
    followed_by(followed_by(kStepColumns, kMinimizerColumns),
                followed_by(momentum_columns(kMomentumColumn), kMinimizerTimes));

/// Place in BodyStates::own.
inline constexpr std::size_t kStrainField = 0;
/// |A^T A - I|, of elastic bodies the largest of their tetrahedra.
inline constexpr auto kAffineFrame =
    followed_by(kRigidFrame, std::array{FrameField{"strain", 1, Own{kStrainField}}});

inline constexpr std::array kAffineOwnState{
    // Four vectors a body: center of mass and columns of A, of free bodies and then of kinematic ones.
    StateField{
        .name = "affine/position", .type = StateField::Type::vector, .largest = kLargestOfState},
    StateField{.name = "affine/velocity",
               .type = StateField::Type::vector,
               .rows_of = "affine/position",
               .largest = kLargestOfState},
    // Before the last step, from the first one on.
    StateField{.name = "affine/earlier_position",
               .type = StateField::Type::vector,
               .rows_of = "affine/position",
               .may_be_empty = true,
               .largest = kLargestOfState},
    StateField{.name = "affine/earlier_velocity",
               .type = StateField::Type::vector,
               .rows_of = "affine/position",
               .may_be_empty = true,
               .largest = kLargestOfState},
    // How long that step took [s].
    StateField{.name = "affine/earlier_step",
               .type = StateField::Type::number,
               .may_be_empty = true,
               .largest = kLargestOfState},
    // Angle or way of each driven joint where the last step began.
    StateField{.name = "affine/joint_position",
               .type = StateField::Type::number,
               .may_be_empty = true,
               .largest = kLargestOfState},
    // Time of the motion of each kinematic body.
    StateField{.name = "affine/led_time",
               .type = StateField::Type::number,
               .may_be_empty = true,
               .largest = kLargestOfState}};
inline constexpr auto kAffineState =
    followed_by(kBodyState, followed_by(kAffineOwnState, kGravityState));

/// @throws InputError naming what of the scene the model does not have
void check_affine(const Scene& scene);
double affine_bytes_per_body(const Scene& scene, const WorldOptions& options);

constexpr DynamicsCard affine_card() {
  return {.name = "affine",
          .description =
              "stiff affine bodies and elastic ones with barrier contact and friction, which never "
              "intersect",
          .parameters = kAffineParameters,
          .iteration_cap = &kNewtonIterations,
          .has_joints = true,
          .meshes_may_be_free = true,
          .bodies_may_be_elastic = true,
          .has_collision_groups = true,
          .has_loads = true,
          .report = kAffineReport,
          .frame = kAffineFrame,
          .state = kAffineState,
          .check = check_affine,
          .bytes_per_body = affine_bytes_per_body};
}

}  // namespace scree
