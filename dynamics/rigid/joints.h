#pragma once
// The joints of a scene: their place in the problem of a step, and their impulses from step to step.

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dynamics/model_errors.h"
#include "dynamics/rigid/joint_frames.h"
#include "dynamics/rigid/joint_guess.h"
#include "dynamics/rigid/motor_speed.h"
#include "dynamics/rigid/problem_assembly.h"
#include "host/world.h"
#include "host/world_state.h"
#include "kernels/backend/over_ranks.h"
#include "kernels/step/free_motion.h"
#include "kernels/step/joint_correction.h"
#include "kernels/step/joint_impacts.h"
#include "solvers/body_contacts.h"

namespace scree {

/// Ids of the free bodies that joints hold together.
inline std::vector<std::array<Index, 2>> joined_bodies(const Scene& scene) {
  const auto is_free = [&](int id) {
    return id != kWorldBody && scene.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free;
  };
  std::vector<std::array<Index, 2>> out;
  for (const Joint& joint : scene.joints)
    if (is_free(joint.bodies[0]) && is_free(joint.bodies[1]))
      out.push_back({joint.bodies[0], joint.bodies[1]});
  return out;
}

template <class B, class Real>
class Joints {
 public:
  Joints(B& b, const Scene& scene) : Joints(b, scene, joint_frames(scene)) {}

  Index count() const { return count_; }
  /// See motor_speed() [m/s].
  double motor_speed() const { return motor_speed_; }
  /// Impulse vectors of the joints in a problem, after place().
  Offset vectors() const { return 2 * static_cast<Offset>(here_); }

  /// Impulses of the step before are void.
  void forget(B& b) { fill(b, impulse_.view(), JointImpulse<Real>{}); }

  /// Where the bodies of joints are in the step to come. With several ranks joints are in the problems of those that own one
  /// of their bodies; one host read.
  void place(B& b, const BodyView<Real>& bodies) {
    is_measured_ = false;
    in_impacts_.release();
    if (count_ == 0) return;
    const bool has_ranks = b.ranks() != nullptr;
    if (has_ranks) fill(b, place_.view(), JointPlaces::kNowhere);
    for_each(b, bodies.count, FindPlaces{bodies.ranges(), bodies.id, place_.view()});
    const JointPlaces at = places(bodies);
    for_each(b, count_, JointKeys{at, bodies.owned_count, key_.view(), order_.view()});
    const auto place_bits = bits_for(static_cast<std::uint64_t>(bodies.count) + 1);
    sort_pairs(b, sort_, key_.view(), order_.view(), 32 + place_bits);
    here_ = count_;
    if (!has_ranks) return;
    reduce<Sums<1>>(b, count_, KeyIsBelow{key_.view(), make_key(at.world, 0)},
                    StoreResult<Sums<1>>{here_count_.data()});
    here_ = static_cast<Index>(fetch(b, here_count_.data()).value[0]);
  }

  /// Puts the joints behind the contacts of a problem of the rolling layout, after place().
  /// @param bodies  as the contacts were found
  /// @param period  zero: axis not periodic [m]
  /// @param gamma   impulses of the contacts, then room for vectors(); out: those of the joints
  void join(B& b, const BodyView<Real>& bodies, const SteppingSettings& stepping,
            const Vec3d& period, StepProblem<B, Real>& step, Span<Vec3<Real>> gamma) {
    ContactProblem<Real>& p = step.problem;
    const Index contacts = p.contact_count, total = contacts + here_;

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
    setup.places = places(bodies);
    setup.order = order_.view(here_);
    setup.before = impulse_.view();
    setup.state = state_.view();
    setup.period = period;
    setup.time_step = stepping.time_step;
    setup.recovery_speed = stepping.max_recovery_speed;
    setup.is_measured = is_measured_;
    setup.body_a = tail(joined_.body_a, contacts);
    setup.body_b = tail(joined_.body_b, contacts);
    setup.normal = tail(joined_.normal, contacts);
    setup.row = row_.view(here_);
    setup.gamma = own_part(gamma);
    reduce<JointSums>(b, here_, setup, StoreResult<JointSums>{sums_.data()});
    is_measured_ = true;

    p.layout = ContactLayout::jointed;
    p.contact_count = total;
    p.joint_begin = contacts;
    p.joints = row_.view(here_);
    p.later[0] = lists_.build(b, p.bodies.owned_count, setup.body_a, setup.body_b);
    p.later[0].first = contacts;
    if (b.ranks() != nullptr) {
      is_counted_.reserve_discard(count_);
      fill(b, is_counted_.view(count_), Index(0));
      for_each(b, here_,
               MarkCountedJoints{bodies.ranges(), setup.body_a, setup.body_b, order_.view(here_),
                                 is_counted_.view(count_)});
    }
  }

