#include "tests/affine_reference/planar_rigid.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/reference/dense_algebra.h"

namespace scree::planar {
namespace {

using Local = Eigen::Matrix<double, 6, 1>;  ///< center and angle of two bodies
using LocalMatrix = Eigen::Matrix<double, 6, 6>;

Vec2 left_of(const Vec2& v) { return {-v.y(), v.x()}; }
double cross2(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }

Vec2 place(const Eigen::Ref<const Eigen::Vector3d>& q, const Vec2& rest) {
  return q.head<2>() + Eigen::Rotation2Dd(q[2]) * rest;
}

/// Barrier of a squared distance, and its derivative by that.
double barrier(double d2, double reach) {
  const double s = reach * reach;
  return d2 < s ? -(d2 - s) * (d2 - s) * std::log(d2 / s) : 0;
}
double barrier_slope(double d2, double reach) {
  const double s = reach * reach;
  return d2 < s ? -2 * (d2 - s) * std::log(d2 / s) - (d2 - s) * (d2 - s) / d2 : 0;
}

/// Way from the nearest point of an edge to a corner, and where on the edge that is.
struct Nearest {
  Vec2 gap;
  double share = 0;
  Nearest(const Vec2& x, const Vec2& a, const Vec2& b) {
    const Vec2 e = b - a;
    share = std::clamp((x - a).dot(e) / e.squaredNorm(), 0.0, 1.0);
    gap = x - a - share * e;
  }
};

struct Placed {
  Vec2 corner, from, to;
};
template <class Pair>
Placed placed(const Pair& pair, const Local& q) {
  return {place(q.head<3>(), pair.corner), place(q.tail<3>(), pair.from),
          place(q.tail<3>(), pair.to)};
}

/// Slope of the way along a direction between a corner and a point of an edge.
Local way_slope(const Local& q, const Vec2& corner, const Vec2& on_edge, const Vec2& along) {
  Local slope;
  slope << along, along.dot(left_of(corner - q.head<2>())), -along,
      -along.dot(left_of(on_edge - q.segment<2>(3)));
  return slope;
}

template <class Pair>
Local barrier_gradient(const Pair& pair, const Local& q, double reach) {
  const Placed x = placed(pair, q);
  const Nearest n(x.corner, x.from, x.to);
  const double slope = barrier_slope(n.gap.squaredNorm(), reach);
  return way_slope(q, x.corner, x.corner - n.gap, 2 * slope * n.gap);
}

/// Differences of the gradient, over ways far below the gap.
template <class Pair>
LocalMatrix barrier_hessian(const Pair& pair, const Local& q, double reach) {
  const Placed x = placed(pair, q);
  const double way = 1e-6 * Nearest(x.corner, x.from, x.to).gap.norm();
  LocalMatrix h;
  for (int k = 0; k < 6; ++k) {
    const double arm = k == 2 ? pair.corner.norm() : k == 5 ? pair.from.norm() : 1;
    const double by = way / std::max(arm, 1e-3);
    Local high = q, low = q;
    high[k] += by, low[k] -= by;
    h.col(k) =
        (barrier_gradient(pair, high, reach) - barrier_gradient(pair, low, reach)) / (2 * by);
  }
  return oracle::semidefinite(0.5 * (h + h.transpose()));
}

/// Potential of a slip over the bound of friction, and its first and second derivatives.
struct Smoothed {
  double value = 0, slope = 0, curve = 0;
  Smoothed(double slip, double e) {
    const double y = std::abs(slip), sign = slip < 0 ? -1 : 1;
    if (y < e) {
      value = y * y / e - y * y * y / (3 * e * e) + e / 3;
      slope = sign * (2 - y / e) * y / e, curve = 2 * (1 - y / e) / e;
    } else {
      value = y, slope = sign;
    }
  }
};

Local local(const Eigen::VectorXd& q, std::size_t a, std::size_t b) {
  Local r;
  r << q.segment<3>(3 * static_cast<Eigen::Index>(a)),
      q.segment<3>(3 * static_cast<Eigen::Index>(b));
  return r;
}

}  // namespace

double inertial_stiffness(const RigidSettings& s, double mass, double times) {
  const double half = 0.5 * s.reach;
  return times * mass * s.reach / (s.h * s.h * -2 * half * barrier_slope(half * half, s.reach));
}

std::vector<RigidSystem::Beside> RigidSystem::near(const State& q, double distance) const {
  std::vector<Beside> found;
  for (std::size_t a = 0; a < bodies_.size(); ++a)
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (a == b || (bodies_[a].fixed && bodies_[b].fixed)) continue;
      const Local at = local(q, a, b);
      for (const auto& own : bodies_[a].loops)
        for (const Vec2& corner : own) {
          const Vec2 x = place(at.head<3>(), corner);
          for (const auto& loop : bodies_[b].loops)
            for (std::size_t k = 0; k < loop.size(); ++k) {
              const Beside pair{a, b, corner, loop[k], loop[(k + 1) % loop.size()]};
              const Vec2 from = place(at.tail<3>(), pair.from), to = place(at.tail<3>(), pair.to);
              if (Nearest(x, from, to).gap.norm() < distance) found.push_back(pair);
            }
        }
    }
  return found;
}

