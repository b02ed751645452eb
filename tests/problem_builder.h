#pragma once
// Contact problems for tests: as plain arrays for the dense oracle, and the same numbers in backend
// buffers.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "kernels/backend/backend.h"
#include "kernels/contact_problem.h"
#include "tests/reference/dense_oracle.h"

namespace scree::fixtures {

inline Eigen::Vector3d to_eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
template <class Real>
Vec3<Real> to_vec3(const Eigen::Vector3d& v) {
  return {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z())};
}

/// A problem in double. In the radial layout the arms are +radius[a] * n and -radius[b] * n,
/// inertia is isotropic and fixed bodies do not rotate.
struct PlainProblem {
  ContactLayout layout = ContactLayout::radial;
  oracle::Problem data;
  std::vector<double> radius;            ///< [m] per body
  std::vector<double> mass;              ///< [kg] per body
  std::vector<Eigen::Matrix3d> inertia;  ///< [kg m^2] per body, not in the radial layout

  Index contact_count() const { return static_cast<Index>(data.contacts.size()); }

  /// Adds a sphere (or, with spin_factor 0, a block that does not turn).
  /// @param spin_factor  r^2 m / I: 2.5 for a solid sphere
  int add_sphere(double m, double r, double spin_factor = 2.5) {
    oracle::Body body;
    body.inv_mass.setConstant(1 / m);
    body.inv_inertia = Eigen::Matrix3d::Identity() * (spin_factor / (m * r * r));
    return add(body, m, r,
               Eigen::Matrix3d::Identity() * (spin_factor > 0 ? m * r * r / spin_factor : 0));
  }
  int add_general(double m, const Eigen::Matrix3d& body_inertia) {
    oracle::Body body;
    body.inv_mass.setConstant(1 / m);
    body.inv_inertia = body_inertia.inverse();
    return add(body, m, 1, body_inertia);
  }
  int add_fixed() { return add(oracle::Body{}, 0, 1, Eigen::Matrix3d::Zero()); }

