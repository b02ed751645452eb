#pragma once
// Turns bodies and contacts into the ContactProblem of a step; owns what the problem points at.

#include <algorithm>

#include "host/scene.h"
#include "kernels/step_setup.h"
#include "solvers/body_contacts.h"

namespace scree {

template <class B, class Real>
class ProblemAssembly {
 public:
  /// @param solid_spheres  see SceneSummary
  ProblemAssembly(B& b, const Scene& scene, ContactLayout layout, bool solid_spheres)
      : laws_(b),
        free_velocity_(b),
        radial_inertia_(b),
        general_inertia_(b),
        bias_(b),
        friction_(b),
        adhesion_(b),
        rolling_(b),
        lists_(b),
        sums_(b, 1),
        layout_(layout),
        solid_spheres_(solid_spheres),
        material_count_(static_cast<Index>(scene.materials.size())) {
    std::vector<PairLaw<Real>> laws;
    for (Index i = 0; i < material_count_; ++i) {
      for (Index j = 0; j < material_count_; ++j) {
        const Material m = pair_values(scene, i, j);
        laws.push_back({static_cast<Real>(m.friction), static_cast<Real>(m.restitution),
                        static_cast<Real>(m.cohesion), static_cast<Real>(m.rolling_friction),
                        static_cast<Real>(m.spinning_friction)});
      }
    }
    uniform_friction_ = laws.front().friction;
    for (const PairLaw<Real>& law : laws) {
      has_uniform_friction_ = has_uniform_friction_ && law.friction == uniform_friction_;
      has_cohesion_ = has_cohesion_ || law.cohesion > 0;
    }
    upload(b, laws, laws_);
  }

  struct Result {
    ContactProblem<Real> problem;
    SetupSums sums;
  };

  /// @param gravity_step  h g [m/s]
  Result assemble(B& b, const BodyView<Real>& bodies, const ContactView<Real>& contacts,
                  const SteppingSettings& stepping, double cohesion_range,
                  const Vec3<Real>& gravity_step) {
    ContactProblem<Real> p;
    p.layout = layout_;
    p.contact_count = contacts.count;
    p.free_count = bodies.free_count;
    p.body_count = bodies.count;
    p.body_a = contacts.body_a;
    p.body_b = contacts.body_b;
    p.normal = contacts.normal;
    p.arm_a = contacts.arm_a;
    p.arm_b = contacts.arm_b;

    free_velocity_.reserve_discard(bodies.count);
    p.free_velocity = free_velocity_.view(bodies.count);
    if (layout_ == ContactLayout::radial) {
      radial_inertia_.reserve_discard(bodies.count);
      p.radial_inertia = radial_inertia_.view(bodies.count);
      if (solid_spheres_) p.spin_ratio = Real(2.5);  // r^2 / I over 1 / m
      for_each(b, bodies.count,
               PredictRadial<Real>{bodies, gravity_step, free_velocity_.view(bodies.count),
                                   radial_inertia_.view(bodies.count)});
    } else {
      general_inertia_.reserve_discard(bodies.count);
      p.general_inertia = general_inertia_.view(bodies.count);
      for_each(b, bodies.count,
               PredictGeneral<Real>{bodies, gravity_step, free_velocity_.view(bodies.count),
                                    general_inertia_.view(bodies.count)});
    }

    const Index n = contacts.count;
    bias_.reserve_discard(n);
    p.bias = bias_.view(n);
    ContactSetup<Real> setup;
    setup.bodies = bodies;
    setup.contacts = contacts;
    setup.law = {laws_.view(), material_count_};
    setup.time_step = static_cast<Real>(stepping.time_step);
    setup.max_recovery_speed = static_cast<Real>(stepping.max_recovery_speed);
    setup.restitution_threshold = static_cast<Real>(stepping.restitution_threshold);
    setup.cohesion_range = static_cast<Real>(cohesion_range);
    setup.bias = bias_.view(n);
    p.friction.uniform = uniform_friction_;
    if (!has_uniform_friction_) p.friction.values = setup.friction = sized(friction_, n);
    if (has_cohesion_) p.adhesion.values = setup.adhesion = sized(adhesion_, n);
    if (layout_ == ContactLayout::rolling) p.rolling = setup.rolling = sized(rolling_, n);
    reduce<SetupSums>(b, n, setup, StoreResult<SetupSums>{sums_.data()});
    lists_.build(b, p);
    return {p, fetch(b, sums_.data())};
  }

 private:
  template <class T>
  static Span<T> sized(Buffer<B, T>& buffer, Index n) {
    buffer.reserve_discard(std::max<Index>(n, 1));  // an empty view would mean "uniform"
    return buffer.view(std::max<Index>(n, 1));
  }

  Buffer<B, PairLaw<Real>> laws_;
  Buffer<B, Twist<Real>> free_velocity_;
  Buffer<B, RadialInertia<Real>> radial_inertia_;
  Buffer<B, GeneralInertia<Real>> general_inertia_;
  Buffer<B, Real> bias_;
  Buffer<B, Real> friction_;
  Buffer<B, Real> adhesion_;
  Buffer<B, RollingRow<Real>> rolling_;
  BodyContacts<B> lists_;
  Buffer<B, SetupSums> sums_;
  ContactLayout layout_;
  bool solid_spheres_ = false;
  Index material_count_;
  Real uniform_friction_ = 0;
  bool has_uniform_friction_ = true;
  bool has_cohesion_ = false;
};

}  // namespace scree
