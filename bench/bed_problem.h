#pragma once
// The contact problem of a synthetic bed in the memory of a backend: radial layout,
// random velocities.

#include <algorithm>
#include <vector>

#include "bench/packing.h"
#include "bench/random_values.h"
#include "solvers/body_contacts.h"

namespace scree::bench {

template <class B, class Real>
class BedProblem {
 public:
  static constexpr double kTimeStep = 1e-3;  // [s]
  static constexpr double kGravity = 9.81;   // [m/s^2]
  static constexpr double kDensity = 2500;   // [kg/m^3]
  static constexpr double kFriction = 0.5;   // [-]
  static constexpr double kRecovery = 0.5;   // largest speed that pushes overlaps out [m/s]

  BedProblem(B& b, const Bed& bed)
      : body_a_(b), body_b_(b), normal_(b), bias_(b), free_velocity_(b), inertia_(b), lists_(b) {
    const double mass = kDensity * 0.5235987755982989 * bed.diameter * bed.diameter * bed.diameter;
    impulse_scale_ = static_cast<Real>(mass * kGravity * kTimeStep);

    const auto contacts = static_cast<std::size_t>(bed.contact_count());
    std::vector<Vec3<Real>> normal(contacts);
    std::vector<Real> bias(contacts);
    for (std::size_t c = 0; c < contacts; ++c) {
      normal[c] = Vec3<Real>(bed.normal[c]);
      bias[c] = static_cast<Real>(std::max(bed.gap[c] / kTimeStep, -kRecovery));
    }
    // The floor is the one body that does not move.
    const auto bodies = static_cast<std::size_t>(bed.sphere_count()) + 1;
    std::vector<RadialInertia<Real>> inertia(
        bodies, {static_cast<Real>(1 / mass), static_cast<Real>(2.5 / mass)});
    inertia.back() = {};
    upload(b, bed.body_a, body_a_);
    upload(b, bed.body_b, body_b_);
    upload(b, normal, normal_);
    upload(b, bias, bias_);
    upload(b, inertia, inertia_);

    problem_.layout = ContactLayout::radial;
    problem_.contact_count = bed.contact_count();
    const Index spheres = bed.sphere_count();
    problem_.bodies = {spheres, spheres, spheres, spheres + 1};
    free_velocity_.reserve_discard(problem_.bodies.count);
    fill(b, free_velocity_.view(problem_.bodies.count), Twist<Real>{});
    random_velocities(b, 11, free_velocity_.view(problem_.bodies.count));
    problem_.body_a = body_a_.view(problem_.contact_count);
    problem_.body_b = body_b_.view(problem_.contact_count);
    problem_.normal = normal_.view(problem_.contact_count);
    problem_.bias = bias_.view(problem_.contact_count);
    problem_.friction.uniform = static_cast<Real>(kFriction);
    problem_.free_velocity = free_velocity_.view(problem_.bodies.count);
    problem_.radial_inertia = inertia_.view(problem_.bodies.count);
    problem_.radial_inertia.spin_ratio = Real(2.5);
    lists_.build(b, problem_);
  }

  const ContactProblem<Real>& problem() const { return problem_; }
  Index contact_count() const { return problem_.contact_count; }
  Index owned_count() const { return problem_.bodies.owned_count; }

  /// Impulses of the size of a sphere's weight, in all directions: inside, beside
  /// and under the cone.
  void random_impulses(B& b, std::uint64_t seed, Span<Vec3<Real>> out) const {
    for_each(b, problem_.contact_count, RandomVectors<Real>{seed, impulse_scale_, {}, out});
  }
  /// One step of free fall with about as much at random; the floor's entry is left alone.
  void random_velocities(B& b, std::uint64_t seed, Span<Twist<Real>> out) const {
    const Real fall = static_cast<Real>(kGravity * kTimeStep);
    for_each(b, problem_.bodies.owned_count, RandomTwists<Real>{seed, fall, {0, 0, -fall}, out});
  }

 private:
  Buffer<B, Index> body_a_, body_b_;
  Buffer<B, Vec3<Real>> normal_;
  Buffer<B, Real> bias_;
  Buffer<B, Twist<Real>> free_velocity_;
  Buffer<B, RadialInertia<Real>> inertia_;
  BodyContacts<B> lists_;
  ContactProblem<Real> problem_;
  Real impulse_scale_ = 0;
};

}  // namespace scree::bench
