#pragma once
// The contact problem of a step, copied from backend memory. Internal to host/.

#include <utility>

#include "host/problems/body_problem.h"
#include "kernels/backend/backend.h"
#include "kernels/contact/radial_bodies.h"
#include "solvers/expanded_problem.h"

namespace scree {

template <class T>
Span<const T> host_view(const std::vector<T>& v) {
  return {v.data(), static_cast<Offset>(v.size())};
}

/// The values of a field of `count` contacts on the host, none where it has none.
/// @tparam T  of the values that return
template <class B, class T, class U>
std::vector<T> contact_values(B& b, const Span<const U>& field, Index count,
                              const std::vector<T>&) {
  std::vector<T> values;
  for (const U& value : download(b, field.first(field.empty() ? 0 : count)))
    values.push_back(static_cast<T>(value));
  return values;
}
/// The same of fields that are not always stored.
template <class B, class Field>
requires requires(const Field& field) { field.values; }
std::vector<double> contact_values(B& b, Field field, Index count, const std::vector<double>&) {
  const auto stored = download(b, field.values.first(field.values.empty() ? 0 : count));
  field.values = host_view(stored);
  decltype(download(b, field.values)) gap;
  if constexpr (requires { field.gap; }) {
    gap = download(b, field.gap.first(field.gap.empty() ? 0 : count));
    field.gap = host_view(gap);
  }
  std::vector<double> values(static_cast<std::size_t>(count));
  for (Index c = 0; c < count; ++c) values[static_cast<std::size_t>(c)] = field[c];
  return values;
}

/// The rows that the joints of a problem hold, with their impulses; none may be driven. Row by row
/// they are those of JointRow before these are made independent of each other.
/// @param impulses  of all contacts and joints, in the coordinates of solvers
template <class B, class Real>
std::vector<BilateralRow> download_joints(B& b, const ContactProblem<Real>& p,
                                          const std::vector<Vec3<Real>>& impulses) {
  const std::vector<JointRow<Real>> joints = download(b, p.joints);
  const std::vector<Index> body_a = download(b, p.body_a), body_b = download(b, p.body_b);
  const Index room = p.bodies.fixed_begin - p.bodies.moving_count;
  std::vector<BilateralRow> rows;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointRow<Real>& joint = joints[k];
    const std::size_t c = static_cast<std::size_t>(p.joint_begin) + k;
    JointValues<Real> scaled;
    for (int r = 0; r < kJointRows; ++r)
      scaled[r] = impulses[2 * c + static_cast<std::size_t>(r / 3)][r % 3];
    const JointValues<Real> impulse = joint.impulse(scaled);
    for (int r = 0; r < kJointRows; ++r) {
      if (!(joint.inverse_pivot(r) > Real(0))) continue;
      JointValues<Real> unit;
      unit[r] = 1;
      BilateralRow row;
      row.body_a = body_a[c];
      row.body_b = p.bodies.is_fixed(body_b[c]) ? body_b[c] - room : body_b[c];
      row.arm_a = Vec3d(joint.arm_a);
      row.arm_b = Vec3d(joint.arm_b);
      row.force = Vec3d(joint.world_force(unit));
      row.moment = static_cast<double>(joint.length) * Vec3d(joint.world_moment(unit));
      row.bias = joint.bias[r];
      row.impulse = impulse[r];
      if (row.body_b < row.body_a) {  // the same row, as seen from the other body
        std::swap(row.body_a, row.body_b);
        std::swap(row.arm_a, row.arm_b);
        row.force = -row.force, row.moment = -row.moment;
      }
      rows.push_back(row);
    }
  }
  return rows;
}

/// Biases that a step gave its joints since the problem was copied.
template <class B, class Real>
void store_biases(B& b, const ContactProblem<Real>& p, BodyProblem& stored) {
  std::size_t row = 0;
  for (const JointRow<Real>& joint : download(b, p.joints))
    for (int r = 0; r < kJointRows; ++r)
      if (joint.inverse_pivot(r) > Real(0)) stored.bilateral[row++].bias = joint.bias[r];
}

/// Contacts beside joints have room for rolling friction; without any they are general ones.
inline void drop_empty_rolling(BodyProblem& p) {
  for (const RollingRow<double>& r : p.rolling)
    if (r.rolling > 0 || r.spinning > 0) return;
  p.layout = ContactLayout::general;
  p.rolling.clear();
  for (std::size_t c = 0; 2 * c < p.impulse.size(); ++c) p.impulse[c] = p.impulse[2 * c];
  p.impulse.resize(p.impulse.size() / 2);
}

