#pragma once
// Turns bodies and contacts into the ContactProblem of a step; owns what the problem points at.

#include <algorithm>

#include "dynamics/rigid/step_parts.h"
#include "kernels/bodies/ghosts.h"
#include "kernels/contact/contact_operator.h"
#include "kernels/contact/field_buffers.h"
#include "kernels/step/step_setup.h"
#include "solvers/body_contacts.h"

namespace scree {

/// The contact problem of a step with the memory it points at, beside that of the bodies
/// and of the contacts.
template <class B, class Real>
struct StepProblem {
  explicit StepProblem(B& b)
      : free_velocity(b),
        radial_inertia(b),
        general_inertia(b),
        contacts(b),
        lists(b),
        contacts_of_body(b) {}

  ContactProblem<Real> problem;
  SetupSums sums;
  Buffer<B, Twist<Real>> free_velocity;
  Buffer<B, RadialInertia<Real>> radial_inertia;
  Buffer<B, GeneralInertia<Real>> general_inertia;
  ProblemContacts<B, Real> contacts;  ///< fields that contacts as they were found lack
  BodyContacts<B> lists;
  Buffer<B, Index> contacts_of_body;  ///< with several ranks [moving_count]
};

template <class B, class Real>
class ProblemAssembly {
 public:
  /// @param shapes  records that BodyView::shape points to
  ProblemAssembly(B& b, const Scene& scene, const SceneSummary& summary,
                  Span<const ShapeRecord<Real>> shapes)
      : laws_(b),
        sums_(b, 1),
        contacts_(b),
        layout_(summary.layout),
        own_(parts_of_step<Real>(scene, summary)),
        solid_spheres_(summary.solid_spheres),
        radial_bodies_(summary.radial_bodies),
        shapes_(shapes),
        material_count_(static_cast<Index>(scene.materials.size())) {
    std::vector<PairLaw<Real>> laws;
    for (const Material& m : all_pair_values(scene)) {
      laws.push_back({static_cast<Real>(m.friction), static_cast<Real>(m.restitution),
                      static_cast<Real>(m.cohesion), static_cast<Real>(m.rolling_friction),
                      static_cast<Real>(m.spinning_friction)});
    }
    uniform_friction_ = laws.front().friction;
    has_restitution_ = std::any_of(laws.begin(), laws.end(),
                                   [](const PairLaw<Real>& law) { return law.restitution > 0; });
    upload(b, laws, laws_);
  }

  /// With several ranks: assemble() is then a call that all make together.
  void set_ghosts(const Ghosts<B>* ghosts) { ghosts_ = ghosts; }

  /// Whether some pair of materials bounces.
  bool has_restitution() const { return has_restitution_; }
  LawTable<Real> laws() const { return {laws_.view(laws_.capacity()), material_count_}; }

  /// @param bodies, contacts  the problem points at them: they must not change while it is in use
  /// @param loaded            the bodies with the velocities that loads beside gravity give them
  /// @param parts             the bodies as collision detection saw them
  /// @param gravity_step      h g [m/s]
  StepProblem<B, Real> assemble(B& b, const BodyView<Real>& bodies, const BodyView<Real>& loaded,
                                const BodyView<Real>& parts, const ContactView<Real>& contacts,
                                const SteppingSettings& stepping, double cohesion_range,
                                const Vec3<Real>& gravity_step) {
    StepProblem<B, Real> step(b);
    ContactProblem<Real>& p = step.problem;
    p.layout = layout_;
    p.contact_count = contacts.count;
    p.bodies = bodies.ranges();
    if (layout_ == ContactLayout::jointed) ++p.bodies.count;  // the world
    p.body_a = contacts.body_a;
    p.body_b = contacts.body_b;
    p.normal = contacts.normal;
    p.arm_a = contacts.arm_a;
    p.arm_b = contacts.arm_b;
    const Index n = contacts.count, general = n - contacts.radial_count;
    if (layout_ == ContactLayout::mixed) p.radial_count = contacts.radial_count;
    step.contacts.resize_discard(own_, n, contacts.radial_count);
    const ProblemFields<InSpans<Real>> own = step.contacts.spans();
    if (own_.arms) for_each(b, general, ScaleArms<Real>{bodies, contacts, own.arm_a, own.arm_b});
    set_bodies(b, loaded, gravity_step, step);

    p.bias.gap = contacts.gap;
    p.bias.inv_time_step = static_cast<Real>(1 / stepping.time_step);
    p.bias.least = static_cast<Real>(-stepping.max_recovery_speed);
    ContactSetup<Real> setup;
    setup.bodies = bodies;
    setup.contacts = contacts;
    setup.law = laws();
    setup.without_impact = p.bias;
    setup.time_step = static_cast<Real>(stepping.time_step);
    setup.restitution_threshold = static_cast<Real>(stepping.restitution_threshold);
    setup.cohesion_range = static_cast<Real>(cohesion_range);
    setup.bias = own.bias;
    setup.friction = own.friction;
    setup.adhesion = own.adhesion;
    setup.rolling = own.rolling;
    p.friction.uniform = uniform_friction_;
    if (own_.drift)
      for_each(b, general,
               ContactDrift<Real>{bodies, parts, contacts, p.general_inertia, shapes_,
                                  setup.time_step / 2, own.drift});
    point_to(p, step.contacts);
    step.lists.build(b, p);
    if (ghosts_ != nullptr) show_counts(b, step);
    reduce_contacts<SetupSums>(b, p, setup, StoreResult<SetupSums>{sums_.data()});
    step.sums = fetch(b, sums_.data());
    if (ghosts_ != nullptr) take_counts(b, step.sums.contacts, step);
    return step;
  }

