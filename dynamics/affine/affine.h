#pragma once
// Stiff affine bodies with barrier contact: every step makes an incremental potential least, from a state without intersections
// and along ways that have none. docs/theory.md, sections "Affine bodies" and "Barrier contact". All states are in double, whatever
// the precision of the run.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynamics/affine/affine_card.h"
#include "dynamics/affine/affine_setup.h"
#include "dynamics/affine/joint_warnings.h"
#include "dynamics/affine/led_push.h"
#include "dynamics/affine/minimizer.h"
#include "dynamics/affine/nested_bodies.h"
#include "dynamics/affine/push_islands.h"
#include "dynamics/affine/row_states.h"
#include "dynamics/affine/solids.h"
#include "dynamics/affine/start_checks.h"
#include "dynamics/model_on.h"
#include "dynamics/rigid/body_loading.h"
#include "dynamics/rigid/named_arrays.h"
#include "dynamics/rigid/obstacles.h"
#include "dynamics/rigid/part_store.h"
#include "host/scene/body_name.h"
#include "host/scene/motion.h"
#include "host/scene/scene_summary.h"
#include "kernels/affine/step_programs.h"

namespace scree {

template <class B>
class AffineDynamics final : public ModelOn<B, double> {
 public:
  /// @param setup  of the scene. @throws InputError when bodies intersect or touch
  AffineDynamics(std::unique_ptr<B> on, affine::AffineSetup setup, Scene scene)
      : ModelOn<B, double>(std::move(on), scene),
        scene_(std::move(scene)),
        setup_(std::move(setup)),
        summary_(summarize(scene_)),
        store_(backend(), summary_.free_capacity, summary_.fixed_count, shared_constants(scene_),
               summary_.solid_spheres),
        obstacles_(backend(), scene_, store_.fixed_begin()),
        parts_(backend(), obstacles_.data(), obstacles_.shapes(), summary_.fixed_count,
               obstacles_.fixed_part_begin(), PeriodicBox{}),
        rows_(static_cast<Index>(setup_.body_of_row.size())),
        surfaces_(backend(), setup_.surfaces, setup_.surface_of_body, setup_.collision_group,
                  setup_.held_pairs),
        solids_(backend(), setup_.solid),
        minimizer_(backend(), static_cast<Index>(setup_.bodies.size()), rows_, setup_.solid.links,
                   setup_.equations),
        constants_(backend()),
        body_of_row_(backend()),
        friction_(backend()),
        shapes_(backend()),
        q_(backend()),
        v_(backend()),
        earlier_q_(backend(), std::ssize(setup_.bodies)),
        earlier_v_(backend(), std::ssize(setup_.bodies)),
        next_(backend(), std::ssize(setup_.bodies)),
        target_(backend(), rows_),
        rate_(backend(), rows_),
        hit_(backend(), rows_),
        owed_(backend(), rows_),
        led_target_(backend()),
        joints_(backend()),
        drives_(backend(), std::ssize(setup_.drives)),
        joint_position_(backend()),
        body_strain_(backend(), static_cast<Index>(setup_.scene_bodies)),
        led_(setup_.led),
        push_(backend(), setup_, led_) {
    B& b = backend();
    upload(b, setup_.bodies, constants_);
    upload(b, setup_.body_of_row, body_of_row_);
    upload(b, setup_.position, q_);
    upload(b, setup_.velocity, v_);
    std::vector<double> friction;
    for (const Material& pair : all_pair_values(scene_)) friction.push_back(pair.friction);
    has_friction_ = std::any_of(friction.begin(), friction.end(), [](double mu) { return mu > 0; });
    upload(b, friction, friction_);
    upload(b, setup_.drives, joints_);
    upload(b, std::vector<double>(setup_.drives.size(), 0), joint_position_);
    fill(b, hit_.view(rows_), Index{0});
    read_parameters();
    BodyLoading<B, double>(scene_, store_, obstacles_).load_first();
    place_shapes();
    write_poses();  // motions may begin elsewhere than where bodies are described
    minimizer_.keep_places(q_.view());
    require_apart();
    if (const std::vector<affine::Nested> nested = affine::nested_with_elastic(setup_);
        !nested.empty())
      warnings_.push_back(affine::nested_warning(nested, names()));
    for (std::string& each : affine::joint_warnings(setup_, scene_.stepping.time_step))
      warnings_.push_back(std::move(each));
    for (std::size_t b = 0; b < setup_.bodies.size(); ++b)
      if (affine::is_too_stiff(setup_.bodies[b], scene_.stepping.time_step)) {
        warnings_.push_back(affine::stiff_warning(names()(setup_.id_of_body[b])));
        break;
      }
  }

