#include "dynamics/rigid/held_joints.h"

namespace scree {
namespace {

/// Size of a joint over the length of its moment rows.
constexpr double kJointSize = 0.1;
/// Entries of joints about one body grow with the square of their number.
constexpr std::size_t kMostEntries = 4'000'000;

/// Forces, and moments over the size of the joint. @param z  in the coordinates of solvers
JointValues<double> weighed(const JointRow<double>& joint, const JointValues<double>& z) {
  JointValues<double> g = joint.impulse(z);
  for (int r = 0; r < kJointRows; ++r) {
    const bool is_axial = r == 2 || r == kJointAxisRow;
    const bool is_moment = r >= 3;
    if (is_axial && joint.force_is_last ? !is_moment : is_moment) g[r] /= kJointSize;
  }
  return g;
}

/// Side of the problem that a body of the scene is on.
int side_of(const JointEnds<double>& joint, int side) { return joint.is_turned ? 1 - side : side; }

/// The velocity that a unit impulse on a row gives to the body on one side.
Twist<double> change_of(const JointEnds<double>& joint, int side, int r) {
  JointValues<double> unit;
  unit[r] = 1;
  const Twist<double> w = JointRows<double>::wrench(joint.row, side == 1, unit);
  const auto& body = joint.end[side];
  return {hadamard(body.inv_mass, w.linear), body.inv_inertia * w.angular};
}

}  // namespace

HeldJoints::HeldJoints(const std::vector<std::array<Index, 2>>& bodies, Index body_count)
    : start_(static_cast<std::size_t>(body_count) + 1), place_(bodies.size()) {
  const auto each_end = [&](auto f) {
    for (std::size_t k = 0; k < bodies.size(); ++k)
      for (int side = 0; side < 2; ++side) {
        const Index id = bodies[k][static_cast<std::size_t>(side)];
        if (id >= 0) f(static_cast<std::size_t>(id), End{static_cast<int>(k), side});
      }
  };
  each_end([&](std::size_t id, const End&) { ++start_[id + 1]; });
  for (std::size_t id = 1; id < start_.size(); ++id) start_[id] += start_[id - 1];
  std::vector<int> next = start_;
  ends_.resize(static_cast<std::size_t>(start_.back()));
  each_end([&](std::size_t id, const End& e) { ends_[static_cast<std::size_t>(next[id]++)] = e; });
}

void HeldJoints::improve(std::vector<JointEnds<double>>& joints) {
  list_rows(joints);
  if (rows_ == 0 || !list_entries(joints)) return;
  right_.assign(static_cast<std::size_t>(rows_), 0);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointEnds<double>& j = joints[k];
    const JointValues<double> w =
        JointRows<double>::velocity(j.row, j.end[0].velocity, j.end[1].velocity);
    for (int r = 0; r < kJointRows; ++r)
      if (row(k, r) >= 0) right_[static_cast<std::size_t>(row(k, r))] = -w[r];
  }
  if (!factor_.factorize(rows_, entries_)) return;
  factor_.solve(right_);
  add(joints);
  share_loads(joints);
}

/// Adds what was solved for.
void HeldJoints::add(std::vector<JointEnds<double>>& joints) const {
  for (std::size_t k = 0; k < joints.size(); ++k)
    for (int r = 0; r < kJointRows; ++r)
      if (row(k, r) >= 0) joints[k].impulse[r] += right_[static_cast<std::size_t>(row(k, r))];
}

