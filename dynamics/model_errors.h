#pragma once
// The engine's messages, kept out of its header: the formatting library does not
// compile under nvcc.

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene.h"
#include "host/world.h"

namespace scree {

/// A state that is not finite, or out of the range of kernels/bodies/range.h.
/// @throws RunError naming the body
[[noreturn]] void throw_bad_body(std::int64_t step, int body, const Vec3d& position,
                                 const Vec3d& velocity);
/// A load that is not finite or too large. @throws RunError naming the body
[[noreturn]] void throw_bad_load(std::int64_t step, int body);
/// A state written by a program that no body can have. @throws InputError naming the body
[[noreturn]] void throw_bad_written(int body, const Vec3d& position, const Quatd& orientation,
                                    const Vec3d& velocity, const Vec3d& angular_velocity);
/// @throws InputError listing the names
[[noreturn]] void throw_unknown_array(const std::string& name, const std::vector<ArrayInfo>& known);
/// @throws RunError naming the quantity
[[noreturn]] void throw_not_finite(std::int64_t step, const char* quantity, double value);
/// @throws RunError naming the two bodies
[[noreturn]] void throw_bad_contact(std::int64_t step, int body_a, int body_b);
/// A state of another model. @throws InputError
[[noreturn]] void throw_wrong_model(const std::string& found, const std::string& expected);
/// @throws InputError
[[noreturn]] void throw_wrong_insertions(std::uint64_t found, std::size_t in_scene);
/// @throws InputError
[[noreturn]] void throw_wrong_body_count(std::size_t found, std::size_t expected);
/// @throws InputError
[[noreturn]] void throw_bad_earlier_step();
[[noreturn]] void throw_bad_near_list();
[[noreturn]] void throw_bad_led_part();
/// More bodies on a rank than it has room for. @throws RunError
[[noreturn]] void throw_no_room_for_bodies(std::int64_t wanted, std::int64_t room);
/// More ranks near one than it can know. @throws RunError
[[noreturn]] void throw_too_many_peers(std::size_t found);
/// @throws InputError
[[noreturn]] void throw_unknown_body(int id);
/// A contact of a checkpoint that is none of bodies of the scene. @throws InputError
[[noreturn]] void throw_unknown_contact(std::size_t contact, int body_a, int body_b,
                                        std::uint64_t feature);
/// Vectors of impulses in a checkpoint. @throws InputError
void require_impulses(std::size_t found, std::size_t expected);
/// Rows of arrays of contacts in a checkpoint. @throws InputError
void require_contact_rows(std::initializer_list<std::size_t> found, std::size_t expected);
/// Keys of a checkpoint of version 1 name owned bodies. @throws InputError
void require_places(const std::vector<std::uint64_t>& keys, std::int64_t owned_count);

/// Checks that remembered impulses, two vectors a joint, are those of a scene. @throws InputError
void require_joints(std::size_t found, std::size_t in_scene);
/// Checks the numbers of positions and of marks of broken joints. @throws InputError
void require_joint_states(std::size_t positions, std::size_t broken, std::size_t in_scene);
/// @throws InputError saying that a call needs track_forces()
[[noreturn]] void throw_untracked_forces(const char* call);
/// Gravity that no run can have. @throws InputError
void require_gravity(const Vec3d& gravity, double time_step);
/// That of a checkpoint. @throws InputError
Vec3d saved_gravity(const WorldState& s, double time_step);
/// A velocity that a program gives a body. @throws InputError
void require_velocity(int body, const Vec3d& velocity, const Vec3d& angular_velocity,
                      double time_step);
/// @throws InputError when a force or torque that a program applies is not finite
void require_load(int body, const Vec3d& force, const Vec3d& torque);
/// Forces are told of fixed and kinematic bodies. @throws InputError
[[noreturn]] void throw_no_force(int body);

}  // namespace scree
