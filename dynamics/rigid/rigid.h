#pragma once
// One time step, stage by stage, on backend B with solver precision Real.

#include <algorithm>
#include <chrono>
#include <cmath>

#include "collision/body_order.h"
#include "collision/contact_detector.h"
#include "dynamics/dynamics.h"
#include "dynamics/model_errors.h"
#include "dynamics/rigid/body_store.h"
#include "dynamics/rigid/impact_phase.h"
#include "dynamics/rigid/named_arrays.h"
#include "dynamics/rigid/obstacles.h"
#include "dynamics/rigid/problem_assembly.h"
#include "host/problems/download_problem.h"
#include "host/render/labels.h"
#include "host/render/renderer.h"
#include "host/scene/motion.h"
#include "host/scene/scene_summary.h"
#include "host/version.h"
#include "kernels/step/integrate.h"
#include "kernels/step/written_state.h"
#include "solvers/coulomb.h"
#include "solvers/solver.h"

namespace scree {

/// Wall clock of a stage; waits for the device so that stages do not run into each other.
template <class B>
class StageClock {
 public:
  explicit StageClock(B& b) : b_(&b), last_(Clock::now()) {}
  double lap() {
    b_->synchronize();
    const auto now = Clock::now();
    return std::chrono::duration<double, std::milli>(now - std::exchange(last_, now)).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  B* b_;
  Clock::time_point last_;
};

template <class B, class Real>
class RigidDynamics final : public Dynamics {
 public:
  /// @param near_pairs  whether the list of near pairs is kept between steps
  RigidDynamics(std::unique_ptr<B> backend, Scene scene, bool near_pairs)
      : backend_(std::move(backend)),
        scene_(std::move(scene)),
        summary_(summarize(scene_)),
        constants_(scene_),
        store_(*backend_, summary_.free_capacity, summary_.fixed_count, shared_constants(scene_),
               summary_.solid_spheres),
        loads_(*backend_, store_.count()),
        obstacles_(*backend_, scene_, store_.fixed_begin()),
        detector_(*backend_, collision_settings(near_pairs), obstacles_.data()),
        assembly_(*backend_, scene_, summary_.layout, summary_.solid_spheres),
        impacts_(*backend_, scene_, summary_.layout),
        integrate_sums_(*backend_, 1),
        renderer_(*backend_),
        solver_(make_step_solver()) {
    load_bodies();
    insert_due();
  }

