#pragma once
// Rigid bodies: what a step is, stage by stage, on backend B with solver precision Real.

#include <algorithm>
#include <limits>

#include "collision/body_order.h"
#include "collision/contact_detector.h"
#include "dynamics/model_on.h"
#include "dynamics/ranks/common_error.h"
#include "dynamics/ranks/gather.h"
#include "dynamics/ranks/rank_plan.h"
#include "dynamics/ranks/shareable.h"
#include "dynamics/rigid/body_loading.h"
#include "dynamics/rigid/body_store.h"
#include "dynamics/rigid/changed_bodies.h"
#include "dynamics/rigid/collision_settings.h"
#include "dynamics/rigid/contact_records.h"
#include "dynamics/rigid/correct_joints.h"
#include "dynamics/rigid/force_sums.h"
#include "dynamics/rigid/impact_phase.h"
#include "dynamics/rigid/integration.h"
#include "dynamics/rigid/joints.h"
#include "dynamics/rigid/named_arrays.h"
#include "dynamics/rigid/obstacles.h"
#include "dynamics/rigid/part_store.h"
#include "dynamics/rigid/prescribed_motion.h"
#include "dynamics/rigid/problem_assembly.h"
#include "dynamics/rigid/problem_source.h"
#include "dynamics/rigid/rigid_card.h"
#include "dynamics/rigid/saved_state.h"
#include "dynamics/rigid/shared_state.h"
#include "dynamics/rigid/step_report.h"
#include "dynamics/rigid/tolerance.h"
#include "host/problems/download_problem.h"
#include "host/scene/run_summary.h"
#include "host/scene/stored_joints.h"
#include "kernels/step/written_state.h"
#include "solvers/coulomb.h"
#include "solvers/solver.h"

namespace scree {

template <class B, class Real>
class RigidDynamics final : public ModelOn<B, Real> {
 public:
  /// @param summary     see summarize_run()
  /// @param near_pairs  whether the list of near pairs is kept between steps
  RigidDynamics(std::unique_ptr<B> on, Scene scene, const SceneSummary& summary, bool near_pairs,
                RankPlan plan)
      : ModelOn<B, Real>(std::move(on), scene),
        ranks_(std::move(plan.ranks)),
        scene_(std::move(scene)),
        steepest_(steepest_friction(scene_, summary.median_diameter)),
        gravity_(scene_.gravity),
        summary_(summary),
        motion_(scene_),
        store_(backend(), plan.places, summary_.fixed_count, shared_constants(scene_),
               summary_.solid_spheres),
        loads_(backend(), id_count()),
        obstacles_(backend(), scene_, store_.fixed_begin(),
                   ranks_ ? std::optional(store_.fixed_begin()) : std::nullopt),
        parts_(backend(), obstacles_.data(), obstacles_.shapes(), summary_.fixed_count,
               obstacles_.fixed_part_begin(), periodic_box()),
        detector_(backend(), collision_settings(scene_, summary_, near_pairs), obstacles_.data()),
        assembly_(backend(), scene_, summary_, obstacles_.shapes()),
        joints_(backend(), scene_),
        impacts_(backend(), scene_, summary_.layout),
        integration_(backend()),
        forces_(scene_),
        solver_(make_step_solver()),
        shared_(ranks_ ? std::make_unique<SharedState<B, Real>>(
                             backend(), *ranks_, std::move(plan.decomposition),
                             summary_.median_diameter, joined_bodies(scene_), store_, parts_,
                             PartNames{id_count(), obstacles_.part_owners()},
                             parts_.reach(obstacles_.data()), detector_, *solver_, vectors())
                       : nullptr),
        loading_(scene_, store_, obstacles_, owned_here()),
        impulse_(backend()) {
    if (shared_) {
      backend().set_ranks(ranks_.get());
      solver_->set_ghosts(&shared_->ghosts());
      detector_.set_ghosts(&shared_->ghosts());
      assembly_.set_ghosts(&shared_->ghosts());
      impacts_.set_ghosts(&shared_->ghosts());
      store_.before_fixed_move([this](Index shift) { follow_fixed_bodies(shift); });
      parts_.before_fixed_move([this](Index shift) {
        obstacles_.follow_fixed_parts(backend(), shift);
        follow_walls(shift);
      });
    }
    loading_.load_first();
    motion_.set(store_, 0, 1);
    insert_due(0);
  }