  using ModelOn<B, double>::steps_done;

  StepReport step(BodyProblem* /*problem*/) override {
    B& b = backend();
    StageClock<B> clock(b);
    StepReport report;
    report.own.assign(kPartsColumn + 1, 0);
    report.own[kMinGapColumn] = kNoValue;
    affine::MinimizerReport done;
    const int parts = part_count();
    bool is_slow = false;
    for (int part = 0; part < parts; ++part) {
      const affine::StepScheme scheme = scheme_of(scene_.stepping.time_step / parts);
      affine::Potential p = potential(scheme);
      led_.begin();
      set_out(p, scheme);
      p.barrier.stiffness = barrier_stiffness(p, scheme.h);
      const int blocked = minimize(p, scheme, minimizer_settings(scheme.h), done);
      is_slow = is_slow || led_.is_slow();
      finish(scheme);
      affine::AffineSums sums = sum();
      if (sums.bad_body >= 0) report_bad_body(sums.bad_body);
      if (scheme.is_second && sums.hit > 0) {
        start_anew(p, scheme);
        sums = sum();
      }
      turn_ = sums.turn;
      note_part(report, p, scheme, done, sums, blocked);
    }
    this->count_step();
    fill_report(report, done, parts);
    if (is_slow) ++slow_steps_;
    report.ms.collision = minimizer_.take_near_ms();
    report.ms.solve = done.linear_ms;
    report.ms.setup = done.assembly_ms;
    report.ms.integrate = clock.lap() - report.ms.collision - report.ms.setup - report.ms.solve;
    report.ms.total = report.ms.collision + report.ms.setup + report.ms.solve + report.ms.integrate;
    return report;
  }

  std::vector<std::string> warnings() const override {
    std::vector<std::string> all = warnings_;
    if (worst_strain_ > kStrained)
      all.push_back(affine::strain_warning(worst_strain_, strained_step_));
    if (slow_steps_ > 0)
      all.push_back(affine::blocked_warning(blocked_steps_, slow_steps_, led_.delay(this->time())));
    return all;
  }
  int body_count() const override { return store_.ranges().present_count(); }
  BodyStates states() override {
    write_output();
    BodyStates states = store_.states(static_cast<Index>(store_.ranges().present_count()));
    add_axes(states);
    solids_.add_bent(backend(), q_.view(), states);
    return states;
  }
  void arrays_changed(Written /*what*/) override {}  // none can be written
  void set_gravity(const Vec3d& gravity) override {
    require_gravity(gravity, scene_.stepping.time_step);
    scene_.gravity = gravity;
  }

 private:
  using AffineVec = affine::AffineVec;
  using ModelOn<B, double>::backend;

  /// Most minimizations of a step whose friction is worked out until it does not change.
  static constexpr int kMostFrictionSolves = 100;
  /// Factors of the mass of led bodies: raised until they are where they should be.
  static constexpr double kFirstLead = 1e3, kMostLead = 1e9;
  /// Least reach without a value in the scene, over what it is where bodies begin far apart.
  static constexpr double kLeastReach = 0.01;
  /// Reach over the size of the smallest free body, at most, where the scene does not say: in wide scenes bodies would float.
  static constexpr double kMostReach = 0.01;
  /// Square of the speed at which pairs that begin within reach throw bodies, over gravity times the reach, from which on users
  /// are told.
  static constexpr double kThrow = 20;
  /// Tolerance over what gravity changes a velocity by in a step from which on users are told.
  static constexpr double kLooseTolerance = 0.1;
  /// Without gravity: over what it is without a value in the scene.
  static constexpr double kLooseAtRest = 3;
  /// Ways of Newton steps that end a step, over the reach: gaps are a part of that, and what presses and rubs depends on them.
  static constexpr double kFineWay = 0.01;
  /// Ways of Newton steps that rounding leaves, over the size of the scene.
  static constexpr double kFinest = 1e-12;
  /// Part of their speed by which bodies may become faster in a step without an impact, where led bodies go parts of their way.
  static constexpr double kJerk = 0.1;
  /// Strain of stiff bodies from which on users are told.
  static constexpr double kStrained = 0.05;
  static constexpr int kMostParts = 1024;

