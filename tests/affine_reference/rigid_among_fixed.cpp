#include "tests/affine_reference/rigid_among_fixed.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/reference/dense_algebra.h"

namespace scree::spatial {
namespace {

double barrier_of(double d2, double s) {
  return d2 < s ? -(d2 - s) * (d2 - s) * std::log(d2 / s) : 0;
}
double slope_of(double d2, double s) {
  return d2 < s ? -2 * (d2 - s) * std::log(d2 / s) - (d2 - s) * (d2 - s) / d2 : 0;
}

Mat3 turn_by(const Vec3& w) {
  const double angle = w.norm();
  return angle > 0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Mat3::Identity();
}

/// Weights of the corners of a triangle at its point nearest to x, by its regions.
Vec3 on_triangle(const Vec3& x, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 e = b - a, f = c - a, normal = e.cross(f);
  const double area = normal.squaredNorm();
  const double v = (x - a).cross(f).dot(normal) / area, w = e.cross(x - a).dot(normal) / area;
  if (v >= 0 && w >= 0 && v + w <= 1) return {1 - v - w, v, w};
  const std::array<Vec3, 3> corner{a, b, c};
  Vec3 best{1, 0, 0};
  double least = 1e300;
  for (int k = 0; k < 3; ++k) {  // outside, the nearest point is on an edge
    const Vec3 &p = corner[static_cast<std::size_t>(k)],
               &q = corner[static_cast<std::size_t>((k + 1) % 3)];
    const double t = std::clamp((x - p).dot(q - p) / (q - p).squaredNorm(), 0.0, 1.0);
    const double apart = (x - p - t * (q - p)).squaredNorm();
    if (apart >= least) continue;
    least = apart;
    best.setZero();
    best[k] = 1 - t, best[(k + 1) % 3] = t;
  }
  return best;
}

/// Shares along two segments at their nearest points: inside both, else one is at an end.
std::array<double, 2> on_edges(const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
  const Vec3 e = q - p, f = s - r, d = p - r;
  const double ee = e.dot(e), ff = f.dot(f), ef = e.dot(f), det = ee * ff - ef * ef;
  if (det > 1e-14 * ee * ff) {
    const double u = (ef * f.dot(d) - ff * e.dot(d)) / det;
    const double v = (ee * f.dot(d) - ef * e.dot(d)) / det;
    if (u >= 0 && u <= 1 && v >= 0 && v <= 1) return {u, v};
  }
  std::array<double, 2> best{};
  double least = 1e300;
  const auto attempt = [&](double u, double v) {
    const double apart = (d + u * e - v * f).squaredNorm();
    if (apart < least) least = apart, best = {u, v};
  };
  for (const double end : {0.0, 1.0}) {
    attempt(end, std::clamp((d + end * e).dot(f) / ff, 0.0, 1.0));
    attempt(std::clamp((end * f - d).dot(e) / ee, 0.0, 1.0), end);
  }
  return best;
}

/// Boxes about features, from the least x on.
struct Boxed {
  Vec3 low, high;
  std::size_t number = 0;
};
template <class Features>
std::vector<Boxed> boxes_of(const std::vector<Vec3>& corners, const Features& features,
                            double margin) {
  std::vector<Boxed> boxes;
  for (std::size_t k = 0; k < features.size(); ++k) {
    Boxed box{Vec3::Constant(1e300), Vec3::Constant(-1e300), k};
    for (const int c : features[k]) {
      const Vec3& x = corners[static_cast<std::size_t>(c)];
      box.low = box.low.cwiseMin(x), box.high = box.high.cwiseMax(x);
    }
    box.low.array() -= margin / 2, box.high.array() += margin / 2;
    boxes.push_back(box);
  }
  std::sort(boxes.begin(), boxes.end(),
            [](const Boxed& a, const Boxed& b) { return a.low.x() < b.low.x(); });
  return boxes;
}
template <class F>
void for_meeting(const std::vector<Boxed>& a, const std::vector<Boxed>& b, F found) {
  std::size_t i = 0, j = 0;
  const auto meet = [](const Boxed& s, const Boxed& t) {
    return s.low.y() <= t.high.y() && t.low.y() <= s.high.y() && s.low.z() <= t.high.z() &&
           t.low.z() <= s.high.z();
  };
  while (i < a.size() && j < b.size()) {
    if (a[i].low.x() <= b[j].low.x()) {
      for (std::size_t k = j; k < b.size() && b[k].low.x() <= a[i].high.x(); ++k)
        if (meet(a[i], b[k])) found(a[i].number, b[k].number);
      ++i;
    } else {
      for (std::size_t k = i; k < a.size() && a[k].low.x() <= b[j].high.x(); ++k)
        if (meet(a[k], b[j])) found(a[k].number, b[j].number);
      ++j;
    }
  }
}
std::vector<std::array<int, 1>> corner_numbers(std::size_t count) {
  std::vector<std::array<int, 1>> all(count);
  for (std::size_t k = 0; k < count; ++k) all[k] = {static_cast<int>(k)};
  return all;
}

}  // namespace

double inertial_stiffness(const FallingSettings& s, double mass, double times) {
  const double half = 0.5 * s.reach;
  return times * mass * s.reach /
         (s.h * s.h * -2 * half * slope_of(half * half, s.reach * s.reach));
}

RigidAmongFixed::RigidAmongFixed(const FallingSettings& settings, TriangleSurface own, double mass,
                                 const Mat3& second, const Vec3& center, TriangleSurface others)
    : settings_(settings),
      own_(std::move(own)),
      others_(std::move(others)),
      mass_(mass),
      second_(second),
      center_(center) {
  for (const Vec3& x : own_.corners) radius_ = std::max(radius_, x.norm());
}

/// Where the corners of a pair are, the way between its nearest points, and how much each corner has of it.
struct RigidAmongFixed::Nearest {
  std::array<Vec3, 4> arm;  ///< of own corners, from the center
  std::array<double, 4> weight{};
  std::array<bool, 4> is_own{};
  Vec3 gap;
};

RigidAmongFixed::State RigidAmongFixed::moved(const State& at, const Six& way) {
  return {at.center + way.head<3>(), turn_by(way.tail<3>()) * at.rotation};
}

RigidAmongFixed::Nearest RigidAmongFixed::nearest(const State& at, const Pair& pair) const {
  Nearest n;
  std::array<Vec3, 4> x;
  const std::size_t split = pair.is_edges ? 2 : 1;
  for (std::size_t k = 0; k < 4; ++k) {
    n.is_own[k] = (k < split) == pair.first_is_own;
    const auto c = static_cast<std::size_t>(pair.corner[k]);
    if (n.is_own[k]) n.arm[k] = at.rotation * own_.corners[c];
    x[k] = n.is_own[k] ? at.center + n.arm[k] : others_.corners[c];
  }
  if (pair.is_edges) {
    const auto [u, v] = on_edges(x[0], x[1], x[2], x[3]);
    n.weight = {1 - u, u, v - 1, -v};
  } else {
    const Vec3 w = on_triangle(x[0], x[1], x[2], x[3]);
    n.weight = {1, -w[0], -w[1], -w[2]};
  }
  n.gap = n.weight[0] * x[0] + n.weight[1] * x[1] + n.weight[2] * x[2] + n.weight[3] * x[3];
  return n;
}

RigidAmongFixed::Six RigidAmongFixed::barrier_gradient(const State& at, const Pair& pair) const {
  const Nearest n = nearest(at, pair);
  const double slope = slope_of(n.gap.squaredNorm(), settings_.reach * settings_.reach);
  Six g = Six::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    if (!n.is_own[k]) continue;
    const Vec3 f = 2 * slope * n.weight[k] * n.gap;
    g.head<3>() += f, g.tail<3>() += n.arm[k].cross(f);
  }
  return g;
}