  using ModelOn<B, Real>::steps_done;
  using ModelOn<B, Real>::time;

  StepReport step(BodyProblem* stored) override {
    if (stored != nullptr) require_storable_joints("problem of a step", scene_);
    B& b = backend();
    const double h = scene_.stepping.time_step;
    StageClock<B> clock(b);
    StepReport report;
    forget_solved_contacts();  // a step that fails leaves none

    if (shared_) {
      shared_->move_bodies(steps_done(), loading_.is_due(time()), [&] {
        joints_.spread(b);  // bodies take theirs along
        insert_due(time());
      });
    } else {
      insert_due(time());
    }
    motion_.set(store_, time(), steps_done() + 1);
    if (steps_done() % kReorderEvery == 0) reorder();
    if (shared_)
      shared_->renew_ghosts(detector_.range_of(store_.view(), h, Vec3d(gravity_step()), 0));
    const BodyView<Real> bodies = store_.view();
    const LoadSums loads = start_loads(bodies);
    BodyView<Real> loaded = loads_.loaded(b, bodies);
    const BodyView<Real> seen = parts_.place(loaded);
    detector_.detect(b, seen, h, Vec3d(gravity_step()), loads.largest, parts_.of(loaded));
    const ContactView<Real> contacts = detector_.contacts();
    joints_.place(b, bodies);
    const Offset vectors =
        static_cast<Offset>(contacts.count) * vectors_per_contact(summary_.layout);
    Buffer<B, Vec3<Real>> impulse(b, vectors + joints_.vectors());
    const Span<Vec3<Real>> gamma = impulse.view();
    if (scene_.solver.warm_start) {
      detector_.match(b, vectors_per_contact(summary_.layout), gamma.first(vectors));
    } else {
      fill(b, gamma, Vec3<Real>{});
      joints_.forget(b);
    }
    Buffer<B, Vec3<Real>> guess(b, vectors);
    copy(b, Span<const Vec3<Real>>(gamma.first(vectors)), guess.view());
    Buffer<B, Index> mark(b, keeps_marks() ? contacts.count : 0);
    if (keeps_marks()) detector_.match_marks(b, mark.view());
    detector_.forget();  // the last step, in favor of the solver's memory
    report.ms.collision = clock.lap();

    ImpactStats impacts;
    if (has_impacts()) {
      impacts = impacts_.run(b, assembly_, joints_, bodies, contacts, scene_.stepping,
                             summary_.envelope, gravity_step(), loads_.gains());
      if (impacts.rounds > 0) loaded = loads_.loaded(b, bodies);  // loads come after impacts
    }
    const double impact_ms = clock.lap();

    StepProblem<B, Real> assembled = assembly_.assemble(
        b, bodies, loaded, seen, contacts, scene_.stepping, summary_.envelope, gravity_step());
    ContactProblem<Real>& problem = assembled.problem;
    SetupSums& sums = assembled.sums;
    if (impacts.rounds > 0) {  // the speeds of before measure what the step had to do
      sums.approach_squares = impacts.before.touching_squares;
      sums.touching = impacts.before.touching;
    }
    problem.mark = mark.view();
    const Offset contacts_of_all = problem.all_contacts;
    typename Joints<B, Real>::Worst worst;
    if (joints_.count() > 0) {
      joints_.join(b, bodies, scene_.stepping, periodic_box().length, assembled, gamma);
      assembly_.share(b, assembled);  // joints are among what bodies have
      worst = joints_.worst(b);
      report.max_joint_error = worst.error;
      report.max_joint_error_joint = worst.joint;
    }
    const double reference = reference_speed(loads_.is_used() ? &loads : nullptr, h * gravity_,
                                             joints_.motor_speed(), sums, store_.owned_count());
    report.ms.setup = clock.lap();
    if (stored != nullptr) {
      *stored = download_any_problem<B, Real>(b, problem, gamma, store_.ids(), bodies);
      stored->source = problem_source<B, Real>(scene_, steps_done() + 1, time(), reference);
      clock.lap();  // belongs to no stage
    }

    const double tolerance =
        residual_tolerance(scene_.solver.stop, reference, summary_.median_diameter, h, steepest_);
    if (joints_.count() > 0 && tolerance > 0)
      joints_.guess(b, bodies, problem, gamma, scene_.solver.warm_start);
    SolveStats stats = solver_->solve(b, problem, gamma, tolerance);
    if (joints_.count() > 0 && tolerance > 0)
      correct_joints(
          b, joints_, bodies, *solver_, problem, gamma,
          {scene_, tolerance, reference, worst.error, worst.way_back,
           (shared_ ? contacts_of_all : contacts.count) > 0},
          stats,
          [&] {
            return joints_.correct(b, bodies, problem, scene_.stepping, periodic_box().length,
                                   solver_->velocity());
          },
          [&] {
            if (stored != nullptr) store_biases(b, problem, *stored);
          });
    stats.iterations += impacts.iterations;
    stats.applications += impacts.applications;
    stats.converged = stats.converged && impacts.converged;
    if (stats.residual.bad_contact >= 0) {
      const Index here = shared_ ? stats.residual.own_bad_contact : stats.residual.bad_contact;
      throw_on_all(ranks_.get(), here >= 0, [&] { report_bad_contact(problem, here); });
    }
    report.ms.solve = impact_ms + clock.lap();

    if (joints_.count() > 0) joints_.keep(b, bodies, h, gamma);
    if (tracks_forces_) sum_forces(bodies, contacts, gamma, problem.rolling);
    IntegrateSums moved =
        integration_.run(b, bodies, solver_->velocity(), summary_.layout, h, periodic_box(),
                         detector_.walls(), detector_.held_pairs(), seen, obstacles_.shapes());
    solver_->forget_velocity();  // in favor of the next search for contacts
    loads_.finish();
    const Index bad_body = moved.bad_body;
    moved = over_ranks(backend(), moved);
    if (moved.bad_body >= 0)
      throw_on_all(ranks_.get(), bad_body >= 0, [&] { report_bad_body(bad_body); });
    for_each(b, static_cast<Index>(vectors),
             AverageImpulses<Real>{gamma.first(vectors), guess.view()});
    detector_.keep(vectors_per_contact(summary_.layout), std::move(guess));
    impulse_ = std::move(impulse);
    if (keeps_marks()) detector_.keep_marks(std::move(mark));
    has_solved_contacts_ = true;
    this->count_step();
    motion_.set(store_, time(), steps_done() + 1);
    report.ms.integrate = clock.lap();

    report.step = steps_done();
    report.time = time();
    report.contact_count = shared_ ? contacts_of_all : contacts.count;
    if (shared_) stats.residual.max_contact = stats.residual.own_max_contact;
    fill_report(report, stats, sums, problem, b, store_);
    if (joints_.count() > 0 && stats.residual.max_contact >= problem.joint_begin)
      report.residual_max_joint =
          joints_.number_of(b, stats.residual.max_contact - problem.joint_begin);
    report.residual_relative = reference > 0 ? stats.residual.rms / reference : 0;
    report.kinetic_energy = moved.kinetic_energy;
    report.stopped = moved.stopped;
    if (!shared_) {
      require_finite(report);
    } else if (const StepReport own = report;
               !add_report(*ranks_, shared_->ghosts().count(), stats.residual.own_max,
                           is_finite(own), report)) {
      throw_on_all(ranks_.get(), !is_finite(own), [&] { require_finite(own); });
    }
    return report;
  }

