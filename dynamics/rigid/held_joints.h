#pragma once
// A guess of the impulses of joints: those that take the velocities of all rows that joints hold to zero, all at once.

#include <array>
#include <vector>

#include "dynamics/rigid/shared_loads.h"
#include "dynamics/rigid/sparse_factor.h"
#include "kernels/contact/contact_operator.h"
#include "kernels/contact/joint_rows.h"

namespace scree {

/// Iterations carry an impulse from joint to joint, so those of a chain of n links take n of them and more. Where nothing but held
/// rows are there, this solves the step, and the solver sees that its guess is the answer; contacts, motors and limits keep the
/// impulse that they have, and are left to the solver. On the host, in double precision, with equal bits on any number of threads.
template <class Real>
class HeldJoints {
 public:
  /// @param p         a problem of the jointed layout, in host memory
  /// @param gamma     impulses in the coordinates of solvers, in and out
  /// @param velocity  of owned bodies under these impulses
  void improve(const ContactProblem<Real>& p, Span<const Twist<Real>> velocity,
               Span<Vec3<Real>> gamma) {
    list_rows(p);
    if (rows_ == 0) return;
    if (!list_entries(p)) return;
    right_.assign(static_cast<std::size_t>(rows_), 0);
    for (Index k = 0; k < p.joints.size; ++k) {
      const JointRow<double>& j = joint_[static_cast<std::size_t>(k)];
      const Index c = p.joint_begin + k;
      const JointValues<double> w =
          JointRows<double>::velocity(j, widened(velocity_of(p, velocity, p.body_a[c])),
                                      widened(velocity_of(p, velocity, p.body_b[c])));
      for (int r = 0; r < kJointRows; ++r)
        if (row(k, r) >= 0) right_[static_cast<std::size_t>(row(k, r))] = -w[r];
    }
    if (!factor_.factorize(rows_, entries_)) return;
    factor_.solve(right_);
    add(p, gamma);
    share_loads(p, gamma);
  }

 private:
  /// Size of a joint over the length of its moment rows.
  static constexpr double kJointSize = 0.1;
  /// Entries of joints about one body grow with the square of their number.
  static constexpr std::size_t kMostEntries = 4'000'000;

  static Real& impulse_of(const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, Index joint,
                          int r) {
    return gamma[2 * static_cast<Offset>(p.joint_begin + joint) + r / 3][r % 3];
  }

  /// Adds what was solved for.
  void add(const ContactProblem<Real>& p, Span<Vec3<Real>> gamma) {
    for (Index k = 0; k < p.joints.size; ++k)
      for (int r = 0; r < kJointRows; ++r)
        if (row(k, r) >= 0)
          impulse_of(p, gamma, k, r) +=
              static_cast<Real>(right_[static_cast<std::size_t>(row(k, r))]);
  }

  /// Where joints are redundant many impulses have one effect. Of these the one with the least squares of forces, and of moments
  /// over the size of a joint: loads as of joints that are all alike stiff, and small beside their bodies.
  void share_loads(const ContactProblem<Real>& p, Span<Vec3<Real>> gamma) {
    const std::vector<FactorEntry> free = factor_.free_directions();
    if (free.empty()) return;
    std::vector<double> impulse(static_cast<std::size_t>(p.joints.size) * kJointRows);
    std::vector<int> joint_of_row(static_cast<std::size_t>(rows_));
    for (Index k = 0; k < p.joints.size; ++k) {
      JointValues<double> z;
      for (int r = 0; r < kJointRows; ++r) {
        z[r] = impulse_of(p, gamma, k, r);
        if (row(k, r) >= 0) joint_of_row[static_cast<std::size_t>(row(k, r))] = k;
      }
      const JointValues<double> g = weighed(k, z);
      for (int r = 0; r < kJointRows; ++r)
        impulse[static_cast<std::size_t>(k) * kJointRows + static_cast<std::size_t>(r)] = g[r];
    }
    // The directions as impulses: those of one joint follow each other.
    std::vector<FactorEntry> along;
    for (std::size_t at = 0; at < free.size();) {
      const int k = joint_of_row[static_cast<std::size_t>(free[at].row)], column = free[at].column;
      JointValues<double> z;
      for (; at < free.size() && free[at].column == column &&
             joint_of_row[static_cast<std::size_t>(free[at].row)] == k;
           ++at)
        for (int r = 0; r < kJointRows; ++r)
          if (row(k, r) == free[at].row) z[r] = free[at].value;
      const JointValues<double> g = weighed(k, z);
      for (int r = 0; r < kJointRows; ++r) along.push_back({k * kJointRows + r, column, g[r]});
    }
    const std::vector<double> ways = ways_to_least(impulse, along);
    if (ways.empty()) return;
    right_.assign(right_.size(), 0);
    for (const FactorEntry& e : free)
      right_[static_cast<std::size_t>(e.row)] -= ways[static_cast<std::size_t>(e.column)] * e.value;
    add(p, gamma);
  }