/// Copies a problem as it is before the solve. Values that the problem works out where they are
/// needed (bias, v*, inertia) are worked out here by the same functions; numbers of float problems
/// become double, which is exact. Room of bodies that join later is left out. Ghosts, which the
/// problem keeps at their velocity, become bodies that do not move.
/// @param guess    impulses as matched with the last step, world frame
/// @param body_id  ids in storage order
template <class B, class Real>
BodyProblem download_problem(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> guess,
                             const std::vector<Index>& body_id) {
  BodyProblem out;
  const bool jointed = p.layout == ContactLayout::jointed;
  const Index contacts = jointed ? p.joint_begin : p.contact_count;
  out.layout = jointed ? ContactLayout::rolling : p.layout;
  out.free_count = p.bodies.owned_count;
  // bodies
  const auto per_body = [&](auto constant, auto& memory) {
    memory = download(b, constant.values);
    constant.values = host_view(memory);
    return constant;
  };
  const auto twists = download(b, p.free_velocity.values);
  const auto velocity = download(b, p.free_velocity.velocity);
  const auto angular_velocity = download(b, p.free_velocity.angular_velocity);
  std::vector<Real> radius, inv_mass;
  FreeVelocity<Real> free_velocity = p.free_velocity;
  free_velocity.values = host_view(twists);
  free_velocity.velocity = host_view(velocity);
  free_velocity.angular_velocity = host_view(angular_velocity);
  free_velocity.radius = per_body(free_velocity.radius, radius);
  const auto inertias = download(b, p.radial_inertia.values);
  RadialInertias<Real> radial = p.radial_inertia;
  radial.values = host_view(inertias);
  radial.inv_mass = per_body(radial.inv_mass, inv_mass);
  const auto general = download(b, p.general_inertia);
  const auto sym = [](const Sym3<Real>& m) {
    Sym3<double> d;
    d.xx = m.xx, d.yy = m.yy, d.zz = m.zz, d.xy = m.xy, d.xz = m.xz, d.yz = m.yz;
    return d;
  };
  for (Index i = 0; i < p.bodies.present_count(); ++i) {
    const Index k = p.bodies.present(i);
    const bool is_owned = p.bodies.is_owned(k);
    // The world, to which joints hold bodies, is no body of the scene.
    const bool is_body = static_cast<std::size_t>(k) < body_id.size();
    out.body_id.push_back(is_body ? body_id[static_cast<std::size_t>(k)] : -1);
    const Twist<Real> rate = free_velocity[k];
    Twist<double> twist;
    twist.linear = Vec3d(rate.linear);
    twist.angular = Vec3d(rate.angular);
    out.free_velocity.push_back(twist);
    if (p.layout == ContactLayout::radial) {
      const RadialInertia<Real> r = is_owned ? radial[k] : RadialInertia<Real>{};
      RadialInertia<double> inertia;
      inertia.inv_mass = r.inv_mass;
      inertia.inv_spin = r.inv_spin;
      out.radial_inertia.push_back(inertia);
    } else {
      const GeneralInertia<Real> g =
          is_owned ? general[static_cast<std::size_t>(k)] : GeneralInertia<Real>{};
      GeneralInertia<double> inertia;
      inertia.mass = g.mass;
      inertia.inv_mass = Vec3d(g.inv_mass);
      inertia.inertia = sym(g.inertia);
      inertia.inv_inertia = sym(g.inv_inertia);
      out.general_inertia.push_back(inertia);
    }
  }

  // contacts
  p.visit([&](const ContactField&, const auto& field,
              auto& values) { values = contact_values(b, field, contacts, values); },
          p, out);
  const Index room = p.bodies.fixed_begin - p.bodies.moving_count;
  for (Index& body : out.body_b)
    if (p.bodies.is_fixed(body)) body -= room;
  const std::vector<Vec3<Real>> impulses = download(b, guess);
  const auto used = static_cast<Offset>(contacts) * vectors_per_contact(p.layout);
  for (Offset k = 0; k < used; ++k) out.impulse.emplace_back(impulses[static_cast<std::size_t>(k)]);
  if (jointed) {
    out.bilateral = download_joints(b, p, impulses);
    drop_empty_rolling(out);
  }
  return out;
}

/// A problem of the general layout whose angular rates were multiplied by lengths, in rad/s and m.
/// @param length  of each body [m]
inline void divide_by_lengths(BodyProblem& p, const std::vector<double>& length) {
  const auto scaled = [](const Sym3<double>& m, double factor) {
    Sym3<double> s;
    s.xx = factor * m.xx, s.yy = factor * m.yy, s.zz = factor * m.zz;
    s.xy = factor * m.xy, s.xz = factor * m.xz, s.yz = factor * m.yz;
    return s;
  };
  for (std::size_t i = 0; i < length.size(); ++i) {
    const double square = length[i] * length[i];
    p.free_velocity[i].angular = (1 / length[i]) * p.free_velocity[i].angular;
    GeneralInertia<double>& g = p.general_inertia[i];
    g.inertia = scaled(g.inertia, square);
    g.inv_inertia = scaled(g.inv_inertia, 1 / square);
  }
  for (std::size_t c = 0; c < p.body_a.size(); ++c) {
    p.arm_a[c] = length[static_cast<std::size_t>(p.body_a[c])] * p.arm_a[c];
    p.arm_b[c] = length[static_cast<std::size_t>(p.body_b[c])] * p.arm_b[c];
  }
}

/// The same for all layouts: a problem of several groups comes as one of the general layout.
template <class B, class Real>
BodyProblem download_any_problem(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> guess,
                                 const std::vector<Index>& body_id, const BodyView<Real>& bodies) {
  if (p.layout != ContactLayout::mixed) return download_problem<B, Real>(b, p, guess, body_id);
  ExpandedProblem<B, Real> expanded(b, p);
  expanded.take_impulses(b, guess);
  BodyProblem out = download_problem<B, Real>(b, expanded.problem(), expanded.impulses(), body_id);
  Buffer<B, Real> lengths(b, bodies.count);
  for_each(b, bodies.count, RateLengths<Real>{bodies, lengths.view()});
  const std::vector<Real> all = download(b, lengths.view(bodies.count));
  std::vector<double> length(all.begin(), all.begin() + bodies.moving_count);
  length.insert(length.end(), all.begin() + bodies.fixed_begin, all.end());
  divide_by_lengths(out, length);
  return out;
}

}  // namespace scree