bool RigidSystem::crosses(const State& q) const {
  for (std::size_t a = 0; a < bodies_.size(); ++a)
    for (std::size_t b = a + 1; b < bodies_.size(); ++b) {
      const Local at = local(q, a, b);
      for (const auto& own : bodies_[a].loops)
        for (std::size_t i = 0; i < own.size(); ++i) {
          const Vec2 p = place(at.head<3>(), own[i]);
          const Vec2 r = place(at.head<3>(), own[(i + 1) % own.size()]);
          for (const auto& loop : bodies_[b].loops)
            for (std::size_t k = 0; k < loop.size(); ++k) {
              const Vec2 s = place(at.tail<3>(), loop[k]);
              const Vec2 t = place(at.tail<3>(), loop[(k + 1) % loop.size()]);
              if (cross2(r - p, s - p) * cross2(r - p, t - p) <= 0 &&
                  cross2(t - s, p - s) * cross2(t - s, r - s) <= 0)
                return true;
            }
        }
    }
  return false;
}

std::vector<RigidSystem::Rubbing> RigidSystem::rubbing(const State& q) const {
  std::vector<Rubbing> rubs;
  if (settings_.mu == 0) return rubs;
  for (const Beside& pair : near(q, settings_.reach)) {
    const Placed x = placed(pair, local(q, pair.body, pair.other));
    const Nearest n(x.corner, x.from, x.to);
    const double d2 = n.gap.squaredNorm();
    rubs.push_back({pair, n.share,
                    -2 * settings_.stiffness * std::sqrt(d2) * barrier_slope(d2, settings_.reach),
                    left_of(n.gap.normalized())});
  }
  return rubs;
}

double RigidSystem::energy(const State& q, const std::vector<Rubbing>& rubs) const {
  const double h = settings_.h;
  double sum = 0, acting = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const RigidBody& body = bodies_[b];
    if (body.fixed) continue;
    const auto k = 3 * static_cast<Eigen::Index>(b);
    const Vec2 goal = body.center + h * body.velocity + h * h * settings_.gravity;
    const Vec2 goal_turn = Vec2(std::cos(body.angle), std::sin(body.angle)) + h * body.turn;
    sum += 0.5 * body.mass * (q.segment<2>(k) - goal).squaredNorm();
    sum += 0.5 * body.inertia *
           (Vec2(std::cos(q[k + 2]), std::sin(q[k + 2])) - goal_turn).squaredNorm();
  }
  for (const Beside& pair : near(q, settings_.reach)) {
    const Placed x = placed(pair, local(q, pair.body, pair.other));
    acting += settings_.stiffness *
              barrier(Nearest(x.corner, x.from, x.to).gap.squaredNorm(), settings_.reach);
  }
  for (const Rubbing& rub : rubs) {
    const Placed at = placed(rub.pair, local(q, rub.pair.body, rub.pair.other));
    const Placed was = placed(rub.pair, local(start_, rub.pair.body, rub.pair.other));
    const Vec2 on = at.from + rub.share * (at.to - at.from),
               before = was.from + rub.share * (was.to - was.from);
    const double slip = rub.along.dot(at.corner - was.corner - on + before);
    acting += settings_.mu * rub.force * Smoothed(slip, settings_.slip_speed * h).value;
  }
  return sum + h * h * acting;
}