  int body_count() const override {
    return shared_ ? loading_.id_end() : store_.ranges().without_ghosts().present_count();
  }
  BodyStates states() override {
    BodyStates own = store_.states(loading_.id_end());
    if (shared_) gather_states(*ranks_, store_.owned_ids(), own);
    return own;
  }

  void begin_own_bodies(OwnBodiesSink& sink, std::optional<double> resumed_time) override {
    on_all_ranks(ranks_.get(), [&] { sink.begin(this->constants(), resumed_time); });
  }
  std::vector<std::int64_t> give_own_bodies(OwnBodiesSink& sink) override {
    if (!shared_) return Dynamics::give_own_bodies(sink);
    std::int64_t given = 0;
    on_all_ranks(ranks_.get(), [&] {
      const OwnBodies bodies = store_.own_bodies(/*with_fixed=*/ranks_->rank() == 0);
      sink.take(time(), bodies, this->constants());
      given = std::ssize(bodies.id);
    });
    return gather(*ranks_, given);
  }

  bool bodies_may_change() const override { return !shared_; }
  bool has_body(int id) const override { return loading_.has_come(id) && !is_removed(id); }
  int id_end() const override { return loading_.id_end(); }
  std::uint64_t insertions_done() const override { return loading_.insertions_done(); }
  void change_bodies(const std::vector<int>& removed) override {
    removed_ = removed;
    loading_.insert_added();
    store_.drop(removed_);
    parts_.forget();
  }
  WorldState leave() override {
    WorldState s = this->save();
    leave_naming(naming(), obstacles_.part_owners(), s);
    loads_.leave(backend(), s);
    if (tracks_forces_) forces_.leave(s);
    return s;
  }
  void enter(const WorldState& left) override {
    loading_.insert_first(left.insertions_done);
    store_.drop(removed_);
    WorldState own;
    store_.save_owned(own);
    WorldState s = left;
    change_state(naming(), removed_, own, s);
    tracks_forces_ = s.has("run/force");
    this->restore(s);
    if (tracks_forces_) forces_.enter(s);
    enter_loads(s);
  }

