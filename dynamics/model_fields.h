#pragma once
// Columns and arrays that several models of dynamics have, and lists made of them.

#include <array>
#include <cstddef>

#include "dynamics/dynamics_card.h"

namespace scree {

/// The elements of one list after those of another.
template <class T, std::size_t M, std::size_t N>
constexpr std::array<T, M + N> followed_by(const std::array<T, M>& first,
                                           const std::array<T, N>& second) {
  std::array<T, M + N> all{};
  for (std::size_t k = 0; k < M; ++k) all[k] = first[k];
  for (std::size_t k = 0; k < N; ++k) all[M + k] = second[k];
  return all;
}

/// Positions [m] and speeds [m/s, rad/s] of runs are far below this, and those far above it are no
/// place where contacts could be found in float.
inline constexpr double kLargestOfState = 1e15;

/// The bodies that a model owns.
inline constexpr std::array kBodyState{
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
               .largest = kLargestOfState}};
/// Gravity that a program set.
inline constexpr std::array kGravityState{StateField{.name = "world/gravity",
                                                     .type = StateField::Type::vector,
                                                     .may_be_absent = true,
                                                     .largest = kLargestOfState}};

/// The first columns of steps.csv.
inline constexpr std::array kStepColumns{ReportColumn{"step", &StepReport::step},
                                         ReportColumn{"time_s", &StepReport::time},
                                         ReportColumn{"bodies", &StepReport::body_count}};
/// Momentum and angular momentum, from a place in StepReport::own on.
constexpr std::array<ReportColumn, 6> momentum_columns(std::size_t first) {
  return {ReportColumn{"momentum_x_kg_m_per_s", Own{first}},
          ReportColumn{"momentum_y_kg_m_per_s", Own{first + 1}},
          ReportColumn{"momentum_z_kg_m_per_s", Own{first + 2}},
          ReportColumn{"angular_momentum_x_kg_m2_per_s", Own{first + 3}},
          ReportColumn{"angular_momentum_y_kg_m2_per_s", Own{first + 4}},
          ReportColumn{"angular_momentum_z_kg_m2_per_s", Own{first + 5}}};
}

}  // namespace scree