void RigidSystem::derivatives(const State& q, const std::vector<Rubbing>& rubs,
                              Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const {
  const double h = settings_.h;
  gradient = Eigen::VectorXd::Zero(q.size());
  hessian = Eigen::MatrixXd::Zero(q.size(), q.size());
  const auto add = [&](const Beside& pair, const Local& g, const LocalMatrix& m) {
    const Eigen::Index at[2] = {3 * static_cast<Eigen::Index>(pair.body),
                                3 * static_cast<Eigen::Index>(pair.other)};
    for (int i = 0; i < 2; ++i) {
      gradient.segment<3>(at[i]) += g.segment<3>(3 * i);
      for (int j = 0; j < 2; ++j) hessian.block<3, 3>(at[i], at[j]) += m.block<3, 3>(3 * i, 3 * j);
    }
  };
  for (const Beside& pair : near(q, settings_.reach)) {
    const Local at = local(q, pair.body, pair.other);
    const double scale = h * h * settings_.stiffness;
    add(pair, scale * barrier_gradient(pair, at, settings_.reach),
        scale * barrier_hessian(pair, at, settings_.reach));
  }
  for (const Rubbing& rub : rubs) {
    const Local here = local(q, rub.pair.body, rub.pair.other);
    const Placed at = placed(rub.pair, here);
    const Placed was = placed(rub.pair, local(start_, rub.pair.body, rub.pair.other));
    const Vec2 on = at.from + rub.share * (at.to - at.from),
               before = was.from + rub.share * (was.to - was.from);
    const Smoothed f(rub.along.dot(at.corner - was.corner - on + before), settings_.slip_speed * h);
    const Local slope = way_slope(here, at.corner, on, rub.along);
    const double scale = h * h * settings_.mu * rub.force;
    add(rub.pair, scale * f.slope * slope, scale * f.curve * slope * slope.transpose());
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const RigidBody& body = bodies_[b];
    const auto k = 3 * static_cast<Eigen::Index>(b);
    if (body.fixed) {
      gradient.segment<3>(k).setZero();
      hessian.middleRows(k, 3).setZero(), hessian.middleCols(k, 3).setZero();
      hessian.block<3, 3>(k, k).setIdentity();
      continue;
    }
    const Vec2 goal = body.center + h * body.velocity + h * h * settings_.gravity;
    const Vec2 goal_turn = Vec2(std::cos(body.angle), std::sin(body.angle)) + h * body.turn;
    const Vec2 axis(std::cos(q[k + 2]), std::sin(q[k + 2]));
    gradient.segment<2>(k) += body.mass * (q.segment<2>(k) - goal);
    gradient[k + 2] -= body.inertia * left_of(axis).dot(goal_turn);
    hessian(k, k) += body.mass, hessian(k + 1, k + 1) += body.mass;
    hessian(k + 2, k + 2) += body.inertia * axis.dot(goal_turn);
  }
}

double RigidSystem::largest_way(const Eigen::VectorXd& step) const {
  double most = 0;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const auto k = 3 * static_cast<Eigen::Index>(b);
    for (const auto& loop : bodies_[b].loops)
      for (const Vec2& corner : loop)
        most = std::max(most, step.segment<2>(k).norm() + std::abs(step[k + 2]) * corner.norm());
  }
  return most;
}

void RigidSystem::minimize(State& q, const std::vector<Rubbing>& rubs) const {
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
  for (int iteration = 0; iteration < 500; ++iteration) {
    derivatives(q, rubs, gradient, hessian);
    const Eigen::VectorXd step = -oracle::solve_definite(hessian, gradient);
    const double before = energy(q, rubs), way = largest_way(step);
    // Rounding of the energy hides the last steps, which Newton's method takes alone.
    const bool is_hidden = std::abs(gradient.dot(step)) < 1e-11 * std::abs(before);
    double share = 1;
    for (;; share *= 0.5) {
      const State trial = q + share * step;
      if (!crosses(trial) &&
          (is_hidden || energy(trial, rubs) <= before + 1e-4 * share * gradient.dot(step))) {
        q = trial;
        break;
      }
      if (share < 1e-14) throw std::runtime_error("planar_rigid: no state of less energy");
    }
    if (way < settings_.tolerance && share == 1) return;
  }
  throw std::runtime_error("planar_rigid: Newton's method does not end");
}

void RigidSystem::step() {
  const int most_solves = settings_.friction_solves > 0 ? settings_.friction_solves : 100;
  State q(3 * static_cast<Eigen::Index>(bodies_.size()));
  for (std::size_t b = 0; b < bodies_.size(); ++b)
    q.segment<3>(3 * static_cast<Eigen::Index>(b)) << bodies_[b].center, bodies_[b].angle;
  start_ = q;
  for (int solve = 0; solve < most_solves; ++solve) {
    const State before = q;
    minimize(q, rubbing(q));
    if (settings_.mu == 0 || largest_way(q - before) < 10 * settings_.tolerance) break;
  }
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    RigidBody& body = bodies_[b];
    if (body.fixed) continue;
    const auto k = 3 * static_cast<Eigen::Index>(b);
    body.velocity = (q.segment<2>(k) - body.center) / settings_.h;
    body.turn = (Vec2(std::cos(q[k + 2]), std::sin(q[k + 2])) -
                 Vec2(std::cos(body.angle), std::sin(body.angle))) /
                settings_.h;
    body.center = q.segment<2>(k), body.angle = q[k + 2];
  }
}

}  // namespace scree::planar
