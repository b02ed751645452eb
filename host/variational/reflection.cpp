#include "host/variational/reflection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "host/variational/normal_cone.h"

namespace scree::variational {
namespace {

constexpr double kRounding = std::numeric_limits<double>::epsilon();
constexpr int kMostNewtonSteps = 50;

struct PartAtImpact {
  Vector gradient;
  double value;
  double tolerance;  ///< values as small count as zero
  double rate, rate_rounding;
};

PartAtImpact look_at(const Wall& wall, const WallFunction& part, const Vector& q, const Vector& v,
                     double reach) {
  PartAtImpact at{Vector(q.size()), part.value(as_span(q)), 0, 0, 0};
  part.gradient(as_span(q), as_span(at.gradient));
  if (!at.gradient.allFinite())
    throw RunError(fmt::format("wall \"{}\": its gradient is not finite", wall.name));
  const double speed = at.gradient.cwiseAbs().dot(v.cwiseAbs());
  at.tolerance = reach * speed + 64 * rounding_of(at.gradient, q);
  at.rate = at.gradient.dot(v);
  at.rate_rounding = 64 * kRounding * speed;
  return at;
}

}  // namespace

Reflection::Reflection(const Metric& metric, const Forces& forces, std::span<const Wall> walls,
                       Arrival arrival, double reach)
    : metric_(metric), forces_(forces), arrival_(std::move(arrival)) {
  add_active(walls, reach, true);
  if (parts_.empty()) add_active(walls, reach, false);  // it grazes one
  if (parts_.empty()) throw RunError("an impact without a wall: a wall function is not continuous");
  choose_direction();
  direction_velocity_ = metric_.velocity(direction_);
  direction_square_ = direction_.dot(direction_velocity_);
  if (!(direction_square_ > 0))
    throw RunError(
        fmt::format("wall \"{}\": its gradient is zero where the wall is, expected a regular one",
                    walls[static_cast<std::size_t>(parts_.front().wall)].name));
}

void Reflection::add_active(std::span<const Wall> walls, double reach, bool approached_only) {
  const Vector v = metric_.velocity(arrival_.momentum);
  std::vector<Vector> gradients;
  for (std::size_t w = 0; w < walls.size(); ++w) {
    std::vector<PartAtImpact> seen;
    for (const WallFunction& part : walls[w].parts)
      seen.push_back(look_at(walls[w], part, arrival_.place, v, reach));
    if (std::any_of(seen.begin(), seen.end(), [](const auto& s) { return s.value > s.tolerance; }))
      continue;
    for (std::size_t k = 0; k < seen.size(); ++k) {
      if (seen[k].value < -seen[k].tolerance) continue;
      if (approached_only && seen[k].rate > seen[k].rate_rounding) continue;
      parts_.push_back({static_cast<int>(w), static_cast<int>(k), 0});
      gradients.push_back(seen[k].gradient);
      restitution_ = std::min(restitution_, walls[w].restitution);
      friction_ = std::max(friction_, walls[w].friction);
    }
  }
  gradients_.resize(arrival_.place.size(), static_cast<Eigen::Index>(gradients.size()));
  for (std::size_t k = 0; k < gradients.size(); ++k)
    gradients_.col(static_cast<Eigen::Index>(k)) = gradients[k];
}

void Reflection::choose_direction() {
  if (parts_.size() == 1) {
    parts_.front().impulse = 1;
    direction_ = gradients_.col(0);
    return;
  }
  const Vector x = project_on_normal_cone(metric_, gradients_, arrival_.momentum).multipliers;
  direction_ = gradients_ * x;
  for (std::size_t k = 0; k < parts_.size(); ++k)
    parts_[k].impulse = x[static_cast<Eigen::Index>(k)];
  if (x.maxCoeff() > 0) return;
  direction_ = gradients_.col(0);  // it approaches none of them: any will do for an impulse of zero
  parts_.front().impulse = 1;
}

double Reflection::instant_impulse() const {
  return std::max(0.0, -2 * direction_velocity_.dot(arrival_.momentum) / direction_square_);
}

Departure Reflection::with_losses(double lambda, bool grazing) const {
  const double before = direction_velocity_.dot(arrival_.momentum);
  const double rate = before + lambda * direction_square_;
  if (restitution_ < 1 && rate > 0) lambda -= (1 - restitution_) * rate / direction_square_;
  Departure out{arrival_.momentum + lambda * direction_, lambda, grazing};
  if (friction_ == 0) return out;
  const double normal = direction_velocity_.dot(out.momentum) / direction_square_;
  const Vector tangential = out.momentum - normal * direction_;
  const double size = metric_.whitened(tangential).norm();
  const double bound = friction_ * lambda * std::sqrt(direction_square_);
  out.momentum -= size <= bound ? tangential : Vector((bound / size) * tangential);
  return out;
}

Departure Reflection::at_once() const { return with_losses(instant_impulse(), true); }

Departure Reflection::after(double duration) const {
  if (!forces_.any()) return with_losses(instant_impulse(), false);
  const double half = 0.5 * duration;
  const Vector free = metric_.velocity(arrival_.momentum - half * arrival_.gradient);
  double lambda = -2 * direction_.dot(free) / direction_square_;
  double last = std::numeric_limits<double>::infinity();
  Vector v, end, gradient(free.size());
  for (int k = 0; k < kMostNewtonSteps; ++k) {
    v = free + lambda * direction_velocity_;
    end = arrival_.place + duration * v;
    forces_.gradient(end, gradient);
    const double excess = 0.5 * v.dot(metric_.momentum(v)) +
                          0.5 * (arrival_.potential + forces_.potential(end)) - arrival_.energy;
    const double slope = direction_.dot(v) + half * gradient.dot(direction_velocity_);
    if (!(slope > 0)) break;  // at the least energy or left of it: no root, or the smaller one
    const double change = excess / slope;
    lambda -= change;
    const double size = std::abs(change);
    // Rounding of the energies ends it.
    if (size <= 4 * kRounding * std::abs(lambda) ||
        (size >= 0.5 * last && size <= 1e-9 * std::abs(lambda))) {
      const double rate = direction_velocity_.dot(arrival_.momentum) + lambda * direction_square_;
      if (!(lambda > 0) || !(rate > 0)) break;
      return with_losses(lambda, false);
    }
    last = size;
  }
  return at_once();
}

std::vector<ActivePart> Reflection::parts(double lambda) const {
  std::vector<ActivePart> out = parts_;
  for (ActivePart& part : out) part.impulse *= lambda;
  return out;
}

double Reflection::closest_point_error(const Vector& from, double time_to, const Vector& to,
                                       double time_from) const {
  const double h = time_to + time_from;
  if (!(h > 0)) return 0;
  const double alpha = time_to / h;
  const Vector offset =
      (1 - alpha) * (arrival_.place - from) + alpha * (arrival_.place - to);  // q~ - q_(i-alpha)
  const Vector p =
      metric_.momentum(offset) - (0.5 * alpha * (1 - alpha) * h * h) * arrival_.gradient;
  return project_on_normal_cone(metric_, gradients_, p).distance;
}

Reflection::Rest Reflection::rest(const Departure& departure,
                                  const ImpactSettings& settings) const {
  const Vector v = metric_.velocity(departure.momentum);
  const Vector v_before = metric_.velocity(arrival_.momentum);
  const Vector acceleration = metric_.velocity(arrival_.gradient);
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    if (!(parts_[k].impulse > 0)) continue;
    const auto g = gradients_.col(static_cast<Eigen::Index>(k));
    const double speed = std::min(g.dot(v), -g.dot(v_before)), pull = g.dot(acceleration);
    double threshold = settings.handover_speed;
    if (threshold == 0)
      threshold = 0.5 * settings.step * pull / (restitution_ < 1 ? 1 : settings.max_impacts);
    if (pull > 0 && speed < threshold) return {parts_[k].wall, speed, threshold};
  }
  return {};
}

}  // namespace scree::variational
