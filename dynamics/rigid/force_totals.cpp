#include "dynamics/rigid/force_totals.h"

#include <algorithm>
#include <string>
#include <utility>

#include "dynamics/model_errors.h"
#include "host/error.h"

namespace scree {

ForceTotals::ForceTotals(const Scene& scene) : group_count_(scene.groups.size()) {
  for (std::size_t id = 0; id < scene.bodies.size(); ++id)
    if (scene.bodies[id].kind != BodyKind::free) fixed_.push_back(static_cast<int>(id));
  sums_.resize(fixed_.size() + group_count_ + scene.joints.size());
  now_ = last_ = sums_;
}

void ForceTotals::add(std::size_t target, const Vec3d& impulse, const Vec3d& torque) {
  now_[target].impulse += impulse;
  now_[target].torque += torque;
}

void ForceTotals::count_step() {
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    sums_[k].impulse += now_[k].impulse;
    sums_[k].torque += now_[k].torque;
  }
  std::swap(now_, last_);
  std::fill(now_.begin(), now_.end(), Sum{});
  ++steps_;
}

ForceRecord ForceTotals::of_last(std::size_t target, double time_step) const {
  return {(1 / time_step) * last_[target].impulse, (1 / time_step) * last_[target].torque};
}

ForceRecord ForceTotals::on_body(int id, double time_step) const {
  const auto place = std::lower_bound(fixed_.begin(), fixed_.end(), id);
  if (place == fixed_.end() || *place != id) throw_no_force(id);
  return of_last(static_cast<std::size_t>(place - fixed_.begin()), time_step);
}

ForceRecord ForceTotals::on_group(int group, double time_step) const {
  return of_last(fixed_.size() + static_cast<std::size_t>(group), time_step);
}

void ForceTotals::add_to_body(int id, const Vec3d& impulse, const Vec3d& torque) {
  const auto place = std::lower_bound(fixed_.begin(), fixed_.end(), id);
  add(static_cast<std::size_t>(place - fixed_.begin()), impulse, torque);
}

void ForceTotals::add_to_group(int group, const Vec3d& impulse, const Vec3d& torque) {
  add(fixed_.size() + static_cast<std::size_t>(group), impulse, torque);
}

void ForceTotals::add_joints(const std::vector<JointRecord>& joints) {
  for (std::size_t k = 0; k < joints.size(); ++k)
    add(fixed_.size() + group_count_ + k, joints[k].force, joints[k].moment);
}

MeanForces ForceTotals::take(double time_step) {
  MeanForces out;
  out.steps = steps_;
  out.bodies = fixed_;
  const double scale = steps_ > 0 ? 1 / (static_cast<double>(steps_) * time_step) : 0;
  for (std::size_t k = 0; k < sums_.size(); ++k) {
    auto& part = k < fixed_.size()                  ? out.on_bodies
                 : k < fixed_.size() + group_count_ ? out.on_groups
                                                    : out.on_joints;
    part.push_back({scale * sums_[k].impulse, scale * sums_[k].torque});
  }
  std::fill(sums_.begin(), sums_.end(), Sum{});
  steps_ = 0;
  return out;
}

void ForceTotals::save(WorldState& s) const {
  std::vector<Vec3d> rows;
  for (const Sum& sum : sums_) {
    rows.push_back(sum.impulse);
    rows.push_back(sum.torque);
  }
  s.add("force/sum", std::move(rows));
  s.add("force/steps", std::vector<double>{static_cast<double>(steps_)});
}

void ForceTotals::restore(const WorldState& s) {
  for (std::vector<Sum>* sums : {&sums_, &now_, &last_})
    std::fill(sums->begin(), sums->end(), Sum{});
  steps_ = 0;
  if (!s.has("force/sum") || !s.has("force/steps")) return;
  const std::vector<Vec3d>& rows = s.at<Vec3d>("force/sum");
  const std::vector<double>& steps = s.at<double>("force/steps");
  if (rows.size() != 2 * sums_.size() || steps.size() != 1 || !(steps[0] >= 0) || steps[0] > 1e15)
    throw InputError("force/sum has " + std::to_string(rows.size()) + " rows, expected " +
                     std::to_string(2 * sums_.size()) + ", and force/steps one number of steps");
  for (std::size_t k = 0; k < sums_.size(); ++k) sums_[k] = {rows[2 * k], rows[2 * k + 1]};
  steps_ = static_cast<std::int64_t>(steps[0]);
}

void ForceTotals::leave(WorldState& s) const {
  std::vector<Vec3d> rows;
  for (const Sum& sum : last_) {
    rows.push_back(sum.impulse);
    rows.push_back(sum.torque);
  }
  s.add("run/force", std::move(rows));
}

void ForceTotals::enter(const WorldState& s) {
  const std::vector<Vec3d>& rows = s.at<Vec3d>("run/force");
  for (std::size_t k = 0; k < last_.size(); ++k) last_[k] = {rows[2 * k], rows[2 * k + 1]};
}

}  // namespace scree
