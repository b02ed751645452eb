#include "tests/plain_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <tuple>

namespace scree::fixtures {

int PlainProblem::add_sphere(double m, double r, double spin_factor) {
  oracle::Body body;
  body.inv_mass.setConstant(1 / m);
  body.inv_inertia = Eigen::Matrix3d::Identity() * (spin_factor / (m * r * r));
  return add(body, m, r,
             Eigen::Matrix3d::Identity() * (spin_factor > 0 ? m * r * r / spin_factor : 0), true);
}

int PlainProblem::add_general(double m, const Eigen::Matrix3d& body_inertia) {
  oracle::Body body;
  body.inv_mass.setConstant(1 / m);
  body.inv_inertia = body_inertia.inverse();
  return add(body, m, 1, body_inertia, false);
}

int PlainProblem::add_fixed() { return add(oracle::Body{}, 0, 1, Eigen::Matrix3d::Zero(), false); }

oracle::Contact& PlainProblem::add_radial_contact(int a, int b, const Eigen::Vector3d& n,
                                                  double mu) {
  oracle::Contact c;
  c.a = a;
  c.b = b;
  c.normal = n;
  c.arm_a = radius[a] * n;
  c.arm_b = -radius[b] * n;
  c.mu = mu;
  data.contacts.push_back(c);
  return data.contacts.back();
}

int PlainProblem::add(const oracle::Body& body, double m, double r,
                      const Eigen::Matrix3d& body_inertia, bool sphere) {
  is_sphere.push_back(sphere);
  data.bodies.push_back(body);
  mass.push_back(m);
  radius.push_back(r);
  inertia.push_back(body_inertia);
  return static_cast<int>(data.bodies.size()) - 1;
}

PlainProblem random_problem(const RandomProblem& options) {
  std::mt19937 generator(options.seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(generator), normal(generator), normal(generator));
  };

  PlainProblem p;
  p.layout = options.layout;
  p.data.has_moments = options.layout == ContactLayout::rolling;
  p.data.free_count = options.free_count;
  const bool mixed = options.layout == ContactLayout::mixed;
  const auto is_radial = [&](int i) {  // the body
    if (!mixed) return options.layout == ContactLayout::radial;
    return i < options.free_count ? options.only_spheres || i % 3 != 1
                                  : (i - options.free_count) % 2 == 0;
  };
  for (int i = 0; i < options.free_count; ++i) {
    const double m = 0.5 + 2 * unit(generator);
    if (is_radial(i)) {
      p.add_sphere(m, 0.5 + unit(generator), i % 7 == 3 ? 0.0 : 2.5);
    } else {
      const Eigen::Matrix3d turn = Eigen::Quaterniond(normal(generator), normal(generator),
                                                      normal(generator), normal(generator))
                                       .normalized()
                                       .toRotationMatrix();
      const Eigen::Vector3d moments =
          m * (Eigen::Vector3d(0.3, 0.3, 0.3) + 0.5 * vector().cwiseAbs());
      p.add_general(m, turn * moments.asDiagonal() * turn.transpose());
    }
  }
  for (int i = 0; i < options.fixed_count; ++i) p.add_fixed();
  const int body_count = options.free_count + options.fixed_count;

  // The feasible velocity; fixed bodies may move along a prescribed way.
  std::vector<oracle::Body>& bodies = p.data.bodies;
  for (int i = 0; i < body_count; ++i) {
    bodies[i].velocity = 0.5 * vector();
    if (!is_radial(i) || i < options.free_count) bodies[i].angular_velocity = 0.5 * vector();
  }
  while (p.contact_count() < options.contact_count) {
    int a = static_cast<int>(unit(generator) * options.free_count);
    int b = static_cast<int>(unit(generator) * body_count);
    const int hub = options.free_count / 2;
    if (p.contact_count() < options.hub_contacts) (a < hub ? b : a) = hub;
    if (a >= b) continue;
    oracle::Contact& c =
        p.add_radial_contact(a, b, vector().normalized(), options.mu_max * unit(generator));
    if (p.contact_count() % 9 == 0) c.mu = 0;
    const bool radial = is_radial(a) && is_radial(b);
    if (mixed && radial) ++p.radial_count;
    if (!radial) {
      c.arm_a += 0.5 * vector();
      c.arm_b += 0.5 * vector();
    }
    if (options.has_adhesion) c.adhesion = 0.2 * unit(generator);
    if (p.data.has_moments) {
      c.length = 0.5 + unit(generator);
      c.rolling = p.contact_count() % 5 == 0 ? 0 : 0.3 * unit(generator);
      c.spinning = p.contact_count() % 7 == 0 ? 0 : 0.2 * unit(generator);
    }
  }
  const auto group = [&](const oracle::Contact& c) {
    return mixed && !(is_radial(c.a) && is_radial(c.b)) ? 1 : 0;
  };
  std::stable_sort(p.data.contacts.begin(), p.data.contacts.end(),
                   [&](const auto& x, const auto& y) {
                     return std::tuple(group(x), x.a, x.b) < std::tuple(group(y), y.a, y.b);
                   });

