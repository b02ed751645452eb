#pragma once
// Bodies in flight that bounce off each other and off fixed walls: the variational collision integrator. Spheres, which need
// not turn, or convex bodies of any shape, which do (rigid_flight.h).
// docs/theory.md, section "Variational collisions". All states are in double, whatever the precision of the run.
//
// Bytes per body and step of a dilute gas: 48 of position and velocity read, 24 of where it was listed, 16 + 4 m of
// its list and 48 m of m neighbors, mostly from the caches, 60 written by the pass of free flight; 96 by the pass that
// takes the state over; 8 by the scan that finds the bodies that meet. These, few, take some 500 bytes an impact more.
// Every 4 to 16 steps all near pairs are listed anew.

#include <algorithm>
#include <optional>

#include "collision/body_order.h"
#include "collision/obstacle_buffers.h"
#include "dynamics/model_on.h"
#include "dynamics/rigid/body_loading.h"
#include "dynamics/rigid/body_store.h"
#include "dynamics/rigid/collision_settings.h"
#include "dynamics/rigid/named_arrays.h"
#include "dynamics/rigid/obstacles.h"
#include "dynamics/variational/island_rounds.h"
#include "dynamics/variational/near_list.h"
#include "dynamics/variational/rigid_flight.h"
#include "dynamics/variational/run_faults.h"
#include "dynamics/variational/variational_card.h"
#include "host/scene/scene_summary.h"
#include "kernels/step/written_state.h"

namespace scree {

template <class B>
class VariationalDynamics final : public ModelOn<B, double> {
 public:
  /// @throws InputError when bodies overlap
  VariationalDynamics(std::unique_ptr<B> on, Scene scene)
      : ModelOn<B, double>(std::move(on), scene),
        scene_(std::move(scene)),
        summary_(summarize(scene_)),
        box_(periodic_box(scene_.periodicity)),
        store_(backend(), summary_.free_capacity, summary_.fixed_count, shared_constants(scene_),
               summary_.solid_spheres),
        obstacles_(backend(), scene_, store_.fixed_begin()),
        walls_(backend(), obstacles_.data(), box_.length),
        restitution_(backend()),
        near_(backend(), box_.length, fixed_spheres(scene_, store_.fixed_begin())),
        islands_(backend(), has_convex_bodies(scene_) ? 0 : summary_.free_capacity),
        x_(backend(), summary_.free_capacity),
        v_(backend(), summary_.free_capacity),
        flight_(backend(), 1),
        motion_(backend(), 1) {
    std::vector<double> restitution;
    for (const Material& pair : all_pair_values(scene_)) restitution.push_back(pair.restitution);
    upload(backend(), restitution, restitution_);
    most_impacts_ = kMostImpacts.of(scene_.dynamics.parameters);
    if (has_convex_bodies(scene_))
      rigid_.emplace(backend(), summary_.free_capacity, obstacles_.data(), obstacles_.shapes(),
                     summary_.fixed_count, obstacles_.fixed_part_begin(), box_);
    BodyLoading<B, double>(scene_, store_, obstacles_).load_first();
    walls_.refresh(backend(), seen(), {}, {});
    require_apart();
  }

  using ModelOn<B, double>::steps_done;

  StepReport step(BodyProblem* /*problem*/) override {
    B& b = backend();
    StageClock<B> clock(b);
    StepReport report;
    const Index n = store_.owned_count();
    if (steps_done() % kReorderEvery == 0 && n > 1) reorder();
    FlightSums flight;
    ImpactReport impacts;
    set_out();
    for (int attempt = 0, widening = 0;; ++attempt) {
      if (attempt > kMostAttempts)
        throw_step_too_long(steps_done() + 1, scene_.stepping.time_step, box_.length);
      if (!near_.is_kept()) {
        near_.build(b, store_.view(), scene_.gravity, scene_.stepping.time_step,
                    summary_.largest_diameter, widening++);
        report.ms.collision += clock.lap();
      }
      impacts = {};
      with_stage([&](const auto& stage) {
        flight = fly(stage);
        report.ms.integrate += clock.lap();
        impacts.is_done = flight.left == 0;
        if (impacts.is_done && flight.active > 0) impacts = run_islands(stage, flight.active);
        report.ms.solve += clock.lap();
      });
      if (impacts.is_done) break;
      if (flight.left > 0 || impacts.faults.left != IslandFaults::kNone) {
        // A list of this step that holds as far as the period lets bodies go is not what lacks.
        if (widening > 0 && near_.room() >= most_way())
          throw_step_too_long(steps_done() + 1, scene_.stepping.time_step, box_.length);
        near_.forget();
      }
    }
    refuse(impacts.faults);
    const MotionSums sums = take();
    if (sums.bad_body >= 0) report_bad_body(sums.bad_body);
    this->count_step();
    report.ms.integrate += clock.lap();
    fill_report(report, flight, impacts, sums);
    return report;
  }