  /// What ranks have to know of each other's contacts; assemble() sees to it for what it assembled.
  /// @param step  with contacts, bodies and lists
  void share(B& b, StepProblem<B, Real>& step) {
    if (ghosts_ == nullptr) return;
    show_counts(b, step);
    reduce_contacts<Sums<1>>(b, step.problem, EachContact{},
                             StoreResult<Sums<1>>{contacts_.resize_discard(1).data});
    take_counts(b, fetch(b, std::as_const(contacts_).data()).value[0], step);
  }

  /// Velocities and inertias of the bodies in the problem of a step.
  void set_bodies(B& b, const BodyView<Real>& bodies, const Vec3<Real>& gravity_step,
                  StepProblem<B, Real>& step) {
    ContactProblem<Real>& p = step.problem;
    if (layout_ == ContactLayout::radial && solid_spheres_) {
      p.free_velocity.velocity = bodies.velocity;
      p.free_velocity.angular_velocity = bodies.angular_velocity;
      p.free_velocity.radius = bodies.radius;
      p.free_velocity.gravity_step = gravity_step;
      p.free_velocity.moving_count = bodies.moving_count;
      set_solid_spheres(bodies, p);
      return;
    }
    const Span<Twist<Real>> free_velocity = sized(step.free_velocity, p.bodies.count);
    p.free_velocity = free_velocity;
    if (layout_ == ContactLayout::mixed) {
      Span<RadialInertia<Real>> radial;
      Span<GeneralInertia<Real>> general;
      if (solid_spheres_) {
        set_solid_spheres(bodies, p);
      } else {
        p.radial_inertia = radial = sized(step.radial_inertia, bodies.count);
      }
      if (!radial_bodies_) p.general_inertia = general = sized(step.general_inertia, bodies.count);
      for_each(b, bodies.count,
               PredictMixed<Real>{bodies, gravity_step, free_velocity, radial, general});
    } else if (layout_ == ContactLayout::radial) {
      const Span<RadialInertia<Real>> inertia = sized(step.radial_inertia, bodies.count);
      p.radial_inertia = inertia;
      for_each(b, bodies.count, PredictRadial<Real>{bodies, gravity_step, free_velocity, inertia});
    } else {
      const Span<GeneralInertia<Real>> inertia = sized(step.general_inertia, p.bodies.count);
      p.general_inertia = inertia;
      for_each(b, p.bodies.count,
               PredictGeneral<Real>{bodies, gravity_step, free_velocity, inertia});
    }
  }

 private:
  void show_counts(B& b, StepProblem<B, Real>& step) {
    const BodyRanges& bodies = step.problem.bodies;
    const Span<Index> count = step.contacts_of_body.resize_discard(bodies.moving_count);
    for_each(b, bodies.owned_count, ContactsOfBodies<Real>{step.problem, count});
    ghosts_->send(b, count);
  }
  /// When all have told how many contacts they have, all have shown those of their bodies.
  void take_counts(B& b, double all_contacts, StepProblem<B, Real>& step) {
    const Index moving = step.problem.bodies.moving_count, owned = step.problem.bodies.owned_count;
    const Span<Index> count = step.contacts_of_body.view(moving);
    ghosts_->receive(b, count);
    step.problem.all_contacts = static_cast<Offset>(all_contacts);
    step.problem.ghost_contacts = Span<const Index>{count.data + owned, moving - owned};
  }
  static void set_solid_spheres(const BodyView<Real>& bodies, ContactProblem<Real>& p) {
    p.radial_inertia.inv_mass = bodies.inv_mass;
    p.radial_inertia.spin_ratio = Real(2.5);  // r^2 / I over 1 / m
  }

  template <class T>
  static Span<T> sized(Buffer<B, T>& buffer, Index n) {
    buffer.reserve_discard(std::max<Index>(n, 1));  // an empty view would mean "worked out"
    return buffer.view();
  }

  Buffer<B, PairLaw<Real>> laws_;
  Buffer<B, SetupSums> sums_;
  Buffer<B, Sums<1>> contacts_;
  const Ghosts<B>* ghosts_ = nullptr;
  ContactLayout layout_;
  ContactParts own_;  ///< what it stores of contacts
  bool solid_spheres_ = false;
  bool radial_bodies_ = false;
  Span<const ShapeRecord<Real>> shapes_;
  Index material_count_;
  Real uniform_friction_ = 0;
  bool has_restitution_ = false;
};

}  // namespace scree
