#pragma once
// Element programs that find the contacts under bodies far heavier than those they rest on, and
// read what an exact solve of these contacts needs.

#include "kernels/backend/atomic.h"
#include "kernels/backend/backend.h"
#include "kernels/solve/metric_step.h"

namespace scree {

/// Largest ratio of the masses of two bodies that touch.
template <class R, class Real>
struct ContactContrast {
  static constexpr const char* name = "contact_contrast";
  ContactProblem<Real> p;
  SCREE_HD Largest<double> operator()(Index c) const {
    const Index a = p.body_a[c], b = p.body_b[c];
    if (!p.bodies.is_owned(b)) return {};
    const auto m_a = static_cast<double>(R::body_metric(p, c, false, a).normal);
    const auto m_b = static_cast<double>(R::body_metric(p, c, true, b).normal);
    if (!(m_a > 0 && m_b > 0)) return {};
    return {m_a > m_b ? m_a / m_b : m_b / m_a};
  }
};

/// Marks the light bodies of loaded contacts: those whose impulse alone would give the lighter body
/// at least this speed.
template <class R, class Real>
struct MarkLoaded {
  static constexpr const char* name = "mark_loaded";
  ContactProblem<Real> p;
  Span<const Vec3<Real>> gamma;
  double speed;               ///< [m/s]
  Span<std::uint8_t> loaded;  ///< [owned_count] in: zero; out

  SCREE_HD void operator()(Index c) const {
    const Real impulse = norm(R::load(gamma, c).force);
    for (int side = 0; side < 2; ++side) {
      const Index i = side == 0 ? p.body_a[c] : p.body_b[c];
      if (!p.bodies.is_owned(i)) continue;
      const Real response = R::body_metric(p, c, side == 1, i).normal;
      if (static_cast<double>(response * impulse) >= speed) atomic_mark(&loaded[i]);
    }
  }
};

/// Lists the contacts of marked bodies, in any order.
template <class Real>
struct PickLoaded {
  static constexpr const char* name = "pick_loaded";
  ContactProblem<Real> p;
  Span<const std::uint8_t> loaded;
  Index* count;         ///< in: zero; out: contacts, maybe more than there is room for
  Span<Index> contact;  ///< out

  SCREE_HD void operator()(Index c) const {
    const Index a = p.body_a[c], b = p.body_b[c];
    if (loaded[a] == 0 && (!p.bodies.is_owned(b) || loaded[b] == 0)) return;
    const Index at = atomic_add(count, 1);
    if (at < contact.size) contact[at] = c;
  }
};

/// One contact for an exact solve. Rows are normal and two tangents.
struct BlockContact {
  Index body[2] = {};           ///< A and B; -1: does not move
  double wrench[2][3][6] = {};  ///< on A and on B, of a unit impulse along each row
  double motion[2][3][6] = {};  ///< what that does to the velocity of the body
  double impulse[3] = {};       ///< [N s]
  double velocity[3] = {};      ///< J V + bias [m/s]
  double axis[3][3] = {};       ///< of the rows, in world axes
  double friction = 0;
};

/// Reads the contacts of the block.
template <class R, class Real>
struct ReadBlock {
  static constexpr const char* name = "read_block";
  ContactProblem<Real> p;
  Span<const Vec3<Real>> gamma;
  Span<const Twist<Real>> velocity;
  Span<const Index> contact;
  Span<BlockContact> block;  ///< out

  SCREE_HD void operator()(Index k) const {
    const Index c = contact[k];
    BlockContact out;
    const Vec3<Real> n = p.normal[c], t = any_orthogonal(n);
    const Vec3<Real> axis[3] = {n, t, cross(n, t)};
    const auto u = R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]);
    const auto g = R::load(gamma, c);
    out.friction = static_cast<double>(p.friction[c]);
    for (int row = 0; row < 3; ++row) {
      typename R::Rows unit{};
      unit.force = axis[row];
      out.impulse[row] = static_cast<double>(dot(axis[row], g.force));
      out.velocity[row] = static_cast<double>(dot(axis[row], u.force));
      store(Vec3<double>(axis[row]), out.axis[row]);
      for (int side = 0; side < 2; ++side) {
        const Index i = side == 0 ? p.body_a[c] : p.body_b[c];
        out.body[side] = p.bodies.is_owned(i) ? i : -1;
        if (!p.bodies.is_owned(i)) continue;
        const Twist<Real> wrench = R::wrench(p, c, side == 1, unit);
        store(wrench, out.wrench[side][row]);
        store(R::apply_inverse_mass(p, i, wrench), out.motion[side][row]);
      }
    }
    block[k] = out;
  }

 private:
  static SCREE_HD void store(const Vec3<double>& v, double* to) {
    to[0] = v.x, to[1] = v.y, to[2] = v.z;
  }
  static SCREE_HD void store(const Twist<Real>& t, double* to) {
    store(Vec3<double>(t.linear), to);
    store(Vec3<double>(t.angular), to + 3);
  }
};

/// Writes the impulses of the block back.
template <class Real>
struct WriteBlock {
  static constexpr const char* name = "write_block";
  Span<const Index> contact;
  Span<const Vec3<double>> impulse;
  Span<Vec3<Real>> gamma;
  SCREE_HD void operator()(Index k) const { gamma[contact[k]] = Vec3<Real>(impulse[k]); }
};

}  // namespace scree