  void restore_after(const WorldState& left, const WorldState& state) override {
    tracks_forces_ = left.has("run/force");
    this->restore(state);
    enter_loads(left);
  }

  std::vector<ContactRecord> contacts() override {
    if (!has_solved_contacts_) return kept_records_;  // on all ranks
    std::vector<ContactRecord> out = records(download(backend(), solved_impulses()));
    add_impacts(backend(), impacts_.impulses(), vectors(), out);
    if (shared_) gather_counted(out);
    return out;
  }

  std::vector<JointRecord> joints() override { return joints_.records(backend()); }

  void track_forces() override { tracks_forces_ = true; }
  MeanForces take_forces() override {
    if (!tracks_forces_) throw_untracked_forces("take_forces()");
    MeanForces means = forces_.take(scene_.stepping.time_step);
    if (shared_) add_over_ranks(*ranks_, means);
    return means;
  }
  ForceRecord force_on_body(int body) override {
    if (!tracks_forces_) throw_untracked_forces("force_on()");
    return sum_over_ranks(forces_.on_body(body, scene_.stepping.time_step));
  }
  ForceRecord force_on_group(int group) override {
    if (!tracks_forces_) throw_untracked_forces("force_on_group()");
    return sum_over_ranks(forces_.on_group(group, scene_.stepping.time_step));
  }

  void set_gravity(const Vec3d& gravity) override {
    require_gravity(gravity, scene_.stepping.time_step);
    gravity_ = gravity;
  }
  void set_velocity(int body, const Vec3d& velocity, const Vec3d& angular_velocity) override {
    require_velocity(body, velocity, angular_velocity, scene_.stepping.time_step);
    const BodyView<Real> bodies = store_.view();
    for_each(backend(), bodies.owned_count,
             WriteVelocity<Real>{bodies, body, Vec3<Real>(velocity), Vec3<Real>(angular_velocity)});
  }
  void set_motion(int body, const Motion& motion) override {
    motion_.replace(scene_, body, motion, time(), has_arms());
    motion_.set(store_, time(), steps_done() + 1);
  }
  void apply_force(int body, const Vec3d& force, const Vec3d& torque) override {
    require_load(body, force, torque);
    if (shared_) throw_not_over_ranks("apply_force()");
    loads_.apply(backend(), body, force, torque);
  }

  std::vector<ContactRecord> overlaps() override {
    forget_solved_contacts();
    if (shared_) shared_->renew_ghosts(detector_.range_of(store_.view(), 0, {}, 0));
    const BodyView<Real> bodies = store_.view();
    detector_.detect(backend(), parts_.place(bodies), 0, {}, 0, parts_.of(bodies));
    std::vector<ContactRecord> found = records({});
    if (shared_) gather_counted(found);
    std::erase_if(found, [](const ContactRecord& contact) { return !(contact.gap < 0); });
    return found;
  }

