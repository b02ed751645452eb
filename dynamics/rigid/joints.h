#pragma once
// The joints of a scene: their place in the problem of a step, and their impulses from step to step.

#include <vector>

#include "dynamics/rigid/collision_settings.h"
#include "dynamics/rigid/problem_assembly.h"
#include "host/scene/motion.h"
#include "host/world.h"
#include "kernels/step/joint_setup.h"
#include "solvers/body_contacts.h"

namespace scree {

/// Rows that a joint holds, see JointRow.
constexpr unsigned held_rows(JointKind kind) {
  switch (kind) {
    case JointKind::ball:
      return 0b000111;
    case JointKind::hinge:
      return 0b011111;
    case JointKind::fixed:
      break;
  }
  return 0b111111;
}

/// A rotation that takes the z axis to a unit vector.
inline Quatd rotation_to(const Vec3d& axis) {
  if (axis.z < -0.5) {  // by way of the opposite vector: near it no digits are lost
    return rotation_to(-axis) * Quatd{0, 1, 0, 0};
  }
  return normalized(Quatd{1 + axis.z, -axis.y, axis.x, 0});
}

/// The joint in the frames of its bodies, from their poses at time zero. Where space repeats, the
/// anchor of a body is the image nearest to it.
inline JointFrames joint_frames(const Scene& scene, const Joint& joint) {
  JointFrames out;
  const Vec3d period = periodic_box(scene.periodicity).length;
  const Quatd axes = joint.kind == JointKind::hinge ? rotation_to(joint.axis) : Quatd{1, 0, 0, 0};
  for (int k = 0; k < 2; ++k) {
    const int id = joint.bodies[static_cast<std::size_t>(k)];
    out.body[k] = id;
    out.anchor[k] = joint.anchor;
    out.frame[k] = axes;
    if (id == kWorldBody) continue;
    const BodyDescription& body = scene.bodies[static_cast<std::size_t>(id)];
    const Pose pose =
        body.kind == BodyKind::kinematic ? pose_at(body, 0) : Pose{body.position, body.orientation};
    const Quatd q = normalized(pose.orientation);
    out.anchor[k] = rotate_back(q, minimum_image(joint.anchor - pose.position, period));
    out.frame[k] = conjugate(q) * axes;
  }
  out.held = held_rows(joint.kind);
  return out;
}

template <class B, class Real>
class Joints {
 public:
  Joints(B& b, const Scene& scene)
      : count_(static_cast<Index>(scene.joints.size())),
        frames_(b),
        impulse_(b, count_),
        place_(b, count_ > 0 ? static_cast<Offset>(scene.bodies.size()) : 0),
        key_(b, count_),
        order_(b, count_),
        sort_(b),
        joined_(b),
        row_(b, count_),
        sums_(b, 1),
        lists_(b) {
    std::vector<JointFrames> frames;
    for (const Joint& joint : scene.joints) frames.push_back(joint_frames(scene, joint));
    upload(b, frames, frames_);
    forget(b);
  }

  Index count() const { return count_; }
  /// Impulse vectors of the joints in a problem.
  Offset vectors() const { return 2 * static_cast<Offset>(count_); }

  /// Impulses of the step before are void.
  void forget(B& b) { fill(b, impulse_.view(), JointImpulse<Real>{}); }