  /// Parts of the step to come: a power of two, and half as many as those of the step before at least. bdf2 goes on
  /// as from before to now: over a step of many times that length a push would become a throw.
  int part_count() {
    const double most = kMaxTurn.of(scene_.dynamics.parameters), h = scene_.stepping.time_step;
    if (!(most > 0)) return 1;
    if (!turn_) turn_ = sum().turn;
    const double turn = *turn_ * h, most_led = std::min(most, kMostLedTurn);
    int parts = 1;
    while (parts < kMostParts && (turn > most * parts || led_.turn(h, parts) > most_led ||
                                  (has_earlier_ && h > 2.5 * earlier_step_ * parts)))
      parts *= 2;
    return parts;
  }
  affine::StepScheme scheme_of(double h) const {
    const bool is_second = rule_ == affine::StepRule::bdf2 && has_earlier_;
    return {rule_, is_second, h, scene_.gravity, is_second ? h / earlier_step_ : 1};
  }

  void read_parameters() {
    const ParameterValues& values = scene_.dynamics.parameters;
    rule_ = static_cast<affine::StepRule>(std::lround(kStepRule.of(values)));
    reach_ = kReach.of(values) > 0
                 ? kReach.of(values)
                 : std::min(1e-3 * setup_.size, kMostReach * setup_.least_free_size);
    set_tolerance(kNewtonTolerance.of(values));
  }

  /// Friction and loads change velocities by about as much as gravity does in a step: what ends Newton's method has to be
  /// small beside that. @param given  of the scene; 0: none
  void set_tolerance(double given) {
    const double h = scene_.stepping.time_step, gained = h * norm(scene_.gravity);
    double fitting = 1e-3 * setup_.free_size;
    if (gained > 0) fitting = std::min(fitting, std::max(0.01 * gained, kFinest * setup_.size / h));
    tolerance_ = given > 0 ? given : std::min(fitting, kFineWay * reach_ / h);
    if (tolerance_ > (gained > 0 ? kLooseTolerance * gained : kLooseAtRest * fitting))
      warnings_.push_back(affine::tolerance_warning(tolerance_, gained, fitting));
  }

  /// Pictures find the body of a mesh by its shape: the first of its parts, where there are compounds.
  void place_shapes() {
    const ObstacleData<double>& data = obstacles_.data();
    std::vector<ShapeRecord<double>> shapes = data.shapes;
    Index place = 0;
    for (std::size_t body = 0; body < setup_.scene_bodies; ++body) {
      const Index shape = obstacles_.shape(setup_.id_of_body[body]);
      Index parts = 1;
      if (shape >= 0) {
        ShapeRecord<double>& record = shapes[static_cast<std::size_t>(shape)];
        record.body = place;
        if (shape_card(record.kind).is_compound) {
          const auto k = static_cast<std::size_t>(record.mesh);
          parts = data.first_part[k + 1] - data.first_part[k];
        }
      }
      place += parts;
    }
    upload(backend(), shapes, shapes_);
  }

  affine::Potential potential(const affine::StepScheme& scheme) {
    affine::Potential p;
    p.bodies = constants_.view(std::ssize(setup_.bodies));
    p.body_of_row = body_of_row_.view(rows_);
    p.start = q_.view();
    p.target = target_.view();
    p.friction = friction_.view(friction_.capacity());
    p.material_count = static_cast<Index>(scene_.materials.size());
    p.barrier.reach = reach_;
    p.barrier.separation = kSeparation.of(scene_.dynamics.parameters);
    p.law.slip = kSlipSpeed.of(scene_.dynamics.parameters) * scheme.h;
    p.scale = scheme.scale();
    p.lead = kFirstLead;
    return p;
  }
  affine::StepStates states(bool with_earlier) {
    affine::StepStates s;
    s.q = q_.view(), s.v = v_.view();
    if (with_earlier) s.earlier_q = earlier_q_.view(), s.earlier_v = earlier_v_.view();
    return s;
  }
  affine::MinimizerSettings minimizer_settings(double h) const {
    const ParameterValues& values = scene_.dynamics.parameters;
    return {tolerance_ * h, static_cast<int>(kNewtonIterations.of(values)), 1e-9 * setup_.size,
            kBarrierStiffness.of(values) == 0};
  }