  void arrays_changed(Written what) override {
    if (shared_) throw_not_over_ranks("arrays_changed()");
    B& b = backend();
    const bool poses = what == Written::poses;
    const BodyView<Real> bodies = store_.view();
    Buffer<B, FirstBad> first(b, 1);
    reduce<FirstBad>(
        b, bodies.owned_count,
        TakeWrittenState<Real>{bodies, scene_.stepping.time_step, periodic_box(), poses},
        StoreResult<FirstBad>{first.data()});
    const Index bad = fetch(b, first.data()).body;
    if (poses) {
      detector_.forget_places();
      joints_.forget(b);
      solver_->restore_memory({});
      forget_solved_contacts();
    }
    if (bad < 0) return;
    throw_bad_written(store_.id_of(bad), fetch(b, bodies.position.data + bad),
                      Quatd(fetch(b, bodies.orientation.data + bad)),
                      Vec3d(fetch(b, bodies.velocity.data + bad)),
                      Vec3d(fetch(b, bodies.angular_velocity.data + bad)));
  }

 private:
  /// Steps between two sorts of the bodies; a function of the step number only, so
  /// that a resumed run reorders at the same steps.
  static constexpr std::int64_t kReorderEvery = 64;

  using ModelOn<B, Real>::backend;

  void save_arrays(WorldState& s) override {
    s.insertions_done = loading_.insertions_done();
    if (shared_) {
      put_contacts_aside();
      shared_->save(s);
    } else {
      save_state(backend(), store_, parts_, id_count(), detector_, *solver_, s);
    }
    joints_.save(backend(), s);
    if (tracks_forces_) forces_.save(s);
    if (tracks_forces_ && shared_) add_array(*ranks_, "force/sum", s);
    motion_.save(s);
    loads_.save(s);
    if (!(gravity_ == scene_.gravity)) s.add("world/gravity", std::vector<Vec3d>{gravity_});
  }

  void restore_arrays(const WorldState& s) override {
    // First what may be refused whatever the bodies are.
    PrescribedMotion motion = motion_;
    motion.restore(scene_, s, has_arms());
    const Vec3d gravity =
        s.has("world/gravity") ? saved_gravity(s, scene_.stepping.time_step) : scene_.gravity;
    joints_.check(s);
    loads_.check(s);
    loading_.insert_first(s.insertions_done);
    store_.drop(removed_);
    forget_solved_contacts();
    if (shared_) {
      shared_->restore(s);
    } else {
      restore_state(backend(), s, vectors(), store_, parts_, id_count(), detector_, *solver_);
    }
    joints_.restore(backend(), s);
    loads_.restore(backend(), s, [this](Index id) { return has_body(id); });
    if (tracks_forces_) restore_forces(s);
    motion_ = std::move(motion);
    gravity_ = gravity;
    motion_.set(store_, s.time, s.step + 1);
  }

  /// With several ranks rank 0 has all bodies for the moment, and the others have none to draw.
  Image render(const PictureSettings& settings) override {
    if (!shared_) return ModelOn<B, Real>::render(settings);
    put_contacts_aside();
    Image image;
    shared_->with_all_bodies([&] { image = ModelOn<B, Real>::render(settings); });
    return image;
  }

  typename ModelOn<B, Real>::Drawn drawn() override {
    return {parts_.place(store_.view()), obstacles_.shapes(), obstacles_.mesh_set()};
  }

  void for_each_array(const typename ModelOn<B, Real>::VisitArray& visit) override {
    if (shared_) throw_not_over_ranks("array()");
    for_each_named_array(backend(), store_, loads_, detector_.contacts(), solved_impulses(),
                         vectors(), visit);
  }

  void sum_forces(const BodyView<Real>& bodies, const ContactView<Real>& contacts,
                  Span<const Vec3<Real>> gamma, Span<const RollingRow<Real>> rolling) {
    B& b = backend();
    const Offset of_contacts = static_cast<Offset>(contacts.count) * vectors();
    add_loads(contact_loads<B, Real>(
                  b,
                  {bodies,
                   contacts,
                   gamma.first(of_contacts),
                   vectors(),
                   rolling,
                   {periodic_box().length, detector_.walls().solids, parts_.of(bodies).owner}},
                  impacts_.impulses()),
              forces_);
    if (joints_.count() > 0) forces_.add_joints(joints_.own_records(b));
    forces_.count_step();
  }