  /// Puts the joints behind the contacts of a problem of the rolling layout.
  /// @param bodies  as the contacts were found
  /// @param period  zero: axis not periodic [m]
  /// @param gamma   impulses of the contacts, then room for vectors(); out: those of the joints
  void join(B& b, const BodyView<Real>& bodies, const SteppingSettings& stepping,
            const Vec3d& period, StepProblem<B, Real>& step, Span<Vec3<Real>> gamma) {
    ContactProblem<Real>& p = step.problem;
    const Index contacts = p.contact_count, total = contacts + count_;
    for_each(b, bodies.count, FindPlaces{bodies.ranges(), bodies.id, place_.view()});
    const JointPlaces places{frames_.view(), place_.view(), bodies.count};
    for_each(b, count_, JointKeys{places, key_.view(), order_.view()});
    const auto place_bits = bits_for(static_cast<std::uint64_t>(bodies.count) + 1);
    sort_pairs(b, sort_, key_.view(), order_.view(), 32 + place_bits);

    // What joints have too moves to arrays with room for them.
    p.visit(
        [&]<class T>(const ContactField& field, auto& values, Buffer<B, T>& joined) {
          if (field.count != FieldCount::rows) return;
          joined.reserve_discard(total);
          if (contacts > 0) copy(b, stored_values(values).first(contacts), joined.view(contacts));
          point_to(values, Span<const T>(joined.view(total)));
        },
        p, joined_);
    JointSetup<Real> setup;
    setup.bodies = bodies;
    setup.inertia = p.general_inertia;
    setup.places = places;
    setup.order = order_.view();
    setup.before = impulse_.view();
    setup.period = period;
    setup.time_step = stepping.time_step;
    setup.recovery_speed = stepping.max_recovery_speed;
    setup.body_a = tail(joined_.body_a, contacts);
    setup.body_b = tail(joined_.body_b, contacts);
    setup.normal = tail(joined_.normal, contacts);
    setup.row = row_.view();
    setup.gamma = {gamma.data + gamma.size - vectors(), vectors()};
    reduce<JointSums>(b, count_, setup, StoreResult<JointSums>{sums_.data()});

    p.layout = ContactLayout::jointed;
    p.contact_count = total;
    p.joint_begin = contacts;
    p.joints = row_.view();
    p.later[0] = lists_.build(b, p.bodies.owned_count, setup.body_a, setup.body_b);
    p.later[0].first = contacts;
  }

  /// Largest distance of two anchors, or turn of two axes times the size of a body, at the start of
  /// the step [m]. One host read.
  double largest_error(B& b) const { return fetch(b, sums_.data()).max_error; }

  /// Remembers the impulses that a solver found for the problem of join().
  void keep(B& b, const BodyView<Real>& bodies, Span<const Vec3<Real>> gamma) {
    const JointPlaces places{frames_.view(), place_.view(), bodies.count};
    for_each(b, count_,
             KeepJointImpulses<Real>{places,
                                     order_.view(),
                                     row_.view(),
                                     {gamma.data + gamma.size - vectors(), vectors()},
                                     impulse_.view()});
  }

  /// Force and moment of each joint by turns, for checkpoints; double holds float exactly.
  std::vector<Vec3d> save(B& b) const {
    std::vector<Vec3d> out;
    for (const JointImpulse<Real>& impulse : download(b, impulse_.view(count_))) {
      out.emplace_back(impulse.force);
      out.emplace_back(impulse.moment);
    }
    return out;
  }
  /// @param impulses  of save()
  void restore(B& b, const std::vector<Vec3d>& impulses) {
    std::vector<JointImpulse<Real>> host;
    for (std::size_t k = 0; k < impulses.size(); k += 2)
      host.push_back({Vec3<Real>(impulses[k]), Vec3<Real>(impulses[k + 1])});
    upload(b, host, impulse_);
  }

  /// Impulses of the last step, in the order of the scene.
  std::vector<JointRecord> records(B& b) const {
    std::vector<JointRecord> out;
    const auto frames = download(b, frames_.view(count_));
    const std::vector<Vec3d> impulse = save(b);
    for (std::size_t k = 0; k < frames.size(); ++k)
      out.push_back({frames[k].body[0], frames[k].body[1], impulse[2 * k], impulse[2 * k + 1]});
    return out;
  }

 private:
  template <class T>
  Span<T> tail(Buffer<B, T>& buffer, Index contacts) {
    return {buffer.data() + contacts, count_};
  }

  Index count_;
  Buffer<B, JointFrames> frames_;
  Buffer<B, JointImpulse<Real>> impulse_;  ///< of the last step, in the order of the scene
  Buffer<B, Index> place_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> order_;
  SortSpace<B> sort_;
  ProblemContacts<B, Real> joined_;  ///< fields of contacts and joints
  Buffer<B, JointRow<Real>> row_;
  Buffer<B, JointSums> sums_;
  GroupContacts<B> lists_;
};

}  // namespace scree
