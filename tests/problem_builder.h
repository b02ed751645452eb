#pragma once
// Contact problems for tests in backend buffers, with the numbers of plain ones.

#include <cmath>
#include <cstdint>
#include <vector>

#include "kernels/backend/backend.h"
#include "tests/plain_problem.h"

namespace scree::fixtures {

inline Eigen::Vector3d to_eigen(const Vec3<double>& v) { return {v.x, v.y, v.z}; }
template <class Real>
Vec3<Real> to_vec3(const Eigen::Vector3d& v) {
  return {static_cast<Real>(v.x()), static_cast<Real>(v.y()), static_cast<Real>(v.z())};
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
  /// The oracle's twists (v, w) from the solver's: in the radial layout those carry
  /// the surface speed r w.
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