  int body_count() const override { return store_.ranges().present_count(); }
  BodyStates states() override {
    return store_.states(static_cast<Index>(store_.ranges().present_count()));
  }

  void arrays_changed(Written what) override {
    B& b = backend();
    const BodyView<double> bodies = store_.view();
    Buffer<B, FirstBad> first(b, 1);
    reduce<FirstBad>(
        b, bodies.owned_count,
        TakeWrittenState<double>{bodies, scene_.stepping.time_step, box_, what == Written::poses},
        StoreResult<FirstBad>{first.data()});
    near_.forget();
    const Index bad = fetch(b, first.data()).body;
    if (bad < 0) return;
    throw_bad_written(store_.id_of(bad), fetch(b, bodies.position.data + bad),
                      fetch(b, bodies.orientation.data + bad), fetch(b, bodies.velocity.data + bad),
                      fetch(b, bodies.angular_velocity.data + bad));
  }

  void set_gravity(const Vec3d& gravity) override {
    require_gravity(gravity, scene_.stepping.time_step);
    require_gravity_of_periods(scene_.periodicity, gravity);
    scene_.gravity = gravity;
    near_.forget();
  }
  void set_velocity(int body, const Vec3d& velocity, const Vec3d& angular_velocity) override {
    require_velocity(body, velocity, angular_velocity, scene_.stepping.time_step);
    const BodyView<double> bodies = store_.view();
    for_each(backend(), bodies.owned_count,
             WriteVelocity<double>{bodies, body, velocity, angular_velocity});
  }

 private:
  /// Steps between two sorts of the bodies; a function of the step number only, so that a resumed run reorders at
  /// the same steps.
  static constexpr std::int64_t kReorderEvery = 64;
  /// How often a step may begin again with more room around bodies.
  static constexpr int kMostAttempts = 24;

  using ModelOn<B, double>::backend;

  static std::vector<Index> fixed_spheres(const Scene& scene, Index fixed_begin) {
    std::vector<Index> spheres;
    Index place = fixed_begin;
    for (const BodyDescription& body : scene.bodies) {
      if (body.kind == BodyKind::free) continue;
      if (shape_card(body.shape.kind).is_ball) spheres.push_back(place);
      ++place;
    }
    return spheres;
  }

  /// Calls f(stage) with what the programs of a step read.
  template <class F>
  void with_stage(F&& f) {
    const WallView<double> walls = walls_.walls();
    if (rigid_) {
      f(rigid_->stage(stage<true>(walls), walls_.shapes(), seen()));
    } else if (walls.solids.size > 0) {
      f(stage<true>(walls));
    } else {
      f(stage<false>(walls));
    }
  }
  template <bool kSolids>
  Stage<kSolids> stage(const WallView<double>& walls) {
    Stage<kSolids> s;
    s.bodies = store_.view();
    s.near = near_.view();
    s.walls = {walls, box_.length};
    s.gravity = scene_.gravity;
    s.h = scene_.stepping.time_step;
    s.origin = near_.origin();
    s.room = near_.room();
    s.most_way = most_way();
    s.restitution = restitution_.view(restitution_.capacity());
    s.materials = static_cast<Index>(scene_.materials.size());
    s.most_impacts = most_impacts_;
    return s;
  }
  /// A neighbor is met in its nearest image: others must be out of reach for a step.
  double most_way() const {
    double least = kNever;
    for (int axis = 0; axis < 3; ++axis)
      if (box_.length[axis] > 0)
        least = std::min(least, 0.5 * (0.5 * box_.length[axis] - summary_.largest_diameter));
    return least;
  }

