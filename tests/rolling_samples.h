#pragma once
// Problems with rolling friction as FCLIB's global form holds them: five rows a contact.

#include <cmath>
#include <cstdint>
#include <random>
#include <utility>
#include <vector>

#include "host/problems/matrix_problem.h"

namespace scree::fixtures {

/// One contact with a plane along z: rows normal, x, y, rates about x and y of a sphere over it.
inline void add_floor_rows(GlobalProblem& p, std::vector<MatrixEntry>& h, int body, double radius) {
  const int at = 6 * body, row = static_cast<int>(p.w.size());
  // u = v + omega x (0, 0, -radius).
  h.insert(h.end(), {{at + 2, row, 1},
                     {at + 0, row + 1, 1},
                     {at + 4, row + 1, -radius},
                     {at + 1, row + 2, 1},
                     {at + 3, row + 2, radius},
                     {at + 3, row + 3, 1},
                     {at + 4, row + 4, 1}});
  p.w.insert(p.w.end(), 5, 0.0);
}

/// A solid sphere of 1 kg and radius 0.1 m that rolls along x without sliding and
/// presses with 0.3 N s.
struct RollingSphere {
  static constexpr double mass = 1, radius = 0.1, inertia = 0.4 * mass * radius * radius;
  static constexpr double speed = 0.5, press = 0.3;
};

inline GlobalProblem rolling_sphere(double mu, double mu_r) {
  using S = RollingSphere;
  GlobalProblem p;
  p.dimension = 5;
  std::vector<MatrixEntry> m, h;
  for (int k = 0; k < 6; ++k) m.push_back({k, k, k < 3 ? S::mass : S::inertia});
  add_floor_rows(p, h, 0, S::radius);
  p.M = compress(6, 6, m);
  p.H = compress(6, 5, h);
  p.f = {S::mass * S::speed, 0, -S::press, 0, S::inertia * S::speed / S::radius, 0};
  p.mu = {mu};
  p.mu_r = {mu_r};
  return p;
}

/// Spheres on the sites of a cubic lattice over a floor, under gravity, with random velocities: six
/// degrees of freedom a sphere against some fifteen rows.
inline GlobalProblem rolling_pile(int across, int high, double mu, double mu_r, unsigned seed) {
  constexpr double mass = 0.1, radius = 0.05, inertia = 0.4 * mass * radius * radius;
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  GlobalProblem p;
  p.dimension = 5;
  std::vector<MatrixEntry> m, h;
  const auto body = [&](int i, int j, int k) { return (k * across + j) * across + i; };
  const int bodies = across * across * high;
  for (int b = 0; b < bodies; ++b)
    for (int k = 0; k < 6; ++k) {
      m.push_back({6 * b + k, 6 * b + k, k < 3 ? mass : inertia});
      const double velocity = (k < 3 ? 0.05 : 1.0) * normal(generator) - (k == 2 ? 0.1 : 0);
      p.f.push_back((k < 3 ? mass : inertia) * velocity);
    }
  // Along an axis: the normal, then the other two axes as tangents, of B against A.
  const auto add_pair = [&](int a, int b, int axis) {
    const int row = static_cast<int>(p.w.size());
    for (int k = 0; k < 3; ++k) {
      const int n = axis, t = (axis + k) % 3;
      h.push_back({6 * a + t, row + k, -1});
      h.push_back({6 * b + t, row + k, 1});
      if (k == 0) continue;
      // u_t of omega x arm with arms +radius e_n of A and -radius e_n of B; s = e_s . (e_t x e_n)
      const int s = 3 - n - t;
      const double sign = (t + 1) % 3 == n ? 1 : -1;
      h.push_back({6 * a + 3 + s, row + k, sign * radius});
      h.push_back({6 * b + 3 + s, row + k, sign * radius});
      h.push_back({6 * a + 3 + t, row + k + 2, -1});
      h.push_back({6 * b + 3 + t, row + k + 2, 1});
    }
    p.w.insert(p.w.end(), 5, 0.0);
  };
  for (int k = 0; k < high; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i) {
        if (k == 0) add_floor_rows(p, h, body(i, j, k), radius);
        if (i + 1 < across) add_pair(body(i, j, k), body(i + 1, j, k), 0);
        if (j + 1 < across) add_pair(body(i, j, k), body(i, j + 1, k), 1);
        if (k + 1 < high) add_pair(body(i, j, k), body(i, j, k + 1), 2);
      }
  const int rows = static_cast<int>(p.w.size());
  p.M = compress(6 * bodies, 6 * bodies, m);
  p.H = compress(6 * bodies, rows, h);
  p.mu.assign(static_cast<std::size_t>(rows / 5), mu);
  p.mu_r.assign(static_cast<std::size_t>(rows / 5), mu_r);
  return p;
}

/// W = H^T H of a random H with fewer rows than columns where `redundant`, contacts that approach,
/// and coefficients that differ, some of them zero.
inline LocalProblem random_rolling_problem(int contact_count, bool redundant, unsigned seed) {
  std::mt19937 generator(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit;
  const int rows = 5 * contact_count, freedoms = redundant ? 2 * rows / 3 : rows + 3;
  std::vector<std::vector<double>> H(static_cast<std::size_t>(freedoms));
  for (int i = 0; i < freedoms; ++i)
    for (int j = 0; j < rows; ++j)
      H[i].push_back(normal(generator) + (i == 0 && j % 5 == 0 ? 8 : 0));
  LocalProblem p;
  p.dimension = 5;
  std::vector<MatrixEntry> entries;
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < rows; ++j) {
      double sum = 0;
      for (const std::vector<double>& row : H) sum += row[i] * row[j];
      entries.push_back({i, j, sum});
    }
  p.W = compress(rows, rows, entries);
  p.q.assign(static_cast<std::size_t>(rows), 0.0);
  for (int i = 0; i < freedoms; ++i) {
    const double v = normal(generator) - (i == 0 ? 3 : 0);
    for (int j = 0; j < rows; ++j) p.q[j] += H[i][j] * v;
  }
  for (int c = 0; c < contact_count; ++c) {
    p.mu.push_back(c % 5 == 4 ? 0 : unit(generator));
    p.mu_r.push_back(c % 4 == 3 ? 0 : 0.5 * unit(generator));
  }
  return p;
}

}  // namespace scree::fixtures