  for (oracle::Contact& c : p.data.contacts) {
    const oracle::Body &a = bodies[c.a], &b = bodies[c.b];
    const Eigen::Vector3d u = b.velocity + b.angular_velocity.cross(c.arm_b) - a.velocity -
                              a.angular_velocity.cross(c.arm_a);
    const Eigen::Vector3d turn = c.length * (b.angular_velocity - a.angular_velocity);
    const double needed = c.mu * (u - u.dot(c.normal) * c.normal).norm() +
                          c.rolling * (turn - turn.dot(c.normal) * c.normal).norm() +
                          c.spinning * std::abs(turn.dot(c.normal));
    c.bias = needed - u.dot(c.normal) + 0.02 + 0.2 * unit(generator) * unit(generator);
  }
  for (int i = 0; i < options.free_count; ++i) {
    bodies[i].velocity += 2 * vector();
    // What cannot turn keeps the feasible rate.
    if (bodies[i].inv_inertia.trace() > 0) bodies[i].angular_velocity += vector();
  }
  return p;
}

PlainProblem lattice_problem(int n, double share, unsigned seed) {
  PlainProblem p;
  std::vector<std::array<int, 3>> sites;
  for (int x = 0; x < 2 * n; ++x)
    for (int y = 0; y < 2 * n; ++y)
      for (int z = 0; z < 2 * n; ++z)
        if ((x + y + z) % 2 == 0) sites.push_back({x, y, z});
  for (std::size_t i = 0; i < sites.size(); ++i) p.add_sphere(1, 0.5);
  p.data.free_count = static_cast<int>(sites.size());
  const auto site = [&](int x, int y, int z) {
    return (x * 2 * n * 2 * n + y * 2 * n + z) / 2;  // every other cell holds a site, in this order
  };
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const int steps[6][3] = {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (const auto& s : steps) {
      const int x = sites[i][0] + s[0], y = sites[i][1] + s[1], z = sites[i][2] + s[2];
      if (x < 0 || y < 0 || z < 0 || x >= 2 * n || y >= 2 * n || z >= 2 * n) continue;
      if (unit(generator) > share) continue;
      const int other = site(x, y, z);
      const int a = static_cast<int>(i);
      p.add_radial_contact(std::min(a, other), std::max(a, other),
                           Eigen::Vector3d(s[0], s[1], s[2]).normalized(), 0.5);
    }
  }
  std::stable_sort(p.data.contacts.begin(), p.data.contacts.end(),
                   [](const auto& x, const auto& y) { return x.a < y.a; });
  return p;
}

template <class Real>
void round_to(PlainProblem& p) {
  const auto scalar = [](double& x) { x = static_cast<Real>(x); };
  const auto each = [](auto& m) { m = m.template cast<Real>().template cast<double>(); };
  for (std::size_t i = 0; i < p.data.bodies.size(); ++i) {
    oracle::Body& body = p.data.bodies[i];
    each(body.velocity);
    each(body.inv_mass);
    each(body.inv_inertia);
    each(body.angular_velocity);
  }
  for (oracle::Contact& c : p.data.contacts) {
    each(c.normal);
    each(c.arm_a);
    each(c.arm_b);
    for (double* x : {&c.mu, &c.bias, &c.adhesion, &c.length, &c.rolling, &c.spinning}) scalar(*x);
  }
}

template void round_to<float>(PlainProblem&);
template void round_to<double>(PlainProblem&);

}  // namespace scree::fixtures