  StepReport step(BodyProblem* stored) override {
    B& b = *backend_;
    const double h = scene_.stepping.time_step;
    StageClock<B> clock(b);
    StepReport report;

    insert_due();
    set_motion(time_);
    if (step_ % kReorderEvery == 0) reorder();
    const BodyView<Real> bodies = store_.view();
    const LoadSums loads = start_loads(bodies);
    BodyView<Real> loaded = loads_.loaded(b, bodies);
    detector_.detect(b, loaded, h, Vec3d(gravity_step()), loads.largest);
    const ContactView<Real> contacts = detector_.contacts();
    const Offset vectors =
        static_cast<Offset>(contacts.count) * vectors_per_contact(summary_.layout);
    Buffer<B, Vec3<Real>> impulse(b, vectors);
    const Span<Vec3<Real>> gamma = impulse.view();
    if (scene_.solver.warm_start) {
      detector_.match(b, vectors_per_contact(summary_.layout), gamma);
    } else {
      fill(b, gamma, Vec3<Real>{});
    }
    Buffer<B, Index> mark(b, solver_->keeps_marks() ? contacts.count : 0);
    if (solver_->keeps_marks()) detector_.match_marks(b, mark.view());
    detector_.forget();  // the last step, in favor of the solver's memory
    report.ms.collision = clock.lap();

    ImpactStats impacts;
    if (has_impacts()) {
      impacts = impacts_.run(b, assembly_, bodies, contacts, scene_.stepping, summary_.envelope,
                             gravity_step(), loads_.gains());
      if (impacts.rounds > 0) loaded = loads_.loaded(b, bodies);  // loads come after impacts
    }
    const double impact_ms = clock.lap();

    StepProblem<B, Real> assembled = assembly_.assemble(
        b, bodies, loaded, contacts, scene_.stepping, summary_.envelope, gravity_step());
    ContactProblem<Real>& problem = assembled.problem;
    SetupSums& sums = assembled.sums;
    if (impacts.rounds > 0) {  // the speeds of before measure what the step had to do
      sums.approach_squares = impacts.before.touching_squares;
      sums.touching = impacts.before.touching;
    }
    problem.mark = mark.view();
    const double reference = reference_speed(loads, sums);
    report.ms.setup = clock.lap();
    if (stored != nullptr) {
      *stored = download_problem<B, Real>(b, problem, gamma, store_.ids(), bodies.fixed_begin);
      stored->source = problem_source(reference);
      clock.lap();  // belongs to no stage
    }

    SolveStats stats = solver_->solve(b, problem, gamma, tolerance(reference));
    stats.iterations += impacts.iterations;
    stats.applications += impacts.applications;
    stats.converged = stats.converged && impacts.converged;
    if (stats.residual.bad_contact >= 0) report_bad_contact(contacts, stats.residual.bad_contact);
    report.ms.solve = impact_ms + clock.lap();

    const IntegrateSums moved = integrate(bodies);
    solver_->forget_velocity();  // in favor of the next search for contacts
    loads_.finish();
    if (moved.bad_body >= 0) report_bad_body(moved.bad_body);
    detector_.keep(vectors_per_contact(summary_.layout), std::move(impulse));
    if (solver_->keeps_marks()) detector_.keep_marks(std::move(mark));
    has_solved_contacts_ = true;
    ++step_;
    time_ = static_cast<double>(step_) * h;
    set_motion(time_);
    report.ms.integrate = clock.lap();

    fill_report(report, stats, sums, contacts);
    report.residual_relative = reference > 0 ? stats.residual.rms / reference : 0;
    report.kinetic_energy = moved.kinetic_energy;
    report.stopped = moved.stopped;
    require_finite(report);
    return report;
  }

  std::int64_t steps_done() const override { return step_; }
  double time() const override { return time_; }
  int body_count() const override {
    return store_.free_count() + store_.count() - store_.fixed_begin();
  }
  BodyStates states() override { return store_.states(); }
  const BodyConstants& constants() const override { return constants_; }

  std::vector<ContactRecord> contacts() override {
    std::vector<ContactRecord> out = records(download(*backend_, solved_impulses()));
    const int vectors = vectors_per_contact(summary_.layout);
    for (const ImpactImpulses<B, Real>& round : impacts_.impulses()) {
      const auto contact = download(*backend_, round.contact.view(round.count));
      const auto impulse = download(*backend_, round.gamma.view(round.gamma.capacity()));
      for (std::size_t k = 0; k < contact.size(); ++k)
        out[static_cast<std::size_t>(contact[k])].impulse +=
            Vec3d(impulse[k * static_cast<std::size_t>(vectors)]);
    }
    return out;
  }

  std::vector<ContactRecord> overlaps() override {
    impacts_.forget();
    has_solved_contacts_ = false;
    detector_.detect(*backend_, store_.view(), 0, {});
    std::vector<ContactRecord> found = records({});
    std::erase_if(found, [](const ContactRecord& contact) { return !(contact.gap < 0); });
    return found;
  }

  std::vector<ArrayInfo> arrays() override {
    std::vector<ArrayInfo> known;
    for_each_array([&](const ArrayInfo& info, auto&&) { known.push_back(info); });
    return known;
  }

  ArrayView array(const std::string& name) override {
    std::optional<ArrayView> found;
    for_each_array([&](const ArrayInfo& info, auto&& make) {
      if (info.name != name) return;
      found = make();
      found->writable = info.writable;
    });
    if (!found) throw_unknown_array(name, arrays());
    backend_->synchronize();
    if constexpr (B::kIsDevice) {
      found->backend = BackendKind::cuda;
      found->device = backend_->device();
      found->stream = backend_->stream();
    }
    return *found;
  }