  template <bool kSolids>
  FlightSums fly(const Stage<kSolids>& stage) {
    const Index n = store_.owned_count();
    reduce<FlightSums>(backend(), n,
                       FlyFreely<kSolids>{stage, x_.view(n), v_.view(n), islands_.partner(),
                                          islands_.is_active(), islands_.place()},
                       StoreResult<FlightSums>{flight_.data()});
    return fetch(backend(), flight_.data());
  }

  FlightSums fly(const RigidStage& stage) {
    const Index n = store_.owned_count();
    return rigid_->fly(backend(), stage, x_.view(n), v_.view(n));
  }
  template <bool kSolids>
  ImpactReport run_islands(const Stage<kSolids>& stage, Index active) {
    const Index n = store_.owned_count();
    return islands_.run(backend(), stage, active, [&](Span<const Member> members) {
      return FinishIslands<kSolids>{stage, members, x_.view(n), v_.view(n)};
    });
  }
  ImpactReport run_islands(const RigidStage& stage, Index active) {
    const Index n = store_.owned_count();
    return rigid_->run(backend(), stage, active, x_.view(n), v_.view(n));
  }
  MotionSums take() {
    const Index n = store_.owned_count();
    const double h = scene_.stepping.time_step;
    if (rigid_)
      return rigid_->take(backend(), store_.view(), box_, scene_.gravity, h, x_.view(n),
                          v_.view(n));
    reduce<MotionSums>(backend(), n,
                       TakeMotion{x_.view(n), v_.view(n), store_.view(), box_, scene_.gravity, h},
                       StoreResult<MotionSums>{motion_.data()});
    return fetch(backend(), motion_.data());
  }
  /// Bodies, or the parts of those that have several.
  BodyView<double> seen() { return rigid_ ? rigid_->parts(store_.view()) : store_.view(); }
  /// Bodies that turn begin their ways.
  void set_out() {
    if (rigid_)
      rigid_->set_out(backend(), store_.view(), scene_.gravity, scene_.stepping.time_step);
  }

  /// Impacts begin with bodies that are apart.
  void require_apart() {
    if (store_.owned_count() == 0) return;
    near_.build(backend(), store_.view(), scene_.gravity, scene_.stepping.time_step,
                summary_.largest_diameter, 0);
    FlightSums flight;
    set_out();
    with_stage([&](const auto& stage) { flight = fly(stage); });
    if (!(flight.min_gap < 0)) return;
    const BodyView<double> bodies = store_.view();
    const double radius = radius_of(flight.deepest);
    if (flight.min_gap < -(rigid_ ? kTouchPart : kMostOverlap) * radius)
      throw_overlap(store_.id_of(flight.deepest),
                    fetch(backend(), bodies.position.data + flight.deepest), -flight.min_gap);
  }
  double radius_of(Index i) {
    const PerBody<double> radius = store_.view().radius;
    return i < radius.first ? radius.shared
                            : fetch(backend(), radius.values.data + (i - radius.first));
  }

  void refuse(const IslandFaults& faults) {
    if (faults.resting != IslandFaults::kNone)
      throw_resting(steps_done() + 1, static_cast<int>(faults.resting),
                    0.5 * scene_.stepping.time_step * norm(scene_.gravity));
    if (faults.stuck != IslandFaults::kNone)
      throw_stuck(steps_done() + 1, static_cast<int>(faults.stuck));
    if (faults.crowded != IslandFaults::kNone)
      throw_crowded(steps_done() + 1, static_cast<int>(faults.crowded), most_impacts_);
  }

