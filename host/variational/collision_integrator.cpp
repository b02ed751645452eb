#include "host/collision_integrator.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host/variational/check_system.h"
#include "host/variational/first_hit.h"
#include "host/variational/forces.h"
#include "host/variational/metric.h"
#include "host/variational/reflection.h"

namespace scree {

using namespace variational;

namespace {

constexpr double kEpsilon = std::numeric_limits<double>::epsilon();
/// Time of a second impact in a step: so many times at most is it taken anew with the impulse that belongs to it.
constexpr int kMostTimes = 60;
/// Walls this share of a step apart are so to rounding only.
constexpr double kLeastTogether = 256 * kEpsilon;

std::vector<double> to_vector(const Vector& v) { return {v.begin(), v.end()}; }
Vector to_eigen(const std::vector<double>& v) {
  return Eigen::Map<const Vector>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// Checks first: what follows may rely on sizes.
MechanicalSystem checked(MechanicalSystem system, const ImpactSettings& settings,
                         const std::vector<double>& position, const std::vector<double>& velocity) {
  check_system(system, settings, position, velocity);
  return system;
}

/// A point of the discrete motion, with the gradient of V there.
struct Point {
  Vector q, p, gradient;
};

}  // namespace

class CollisionIntegrator::State {
 public:
  State(MechanicalSystem system, const ImpactSettings& settings,
        const std::vector<double>& position, const std::vector<double>& velocity)
      : system_(checked(std::move(system), settings, position, velocity)),
        settings_(settings),
        metric_(system_.mass, static_cast<int>(position.size())),
        forces_(system_),
        search_(system_.walls, static_cast<int>(position.size()), settings.samples) {
    node_.q = to_eigen(position);
    node_.p = metric_.momentum(to_eigen(velocity));
    node_.gradient = Vector::Zero(node_.q.size());
    forces_.gradient(node_.q, node_.gradient);
    at_ = end_ = node_;
    acceleration_ = node_.q;
    totals_.smallest_gap = gap_at(system_.walls, node_.q);
    publish();
  }

  void step() {
    new_impacts_.clear();
    impact_.reset();
    elapsed_ = 0;
    at_ = node_;
    set_way(settings_.step);
    std::optional<double> hit = search_.first(way_);
    while (hit) {
      arrive(*hit);
      hit = depart();
    }
    finish();
  }

  double discrete_energy() const {
    if (totals_.steps == 0) {
      const double half = 0.5 * settings_.step;
      const Vector v = metric_.velocity(node_.p - half * node_.gradient);
      return segment_energy(v, node_.q, node_.q + settings_.step * v);
    }
    const Vector v = metric_.velocity(node_.p + 0.5 * last_duration_ * node_.gradient);
    return segment_energy(v, node_.q - last_duration_ * v, node_.q);
  }
  double energy() const {
    return 0.5 * node_.p.dot(metric_.velocity(node_.p)) + forces_.potential(node_.q);
  }
  double gap() const { return gap_at(system_.walls, node_.q); }
  double time() const { return static_cast<double>(totals_.steps) * settings_.step; }
  std::vector<double> velocity() const { return to_vector(metric_.velocity(node_.p)); }
  std::vector<double> momenta() const {
    std::vector<double> values;
    for (const MomentumMap& map : system_.momenta)
      values.push_back(map.value(as_span(node_.q), as_span(node_.p)));
    return values;
  }

  std::vector<double> node_position, node_momentum;  // copies of the node, for callers
  std::vector<Impact> impacts;
  const CollisionTotals& totals() const { return totals_; }

 private:
  double segment_energy(const Vector& v, const Vector& from, const Vector& to) const {
    return 0.5 * v.dot(metric_.momentum(v)) +
           0.5 * (forces_.potential(from) + forces_.potential(to));
  }

  /// The way from at_ for a time.
  void set_way(double duration) {
    way_.start = at_.q;
    metric_.velocity(at_.p, way_.velocity);
    metric_.velocity(at_.gradient, acceleration_);
    way_.acceleration = -acceleration_;
    way_.duration = duration;
    way_.step = settings_.step;
  }

  /// Goes along the way for a time: sets end_.
  void go(double duration) {
    way_.place(duration, end_.q);
    forces_.gradient(end_.q, end_.gradient);
    end_.p = at_.p - (0.5 * duration) * (at_.gradient + end_.gradient);
    if (!end_.q.allFinite() || !end_.p.allFinite())
      throw RunError(
          fmt::format("collision integrator: the state after t = {} s is not finite", time()));
  }

  /// Follows the way to a wall.
  void arrive(double duration) {
    if (static_cast<int>(new_impacts_.size()) == settings_.max_impacts)
      throw TooManyImpacts(fmt::format(
          "collision integrator: more than {} impacts in the step from t = {} s, the last at wall "
          "\"{}\"",
          settings_.max_impacts, time(), wall_name(new_impacts_.back().parts.front().wall)));
    go(duration);
    end_segment(duration);
    const Vector v = way_.velocity + (0.5 * duration) * way_.acceleration;
    const double energy = segment_energy(v, at_.q, end_.q);
    impact_.emplace(metric_, forces_, system_.walls,
                    Arrival{end_.q, end_.p, end_.gradient, forces_.potential(end_.q), energy},
                    std::max(settings_.together, kLeastTogether) * settings_.step);
    from_ = at_.q;
    time_to_ = duration;
    elapsed_ += duration;
    at_ = end_;
  }