  /// The same for a problem of impacts, which come before that of the step.
  void join_impacts(B& b, const BodyView<Real>& bodies, const SteppingSettings& stepping,
                    const Vec3d& period, StepProblem<B, Real>& step, Span<Vec3<Real>> gamma) {
    join(b, bodies, stepping, period, step, gamma);
    for_each(b, here_, HoldInImpact<Real>{step.problem, row_.view(here_), own_part(gamma)});
  }
  /// Marks bodies that joints hold to those that impacts have reached, see SpreadThroughJoints.
  void spread_impacts(B& b, const BodyView<Real>& bodies, float least, Span<float> reached) {
    for_each(
        b, here_,
        SpreadThroughJoints{places(bodies), order_.view(here_), state_.view(), least, reached});
  }
  /// Adds the impulses that a solver found for the problem of join_impacts() to those of the step.
  void keep_impacts(B& b, const BodyView<Real>& bodies, Span<const Vec3<Real>> gamma) {
    if (count_ == 0) return;
    if (in_impacts_.capacity() == 0)
      fill(b, in_impacts_.resize_discard(count_), JointImpulse<Real>{});
    for_each(b, here_,
             AddJointImpulses<Real>{places(bodies), order_.view(here_), row_.view(here_),
                                    own_part(gamma), state_.view(), in_impacts_.view(count_)});
  }

  /// Makes the impulses of joints a better guess of those of the problem of join(), see JointGuess.
  void guess(B& b, const BodyView<Real>& bodies, const ContactProblem<Real>& problem,
             Span<Vec3<Real>> gamma, bool is_warm) {
    guess_.improve(b, problem, places(bodies), order_.view(here_), gamma, is_warm);
  }

  /// Redundant joints share the impulses that a solver found from the last guess(), see JointGuess.
  /// @param velocity  of owned bodies and ghosts
  void share(B& b, const BodyView<Real>& bodies, const ContactProblem<Real>& problem,
             Span<Vec3<Real>> gamma, Span<const Twist<Real>> velocity) {
    guess_.share(b, problem, places(bodies), order_.view(here_), gamma, velocity);
  }

  /// Number in the scene of the joint that row k of the problem of join() holds. One host read.
  Index number_of(B& b, Index k) const { return in_scene(fetch(b, order_.data() + k)); }

  struct Worst {
    double error =
        0;  ///< distance of two anchors, or turn of two axes times the size of a body [m]
    Index joint = -1;     ///< in the order of the scene; -1: no joint is off
    double way_back = 0;  ///< longest of a point to where a limit is passed no more [m]
  };
  /// At the start of the step, of all ranks. One host read.
  Worst worst(B& b) const {
    const JointSums sums = over_ranks(b, fetch(b, sums_.data()));
    return {sums.max_error, in_scene(sums.max_error_joint), sums.way_back};
  }

  /// Where joints will be with velocities that a solver found, of all ranks.
  struct AtEnd {
    double missed = 0;                   ///< from where the step was to take them [m]
    double error = 0;                    ///< from where they belong [m]
    double speed_before = 0, speed = 0;  ///< of the fastest of their bodies [m/s]
    /// Of their bodies, once for each of their joints: without joints and contacts, now, and their mass [J, kg].
    double free_energy = 0, energy = 0, mass = 0;
    double driven = 0;  ///< largest speed that a drive or a prescribed body asks for [m/s]
    double forced = 0;  ///< the same without drives of bounded force [m/s]
    double left = 0;    ///< largest velocity of a row that should have none [m/s]
  };
  /// Corrects the problem of join() by what is missed; solved again, it leaves less. One host read.
  /// @param velocity  of owned bodies and ghosts
  AtEnd correct(B& b, const BodyView<Real>& bodies, const ContactProblem<Real>& problem,
                const SteppingSettings& stepping, const Vec3d& period,
                Span<const Twist<Real>> velocity) {
    reduce<JointSums>(
        b, here_,
        CorrectJoint<Real>{bodies, problem.free_velocity, problem.general_inertia, velocity,
                           places(bodies), order_.view(here_), state_.view(), period,
                           stepping.time_step, stepping.max_recovery_speed, row_.view(here_)},
        StoreResult<JointSums>{sums_.data()});
    const JointSums sums = over_ranks(b, fetch(b, sums_.data()));
    return {sums.max_error, sums.end_error, sums.speed_before, sums.speed,  sums.free_energy,
            sums.energy,    sums.mass,      sums.driven,       sums.forced, sums.left};
  }