  /// The room for free bodies changes: fixed ones move back by so many places.
  void follow_fixed_bodies(Index shift) {
    obstacles_.follow_fixed_bodies(backend(), shift);
    if (parts_.is_used()) {
      parts_.forget();  // detection knows walls by the places of parts
    } else {
      follow_walls(shift);
    }
  }
  /// Walls get other places among what detection sees.
  void follow_walls(Index shift) {
    shared_->remember_contacts();
    detector_.follow_fixed_bodies(backend(), shift);
  }

  std::function<bool(const Vec3d&)> owned_here() const {
    if (!shared_) return {};
    return [shared = shared_.get()](const Vec3d& x) { return shared->owns(x); };
  }

  /// Contact frames show the last step, whatever a picture or a checkpoint does to bodies before.
  void put_contacts_aside() {
    if (!has_solved_contacts_) return;
    std::vector<ContactRecord> records;
    if (scene_.output.contact_frames) records = contacts();
    forget_solved_contacts();
    kept_records_ = std::move(records);
  }

  /// Sums of all ranks go on at rank 0.
  bool is_removed(Index id) const {
    return std::binary_search(removed_.begin(), removed_.end(), id);
  }
  /// Rows of arrays stay for bodies that are still to come.
  void enter_loads(const WorldState& left) {
    loads_.enter(backend(), left, [this](Index id) { return !is_removed(id); });
  }

  void restore_forces(const WorldState& s) {
    if (!shared_ || ranks_->rank() == 0 || !s.has("force/sum")) return forces_.restore(s);
    WorldState own;
    own.add("force/sum", std::vector<Vec3d>(s.at<Vec3d>("force/sum").size()));
    own.add("force/steps", s.at<double>("force/steps"));
    forces_.restore(own);
  }

  /// Records of the contacts of all ranks, each once, at rank 0.
  void gather_counted(std::vector<ContactRecord>& own) {
    keep_counted(backend(), store_.ranges(), detector_.contacts(), own);
    gather_rows(*ranks_, own);
  }

  ForceRecord sum_over_ranks(const ForceRecord& own) const {
    return shared_ ? added_over_ranks(*ranks_, own) : own;
  }

  ContactNaming naming() const { return {id_count(), summary_.layout}; }
  /// Of all bodies that there can ever be.
  Index id_count() const { return summary_.free_capacity + summary_.fixed_count; }
  int vectors() const { return vectors_per_contact(summary_.layout); }
  /// Marks belong to contacts, and solvers do without any as well.
  bool keeps_marks() const { return solver_->keeps_marks() && joints_.count() == 0; }

  /// Impulses of the contacts that there are; empty when no step found them.
  Span<const Vec3<Real>> solved_impulses() const {
    return has_solved_contacts_ ? impulse_.view(detector_.impulses().size)
                                : Span<const Vec3<Real>>{};
  }
  void forget_solved_contacts() {
    impacts_.forget();
    has_solved_contacts_ = false;
    impulse_.release();
    kept_records_.clear();
  }
  std::vector<ContactRecord> records(const std::vector<Vec3<Real>>& gamma) {
    return contact_records(backend(), store_.ids(), store_.view(), detector_.contacts(), gamma,
                           vectors());
  }

  LoadSums start_loads(const BodyView<Real>& bodies) {
    if (!loads_.is_used()) return {};
    const LoadSums loads =
        loads_.start(backend(), bodies, gravity_step(), scene_.stepping.time_step);
    if (loads.bad_body >= 0) throw_bad_load(steps_done() + 1, store_.id_of(loads.bad_body));
    return loads;
  }

  std::unique_ptr<Solver<B, Real>> make_step_solver() const {
    SolverParams params;
    params.max_iterations = scene_.solver.max_iterations;
    params.check_every = scene_.solver.check_every;
    params.own = scene_.solver.parameters;
    if (!scene_.solver.exact_coulomb) return make_solver<B, Real>(scene_.solver.name, params);
    return make_exact_solver<B, Real>(scene_.solver.name, params,
                                      scene_.solver.max_outer_iterations);
  }

