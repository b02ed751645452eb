#pragma once
// Contact problems for tests in backend buffers, with the numbers of plain ones.

#include <algorithm>
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
        lists_{Lists(b), Lists(b)},
        gamma_(b) {
    const oracle::Problem& d = plain_.data;
    ContactProblem<Real>& p = problem_;
    p.layout = plain_.layout;
    p.contact_count = plain_.contact_count();
    p.bodies = {d.free_count, d.free_count, d.free_count, static_cast<Index>(d.bodies.size())};
    p.radial_count = plain_.radial_count;
    upload_contacts();
    upload_bodies();
    const bool mixed = p.layout == ContactLayout::mixed;
    const ContactLists first = upload_lists(0, mixed ? p.radial_count : p.contact_count, lists_[0]);
    p.a_start = first.a_start;
    p.b_start = first.b_start;
    p.b_contact = first.b_contact;
    if (mixed) p.later[0] = upload_lists(p.radial_count, p.contact_count, lists_[1]);
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
  /// The oracle's twists (v, w) from the solver's: of spheres those carry the surface speed r w.
  Eigen::VectorXd velocities(Span<const Twist<Real>> twists) {
    const std::vector<Twist<Real>> host = download(*backend_, twists);
    Eigen::VectorXd v(6 * static_cast<Eigen::Index>(host.size()));
    for (std::size_t i = 0; i < host.size(); ++i) {
      const double scale = 1 / length(i);
      v.segment<3>(6 * static_cast<Eigen::Index>(i)) = to_eigen(Vec3<double>(host[i].linear));
      v.segment<3>(6 * static_cast<Eigen::Index>(i) + 3) =
          scale * to_eigen(Vec3<double>(host[i].angular));
    }
    return v;
  }

 private:
  struct Lists {
    explicit Lists(B& b) : a_start(b), b_start(b), b_contact(b) {}
    Buffer<B, Index> a_start, b_start, b_contact;
  };

  /// Scale of the angular rates of a body.
  double length(std::size_t i) const {
    const bool has_radial = plain_.layout == ContactLayout::radial || is_mixed();
    return has_radial ? plain_.radius[i] : 1;
  }
  bool is_mixed() const { return plain_.layout == ContactLayout::mixed; }

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
    const auto first = static_cast<std::size_t>(plain_.radial_count);
    const auto body = [](int i) { return static_cast<std::size_t>(i); };
    p.arm_a = upload_each(arm_a_, n - first, [&](std::size_t c) {
      return to_vec3<Real>(k[first + c].arm_a / length(body(k[first + c].a)));
    });
    p.arm_b = upload_each(arm_b_, n - first, [&](std::size_t c) {
      return to_vec3<Real>(k[first + c].arm_b / length(body(k[first + c].b)));
    });
    if (p.layout != ContactLayout::rolling) return;
    p.rolling = upload_each(rolling_, n, [&](std::size_t c) {
      return RollingRow<Real>{real(k[c].length), real(k[c].rolling), real(k[c].spinning)};
    });
  }

  void upload_bodies() {
    const std::vector<oracle::Body>& bodies = plain_.data.bodies;
    const bool radial = plain_.layout == ContactLayout::radial;
    ContactProblem<Real>& p = problem_;
    p.free_velocity = upload_each(free_velocity_, bodies.size(), [&](std::size_t i) {
      return Twist<Real>{to_vec3<Real>(bodies[i].velocity),
                         to_vec3<Real>(length(i) * bodies[i].angular_velocity)};
    });
    if (radial || is_mixed()) {
      p.radial_inertia = upload_each(radial_, bodies.size(), [&](std::size_t i) {
        const double r = plain_.radius[i];
        if (!plain_.is_sphere[i]) return RadialInertia<Real>{};
        return RadialInertia<Real>{static_cast<Real>(bodies[i].inv_mass.x()),
                                   static_cast<Real>(r * r * bodies[i].inv_inertia(0, 0))};
      });
    }
    const auto spheres = std::count(plain_.is_sphere.begin(), plain_.is_sphere.end(), true);
    if (radial || (is_mixed() && spheres == plain_.data.free_count)) return;
    p.general_inertia = upload_each(general_, bodies.size(), [&](std::size_t i) {
      GeneralInertia<Real> g;
      g.mass = static_cast<Real>(plain_.mass[i]);
      g.inv_mass = to_vec3<Real>(bodies[i].inv_mass);
      const double square = length(i) * length(i);
      g.inertia = to_sym3<Real>(plain_.inertia[i] / square);
      g.inv_inertia = to_sym3<Real>(bodies[i].inv_inertia * square);
      return g;
    });
  }

  /// Of the group of contacts [first, last).
  ContactLists upload_lists(Index first, Index last, Lists& lists) {
    const std::vector<oracle::Contact> k(plain_.data.contacts.begin() + first,
                                         plain_.data.contacts.begin() + last);
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
    return {first, put(a_start, lists.a_start), put(b_start, lists.b_start),
            put(b_contact, lists.b_contact)};
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
  Lists lists_[2];
  Buffer<B, Vec3<Real>> gamma_;
};

}  // namespace scree::fixtures