  /// Targets and near pairs of a step, with the part of it that led bodies try.
  /// @param anew  whether bodies are not where the last step left them
  void set_out(affine::Potential& p, const affine::StepScheme& scheme, bool anew = false) {
    B& b = backend();
    upload(b, led_.targets(scheme.h), led_target_);
    for_each(b, rows_,
             affine::SetTargets{scheme, p.bodies, p.body_of_row, states(scheme.is_second),
                                led_target_.view(led_.count()), setup_.first_led_row,
                                target_.view(), rate_.view()});
    copy(b, Span<const AffineVec>(q_.view()), next_.view());
    const auto joints = static_cast<Index>(setup_.drives.size());
    for_each(b, joints,
             affine::SetDrives{joints_.view(joints), p.start, scheme.h,
                               joint_position_.view(joints), drives_.view(joints)});
    p.drives = drives_.view(joints);
    p.lead = kFirstLead;
    minimizer_.begin(surfaces_, p, v_.view(), scheme.h, anew);
  }

  /// That of the scene, or one whose force at half the reach moves the mean mass by three times the reach in a step: about as
  /// stiff as inertia is, where Newton's method takes fewest iterations.
  double barrier_stiffness(const affine::Potential& p, double h) const {
    const double given = kBarrierStiffness.of(scene_.dynamics.parameters);
    if (given > 0) return given;
    affine::Barrier unit = p.barrier;
    unit.stiffness = 1;
    const double half = unit.separation + 0.5 * unit.reach;
    const double force = -2 * half * unit(half * half).first;
    return 3 * setup_.mean_mass * unit.reach / (h * h * force);
  }

  /// Minimizes until friction is as it should be.
  void minimize_with_friction(affine::Potential& p, const affine::MinimizerSettings& settings,
                              affine::MinimizerReport& done) {
    const int wanted = static_cast<int>(kFrictionSolves.of(scene_.dynamics.parameters));
    const int solves = !has_friction_ ? 1 : wanted == 0 ? kMostFrictionSolves : wanted;
    if (has_friction_) minimizer_.remember_friction(p, next_.view());
    minimizer_.minimize(p, next_.view(), settings, done);
    for (int solve = 1; solve < solves; ++solve) {
      // What sticks is held whatever the normal forces are, but where bodies slide friction that lags by a step feeds swings of
      // bdf2: a box on a slope of 60 degrees took off. Contacts that slid and have opened still had the friction of before.
      const bool slid = minimizer_.slides(p, next_.view(), settings.tolerance);
      minimizer_.remember_friction(p, next_.view());
      if (wanted > 0 && !slid && !minimizer_.slides(p, next_.view(), settings.tolerance)) break;
      const int before = done.iterations;
      minimizer_.minimize(p, next_.view(), settings, done);
      if (done.iterations <= before + 1) break;  // friction changed nothing
    }
  }

