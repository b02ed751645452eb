#pragma once
// The contact problem of one step with its bodies, in host memory and in double: all that
// kernels/contact/contact_problem.h needs, the guess, and where it comes from.

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene.h"
#include "kernels/contact/contact_problem.h"

namespace scree {

/// Where a problem comes from.
struct ProblemSource {
  std::string scene;           ///< name of the scene
  std::string program;         ///< that wrote it, with its version
  std::string backend;         ///< cpu or cuda
  std::string precision;       ///< float or double: to what the numbers are rounded
  std::int64_t step = 0;       ///< number of the step, from 1
  double time = 0;             ///< at the start of the step [s]
  double time_step = 0;        ///< h [s]
  double reference_speed = 0;  ///< v* that residuals are divided by [m/s]; 0: none
  friend bool operator==(const ProblemSource&, const ProblemSource&) = default;
};

/// A row that bodies are held in, of a joint. With a unit impulse the force on B is `force`, at the end
/// of arm_b, and the moment on it `moment`; A gets the opposite of both at the end of arm_a.
///
///   0 = force . (v_B + w_B x arm_b - v_A - w_A x arm_a) + moment . (w_B - w_A) + bias
struct BilateralRow {
  std::int32_t body_a = 0;  ///< free
  std::int32_t body_b = 0;  ///< free or fixed, larger
  Vec3d arm_a;              ///< center of A to where the force acts [m]
  Vec3d arm_b;              ///< the same of B
  Vec3d force;              ///< a unit vector, or zero
  Vec3d moment;             ///< a vector [m], or zero
  double bias = 0;          ///< [m/s]
  double impulse = 0;       ///< the guess [N s]
  friend bool operator==(const BilateralRow&, const BilateralRow&) = default;
};

/// Store: fields in host memory.
struct InVectors {
  using Real = double;
  template <class T>
  using Array = std::vector<T>;
  using Bias = std::vector<double>;
  using Varying = std::vector<double>;
};

/// The fields of contacts, sorted by body_a, and bodies. Fields that the layout does not have are
/// empty, and drift where no body needs it; lever arms are in m, whatever the layout.
///
/// Bodies [0, free_count) move, the others keep their velocity. In the radial layout the angular
/// part of a rate is the surface speed r w [m/s], in the others it is w [rad/s]; world frame.
struct BodyProblem : ProblemFields<InVectors> {
  ContactLayout layout = ContactLayout::radial;
  ProblemSource source;

  // bodies [body_count]
  int free_count = 0;
  std::vector<std::int32_t> body_id;                    ///< index in the scene
  std::vector<Twist<double>> free_velocity;             ///< v* = v + h M^-1 f_ext
  std::vector<RadialInertia<double>> radial_inertia;    ///< radial layout, else empty
  std::vector<GeneralInertia<double>> general_inertia;  ///< other layouts, else empty

  std::vector<BilateralRow> bilateral;

  /// The guess [vectors_per_contact * contact_count], world frame, acting on B [N s].
  std::vector<Vec3d> impulse;

  int body_count() const { return static_cast<int>(free_velocity.size()); }
  int contact_count() const { return static_cast<int>(body_a.size()); }
};

/// The fields of contacts that a stored problem of a layout has; beside them it may have those that
/// are optional.
constexpr ContactParts stored_parts(ContactLayout layout) {
  ContactParts parts(layout);
  parts.bias = parts.friction = parts.adhesion = true;
  return parts;
}

/// Checks sizes, indices, signs, order and that all numbers are finite.
/// @throws InputError naming the array, the place, the value and what was expected
void validate(const BodyProblem& problem);

/// "radial", "general" or "rolling": the words of files.
const char* to_string(ContactLayout layout);

}  // namespace scree
