#pragma once
// What ends a run of the variational model: messages, kept out of its header, since the formatting library does not
// compile under nvcc.

#include <cstdint>

#include "host/scene.h"

namespace scree {

/// @throws InputError naming the body
[[noreturn]] void throw_overlap(int body, const Vec3d& position, double depth);
/// A body came to rest. @param speed  at which contacts are handed over [m/s]  @throws RunError naming the body
[[noreturn]] void throw_resting(std::int64_t step, int body, double speed);
/// A body touches, and neither approaches nor leaves. @throws RunError naming the body
[[noreturn]] void throw_stuck(std::int64_t step, int body);
/// A body has too many impacts in a step. @throws RunError naming the body
[[noreturn]] void throw_crowded(std::int64_t step, int body, double most);
/// A body turns farther in a step than is solved. @throws RunError naming the body
/// @param turn, most  what it turns, and what it may [rad]
[[noreturn]] void throw_spinning(std::int64_t step, int body, double turn, double most);
/// Bodies go too far in a step. @throws RunError
[[noreturn]] void throw_step_too_long(std::int64_t step, double time_step, const Vec3d& period);

/// Overlaps at the start, over the radius, that are rounding of the scene.
inline constexpr double kMostOverlap = 1e-9;

}  // namespace scree