  /// Leaves a wall: momentum, record, and when the next wall comes. Impulse and time of a next impact in the step depend on each
  /// other; the time is taken anew with its impulse until it stays, and where it does not, reflection is at once.
  std::optional<double> depart() {
    const double left = std::max(0.0, settings_.step - elapsed_);
    double duration = left;
    std::optional<double> hit;
    Departure departure;
    for (int k = 0;; ++k) {
      departure = k < kMostTimes ? impact_->after(duration) : impact_->at_once();
      at_.p = departure.momentum;
      set_way(left);
      hit = search_.first(way_);
      const double next = hit.value_or(left);
      if (departure.grazing || !forces_.any() ||
          std::abs(next - duration) <= 4 * kEpsilon * settings_.step)
        break;
      duration = next;
    }
    const Reflection::Rest rest = impact_->rest(departure, settings_);
    if (rest.wall >= 0)
      throw RestingContact(
          fmt::format("collision integrator: resting contact with wall \"{}\" at t = {} s: it is "
                      "left at {}, below "
                      "the hand-over speed of {}, and forces press there",
                      wall_name(rest.wall), time() + elapsed_, rest.speed, rest.threshold));
    Impact record;
    record.time = time() + elapsed_;
    record.position = to_vector(at_.q);
    record.before = to_vector(impact_->arrival().momentum);
    record.after = to_vector(departure.momentum);
    record.parts = impact_->parts(departure.impulse);
    record.energy = impact_->arrival().energy;
    record.grazing = departure.grazing;
    new_impacts_.push_back(std::move(record));
    return hit;
  }

  /// Completes the record of the impact that a way of this duration to end_ began at.
  void end_segment(double duration) {
    if (!impact_) return;
    Impact& record = new_impacts_.back();
    const Vector v = way_.velocity + (0.5 * duration) * way_.acceleration;
    record.energy_after = segment_energy(v, at_.q, end_.q);
    record.closest_point_error =
        impact_->has_friction() ? std::numeric_limits<double>::quiet_NaN()
                                : impact_->closest_point_error(from_, time_to_, end_.q, duration);
  }

  /// The rest of the step, and the new node.
  void finish() {
    const double left = impact_ ? std::max(0.0, settings_.step - elapsed_) : settings_.step;
    go(left);
    end_segment(left);
    const double gap =
        gap_at(system_.walls, end_.q);  // what may fail is done: from here on the step counts
    std::swap(node_, end_);
    last_duration_ = left;
    ++totals_.steps;
    for (const Impact& impact : new_impacts_) {
      ++totals_.impacts;
      totals_.grazing_impacts += impact.grazing;
      if (!std::isnan(impact.closest_point_error))
        totals_.largest_closest_point_error =
            std::max(totals_.largest_closest_point_error, impact.closest_point_error);
    }
    totals_.smallest_gap = std::min(totals_.smallest_gap, gap);
    publish();
  }

  void publish() {
    node_position.assign(node_.q.begin(), node_.q.end());
    node_momentum.assign(node_.p.begin(), node_.p.end());
    std::swap(impacts, new_impacts_);
  }

  const std::string& wall_name(int wall) const {
    return system_.walls[static_cast<std::size_t>(wall)].name;
  }

  MechanicalSystem system_;
  ImpactSettings settings_;
  Metric metric_;
  Forces forces_;
  HitSearch search_;
  CollisionTotals totals_;
  Point node_;
  double last_duration_ = 0;  // of the way that led to the node

  // Of the step that is being made.
  Point at_, end_;
  Way way_;
  Vector acceleration_;
  std::optional<Reflection> impact_;  // the last one, which at_ is at
  Vector from_;                       // where the way to it began
  double time_to_ = 0;                // how long that took
  double elapsed_ = 0;
  std::vector<Impact> new_impacts_;
};

CollisionIntegrator::CollisionIntegrator(MechanicalSystem system, const ImpactSettings& settings,
                                         const std::vector<double>& position,
                                         const std::vector<double>& velocity)
    : state_(std::make_unique<State>(std::move(system), settings, position, velocity)) {}
CollisionIntegrator::~CollisionIntegrator() = default;
CollisionIntegrator::CollisionIntegrator(CollisionIntegrator&&) noexcept = default;
CollisionIntegrator& CollisionIntegrator::operator=(CollisionIntegrator&&) noexcept = default;

void CollisionIntegrator::step() { state_->step(); }
double CollisionIntegrator::time() const { return state_->time(); }
const std::vector<double>& CollisionIntegrator::position() const { return state_->node_position; }
const std::vector<double>& CollisionIntegrator::momentum() const { return state_->node_momentum; }
std::vector<double> CollisionIntegrator::velocity() const { return state_->velocity(); }
double CollisionIntegrator::energy() const { return state_->energy(); }
double CollisionIntegrator::discrete_energy() const { return state_->discrete_energy(); }
std::vector<double> CollisionIntegrator::momenta() const { return state_->momenta(); }
double CollisionIntegrator::gap() const { return state_->gap(); }
const std::vector<Impact>& CollisionIntegrator::impacts() const { return state_->impacts; }
const CollisionTotals& CollisionIntegrator::totals() const { return state_->totals(); }

}  // namespace scree
