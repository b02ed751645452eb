#pragma once
// Stored contact problems for tests, and the same ones as the dense oracle takes them.

#include <Eigen/Core>
#include <algorithm>
#include <random>

#include "host/problems/stored_problem.h"
#include "tests/problem_builder.h"

namespace scree::fixtures {

inline Eigen::MatrixXd dense(const SparseMatrix& a) {
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(a.row_count, a.column_count);
  for (int row = 0; row < a.row_count; ++row)
    for (int k = a.row_start[row]; k < a.row_start[row + 1]; ++k) d(row, a.column[k]) += a.value[k];
  return d;
}

/// A random problem in the form that is stored, with a random guess.
inline BodyProblem random_body_problem(const RandomProblem& options) {
  const PlainProblem plain = random_problem(options);
  const bool radial = options.layout == ContactLayout::radial;
  BodyProblem p;
  p.layout = options.layout;
  p.source = {"random", "tests", "cpu", "double", 7, 0.006, 1e-3, 9.81e-3};
  p.free_count = plain.data.free_count;
  for (std::size_t i = 0; i < plain.data.bodies.size(); ++i) {
    const oracle::Body& body = plain.data.bodies[i];
    const double scale = radial ? plain.radius[i] : 1;
    p.body_id.push_back(static_cast<int>(i) + 100);
    p.free_velocity.push_back(
        {to_vec3<double>(body.velocity), to_vec3<double>(scale * body.angular_velocity)});
    if (radial) {
      p.radial_inertia.push_back({body.inv_mass.x(), scale * scale * body.inv_inertia(0, 0)});
    } else {
      p.general_inertia.push_back({plain.mass[i], to_vec3<double>(body.inv_mass),
                                   to_sym3<double>(plain.inertia[i]),
                                   to_sym3<double>(body.inv_inertia)});
    }
  }
  std::mt19937 generator(options.seed + 1000);
  std::normal_distribution<double> normal;
  for (const oracle::Contact& c : plain.data.contacts) {
    p.body_a.push_back(c.a);
    p.body_b.push_back(c.b);
    p.normal.push_back(to_vec3<double>(c.normal));
    p.bias.push_back(c.bias);
    p.friction.push_back(c.mu);
    p.adhesion.push_back(c.adhesion);
    if (!radial) {
      p.arm_a.push_back(to_vec3<double>(c.arm_a));
      p.arm_b.push_back(to_vec3<double>(c.arm_b));
    }
    if (options.layout == ContactLayout::rolling)
      p.rolling.push_back({c.length, c.rolling, c.spinning});
    for (int k = 0; k < vectors_per_contact(options.layout); ++k)
      p.impulse.push_back({normal(generator), normal(generator), normal(generator)});
  }
  return p;
}

/// The problem for the oracle. In the radial layout every sphere gets the radius 1, so that its
/// surface speed is its angular velocity.
inline oracle::Problem oracle_of(const BodyProblem& p) {
  oracle::Problem o;
  o.has_moments = p.layout == ContactLayout::rolling;
  o.free_count = p.free_count;
  const bool radial = p.layout == ContactLayout::radial;
  const auto full = [](const Sym3<double>& m) {
    Eigen::Matrix3d f;
    f << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
    return f;
  };
  for (std::size_t i = 0; i < p.free_velocity.size(); ++i) {
    oracle::Body body;
    body.velocity = to_eigen(p.free_velocity[i].linear);
    body.angular_velocity = to_eigen(p.free_velocity[i].angular);
    if (radial) {
      body.inv_mass.setConstant(p.radial_inertia[i].inv_mass);
      body.inv_inertia = Eigen::Matrix3d::Identity() * p.radial_inertia[i].inv_spin;
    } else {
      body.inv_mass = to_eigen(p.general_inertia[i].inv_mass);
      body.inv_inertia = full(p.general_inertia[i].inv_inertia);
    }
    o.bodies.push_back(body);
  }
  for (std::size_t c = 0; c < p.body_a.size(); ++c) {
    oracle::Contact k;
    k.a = p.body_a[c];
    k.b = p.body_b[c];
    k.normal = to_eigen(p.normal[c]);
    k.arm_a = radial ? k.normal : to_eigen(p.arm_a[c]);
    k.arm_b = radial ? Eigen::Vector3d(-k.normal) : to_eigen(p.arm_b[c]);
    k.mu = p.friction[c];
    k.bias = p.bias[c];
    k.adhesion = p.adhesion[c];
    if (o.has_moments) {
      k.length = p.rolling[c].length;
      k.rolling = p.rolling[c].rolling;
      k.spinning = p.rolling[c].spinning;
    }
    o.contacts.push_back(k);
  }
  return o;
}

/// The problem as files hold it.
inline StoredProblem stored(const BodyProblem& p) {
  StoredProblem s;
  s.form = p;
  return s;
}

}  // namespace scree::fixtures