  void arrays_changed(Written what) override {
    B& b = *backend_;
    const bool poses = what == Written::poses;
    const BodyView<Real> bodies = store_.view();
    Buffer<B, FirstBad> first(b, 1);
    reduce<FirstBad>(
        b, bodies.free_count,
        TakeWrittenState<Real>{bodies, scene_.stepping.time_step, periodic_box(), poses},
        StoreResult<FirstBad>{first.data()});
    const Index bad = fetch(b, first.data()).body;
    if (poses) {
      detector_.forget_places();
      solver_->restore_memory({});
      impacts_.forget();
      has_solved_contacts_ = false;
    }
    if (bad < 0) return;
    throw_bad_written(id_of(bad), fetch(b, bodies.position.data + bad),
                      Quatd(fetch(b, bodies.orientation.data + bad)),
                      Vec3d(fetch(b, bodies.velocity.data + bad)),
                      Vec3d(fetch(b, bodies.angular_velocity.data + bad)));
  }

  WorldState save() override {
    WorldState s;
    s.step = step_;
    s.time = time_;
    s.insertions_done = insertions_done_;
    detector_.save(*backend_, s.contact_key, s.contact_impulse);  // first: needs room to convert
    store_.save_free(s);
    s.solver_memory = solver_->memory();
    const std::vector<Index> marks = detector_.save_marks(*backend_);
    s.solver_memory.insert(s.solver_memory.end(), marks.begin(), marks.end());
    return s;
  }

  void restore(const WorldState& s) override {
    if (s.insertions_done > scene_.insertions.size()) {
      throw_wrong_insertions(s.insertions_done, scene_.insertions.size());
    }
    while (insertions_done_ < s.insertions_done) insert_next();
    const auto n = static_cast<std::size_t>(store_.free_count());
    if (s.id.size() != n) throw_wrong_body_count(s.id.size(), n);
    require_contacts(s, vectors_per_contact(summary_.layout), n);
    impacts_.forget();
    has_solved_contacts_ = false;
    store_.arrange(s.id);
    store_.restore_free(s);
    detector_.restore(*backend_, s.contact_key, s.contact_impulse);
    restore_solver(s.solver_memory, s.contact_key.size());
    step_ = s.step;
    time_ = s.time;
    set_motion(time_);
  }

  Image render(const PictureSettings& settings) override {
    render::ColorRange range;
    Image image = renderer_.render(*backend_, store_.view(), obstacles_.shapes(),
                                   obstacles_.mesh_set(), settings, &range);
    if (settings.labels)
      render::add_labels(image, settings.color_by, range, time_, scene_.stepping.time_step);
    return image;
  }
  int cuda_device() const override {
    if constexpr (B::kIsDevice) {
      return backend_->device();
    } else {
      return -1;
    }
  }
  std::size_t memory() const override { return backend_->allocated(); }
  std::size_t peak_memory() const override { return backend_->peak(); }

 private:
  /// Steps between two checks of the order of the bodies; a function of the step number only, so
  /// that a resumed run reorders at the same steps.
  static constexpr std::int64_t kReorderEvery = 64;

  /// Passes over the arrays that programs may ask for, see for_each_named_array().
  template <class Visit>
  void for_each_array(Visit visit) {
    for_each_named_array(*backend_, store_, loads_, detector_.contacts(), solved_impulses(),
                         vectors_per_contact(summary_.layout), visit);
  }

  /// Impulses of the contacts that there are; empty when no step found them.
  Span<const Vec3<Real>> solved_impulses() const {
    return has_solved_contacts_ ? detector_.impulses() : Span<const Vec3<Real>>{};
  }

  LoadSums start_loads(const BodyView<Real>& bodies) {
    if (!loads_.is_used()) return {};
    const LoadSums loads =
        loads_.start(*backend_, bodies, gravity_step(), scene_.stepping.time_step);
    if (loads.bad_body >= 0) throw_bad_load(step_ + 1, id_of(loads.bad_body));
    return loads;
  }