  bool has_impacts() const {
    return assembly_.has_restitution() &&
           scene_.stepping.restitution_law == RestitutionLaw::poisson;
  }

  Vec3<Real> gravity_step() const { return Vec3<Real>(scene_.stepping.time_step * gravity_); }
  bool has_arms() const { return summary_.layout != ContactLayout::radial; }

  void insert_due(double time) {
    if (loading_.insert_due(time)) parts_.forget();
  }

  PeriodicBox periodic_box() const { return scree::periodic_box(scene_.periodicity); }

  /// What programs added stays behind the bodies of the scene.
  LateBodies added_bodies() {
    const Index first = loading_.first_added();
    const auto gone = removed_.end() - std::lower_bound(removed_.begin(), removed_.end(), first);
    const Index count = loading_.id_end() - first - static_cast<Index>(gone);
    if (!loading_.has_added() || count == 0) return {};
    return {store_.view().id.first(store_.owned_count()), first, count};
  }

  /// Sorts the owned bodies along the Morton curve and renames the kept contacts accordingly.
  void reorder() {
    B& b = backend();
    parts_.place(store_.view());  // by the old order
    BodyOrder<B> order(b);
    order.compute(b, store_.view().position.first(store_.owned_count()), added_bodies());
    store_.for_each_array([&](auto& array) { order.apply(b, array.view()); });
    Buffer<B, Index> place(b);
    const Span<const Index> new_of_old = parts_.follow(store_.view(), order.new_of_old(), place);
    detector_.remap(b, parts_.place(store_.view()), new_of_old);
    if (shared_) shared_->follow(order);
  }

  [[noreturn]] void report_bad_body(Index storage) {
    const BodyView<Real> view = store_.view();
    throw_bad_body(steps_done() + 1, store_.id_of(storage),
                   fetch(backend(), view.position.data + storage),
                   Vec3d(fetch(backend(), view.velocity.data + storage)));
  }

  [[noreturn]] void report_bad_contact(const ContactProblem<Real>& problem, Index c) {
    const auto [a, second] = bodies_of(problem, c, backend(), store_);
    throw_bad_contact(steps_done() + 1, a, second);
  }

  std::shared_ptr<Ranks> ranks_;  ///< null: this process alone
  Scene scene_;                   ///< without the descriptions already loaded
  double steepest_ = 1;           ///< see residual_tolerance()
  Vec3d gravity_;                 ///< [m/s^2]
  SceneSummary summary_;
  PrescribedMotion motion_;
  BodyStore<B, Real> store_;
  BodyLoads<B, Real> loads_;
  Obstacles<B, Real> obstacles_;
  PartStore<B, Real> parts_;
  ContactDetector<B, Real> detector_;
  ProblemAssembly<B, Real> assembly_;
  Joints<B, Real> joints_;
  ImpactPhase<B, Real> impacts_;
  Integration<B, Real> integration_;
  ForceTotals forces_;
  bool tracks_forces_ = false;
  std::unique_ptr<Solver<B, Real>> solver_;
  std::unique_ptr<SharedState<B, Real>> shared_;  ///< null without ranks
  std::vector<int> removed_;                      ///< ids of bodies that are no more, rising
  BodyLoading<B, Real> loading_;
  Buffer<B, Vec3<Real>> impulse_;  ///< of the contacts that the detector has, if they are solved
  std::vector<ContactRecord> kept_records_;  ///< of the last step, see put_contacts_aside()
  bool has_solved_contacts_ = false;         ///< the detector has those of the last step
};

template <class B, class Real>
std::unique_ptr<Dynamics> make_rigid(Scene scene, const WorldOptions& options) {
  const bool near_pairs = keeps_near_pairs(scene, options);  // from what is free before all else
  const SceneSummary summary = summarize_run(scene, options);
  const bool is_shared = options.ranks != nullptr && options.ranks->count() > 1;
  RankPlan plan =
      is_shared ? plan_for_ranks(options.ranks, scene) : plan_for_one(summary.free_capacity);
  return std::make_unique<RigidDynamics<B, Real>>(make_backend<B>(options), std::move(scene),
                                                  summary, near_pairs, std::move(plan));
}

}  // namespace scree