  /// What all bodies have without contacts and joints, of all ranks. One host read.
  FreeMotion free_motion(B& b, const BodyView<Real>& bodies, const ContactProblem<Real>& problem) {
    reduce<FreeMotion>(b, bodies.count,
                       NoteFreeMotion<Real>{bodies, problem.free_velocity, problem.general_inertia},
                       StoreResult<FreeMotion>{free_motion_.data()});
    return over_ranks(b, fetch(b, free_motion_.data()));
  }

  /// Keeps the rows of join() for plan(). Bytes: those of the rows, read and written.
  void keep_plan(B& b) {
    planned_.reserve_discard(here_);
    copy(b, std::as_const(row_).view(here_), planned_.view(here_));
  }
  /// The rows that were kept, with a share of what they do about errors, and no impulses: those of rows that contradict each
  /// other are so large that what is left of their sum is rounding.
  /// @param give  by which rows give way to impulses, in parts of the mobility of their joint
  void plan(B& b, const BodyView<Real>& bodies, double share, double give, Span<Vec3<Real>> gamma) {
    fill(b, own_part(gamma), Vec3<Real>{});
    for_each(b, here_,
             PlanLess<Real>{places(bodies), order_.view(here_), std::as_const(planned_).view(here_),
                            static_cast<Real>(share), static_cast<Real>(give), row_.view(here_)});
  }

  /// Remembers the impulses that a solver found for the problem of join(), and breaks joints.
  void keep(B& b, const BodyView<Real>& bodies, double time_step, Span<const Vec3<Real>> gamma) {
    for_each(b, here_,
             KeepJointImpulses<Real>{places(bodies), order_.view(here_), row_.view(here_),
                                     own_part(gamma), time_step, in_impacts_.view(),
                                     impulse_.view(), state_.view()});
    if (may_break_)
      for_each(b, count_ - own_count_,
               BreakTurns<Real>{frames_.view(), own_count_, time_step, in_impacts_.view(),
                                impulse_.view(), state_.view()});
    is_known_ = b.ranks() == nullptr;
    if (may_break_) spread(b);  // what breaks for one of two owners has to break for the other
  }

  /// With several ranks: all get to know the impulses and states of all joints. A call that they make together.
  void spread(B& b) {
    if (is_known_ || count_ == 0) return;
    std::vector<JointImpulse<Real>> impulse = download(b, impulse_.view());
    std::vector<JointImpulse<Real>> in_impacts = impulses_in_impacts(b);
    std::vector<JointState> state = download(b, state_.view());
    std::vector<Told> own;
    const std::vector<Index> counted = download(b, is_counted_.view(count_));
    for (std::size_t j = 0; j < counted.size(); ++j)
      if (counted[j] != 0)
        own.push_back({static_cast<Index>(j), impulse[j], in_impacts[j], state[j]});
    for (const Told& told : gather_values(*b.ranks(), own)) {
      impulse[static_cast<std::size_t>(told.joint)] = told.impulse;
      in_impacts[static_cast<std::size_t>(told.joint)] = told.in_impacts;
      state[static_cast<std::size_t>(told.joint)] = told.state;
    }
    upload(b, impulse, impulse_);
    upload(b, in_impacts, in_impacts_);
    upload(b, state, state_);
    is_known_ = true;
  }