  /// Forces, and moments over the size of the joint. @param z  in the coordinates of solvers
  JointValues<double> weighed(int joint, const JointValues<double>& z) const {
    const JointRow<double>& j = joint_[static_cast<std::size_t>(joint)];
    JointValues<double> g = j.impulse(z);
    for (int r = 0; r < kJointRows; ++r) {
      const bool is_axial = r == 2 || r == kJointAxisRow;
      const bool is_moment = r >= 3;
      if (is_axial && j.force_is_last ? !is_moment : is_moment) g[r] /= kJointSize;
    }
    return g;
  }

  int row(Index joint, int r) const {
    return place_[static_cast<std::size_t>(joint)][static_cast<std::size_t>(r)];
  }

  /// Rows with a ghost keep their impulse: its owner would guess another.
  void list_rows(const ContactProblem<Real>& p) {
    rows_ = 0;
    place_.clear();
    joint_.clear();
    for (Index k = 0; k < p.joints.size; ++k) {
      const JointRow<Real>& j = p.joints[k];
      const Index c = p.joint_begin + k;
      const bool has_ghost = p.bodies.is_ghost(p.body_a[c]) || p.bodies.is_ghost(p.body_b[c]);
      std::array<int, kJointRows> place;
      for (int r = 0; r < kJointRows; ++r) {
        const bool is_held = !has_ghost && j.inverse_pivot(r) > Real(0) && !j.is_driven(r);
        place[static_cast<std::size_t>(r)] = is_held ? rows_++ : -1;
      }
      place_.push_back(place);
      joint_.push_back(widened(j));
    }
  }

  /// What an impulse on each row changes in the rows at its two bodies. False: there are too many.
  bool list_entries(const ContactProblem<Real>& p) {
    entries_.clear();
    for (Index k = 0; k < p.joints.size; ++k) {
      for (const bool side_b : {false, true}) {
        const Index c = p.joint_begin + k;
        const Index i = side_b ? p.body_b[c] : p.body_a[c];
        if (!p.bodies.is_owned(i)) continue;
        const ContactLists& list = p.later[0];
        if (static_cast<std::size_t>(list.count(i)) * 36 + entries_.size() > kMostEntries)
          return false;
        for (int r = 0; r < kJointRows; ++r) {
          if (row(k, r) < 0) continue;
          const Twist<double> change = change_of(p, i, k, side_b, r);
          for (Index m = list.a_start[i]; m < list.a_start[i + 1]; ++m)
            add_entries(k, r, m, false, change);
          for (Index b = list.b_start[i]; b < list.b_start[i + 1]; ++b)
            add_entries(k, r, list.b_contact[b], true, change);
        }
      }
    }
    return true;
  }

  /// The velocity that a unit impulse on row r of joint k gives to body i.
  Twist<double> change_of(const ContactProblem<Real>& p, Index i, Index k, bool side_b,
                          int r) const {
    JointValues<double> unit;
    unit[r] = 1;
    const Twist<double> w =
        JointRows<double>::wrench(joint_[static_cast<std::size_t>(k)], side_b, unit);
    const GeneralInertia<Real>& own = p.general_inertia[i];
    const Sym3<Real>& m = own.inv_inertia;
    Sym3<double> inverse;
    inverse.xx = m.xx, inverse.yy = m.yy, inverse.zz = m.zz;
    inverse.xy = m.xy, inverse.xz = m.xz, inverse.yz = m.yz;
    return {hadamard(Vec3<double>(own.inv_mass), w.linear), inverse * w.angular};
  }

  void add_entries(Index k, int r, Index m, bool side_b, const Twist<double>& change) {
    const Twist<double> rest;
    JointRow<double> j = joint_[static_cast<std::size_t>(m)];
    j.bias = {};
    const JointValues<double> w =
        JointRows<double>::velocity(j, side_b ? rest : change, side_b ? change : rest);
    for (int s = 0; s < kJointRows; ++s)
      if (row(m, s) >= row(k, r)) entries_.push_back({row(m, s), row(k, r), w[s]});
  }

  static Twist<Real> velocity_of(const ContactProblem<Real>& p, Span<const Twist<Real>> velocity,
                                 Index i) {
    return p.bodies.is_owned(i) ? velocity[i] : p.free_velocity[i];
  }
  static Twist<double> widened(const Twist<Real>& t) {
    return {Vec3<double>(t.linear), Vec3<double>(t.angular)};
  }
  /// What the rows are, without what drives the last one.
  static JointRow<double> widened(const JointRow<Real>& j) {
    JointRow<double> w;
    w.arm_a = Vec3<double>(j.arm_a);
    w.arm_b = Vec3<double>(j.arm_b);
    for (int k = 0; k < 3; ++k) w.axes[k] = Vec3<double>(j.axes[k]);
    w.length = j.length;
    for (int k = 0; k < kJointRows; ++k) w.bias[k] = j.bias[k];
    for (int k = 0; k < kJointTriangle; ++k) w.factor[k] = j.factor[k];
    w.scale = j.scale;
    w.force_is_last = j.force_is_last;
    return w;
  }

  int rows_ = 0;
  std::vector<std::array<int, kJointRows>> place_;  ///< unknown of each row, -1: none
  std::vector<JointRow<double>> joint_;
  std::vector<FactorEntry> entries_;
  std::vector<double> right_;
  SparseFactor factor_;
};

}  // namespace scree