/// Differences of the gradient, over ways far below the gap; its nearest semidefinite matrix.
RigidAmongFixed::SixSix RigidAmongFixed::barrier_hessian(const State& at, const Pair& pair) const {
  const double way = 1e-6 * nearest(at, pair).gap.norm();
  SixSix h;
  for (int k = 0; k < 6; ++k) {
    Six by = Six::Zero();
    by[k] = k < 3 ? way : way / radius_;
    h.col(k) = (barrier_gradient(moved(at, by), pair) - barrier_gradient(moved(at, -by), pair)) /
               (2 * by[k]);
  }
  return oracle::semidefinite(0.5 * (h + h.transpose()));
}

void RigidAmongFixed::gather(const State& at, double margin) {
  pairs_.clear();
  went_ = 0;
  std::vector<Vec3> placed;
  for (const Vec3& x : own_.corners) placed.push_back(at.center + at.rotation * x);
  const auto keep = [&](Pair pair) {
    pair.apart = nearest(at, pair).gap.norm();
    if (pair.apart < margin) pairs_.push_back(pair);
  };
  const auto own_corners = boxes_of(placed, corner_numbers(placed.size()), margin);
  const auto other_corners =
      boxes_of(others_.corners, corner_numbers(others_.corners.size()), margin);
  for_meeting(own_corners, boxes_of(others_.corners, others_.triangles, margin),
              [&](std::size_t c, std::size_t t) {
                const auto& n = others_.triangles[t];
                keep({{static_cast<int>(c), n[0], n[1], n[2]}, false, true, 0});
              });
  for_meeting(other_corners, boxes_of(placed, own_.triangles, margin),
              [&](std::size_t c, std::size_t t) {
                const auto& n = own_.triangles[t];
                keep({{static_cast<int>(c), n[0], n[1], n[2]}, false, false, 0});
              });
  for_meeting(boxes_of(placed, own_.edges, margin),
              boxes_of(others_.corners, others_.edges, margin), [&](std::size_t e, std::size_t f) {
                const auto &a = own_.edges[e], &b = others_.edges[f];
                keep({{a[0], a[1], b[0], b[1]}, true, true, 0});
              });
  std::sort(pairs_.begin(), pairs_.end(),
            [](const Pair& a, const Pair& b) { return a.apart < b.apart; });
}