  /// Minimizes with led bodies ever heavier until they are where they should be. Where that squeezes a body, all of them go
  /// a smaller part of the step, and where they cannot move they stay. @return led bodies that stay
  int minimize(affine::Potential& p, const affine::StepScheme& scheme,
               const affine::MinimizerSettings& settings, affine::MinimizerReport& done) {
    const double stiffness = p.barrier.stiffness;
    const bool was_converged = done.converged;
    minimize_with_friction(p, settings, done);
    if (led_.count() == 0) return 0;
    while (!led_.stay()) {
      const int missed = push_.count_missed(p, next_.view(), settings.tolerance);
      if (push_.squeezes(p, q_.view(), next_.view()) || (missed > 0 && p.lead >= kMostLead)) {
        led_.shorten(scheme.h);
        set_out(p, scheme, /*anew=*/true);
        p.barrier.stiffness = stiffness;
        done.converged = was_converged;
        minimize_with_friction(p, settings, done);
      } else {
        if (missed == 0) break;
        p.lead *= 10;
        minimizer_.minimize(p, next_.view(), settings, done);
      }
    }
    led_.end(scheme.h);
    return led_.stay() ? led_.count() : 0;
  }
  void finish(const affine::StepScheme& scheme) {
    solids_.join(backend(), next_.view());
    for_each(backend(), rows_,
             affine::FinishStep{scheme, constants_.view(), body_of_row_.view(),
                                states(scheme.is_second), next_.view(), target_.view(),
                                rate_.view(), earlier_q_.view(), earlier_v_.view(),
                                hit_.view(rows_), tolerance_, led_.is_slow() ? kJerk : 0});
    has_earlier_ = true;
    earlier_step_ = scheme.h;
    write_poses();
  }
  /// After a step in which bodies were hit: they and those that they touch, since these share its momentum, go on as if
  /// they had flown freely.
  void start_anew(const affine::Potential& p, const affine::StepScheme& scheme) {
    B& b = backend();
    const affine::PushIslands pushed =
        affine::islands_of_hit(setup_, minimizer_.touching_bodies(p, earlier_q_.view(), q_.view()),
                               download(b, Span<const Index>(hit_.view(rows_))));
    std::vector<Index> mark;
    for (const Index body : setup_.body_of_row)
      mark.push_back(pushed.island[static_cast<std::size_t>(body)] >= 0 ? 1 : 0);
    upload(b, mark, hit_);
    affine::StartAnew anew{
        scheme,    constants_.view(), body_of_row_.view(), hit_.view(rows_),  q_.view(),
        v_.view(), earlier_q_.view(), earlier_v_.view(),   owed_.view(rows_), {}};
    for_each(b, rows_, anew);
    upload(b,
           affine::shared_velocities(setup_, pushed,
                                     download(b, Span<const Vec3d>(owed_.view(rows_)))),
           owed_);
    anew.added = owed_.view(rows_);
    for_each(b, rows_, anew);
    write_poses();
  }
  void write_poses() {
    for_each(
        backend(), rows_,
        affine::WritePoses{constants_.view(), body_of_row_.view(), q_.view(), v_.view(),
                           store_.view(), has_earlier_ ? earlier_step_ : 0, earlier_q_.view()});
  }
  /// Strains, and poses of elastic bodies. Only when they are asked for: a pass goes through a body alone.
  void write_output() {
    const auto count = static_cast<Index>(setup_.scene_bodies);
    for_each(backend(), count, affine::WriteStrains{q_.view(), body_strain_.view(count)});
    solids_.write_poses(backend(), constants_.view(std::ssize(setup_.bodies)), q_.view(), v_.view(),
                        store_.view(), body_strain_.view(count));
  }
  /// What states of rigid bodies lack. Of elastic bodies, of which each part has its own A, that of their pose.
  void add_axes(BodyStates& states) {
    const auto count = static_cast<Index>(setup_.scene_bodies);
    const std::vector<AffineVec> q = download(backend(), std::as_const(q_).view(count));
    const std::vector<double> strain = download(backend(), std::as_const(body_strain_).view(count));
    states.axes.resize(setup_.scene_bodies);
    states.own.assign(1, std::vector<double>(setup_.scene_bodies));
    for (std::size_t body = 0; body < setup_.scene_bodies; ++body) {
      const auto id = static_cast<std::size_t>(setup_.id_of_body[body]);
      states.axes[id] = {q[body].node[1], q[body].node[2], q[body].node[3]};
      states.own[kStrainField][id] = strain[body];
    }
    for (const affine::Solid& solid : setup_.solid.solids) {
      const auto id = static_cast<std::size_t>(solid.id);
      const AffineVec own = affine::pose_coordinates({states.position[id], states.orientation[id]});
      states.axes[id] = {own.node[1], own.node[2], own.node[3]};
    }
  }
  affine::AffineSums sum() {
    return reduce_to_host<affine::AffineSums>(
        backend(), rows_,
        affine::SumBody{constants_.view(), body_of_row_.view(), q_.view(), v_.view(),
                        hit_.view(rows_), store_.view().angular_velocity});
  }

