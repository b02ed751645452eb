#include "dynamics/affine/led_motion.h"

#include <algorithm>

#include "dynamics/model_errors.h"

namespace scree::affine {

AffineVec LedMotion::place(std::size_t body, double ahead) const {
  return pose_coordinates(pose_at(bodies_[body].description, time_[body] + ahead));
}

void LedMotion::begin() {
  part_ = last_ > 0 ? std::min(1.0, last_ + rise_) : kLeastPart;
  is_short_ = false;
}

std::vector<AffineVec> LedMotion::targets(double h) const {
  std::vector<AffineVec> all;
  for (std::size_t k = 0; k < bodies_.size(); ++k) all.push_back(place(k, part_ * h));
  return all;
}

bool LedMotion::moves(double h) const {
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const AffineVec way = place(k, h) - place(k, 0);
    if (dot(way, way) > 0) return true;
  }
  return false;
}

// A body that only its inertia holds is as fast as they are after a step that works: then they may go faster by as much as
// did not squeeze it, however little of their speed that is.
void LedMotion::shorten(double h) {
  is_short_ = true;
  if (!moves(h)) {
    part_ = 0;
  } else if (last_ > 0 && part_ > last_) {
    rise_ = 0.5 * (part_ - last_);
    part_ = rise_ >= kLeastPart ? last_ + rise_ : last_;
  } else {
    part_ = kLeft * part_ >= kLeastPart ? kLeft * part_ : 0;
  }
}

void LedMotion::end(double h) {
  for (double& time : time_) time += part_ * h;
  const double gained = part_ - last_;
  if (gained < 0) rise_ = part_;
  if (gained >= 0) rise_ = is_short_ ? gained : 2 * gained;
  rise_ = std::clamp(rise_, kLeastPart, std::max(kLeastPart, part_));
  last_ = part_;
}

double LedMotion::turn(double h, int parts) const {
  double most = 0;
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (!rotates(bodies_[k].description)) continue;
    const auto pose = [&](int part) {
      return pose_at(bodies_[k].description, time_[k] + h * part / parts);
    };
    for (int part = 0; part < parts; ++part)
      most = std::max(most, norm(rates_between(pose(part), pose(part + 1), 1).angular_velocity));
  }
  return most;
}

double LedMotion::delay(double now) const {
  return time_.empty() ? 0 : now - *std::min_element(time_.begin(), time_.end());
}

void LedMotion::restore(const std::vector<double>& time, const std::vector<double>& part) {
  if (time.size() != time_.size()) throw_wrong_body_count(time.size(), time_.size());
  const bool is_part =
      part.size() == 2 && part[0] >= 0 && part[0] <= 1 && part[1] > 0 && part[1] <= 1;
  if (!is_part) throw_bad_led_part();
  time_ = time;
  last_ = part[0], rise_ = part[1];
}

}  // namespace scree::affine
