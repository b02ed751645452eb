#pragma once
// Small contact problems given by W, q and mu, for tests of the solvers that take those.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "host/problems/assembled_form.h"
#include "host/problems/matrix_form.h"
#include "tests/stored_problem_samples.h"

namespace scree::fixtures {

/// One contact.
inline AssembledProblem one_contact(const Block3& W, const std::array<double, 3>& q, double mu) {
  return assemble(1, {{0, 0, W}}, {q[0], q[1], q[2]}, {mu});
}

/// One contact with much friction, on which Newton's method for box friction fails with some seeds.
inline AssembledProblem one_random_contact(unsigned seed) {
  return assembled_form(local_form(random_body_problem({.layout = ContactLayout::general,
                                                        .free_count = 1,
                                                        .fixed_count = 2,
                                                        .contact_count = 1,
                                                        .seed = seed,
                                                        .mu_max = 3.0})));
}

/// Two contacts of a mass of 1 at one point, where it comes down with a speed of 1. No impulses can
/// take from the contacts velocities along their tangents that differ.
inline AssembledProblem doubled_contact(double difference) {
  const Block3 unit{1, 0, 0, 0, 1, 0, 0, 0, 1};
  return assemble(2, {{0, 0, unit}, {0, 1, unit}, {1, 0, unit}, {1, 1, unit}},
                  {-1, 0.5 * difference, 0, -1, -0.5 * difference, 0}, {0.5, 0.5});
}

/// W = H^T H of random H with fewer rows than columns where `redundant`; every contact approaches.
inline LocalProblem random_local_problem(int dimension, int contact_count, bool redundant,
                                         unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  const int rows = dimension * contact_count;
  const int freedoms = redundant ? 2 * rows / 3 : rows + 3;
  Eigen::MatrixXd H(freedoms, rows);
  for (int i = 0; i < freedoms; ++i)
    for (int j = 0; j < rows; ++j) H(i, j) = normal(generator);
  // Contacts push one body apart in like directions: velocities inside all dual cones exist.
  for (int j = 0; j < rows; j += dimension) H(0, j) += 6;
  const Eigen::MatrixXd W = H.transpose() * H;
  LocalProblem p;
  p.dimension = dimension;
  std::vector<MatrixEntry> entries;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) entries.push_back({i, j, W(i, j)});
  p.W = compress(rows, rows, entries);
  Eigen::VectorXd v(freedoms);
  for (int i = 0; i < freedoms; ++i) v(i) = normal(generator);
  v(0) -= 3;
  const Eigen::VectorXd q = H.transpose() * v;
  p.q.assign(q.data(), q.data() + rows);
  for (int c = 0; c < contact_count; ++c) p.mu.push_back(0.1 + 0.1 * (c % 7));
  return p;
}

/// A box of mass m on the four corners of its lower face, a square of half the width `half`, with
/// its center at height `height`. It falls for a step h: W has rank 6 of 12.
inline AssembledProblem box_on_four_corners(double m, double half, double height, double speed) {
  const double inv_inertia[3] = {1 / (m / 3 * (half * half + height * height)),
                                 1 / (m / 3 * (half * half + height * height)),
                                 1 / (m / 3 * 2 * half * half)};
  Eigen::MatrixXd H = Eigen::MatrixXd::Zero(6, 12), M = Eigen::MatrixXd::Zero(6, 6);
  for (int k = 0; k < 3; ++k) {
    M(k, k) = 1 / m;
    M(3 + k, 3 + k) = inv_inertia[k];
  }
  for (int c = 0; c < 4; ++c) {
    const Eigen::Vector3d arm(c % 2 == 0 ? half : -half, c < 2 ? half : -half, -height);
    const Eigen::Vector3d axes[3] = {Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX(),
                                     Eigen::Vector3d::UnitY()};
    for (int k = 0; k < 3; ++k) {
      H.block<3, 1>(0, 3 * c + k) = axes[k];
      H.block<3, 1>(3, 3 * c + k) = arm.cross(axes[k]);
    }
  }
  const Eigen::MatrixXd W = H.transpose() * M * H;
  std::vector<PlacedBlock> blocks;
  for (int a = 0; a < 4; ++a)
    for (int b = 0; b < 4; ++b) {
      PlacedBlock block{a, b, {}};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) block.value[3 * i + j] = W(3 * a + i, 3 * b + j);
      blocks.push_back(block);
    }
  std::vector<double> q(12, 0.0);
  for (int c = 0; c < 4; ++c) q[3 * c] = -speed;
  return assemble(4, blocks, q, {0.5, 0.5, 0.5, 0.5});
}

/// W r + q.
inline std::vector<double> velocity(const AssembledProblem& p, const std::vector<double>& r) {
  std::vector<double> u;
  multiply(p, r, u);
  for (std::size_t k = 0; k < u.size(); ++k) u[k] += p.q[k];
  return u;
}

/// Largest error of a row of box friction with coupled bounds, by r = the nearest to r - u
/// of what is allowed.
inline double box_friction_error(const AssembledProblem& p, const std::vector<double>& r) {
  const std::vector<double> u = velocity(p, r);
  double largest = 0;
  for (std::size_t k = 0; k < r.size(); ++k) {
    const double normal = r[k - k % 3], bound = p.mu[k / 3] * std::max(0.0, normal);
    const double nearest =
        k % 3 == 0 ? std::max(0.0, r[k] - u[k]) : std::clamp(r[k] - u[k], -bound, bound);
    largest = std::max(largest, std::abs(r[k] - nearest));
  }
  return largest;
}

}  // namespace scree::fixtures