  /// Adds what a part of the step ended with.
  /// @param done  of this part and those before
  void note_part(StepReport& report, const affine::Potential& p, const affine::StepScheme& scheme,
                 const affine::MinimizerReport& done, const affine::AffineSums& sums, int blocked) {
    report.own = {std::min(report.own[kMinGapColumn], std::sqrt(done.squared)),
                  std::max(report.own[kStrainColumn], sums.strain),
                  p.barrier.stiffness,
                  std::max(report.own[kBlockedColumn], static_cast<double>(blocked)),
                  sums.momentum.x,
                  sums.momentum.y,
                  sums.momentum.z,
                  sums.angular.x,
                  sums.angular.y,
                  sums.angular.z,
                  0};
    report.residual_max = std::max(report.residual_max, done.residual / scheme.h);
    report.kinetic_energy = sums.kinetic;
    report.max_turn = std::max(report.max_turn, std::max(sums.turn, sums.led_turn) * scheme.h);
    if (!std::isfinite(sums.kinetic))
      throw_not_finite(steps_done() + 1, "kinetic energy", sums.kinetic);
  }
  void fill_report(StepReport& report, const affine::MinimizerReport& done, int parts) {
    report.step = steps_done();
    report.time = this->time();
    report.body_count = store_.owned_count();
    report.contact_count = done.contacts;
    report.iterations = done.iterations;
    report.applications = done.linear_iterations;
    report.converged = done.converged;
    report.residual_rms = report.residual_max;
    report.own[kPartsColumn] = parts;
    // Pairs farther apart are listed by chance.
    if (!(report.own[kMinGapColumn] < kSeparation.of(scene_.dynamics.parameters) + 3 * reach_))
      report.own[kMinGapColumn] = kNoValue;
    if (report.own[kBlockedColumn] > 0) ++blocked_steps_;
    if (report.own[kStrainColumn] > worst_strain_) {
      worst_strain_ = report.own[kStrainColumn];
      strained_step_ = report.step;
    }
  }

  [[noreturn]] void report_bad_body(Index body) {
    throw_bad_body(steps_done() + 1, setup_.id_of_body[static_cast<std::size_t>(body)],
                   fetch(backend(), q_.data() + body).node[0],
                   fetch(backend(), v_.data() + body).node[0]);
  }

  /// What messages call bodies, by id.
  affine::BodyNames names() {
    return [this](Index id) { return body_name(this->constants(), id, scene_.body_names); };
  }
  /// A step ends without intersections only where it begins without.
  void require_apart() {
    if (rows_ == 0) return;
    const affine::BodyNames name = names();
    affine::require_no_crossing(setup_, name);
    fill(backend(), target_.view(), AffineVec{});  // of no step
    affine::Potential p = potential({rule_, false, scene_.stepping.time_step, scene_.gravity});
    minimizer_.begin_at_rest(surfaces_, p);
    minimizer_.take_near_ms();  // of no step
    const double separation = p.barrier.separation;
    if (const auto near = features_within(p, separation + affine::touching_gap(setup_)))
      affine::throw_touching(setup_, near->first, near->second, separation, name);
    const double least = minimizer_.least_distance(p, q_.view()), gap = least - separation;
    if (!(kReach.of(scene_.dynamics.parameters) > 0))
      reach_ = std::clamp(gap, kLeastReach * reach_, reach_);
    p.barrier.reach = reach_;
    p.barrier.stiffness = barrier_stiffness(p, scene_.stepping.time_step);
    const double energy = p.barrier(least * least).value;
    const double speed = std::sqrt(2 * energy / setup_.mean_mass);
    if (!(speed * speed > kThrow * norm(scene_.gravity) * reach_)) return;
    if (const auto near = features_within(p, least * (1 + 1e-9))) {
      const auto of = [&](Index body) {
        return name(setup_.id_of_body[static_cast<std::size_t>(body)]);
      };
      const auto& [first, second] = near->second.body;
      warnings_.push_back(affine::throw_warning(of(first), of(second), gap, reach_, speed));
    }
  }
  /// Features of two bodies that are no farther apart than a distance, if there are such.
  std::optional<std::pair<affine::NearPair, affine::BodyPair>> features_within(
      const affine::Potential& p, double distance) {
    const Index found = minimizer_.touching(p, q_.view(), distance);
    if (found < 0) return std::nullopt;
    const affine::NearPair near = fetch(backend(), p.near.pairs.data + found);
    return std::pair(near, fetch(backend(), p.near.bodies.data + near.bodies));
  }