  /// A contact whose arms lie along the normal, as in the radial layout.
  oracle::Contact& add_radial_contact(int a, int b, const Eigen::Vector3d& n, double mu) {
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

 private:
  int add(const oracle::Body& body, double m, double r, const Eigen::Matrix3d& body_inertia) {
    data.bodies.push_back(body);
    mass.push_back(m);
    radius.push_back(r);
    inertia.push_back(body_inertia);
    return static_cast<int>(data.bodies.size()) - 1;
  }
};

struct RandomProblem {
  ContactLayout layout = ContactLayout::radial;
  int free_count = 10;
  int fixed_count = 2;
  int contact_count = 20;
  unsigned seed = 1;
  bool has_adhesion = false;
  double mu_max = 1.0;
  int hub_contacts = 0;  ///< so many of them are with one free body
};

/// Random bodies and contacts. A velocity strictly inside all dual cones exists by construction, so
/// the minimum is finite; v* is pushed away from it, so that many contacts are active.
inline PlainProblem random_problem(const RandomProblem& options) {
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
  const bool radial = options.layout == ContactLayout::radial;
  for (int i = 0; i < options.free_count; ++i) {
    const double m = 0.5 + 2 * unit(generator);
    if (radial) {
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
    if (!radial || i < options.free_count) bodies[i].angular_velocity = 0.5 * vector();
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
  std::stable_sort(
      p.data.contacts.begin(), p.data.contacts.end(),
      [](const auto& x, const auto& y) { return x.a < y.a || (x.a == y.a && x.b < y.b); });

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

/// Rounds every number to Real, so that oracle and solver see the same problem.
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

template <class Real>
Sym3<Real> to_sym3(const Eigen::Matrix3d& m) {
  Sym3<Real> s;
  s.xx = static_cast<Real>(m(0, 0)), s.yy = static_cast<Real>(m(1, 1)),
  s.zz = static_cast<Real>(m(2, 2));
  s.xy = static_cast<Real>(m(0, 1)), s.xz = static_cast<Real>(m(0, 2)),
  s.yz = static_cast<Real>(m(1, 2));
  return s;
}

/// Spheres on a face-centered lattice of 4 n^3 sites; a share of the neighbors touches.
inline PlainProblem lattice_problem(int n, double share, unsigned seed) {
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

/// |a - b| / |a| over all vectors.
template <class Real>
double relative_distance(const std::vector<Vec3<Real>>& a, const std::vector<Vec3<Real>>& b) {
  double difference = 0, size = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    difference += norm2(Vec3<double>(a[k] - b[k]));
    size += norm2(Vec3<double>(a[k]));
  }
  return std::sqrt(difference / size);
}

/// Linear parts.
template <class Real>
std::vector<Vec3<Real>> linear(const std::vector<Twist<Real>>& twists) {
  std::vector<Vec3<Real>> out;
  for (const Twist<Real>& t : twists) out.push_back(t.linear);
  return out;
}

/// Owns the buffers of a ContactProblem. Contacts of `plain` must be sorted by body a.
template <class B, class Real>
class ProblemBuffers {
 public:
  ProblemBuffers(B& b, const PlainProblem& plain)
      : backend_(&b),
        plain_(plain),
        body_a_(b),
        body_b_(b),
        normal_(b),
        bias_(b),
        friction_(b),
        adhesion_(b),
        arm_a_(b),
        arm_b_(b),
        rolling_(b),
        free_velocity_(b),
        radial_(b),
        general_(b),
        a_start_(b),
        b_start_(b),
        b_contact_(b),
        gamma_(b) {
    const oracle::Problem& d = plain_.data;
    ContactProblem<Real>& p = problem_;
    p.layout = plain_.layout;
    p.contact_count = plain_.contact_count();
    p.free_count = d.free_count;
    p.body_count = static_cast<Index>(d.bodies.size());
    upload_contacts();
    upload_bodies();
    upload_lists();
    const Offset vectors = static_cast<Offset>(p.contact_count) * vectors_per_contact(p.layout);
    gamma_.reserve_discard(vectors);
    clear_impulses();
  }

  const ContactProblem<Real>& problem() const { return problem_; }
  const PlainProblem& plain() const { return plain_; }

  Span<Vec3<Real>> gamma() {
    return gamma_.view(static_cast<Offset>(problem_.contact_count) *
                       vectors_per_contact(problem_.layout));
  }
  void clear_impulses() { fill(*backend_, gamma(), Vec3<Real>{}); }
  /// World vectors in double.
  void set_impulses(const std::vector<Eigen::Vector3d>& vectors) {
    std::vector<Vec3<Real>> host;
    for (const Eigen::Vector3d& v : vectors) host.push_back(to_vec3<Real>(v));
    upload(*backend_, host.data(), gamma());
  }
  std::vector<Eigen::Vector3d> impulses() {
    std::vector<Eigen::Vector3d> vectors;
    for (const Vec3<Real>& v : download(*backend_, gamma()))
      vectors.push_back(to_eigen(Vec3<double>(v)));
    return vectors;
  }
  /// The oracle's twists (v, w) from the solver's: in the radial layout those carry the surface
  /// speed r w.
  Eigen::VectorXd velocities(Span<const Twist<Real>> twists) {
    const std::vector<Twist<Real>> host = download(*backend_, twists);
    Eigen::VectorXd v(6 * static_cast<Eigen::Index>(host.size()));
    for (std::size_t i = 0; i < host.size(); ++i) {
      const double scale = plain_.layout == ContactLayout::radial ? 1 / plain_.radius[i] : 1;
      v.segment<3>(6 * static_cast<Eigen::Index>(i)) = to_eigen(Vec3<double>(host[i].linear));
      v.segment<3>(6 * static_cast<Eigen::Index>(i) + 3) =
          scale * to_eigen(Vec3<double>(host[i].angular));
    }
    return v;
  }

 private:
  template <class T, class F>
  Span<const T> upload_each(Buffer<B, T>& buffer, std::size_t count, F value) {
    std::vector<T> host;
    for (std::size_t i = 0; i < count; ++i) host.push_back(value(i));
    upload(*backend_, host, buffer);
    return std::as_const(buffer).view(static_cast<Offset>(count));
  }

  void upload_contacts() {
    const std::vector<oracle::Contact>& k = plain_.data.contacts;
    const std::size_t n = k.size();
    ContactProblem<Real>& p = problem_;
    const auto real = [](double x) { return static_cast<Real>(x); };
    p.body_a = upload_each(body_a_, n, [&](std::size_t c) { return static_cast<Index>(k[c].a); });
    p.body_b = upload_each(body_b_, n, [&](std::size_t c) { return static_cast<Index>(k[c].b); });
    p.normal = upload_each(normal_, n, [&](std::size_t c) { return to_vec3<Real>(k[c].normal); });
    p.bias = upload_each(bias_, n, [&](std::size_t c) { return real(k[c].bias); });
    p.friction.values = upload_each(friction_, n, [&](std::size_t c) { return real(k[c].mu); });
    if (std::any_of(k.begin(), k.end(), [](const auto& c) { return c.adhesion != 0; })) {
      p.adhesion.values =
          upload_each(adhesion_, n, [&](std::size_t c) { return real(k[c].adhesion); });
    }
    if (p.layout == ContactLayout::radial) return;
    p.arm_a = upload_each(arm_a_, n, [&](std::size_t c) { return to_vec3<Real>(k[c].arm_a); });
    p.arm_b = upload_each(arm_b_, n, [&](std::size_t c) { return to_vec3<Real>(k[c].arm_b); });
    if (p.layout == ContactLayout::general) return;
    p.rolling = upload_each(rolling_, n, [&](std::size_t c) {
      return RollingRow<Real>{real(k[c].length), real(k[c].rolling), real(k[c].spinning)};
    });
  }

  void upload_bodies() {
    const std::vector<oracle::Body>& bodies = plain_.data.bodies;
    const bool radial = plain_.layout == ContactLayout::radial;
    ContactProblem<Real>& p = problem_;
    p.free_velocity = upload_each(free_velocity_, bodies.size(), [&](std::size_t i) {
      const double scale = radial ? plain_.radius[i] : 1;
      return Twist<Real>{to_vec3<Real>(bodies[i].velocity),
                         to_vec3<Real>(scale * bodies[i].angular_velocity)};
    });
    if (radial) {
      p.radial_inertia = upload_each(radial_, bodies.size(), [&](std::size_t i) {
        const double r = plain_.radius[i];
        return RadialInertia<Real>{static_cast<Real>(bodies[i].inv_mass.x()),
                                   static_cast<Real>(r * r * bodies[i].inv_inertia(0, 0))};
      });
      return;
    }
    p.general_inertia = upload_each(general_, bodies.size(), [&](std::size_t i) {
      GeneralInertia<Real> g;
      g.mass = static_cast<Real>(plain_.mass[i]);
      g.inv_mass = to_vec3<Real>(bodies[i].inv_mass);
      g.inertia = to_sym3<Real>(plain_.inertia[i]);
      g.inv_inertia = to_sym3<Real>(bodies[i].inv_inertia);
      return g;
    });
  }

  void upload_lists() {
    const std::vector<oracle::Contact>& k = plain_.data.contacts;
    const int free_count = plain_.data.free_count;
    std::vector<Index> a_start(free_count + 1, 0), b_start(free_count + 1, 0), b_contact;
    for (const oracle::Contact& c : k) {
      ++a_start[c.a + 1];
      if (c.b < free_count) ++b_start[c.b + 1];
    }
    for (int i = 0; i < free_count; ++i) {
      a_start[i + 1] += a_start[i];
      b_start[i + 1] += b_start[i];
    }
    for (std::size_t c = 0; c < k.size(); ++c) {
      if (k[c].b < free_count) b_contact.push_back(static_cast<Index>(c));
    }
    std::stable_sort(b_contact.begin(), b_contact.end(),
                     [&](Index x, Index y) { return k[x].b < k[y].b; });
    const auto put = [&](const std::vector<Index>& host, Buffer<B, Index>& buffer) {
      upload(*backend_, host, buffer);
      return std::as_const(buffer).view(static_cast<Offset>(host.size()));
    };
    problem_.a_start = put(a_start, a_start_);
    problem_.b_start = put(b_start, b_start_);
    problem_.b_contact = put(b_contact, b_contact_);
  }

  B* backend_;
  PlainProblem plain_;
  ContactProblem<Real> problem_;
  Buffer<B, Index> body_a_, body_b_;
  Buffer<B, Vec3<Real>> normal_;
  Buffer<B, Real> bias_, friction_, adhesion_;
  Buffer<B, Vec3<Real>> arm_a_, arm_b_;
  Buffer<B, RollingRow<Real>> rolling_;
  Buffer<B, Twist<Real>> free_velocity_;
  Buffer<B, RadialInertia<Real>> radial_;
  Buffer<B, GeneralInertia<Real>> general_;
  Buffer<B, Index> a_start_, b_start_, b_contact_;
  Buffer<B, Vec3<Real>> gamma_;
};

}  // namespace scree::fixtures