  /// Adds what the next step needs to a state; nothing where there are no joints. With several ranks a call that all make
  /// together, as records() is.
  void save(B& b, WorldState& s) {
    if (count_ == 0) return;
    spread(b);
    std::vector<double> position;
    std::vector<std::int32_t> broken;
    for (const JointState& state : download(b, state_.view(count_))) {
      position.push_back(state.position);
      broken.push_back(state.is_broken);
    }
    s.add("joint/impulse", as_vectors(download(b, impulse_.view(count_))));
    if (in_impacts_.capacity() > 0) s.add("joint/in_impacts", as_vectors(impulses_in_impacts(b)));
    s.add("joint/position", std::move(position));
    s.add("joint/broken", std::move(broken));
  }
  /// @throws InputError when the state is of other joints
  void check(const WorldState& s) const {
    const auto count = static_cast<std::size_t>(count_);
    require_joints(rows<Vec3d>(s, "joint/impulse").size(), count);
    if (s.has("joint/in_impacts")) require_joints(rows<Vec3d>(s, "joint/in_impacts").size(), count);
    if (s.has("joint/position") || s.has("joint/broken"))
      require_joint_states(rows<double>(s, "joint/position").size(),
                           rows<std::int32_t>(s, "joint/broken").size(), count);
  }
  /// @param s  that check() has passed
  void restore(B& b, const WorldState& s) {
    const auto impulse = rows<Vec3d>(s, "joint/impulse");
    auto position = rows<double>(s, "joint/position");
    auto broken = rows<std::int32_t>(s, "joint/broken");
    position.resize(static_cast<std::size_t>(count_));  // earlier versions have none
    broken.resize(position.size());
    std::vector<JointState> states;
    for (std::size_t k = 0; k < position.size(); ++k)
      states.push_back({position[k], broken[k] != 0 ? 1 : 0, s.step > 0 ? 1 : 0});
    upload(b, as_impulses(impulse), impulse_);
    in_impacts_.release();
    if (s.has("joint/in_impacts"))
      upload(b, as_impulses(rows<Vec3d>(s, "joint/in_impacts")), in_impacts_);
    upload(b, states, state_);
    is_known_ = true;
  }

  /// Impulses of the last step, in the order of the scene.
  std::vector<JointRecord> records(B& b) {
    spread(b);
    return known_records(b);
  }
  /// The same; with several ranks zero where another one tells of a joint.
  std::vector<JointRecord> own_records(B& b) const {
    std::vector<JointRecord> out = known_records(b);
    if (b.ranks() == nullptr) return out;
    const std::vector<Index> counted = download(b, is_counted_.view(count_));
    for (std::size_t j = 0; j < out.size(); ++j)
      if (counted[j] == 0) out[j].force = out[j].moment = {};
    return out;
  }

 private:
  Joints(B& b, const Scene& scene, const std::vector<JointFrames>& frames)
      : own_count_(static_cast<Index>(scene.joints.size())),
        count_(static_cast<Index>(frames.size())),
        frames_(b),
        impulse_(b, count_),
        in_impacts_(b),
        state_(b, count_),
        place_(b, count_ > 0 ? static_cast<Offset>(scene.bodies.size()) : 0),
        key_(b, count_),
        order_(b, count_),
        sort_(b),
        joined_(b),
        row_(b, count_),
        planned_(b, count_),
        sums_(b, 1),
        free_motion_(b, 1),
        here_count_(b, 1),
        is_counted_(b),
        lists_(b),
        guess_(b, scene, frames),
        motor_speed_(scree::motor_speed(scene, frames)) {
    for (const Joint& joint : scene.joints) {
      may_break_ =
          may_break_ || std::isfinite(joint.break_force) || std::isfinite(joint.break_moment);
    }
    for (const JointFrames& joint : frames)
      if (joint.turn_of >= 0) turn_of_.push_back(joint.turn_of);
    upload(b, frames, frames_);
    fill(b, state_.view(), JointState{});
    forget(b);
  }

  /// What a rank says of a joint.
  struct Told {
    Index joint = 0;
    JointImpulse<Real> impulse, in_impacts;
    JointState state;
  };

  /// Of a joint, or of a drive about one of its axes.
  Index in_scene(Index joint) const {
    return joint < own_count_ ? joint : turn_of_[static_cast<std::size_t>(joint - own_count_)];
  }

  JointPlaces places(const BodyView<Real>& bodies) {
    return {frames_.view(), place_.view(), bodies.count, bodies.moving_count};
  }