  void save_arrays(WorldState& s) override {
    write_output();
    store_.save_owned(s);
    s.add("affine/position", nodes(q_));
    s.add("affine/velocity", nodes(v_));
    s.add("affine/earlier_position", has_earlier_ ? nodes(earlier_q_) : std::vector<Vec3d>{});
    s.add("affine/earlier_velocity", has_earlier_ ? nodes(earlier_v_) : std::vector<Vec3d>{});
    s.add("affine/earlier_step",
          has_earlier_ ? std::vector<double>{earlier_step_} : std::vector<double>{});
    s.add("affine/joint_position",
          download(backend(), joint_position_.view(std::ssize(setup_.drives))));
    s.add("affine/led_time", led_.time());
    if (led_.count() > 0) s.add("affine/led_part", led_.part());
    save_near_list(s);
    if (!(scene_.gravity == first_gravity_))
      s.add("world/gravity", std::vector<Vec3d>{scene_.gravity});
  }
  void restore_arrays(const WorldState& s) override {
    const auto& id = s.template at<std::int32_t>("body/id");
    const auto n = static_cast<std::size_t>(store_.owned_count());
    if (id.size() != n) throw_wrong_body_count(id.size(), n);
    store_.restore_owned(s);
    put_nodes(s.template at<Vec3d>("affine/position"), q_);
    put_nodes(s.template at<Vec3d>("affine/velocity"), v_);
    const auto& earlier = s.template at<Vec3d>("affine/earlier_position");
    has_earlier_ = !earlier.empty();
    if (has_earlier_) {
      put_nodes(earlier, earlier_q_);
      put_nodes(s.template at<Vec3d>("affine/earlier_velocity"), earlier_v_);
      const auto& step = s.template at<double>("affine/earlier_step");
      if (step.size() != 1 || !(step[0] > 0)) throw_bad_earlier_step();
      earlier_step_ = step[0];
    }
    led_.restore(s.template at<double>("affine/led_time"),
                 s.has("affine/led_part") ? s.template at<double>("affine/led_part")
                                          : std::vector<double>{1, 1});  // an older state
    const auto& position = s.template at<double>("affine/joint_position");
    if (position.size() != setup_.drives.size())
      throw_wrong_body_count(position.size(), setup_.drives.size());
    upload(backend(), position, joint_position_);
    restore_near_list(s);
    turn_.reset();
    write_poses();
    scene_.gravity =
        s.has("world/gravity") ? saved_gravity(s, scene_.stepping.time_step) : first_gravity_;
  }
  /// The list that the next step goes on with: what it holds beside near pairs decides last bits.
  void save_near_list(WorldState& s) {
    affine::NearList<B>& near = minimizer_.near();
    s.add("affine/near_list", near.state().numbers());
    s.add("affine/near_from", nodes(near.from()));
    s.add("affine/near_to", nodes(near.to()));
  }
  /// Without one in an older state, pairs near where bodies are.
  void restore_near_list(const WorldState& s) {
    affine::NearList<B>& near = minimizer_.near();
    const bool is_there = s.has("affine/near_list");
    const auto state = is_there
                           ? affine::NearListState::of(s.template at<double>("affine/near_list"))
                           : affine::NearListState{.room = reach_};
    put_nodes(s.template at<Vec3d>(is_there ? "affine/near_from" : "affine/position"), near.from());
    put_nodes(s.template at<Vec3d>(is_there ? "affine/near_to" : "affine/position"), near.to());
    affine::Barrier barrier;
    barrier.reach = reach_;
    barrier.separation = kSeparation.of(scene_.dynamics.parameters);
    near.restore(surfaces_, barrier, state);
    minimizer_.take_near_ms();  // of no step
  }
  std::vector<Vec3d> nodes(Buffer<B, AffineVec>& array) {
    return affine::row_states(backend(), setup_, array);
  }
  void put_nodes(const std::vector<Vec3d>& from, Buffer<B, AffineVec>& array) {
    affine::restore_row_states(backend(), setup_, from, array);
  }