/// Pairs that may be nearer than a distance: none has come nearer by more than the most that a corner went.
template <class F>
void RigidAmongFixed::for_pairs(double distance, F f) const {
  for (const Pair& pair : pairs_) {
    if (pair.apart > distance + went_) return;
    f(pair);
  }
}

double RigidAmongFixed::energy(const State& at) const {
  const double h = settings_.h, s = settings_.reach * settings_.reach;
  const Mat3 off = at.rotation - goal_rotation_;
  double barriers = 0;
  for_pairs(settings_.reach, [&](const Pair& pair) {
    barriers += barrier_of(nearest(at, pair).gap.squaredNorm(), s);
  });
  return 0.5 * mass_ * (at.center - goal_).squaredNorm() +
         0.5 * (off * second_ * off.transpose()).trace() + h * h * settings_.stiffness * barriers;
}

double RigidAmongFixed::largest_way(const Six& way) const {
  return way.head<3>().norm() + way.tail<3>().norm() * radius_;
}

/// Share of a way in which no pair passes the plane across its gap. Turns are off straight ways by half of their square.
double RigidAmongFixed::free_share(const State& at, const Six& way) const {
  double share = 1;
  const double bend = 0.5 * way.tail<3>().squaredNorm();
  for_pairs(largest_way(way), [&](const Pair& pair) {
    const Nearest n = nearest(at, pair);
    const double apart = n.gap.norm();
    const double side = pair.first_is_own ? 1 : -1;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!n.is_own[k]) continue;
      const Vec3 go = way.head<3>() + way.tail<3>().cross(n.arm[k]);
      const double closes = -side * go.dot(n.gap) / apart + bend * n.arm[k].norm();
      if (closes > 0) share = std::min(share, 0.8 * apart / closes);
    }
  });
  return share;
}

void RigidAmongFixed::step() {
  const double h = settings_.h;
  goal_ = center_ + h * velocity_ + h * h * settings_.gravity;
  goal_rotation_ = rotation_ + h * turning_;
  const double expected = (goal_ - center_).norm() + h * turning_.norm() * radius_;
  const double margin = 0.25 * expected + 4 * settings_.reach;
  State at{center_, rotation_};
  gather(at, margin);
  for (int iteration = 0;; ++iteration) {
    if (iteration == 1000) throw std::runtime_error("rigid_among_fixed: no end");
    ++iterations_;
    const Mat3 m = at.rotation * second_ * goal_rotation_.transpose();
    Six gradient;
    gradient << mass_ * (at.center - goal_), m(2, 1) - m(1, 2), m(0, 2) - m(2, 0),
        m(1, 0) - m(0, 1);
    SixSix hessian = SixSix::Zero();
    hessian.topLeftCorner<3, 3>() = mass_ * Mat3::Identity();
    hessian.bottomRightCorner<3, 3>() = m.trace() * Mat3::Identity() - 0.5 * (m + m.transpose());
    for_pairs(settings_.reach, [&](const Pair& pair) {
      if (nearest(at, pair).gap.norm() >= settings_.reach) return;
      gradient += h * h * settings_.stiffness * barrier_gradient(at, pair);
      hessian += h * h * settings_.stiffness * barrier_hessian(at, pair);
    });
    const Six way = -oracle::solve_definite(hessian, gradient);
    const double before = energy(at), foreseen = gradient.dot(way);
    const bool is_hidden = std::abs(foreseen) < 1e-11 * std::abs(before);
    const double most = 0.5 * (margin - settings_.reach);  // that corners go on one list
    if (went_ + std::min(most, largest_way(way)) + settings_.reach > margin) gather(at, margin);
    const double went = went_;
    double share = std::min(free_share(at, way), most / std::max(most, largest_way(way)));
    for (;; share *= 0.5) {
      const State trial = moved(at, share * way);
      went_ = went + share * largest_way(way);
      if (is_hidden || energy(trial) <= before + 1e-4 * share * foreseen) {
        at = trial;
        break;
      }
      if (share < 1e-14) throw std::runtime_error("rigid_among_fixed: no state of less energy");
    }
    if (largest_way(way) < settings_.tolerance && share == 1) break;
  }
  velocity_ = (at.center - center_) / h, turning_ = (at.rotation - rotation_) / h;
  center_ = at.center, rotation_ = at.rotation;
}

}  // namespace scree::spatial