  void fill_report(StepReport& report, const FlightSums& flight, const ImpactReport& impacts,
                   const MotionSums& sums) {
    report.step = steps_done();
    report.time = this->time();
    report.body_count = store_.owned_count();
    report.max_penetration = flight.min_gap < 0 ? -flight.min_gap : 0;
    report.kinetic_energy = sums.kinetic;
    report.own = {static_cast<double>(impacts.impacts),
                  static_cast<double>(impacts.grazing),
                  static_cast<double>(impacts.rounds),
                  static_cast<double>(impacts.active),
                  sums.kinetic + sums.potential,
                  sums.momentum.x,
                  sums.momentum.y,
                  sums.momentum.z,
                  sums.angular.x,
                  sums.angular.y,
                  sums.angular.z,
                  impacts.identity_error};
    report.ms.total = report.ms.collision + report.ms.solve + report.ms.integrate;
    if (!std::isfinite(report.own[kEnergyColumn]))
      throw_not_finite(steps_done(), "energy", report.own[kEnergyColumn]);
  }

  void reorder() {
    B& b = backend();
    BodyOrder<B> order(b);
    order.compute(b, Span<const Vec3d>(store_.view().position.first(store_.owned_count())));
    store_.for_each_array([&](auto& array) { order.apply(b, array.view()); });
    if (rigid_) rigid_->forget();
    near_.forget();
  }

  void save_arrays(WorldState& s) override {
    store_.save_owned(s);
    if (!(scene_.gravity == first_gravity_))
      s.add("world/gravity", std::vector<Vec3d>{scene_.gravity});
  }
  void restore_arrays(const WorldState& s) override {
    const auto& id = s.template at<std::int32_t>("body/id");
    const auto n = static_cast<std::size_t>(store_.owned_count());
    if (id.size() != n) throw_wrong_body_count(id.size(), n);
    const Vec3d gravity =
        s.has("world/gravity") ? saved_gravity(s, scene_.stepping.time_step) : first_gravity_;
    require_gravity_of_periods(scene_.periodicity, gravity);
    store_.arrange(id);
    store_.restore_owned(s);
    if (rigid_) rigid_->forget();
    scene_.gravity = gravity;
    near_.forget();
  }

  typename ModelOn<B, double>::Drawn drawn() override {
    return {seen(), obstacles_.shapes(), obstacles_.mesh_set()};
  }

  void for_each_array(const typename ModelOn<B, double>::VisitArray& visit) override {
    const BodyView<double> bodies = store_.view();
    const Index n = store_.owned_count();
    const auto rows = [n](const auto* data) { return [data, n] { return array_of(data, n); }; };
    visit({"position", "m", "center of mass, world frame", true}, rows(bodies.position.data));
    visit({"velocity", "m/s", "of the center of mass, world frame", true},
          rows(bodies.velocity.data));
    if (rigid_) {
      visit({"orientation", "1", "body to world, unit quaternion w x y z", true},
            rows(bodies.orientation.data));
      visit({"angular_velocity", "rad/s", "world frame", true}, rows(bodies.angular_velocity.data));
    }
    visit({"id", "1", "index of the body in the scene", false}, rows(bodies.id.data));
  }

  [[noreturn]] void report_bad_body(Index storage) {
    const double turn = scene_.stepping.time_step *
                        norm(fetch(backend(), store_.view().angular_velocity.data + storage));
    if (rigid_ && turn >= kMostTurn)
      throw_spinning(steps_done() + 1, store_.id_of(storage), turn, kMostTurn);
    throw_bad_body(steps_done() + 1, store_.id_of(storage), fetch(backend(), x_.data() + storage),
                   fetch(backend(), v_.data() + storage));
  }

  Scene scene_;  ///< without the descriptions already loaded
  Vec3d first_gravity_ = scene_.gravity;
  SceneSummary summary_;
  PeriodicBox box_;
  BodyStore<B, double> store_;
  Obstacles<B, double> obstacles_;
  ObstacleBuffers<B, double> walls_;
  Buffer<B, double> restitution_;
  NearList<B> near_;
  IslandRounds<B, Member> islands_;
  std::optional<RigidFlight<B>> rigid_;  ///< where bodies turn
  Buffer<B, Vec3d> x_, v_;               ///< [owned] after the step, while it is made
  Buffer<B, FlightSums> flight_;
  Buffer<B, MotionSums> motion_;
  double most_impacts_ = 0;
};

template <class B, class Real>
std::unique_ptr<Dynamics> make_variational(Scene scene, const WorldOptions& options) {
  return std::make_unique<VariationalDynamics<B>>(make_backend<B>(options), std::move(scene));
}

}  // namespace scree