/// Where joints are redundant many impulses have one effect. Of these the one with the least squares of forces, and of moments
/// over the size of a joint: loads as of joints that are all alike stiff, and small beside their bodies.
void HeldJoints::share_loads(std::vector<JointEnds<double>>& joints) {
  const std::vector<FactorEntry> free = factor_.free_directions();
  if (free.empty()) return;
  std::vector<double> impulse(joints.size() * kJointRows);
  std::vector<int> joint_of_row(static_cast<std::size_t>(rows_));
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointValues<double> g = weighed(joints[k].row, joints[k].impulse);
    for (int r = 0; r < kJointRows; ++r) {
      if (row(k, r) >= 0) joint_of_row[static_cast<std::size_t>(row(k, r))] = static_cast<int>(k);
      impulse[k * kJointRows + static_cast<std::size_t>(r)] = g[r];
    }
  }
  // The directions as impulses: those of one joint follow each other.
  std::vector<FactorEntry> along;
  for (std::size_t at = 0; at < free.size();) {
    const int k = joint_of_row[static_cast<std::size_t>(free[at].row)], column = free[at].column;
    const auto joint = static_cast<std::size_t>(k);
    JointValues<double> z;
    for (; at < free.size() && free[at].column == column &&
           joint_of_row[static_cast<std::size_t>(free[at].row)] == k;
         ++at)
      for (int r = 0; r < kJointRows; ++r)
        if (row(joint, r) == free[at].row) z[r] = free[at].value;
    const JointValues<double> g = weighed(joints[joint].row, z);
    for (int r = 0; r < kJointRows; ++r) along.push_back({k * kJointRows + r, column, g[r]});
  }
  const std::vector<double> ways = ways_to_least(impulse, along);
  if (ways.empty()) return;
  right_.assign(right_.size(), 0);
  for (const FactorEntry& e : free)
    right_[static_cast<std::size_t>(e.row)] -= ways[static_cast<std::size_t>(e.column)] * e.value;
  add(joints);
}

void HeldJoints::list_rows(const std::vector<JointEnds<double>>& joints) {
  rows_ = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointRow<double>& j = joints[k].row;
    for (int r = 0; r < kJointRows; ++r) {
      const bool is_held = joints[k].is_here && j.inverse_pivot(r) > 0 && !j.is_driven(r);
      place_[k][static_cast<std::size_t>(r)] = is_held ? rows_++ : -1;
    }
  }
}

/// What an impulse on each row changes in the rows at its two bodies. False: there are too many.
bool HeldJoints::list_entries(const std::vector<JointEnds<double>>& joints) {
  entries_.clear();
  for (std::size_t body = 0; body + 1 < start_.size(); ++body) {
    const int begin = start_[body], end = start_[body + 1];
    for (int at = begin; at < end; ++at) {
      const End& from = ends_[static_cast<std::size_t>(at)];
      const auto k = static_cast<std::size_t>(from.joint);
      const int side = side_of(joints[k], from.side);
      if (!joints[k].is_here || !joints[k].end[side].moves) continue;
      if (static_cast<std::size_t>(end - begin) * 36 + entries_.size() > kMostEntries) return false;
      for (int r = 0; r < kJointRows; ++r) {
        if (row(k, r) < 0) continue;
        const Twist<double> change = change_of(joints[k], side, r);
        for (int other = begin; other < end; ++other)
          add_entries(joints, from, r, ends_[static_cast<std::size_t>(other)], change);
      }
    }
  }
  return true;
}

/// @param change  of the velocity of the body of both ends
void HeldJoints::add_entries(const std::vector<JointEnds<double>>& joints, const End& from, int r,
                             const End& to, const Twist<double>& change) {
  const auto k = static_cast<std::size_t>(from.joint), m = static_cast<std::size_t>(to.joint);
  if (m < k || !joints[m].is_here) return;  // the lower triangle will do
  const Twist<double> rest;
  JointRow<double> j = joints[m].row;
  j.bias = {};
  const bool is_b = side_of(joints[m], to.side) == 1;
  const JointValues<double> w =
      JointRows<double>::velocity(j, is_b ? rest : change, is_b ? change : rest);
  for (int s = 0; s < kJointRows; ++s)
    if (row(m, s) >= row(k, r)) entries_.push_back({row(m, s), row(k, r), w[s]});
}

}  // namespace scree