  std::vector<JointRecord> known_records(B& b) const {
    std::vector<JointRecord> out;
    const auto frames = download(b, frames_.view(count_));
    const auto states = download(b, state_.view(count_));
    const std::vector<JointImpulse<Real>> impulse = download(b, impulse_.view(count_));
    const std::vector<JointImpulse<Real>> in_impacts = impulses_in_impacts(b);
    for (std::size_t k = 0; k < frames.size(); ++k)
      out.push_back({frames[k].body[0], frames[k].body[1],
                     Vec3d(impulse[k].force) + Vec3d(in_impacts[k].force),
                     Vec3d(impulse[k].moment) + Vec3d(in_impacts[k].moment), states[k].position, 0,
                     0, states[k].is_broken != 0});
    for (std::size_t k = 0; k < turn_of_.size(); ++k) {
      const JointRecord& turn = out[static_cast<std::size_t>(own_count_) + k];
      JointRecord& own = out[static_cast<std::size_t>(turn_of_[k])];
      own.moment += turn.moment;
      const JointForm form = frames[static_cast<std::size_t>(own_count_) + k].form;
      if (form == JointForm::second_turn) own.second_turn = turn.position;
      if (form == JointForm::turn || form == JointForm::twist) own.turn = turn.position;
    }
    out.resize(static_cast<std::size_t>(own_count_));
    return out;
  }

  /// Those of the impacts of the last step, of each joint.
  std::vector<JointImpulse<Real>> impulses_in_impacts(B& b) const {
    std::vector<JointImpulse<Real>> out = download(b, in_impacts_.view(in_impacts_.capacity()));
    out.resize(static_cast<std::size_t>(count_));
    return out;
  }

  /// Force and moment of each joint by turns; double holds float exactly.
  static std::vector<Vec3d> as_vectors(const std::vector<JointImpulse<Real>>& impulses) {
    std::vector<Vec3d> out;
    for (const JointImpulse<Real>& impulse : impulses) {
      out.emplace_back(impulse.force);
      out.emplace_back(impulse.moment);
    }
    return out;
  }
  static std::vector<JointImpulse<Real>> as_impulses(const std::vector<Vec3d>& vectors) {
    std::vector<JointImpulse<Real>> out;
    for (std::size_t k = 0; k + 1 < vectors.size(); k += 2)
      out.push_back({Vec3<Real>(vectors[k]), Vec3<Real>(vectors[k + 1])});
    return out;
  }

  template <class T>
  static std::vector<T> rows(const WorldState& s, const char* name) {
    return s.has(name) ? s.at<T>(name) : std::vector<T>{};
  }

  /// Of the impulses of contacts and joints.
  template <class T>
  Span<T> own_part(Span<T> gamma) const {
    return {gamma.data + gamma.size - vectors(), vectors()};
  }

  template <class T>
  Span<T> tail(Buffer<B, T>& buffer, Index contacts) {
    return {buffer.data() + contacts, here_};
  }

  Index own_count_;             ///< of the scene
  Index count_;                 ///< with the drives about axes behind them, see joint_frames()
  std::vector<Index> turn_of_;  ///< joint of each of these drives
  Index here_ = 0;              ///< in the problem of the step; the first of `order_`
  bool may_break_ = false;
  bool is_known_ = true;      ///< impulses and states are those of all ranks
  bool is_measured_ = false;  ///< see JointSetup
  Buffer<B, JointFrames> frames_;
  Buffer<B, JointImpulse<Real>> impulse_;     ///< of the last step, in the order of the scene
  Buffer<B, JointImpulse<Real>> in_impacts_;  ///< the same of its impacts; empty: none
  Buffer<B, JointState> state_;               ///< in the order of the scene
  Buffer<B, Index> place_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> order_;
  SortSpace<B> sort_;
  ProblemContacts<B, Real> joined_;  ///< fields of contacts and joints
  Buffer<B, JointRow<Real>> row_, planned_;
  Buffer<B, JointSums> sums_;
  Buffer<B, FreeMotion> free_motion_;
  Buffer<B, Sums<1>> here_count_;
  Buffer<B, Index> is_counted_;  ///< with several ranks: of each joint, see MarkCountedJoints
  GroupContacts<B> lists_;
  JointGuess<B, Real> guess_;
  double motor_speed_;
};

}  // namespace scree