  typename ModelOn<B, double>::Drawn drawn() override {
    write_output();
    solids_.draw(backend(), q_.view(), store_.view(),
                 [&](Index id) { return obstacles_.vertices_of(id); });
    return {parts_.place(store_.view()), shapes_.view(shapes_.capacity()), obstacles_.mesh_set()};
  }

  void for_each_array(const typename ModelOn<B, double>::VisitArray& visit) override {
    write_output();
    const BodyView<double> bodies = store_.view();
    const Index n = store_.owned_count();
    const auto rows = [n](const auto* data) { return [data, n] { return array_of(data, n); }; };
    visit({"position", "m", "center of mass, world frame", false}, rows(bodies.position.data));
    visit({"velocity", "m/s", "of the center of mass, world frame", false},
          rows(bodies.velocity.data));
    visit({"orientation", "1", "body to world, unit quaternion w x y z", false},
          rows(bodies.orientation.data));
    visit({"angular_velocity", "rad/s", "world frame", false}, rows(bodies.angular_velocity.data));
    visit({"strain", "1", "how far from rigid it is, |A^T A - I|", false},
          rows(static_cast<const double*>(body_strain_.data())));
    visit({"id", "1", "index of the body in the scene", false}, rows(bodies.id.data));
  }

  Scene scene_;                        ///< without the descriptions already loaded
  std::vector<std::string> warnings_;  ///< of the scene
  double worst_strain_ = 0;            ///< of the steps so far
  std::int64_t strained_step_ = 0, blocked_steps_ = 0, slow_steps_ = 0;
  Vec3d first_gravity_ = scene_.gravity;
  affine::AffineSetup setup_;
  SceneSummary summary_;
  BodyStore<B, double> store_;  ///< bodies as rigid ones, for output and pictures; never reordered
  Obstacles<B, double> obstacles_;
  PartStore<B, double> parts_;  ///< of compounds, for pictures
  Index rows_;
  affine::SurfaceTables<B> surfaces_;
  affine::Solids<B> solids_;
  affine::Minimizer<B> minimizer_;
  affine::StepRule rule_ = affine::StepRule::bdf2;
  double reach_ = 0, tolerance_ = 0;  ///< [m], [m/s]
  bool has_friction_ = false;
  std::optional<double> turn_;  ///< largest angular velocity of stiff bodies, once known [rad/s]
  bool has_earlier_ = false;    ///< whether there was a step before
  double earlier_step_ = 0;     ///< how long that took [s]
  Buffer<B, affine::BodyConstant> constants_;
  Buffer<B, Index> body_of_row_;
  Buffer<B, double> friction_;
  Buffer<B, ShapeRecord<double>> shapes_;
  Buffer<B, AffineVec> q_, v_, earlier_q_, earlier_v_;  ///< by body
  Buffer<B, AffineVec> next_;                           ///< by body, while a step is made
  Buffer<B, AffineVec> target_, rate_;                  ///< by row
  Buffer<B, Index> hit_;                                ///< by row, in the last step
  Buffer<B, Vec3d> owed_;                               ///< by row, after impacts
  Buffer<B, AffineVec> led_target_;
  Buffer<B, affine::DrivenJoint> joints_;
  Buffer<B, affine::DriveTerm> drives_;  ///< of the step
  Buffer<B, double> joint_position_;     ///< where the last step began [m or rad]
  Buffer<B, double> body_strain_;        ///< by body of the scene, see write_output()
  affine::LedMotion led_;
  affine::LedPush<B> push_;
};

template <class B, class Real>
std::unique_ptr<Dynamics> make_affine(Scene scene, const WorldOptions& options) {
  affine::AffineSetup setup = affine::affine_setup(scene);
  return std::make_unique<AffineDynamics<B>>(make_backend<B>(options), std::move(setup),
                                             std::move(scene));
}

}  // namespace scree