  IntegrateSums integrate(const BodyView<Real>& bodies) {
    B& b = *backend_;
    const double h = scene_.stepping.time_step;
    const PeriodicBox box = periodic_box();
    const auto along = [&](const auto& way) {
      using Way = std::decay_t<decltype(way)>;
      reduce<IntegrateSums>(
          b, bodies.free_count,
          Integrate<Real, Way>{bodies, solver_->velocity(),
                               summary_.layout == ContactLayout::radial, h, box, way},
          StoreResult<IntegrateSums>{integrate_sums_.data()});
    };
    const WallView<Real> walls = detector_.walls();
    if (walls.solids.size > 0) {
      along(GuardedWay<Real>{bodies, walls, box.length, h});
    } else {
      along(StraightWay<Real>{bodies, h});
    }
    return fetch(b, integrate_sums_.data());
  }

  /// The contacts in host memory.
  /// @param gamma  their impulses; empty: left zero
  std::vector<ContactRecord> records(const std::vector<Vec3<Real>>& gamma) {
    B& b = *backend_;
    const ContactView<Real> view = detector_.contacts();
    const std::vector<Index> id = store_.ids();
    const auto body_a = download(b, view.body_a);
    const auto body_b = download(b, view.body_b);
    const auto normal = download(b, view.normal);
    const auto gap = download(b, view.gap);
    const auto vectors = static_cast<std::size_t>(vectors_per_contact(summary_.layout));
    std::vector<ContactRecord> out(static_cast<std::size_t>(view.count));
    for (std::size_t c = 0; c < out.size(); ++c) {
      out[c] = {id[static_cast<std::size_t>(body_a[c])], id[static_cast<std::size_t>(body_b[c])],
                Vec3d(normal[c]), static_cast<double>(gap[c]),
                gamma.empty() ? Vec3d{} : Vec3d(gamma[c * vectors])};
    }
    return out;
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

  CollisionSettings collision_settings(bool near_pairs) const {
    CollisionSettings settings{summary_.envelope, summary_.layout, periodic_box().length};
    settings.margin_limit = 0.25;
    settings.bounce_threshold = scene_.stepping.restitution_threshold;
    settings.skin = summary_.skin;
    settings.keep_candidates = near_pairs;
    for (const Material& pair : all_pair_values(scene_)) {
      if (!scene_.solver.exact_coulomb) settings.lift = std::max(settings.lift, pair.friction);
      if (scene_.stepping.restitution_law == RestitutionLaw::poisson)
        settings.bounce = std::max(settings.bounce, pair.restitution);
    }
    return settings;
  }

  bool has_impacts() const {
    return assembly_.has_restitution() &&
           scene_.stepping.restitution_law == RestitutionLaw::poisson;
  }

  Vec3<Real> gravity_step() const { return Vec3<Real>(scene_.stepping.time_step * scene_.gravity); }

  PeriodicBox periodic_box() const {
    PeriodicBox box;
    for (int axis = 0; axis < 3; ++axis) {
      if (!scene_.periodicity.periodic[static_cast<std::size_t>(axis)]) continue;
      box.lower[axis] = scene_.periodicity.lower[axis];
      box.length[axis] = scene_.periodicity.upper[axis] - scene_.periodicity.lower[axis];
    }
    return box;
  }

  /// v*: the speed loads give a body in one step (RMS), else that at which touching
  /// bodies approach [m/s].
  double reference_speed(const LoadSums& loads, const SetupSums& sums) const {
    const double speed = loads_.is_used()
                             ? std::sqrt(loads.squares / std::max<Index>(store_.free_count(), 1))
                             : norm(scene_.stepping.time_step * scene_.gravity);
    if (speed > 0) return speed;
    return sums.touching > 0 ? std::sqrt(sums.approach_squares / sums.touching) : 0;
  }

  ProblemSource problem_source(double reference) const {
    ProblemSource s;
    s.scene = scene_.name;
    s.program = std::string("scree ") + version() + " (" + commit() + ")";
    s.backend = B::kName;
    s.precision = std::is_same_v<Real, double> ? "double" : "float";
    s.step = step_ + 1;
    s.time = time_;
    s.time_step = scene_.stepping.time_step;
    s.reference_speed = reference;
    return s;
  }

  /// RMS residual at which the solver stops [m/s]. docs/theory.md, section "Residual".
  double tolerance(double reference) const {
    const double length = summary_.median_diameter / scene_.stepping.time_step;
    const auto level = [&](double speed, double depth) {
      return reference > 0 ? std::min(speed * reference, depth * length) : depth * length;
    };
    switch (scene_.solver.stop.level) {
      case StopRule::Level::quality:
        return level(0.01, 3e-5);
      case StopRule::Level::preview:
        return level(0.03, 1e-4);
      case StopRule::Level::absolute:
        return scene_.solver.stop.residual;
      case StopRule::Level::fixed_iterations:
        break;
    }
    return 0;
  }

  void load_bodies() {
    for (const BodyDescription& body : scene_.bodies) {
      if (body.kind == BodyKind::free) continue;
      walls_.push_back(body);
      has_motion_ = has_motion_ || body.kind == BodyKind::kinematic;
    }
    load(scene_.bodies, scene_.particles);
    set_motion(0);
  }

  /// Uploads bodies, which get the next ids, and frees the host's memory of them as it goes.
  void load(std::vector<BodyDescription>& bodies, std::vector<ParticleSet>& sets) {
    typename BodyStore<B, Real>::Loader free(store_, store_.free_count());
    typename BodyStore<B, Real>::Loader fixed(store_, store_.fixed_begin());
    for (const BodyDescription& body : bodies) {
      auto& loader = body.kind == BodyKind::free ? free : fixed;
      loader.add(body, next_id_, obstacles_.shape(next_id_), bounding_radius(scene_, body));
      ++next_id_;
    }
    bodies = {};
    for (ParticleSet& set : sets) {
      for (std::size_t i = 0; i < set.position.size(); ++i)
        free.add(particle_body(set, i), next_id_++, kSphereShape, set.radius[i]);
      set = {};
    }
    sets = {};
    store_.set_free_count(free.flush());
    fixed.flush();
  }

  void insert_due() {
    // A batch enters before the first step that starts at or after its time;
    // half an ulp of a step of slack.
    const double now = time_ + 1e-9 * scene_.stepping.time_step;
    while (insertions_done_ < scene_.insertions.size() &&
           scene_.insertions[insertions_done_].time <= now) {
      insert_next();
    }
  }

  void insert_next() {
    Insertion& insertion = scene_.insertions[insertions_done_];
    load(insertion.bodies, insertion.particles);
    ++insertions_done_;
  }

  /// Puts kinematic bodies at their pose of time t with the velocity of the step that starts there.
  void set_motion(double t) {
    if (!has_motion_) return;
    const double h = scene_.stepping.time_step;
    std::vector<Vec3d> position;
    std::vector<Quat<Real>> orientation;
    std::vector<Vec3<Real>> velocity, angular_velocity;
    for (const BodyDescription& wall : walls_) {
      const Pose now = pose_at(wall, t);
      const Rates rates = rates_between(now, pose_at(wall, t + h), h);
      if (!is_in_range(now.position) || !is_speed_in_range(norm(rates.velocity), h)) {
        const auto place = store_.fixed_begin() + static_cast<Index>(position.size());
        throw_bad_body(step_ + 1, id_of(place), now.position, rates.velocity);
      }
      position.push_back(now.position);
      orientation.emplace_back(now.orientation);
      velocity.emplace_back(rates.velocity);
      angular_velocity.emplace_back(rates.angular_velocity);
    }
    store_.set_fixed_motion(position, orientation, velocity, angular_velocity);
  }

  /// Sorts the free bodies along the Morton curve and renames the kept contacts accordingly.
  void reorder() {
    B& b = *backend_;
    BodyOrder<B> order(b);
    order.compute(b, store_.view().position.first(store_.free_count()));
    store_.for_each_array([&](auto& array) { order.apply(b, array.view()); });
    detector_.remap(b, store_.view(), order.new_of_old());
  }

  /// @param memory  of the solver, then what it left at each contact; the latter is missing in a
  ///                checkpoint written with another solver
  void restore_solver(std::vector<double> memory, std::size_t contact_count) {
    if (solver_->keeps_marks() && memory.size() >= contact_count) {
      const auto is_mark = [](double value) { return value >= 0 && value < 1 << 30; };
      const std::size_t own = memory.size() - contact_count;
      std::vector<Index> marks(contact_count);
      for (std::size_t c = 0; c < contact_count; ++c)
        marks[c] = is_mark(memory[own + c]) ? static_cast<Index>(memory[own + c]) : -1;
      detector_.restore_marks(*backend_, marks);
      memory.resize(own);
    }
    solver_->restore_memory(memory);
  }

  int id_of(Index storage) { return fetch(*backend_, store_.view().id.data + storage); }

  void fill_report(StepReport& report, const SolveStats& stats, const SetupSums& sums,
                   const ContactView<Real>& contacts) {
    const Residual& residual = stats.residual;
    report.step = step_;
    report.time = time_;
    report.body_count = store_.free_count();
    report.contact_count = contacts.count;
    report.iterations = stats.iterations;
    report.applications = stats.applications;
    report.converged = stats.converged;
    report.residual_rms = residual.rms;
    report.residual_max = residual.max;
    report.exact_residual_rms = residual.exact_rms;
    report.objective = residual.objective;
    report.max_cone_violation = residual.cone_violation;
    report.max_penetration = sums.max_penetration;
    if (residual.max_contact >= 0) {
      report.residual_max_body_a =
          id_of(fetch(*backend_, contacts.body_a.data + residual.max_contact));
      report.residual_max_body_b =
          id_of(fetch(*backend_, contacts.body_b.data + residual.max_contact));
    }
    const StageTimes& t = report.ms;
    report.ms.total = t.collision + t.setup + t.solve + t.integrate;
  }

  /// Sums can overflow where no body and no contact does.
  static void require_finite(const StepReport& r) {
    const std::pair<const char*, double> values[] = {{"residual", r.residual_rms},
                                                     {"largest residual", r.residual_max},
                                                     {"relative residual", r.residual_relative},
                                                     {"exact residual", r.exact_residual_rms},
                                                     {"objective", r.objective},
                                                     {"penetration", r.max_penetration},
                                                     {"cone violation", r.max_cone_violation},
                                                     {"kinetic energy", r.kinetic_energy}};
    for (const auto& [name, value] : values) {
      if (!std::isfinite(value)) throw_not_finite(r.step, name, value);
    }
  }

  [[noreturn]] void report_bad_body(Index storage) {
    const BodyView<Real> view = store_.view();
    throw_bad_body(step_ + 1, id_of(storage), fetch(*backend_, view.position.data + storage),
                   Vec3d(fetch(*backend_, view.velocity.data + storage)));
  }

  [[noreturn]] void report_bad_contact(const ContactView<Real>& contacts, Index c) {
    throw_bad_contact(step_ + 1, id_of(fetch(*backend_, contacts.body_a.data + c)),
                      id_of(fetch(*backend_, contacts.body_b.data + c)));
  }

  std::unique_ptr<B> backend_;
  Scene scene_;  ///< without the descriptions already loaded
  SceneSummary summary_;
  BodyConstants constants_;
  BodyStore<B, Real> store_;
  BodyLoads<B, Real> loads_;
  Obstacles<B, Real> obstacles_;
  ContactDetector<B, Real> detector_;
  ProblemAssembly<B, Real> assembly_;
  ImpactPhase<B, Real> impacts_;
  Buffer<B, IntegrateSums> integrate_sums_;
  Renderer<B, Real> renderer_;
  std::unique_ptr<Solver<B, Real>> solver_;
  std::vector<BodyDescription> walls_;  ///< fixed and kinematic bodies, in storage order
  bool has_motion_ = false;
  Index next_id_ = 0;
  std::uint64_t insertions_done_ = 0;
  std::int64_t step_ = 0;
  double time_ = 0;
  bool has_solved_contacts_ = false;  ///< the detector has those of the last step
};

}  // namespace scree
