#include "dynamics/rigid/held_joints.h"

#include <algorithm>
#include <limits>

namespace scree {
namespace {

/// Size of a joint over the length of its moment rows.
constexpr double kJointSize = 0.1;
/// Entries of joints about one body grow with the square of their number.
constexpr std::size_t kMostEntries = 4'000'000;
/// Multiplications of a factorization that is worth its time where there are springs, a few milliseconds: they take few
/// iterations. Nets of them are worth it, but those in space, whose factors fill up.
constexpr double kMostWorkWithSprings = 3e6;
/// Square of the part of the speeds of bodies that is taken for none.
constexpr double kNothing = 1e-20;
/// The part of a number that rounding may be.
constexpr double kRounding = 1e-12;
/// See look_at_drives().
constexpr double kLong = 1e3;
/// Times that drives are looked at anew.
constexpr int kMostRounds = 20;

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

/// The velocity that impulses give to the body on one side.
Twist<double> change_of(const JointEnds<double>& joint, int side,
                        const JointValues<double>& impulse) {
  const Twist<double> w = JointRows<double>::wrench(joint.row, side == 1, impulse);
  const auto& body = joint.end[side];
  return {hadamard(body.inv_mass, w.linear), body.inv_inertia * w.angular};
}

JointValues<double> velocity(const JointEnds<double>& joint) {
  return JointRows<double>::velocity(joint.row, joint.end[0].velocity, joint.end[1].velocity);
}

/// Of the bodies, once for each of their joints.
double squares_of_speeds(const std::vector<JointEnds<double>>& joints) {
  double sum = 0;
  for (const JointEnds<double>& joint : joints)
    for (const auto& end : joint.end) sum += norm2(end.velocity.linear);
  return sum;
}

}  // namespace

HeldJoints::HeldJoints(const std::vector<Known>& joints, Index body_count)
    : start_(static_cast<std::size_t>(body_count) + 1), place_(joints.size()) {
  const auto each_end = [&](auto f) {
    for (std::size_t k = 0; k < joints.size(); ++k)
      for (int side = 0; side < 2; ++side) {
        const Index id = joints[k].body[static_cast<std::size_t>(side)];
        if (id >= 0) f(static_cast<std::size_t>(id), End{static_cast<int>(k), side});
      }
  };
  each_end([&](std::size_t id, const End&) { ++start_[id + 1]; });
  for (std::size_t id = 1; id < start_.size(); ++id) start_[id] += start_[id - 1];
  std::vector<int> next = start_;
  ends_.resize(static_cast<std::size_t>(start_.back()));
  each_end([&](std::size_t id, const End& e) { ends_[static_cast<std::size_t>(next[id]++)] = e; });
  takes_springs_ = are_springs_worth_it(joints);
  takes_all_drives_ = std::none_of(joints.begin(), joints.end(), [&](const Known& joint) {
    return joint.rubs || (joint.is_spring && !takes_springs_);
  });
}

bool HeldJoints::are_springs_worth_it(const std::vector<Known>& joints) const {
  if (std::none_of(joints.begin(), joints.end(), [](const Known& j) { return j.is_spring; }))
    return false;
  std::vector<int> first(joints.size());
  int rows = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    first[k] = rows;
    rows += joints[k].rows;
  }
  std::vector<FactorEntry> entries;
  entries.reserve(static_cast<std::size_t>(rows));
  for (int r = 0; r < rows; ++r) entries.push_back({r, r, 1});
  const auto add = [&](std::size_t k, std::size_t m) {
    for (int r = 0; r < joints[k].rows; ++r)
      for (int s = 0; s < joints[m].rows; ++s)
        if (first[m] + s > first[k] + r) entries.push_back({first[m] + s, first[k] + r, 1});
  };
  for (std::size_t body = 0; body + 1 < start_.size(); ++body)
    for (int at = start_[body]; at < start_[body + 1]; ++at)
      for (int other = at; other < start_[body + 1]; ++other) {
        if (entries.size() > kMostEntries) return false;
        const auto k = static_cast<std::size_t>(ends_[static_cast<std::size_t>(at)].joint);
        add(k, static_cast<std::size_t>(ends_[static_cast<std::size_t>(other)].joint));
      }
  return SparseFactor::work(rows, entries) < kMostWorkWithSprings;
}

bool HeldJoints::improve(std::vector<JointEnds<double>>& joints) {
  list_rows(joints);
  free_.clear();
  const bool is_all = is_whole_ && takes_all_drives_;
  if (rows_ == 0) return is_all;
  if (!list_entries(joints)) return false;
  if (!(drives_.empty() ? solve(joints) : find_set(joints))) return false;
  free_ = factor_.free_directions();
  share(joints);
  return is_all;
}

void HeldJoints::share(std::vector<JointEnds<double>>& joints) {
  if (free_.empty()) return;
  if (drives_.empty()) return share_loads(joints, free_);
  const std::vector<JointEnds<double>> unshared = joints;
  share_loads(joints, free_);
  if (drives_hold(joints)) return;
  joints = unshared;
  share_loads(joints, free_without_drives());
}

/// Takes the velocities of rows that hold to where they belong, the others keep their impulse.
bool HeldJoints::solve(std::vector<JointEnds<double>>& joints) {
  right_.assign(static_cast<std::size_t>(rows_), 0);
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointValues<double> w = velocity(joints[k]);
    for (int r = 0; r < kJointRows; ++r)
      if (row(k, r) >= 0) right(k, r) = -w[r];
  }
  for (const Drive& d : drives_) {
    double& of_row = right(d.joint, kJointAxisRow);
    of_row = d.holds() ? d.target + of_row : 0;
  }
  if (!drives_.empty()) list_entries_of_set(joints);
  if (!factor_.factorize(rows_, drives_.empty() ? entries_ : of_set_)) return false;
  factor_.solve(right_);
  add(joints);
  return true;
}

/// The same, with the drives that hold by their laws. False: they were not found, and impulses are the best of those seen.
bool HeldJoints::find_set(std::vector<JointEnds<double>>& joints) {
  const double nothing = kNothing * squares_of_speeds(joints);
  double least = std::numeric_limits<double>::infinity();
  std::vector<JointEnds<double>> best;
  for (int round = 0; round <= kMostRounds; ++round) {
    const bool is_same = look_at_drives(joints, /*is_first=*/round == 0);
    const double left = left_over(joints);
    if (left <= std::max(least, nothing)) {
      least = left;
      best = joints;
      if (round > 0 && (is_same || left <= nothing)) return true;
    }
    if (is_same || round == kMostRounds) break;
    let_go(joints);
    if (!solve(joints)) break;
    move_bodies(joints);
  }
  joints = best;
  return false;
}

/// Finds what decides about drives by their impulses and velocities. Laws are lines with corners: from a part of one a drive goes to
/// the next part, as in a step that is long beside impulses that it cannot have, and short beside velocities. Else it may go
/// from one limit to the other and back for ever.
/// @return  whether that is what it was before
bool HeldJoints::look_at_drives(const std::vector<JointEnds<double>>& joints, bool is_first) {
  bool is_same = !is_first;
  for (Drive& d : drives_) {
    const JointEnds<double>& j = joints[d.joint];
    const double own = 1 / j.row.scale, impulse = j.impulse[kJointAxisRow];
    const double w = velocity(j)[kJointAxisRow];
    const double step = is_first ? own : (d.holds() ? kLong * own : own / kLong);
    const DrivenImpulse<double> now = j.row.driven(impulse - step * w, step);
    const double off = impulse - now.impulse;
    const bool is_at_bound = std::abs(off) <= kRounding * std::abs(impulse);
    is_same = is_same && now.by == d.by && (d.holds() || is_at_bound);
    d.by = now.by;
    d.off = off;
    d.target = w - off * (1 / step + (now.by == DrivePart::main ? j.row.compliance : 0));
  }
  return is_same;
}

/// Drives that do not hold give what they give.
void HeldJoints::let_go(std::vector<JointEnds<double>>& joints) {
  right_.assign(static_cast<std::size_t>(rows_), 0);
  for (const Drive& d : drives_)
    if (!d.holds()) right(d.joint, kJointAxisRow) = -d.off;
  add(joints);
  move_bodies(joints);
}

/// Sum of the squares of what the rows are off by, as velocities.
double HeldJoints::left_over(const std::vector<JointEnds<double>>& joints) const {
  double sum = 0;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointValues<double> w = velocity(joints[k]);
    for (int r = 0; r < kJointRows; ++r)
      if (row(k, r) >= 0 && !joints[k].row.is_driven(r)) sum += w[r] * w[r];
  }
  for (const Drive& d : drives_) {
    const JointRow<double>& row = joints[d.joint].row;
    const double impulse = joints[d.joint].impulse[kJointAxisRow];
    const double w = velocity(joints[d.joint])[kJointAxisRow];
    const double off =
        row.scale * (impulse - row.driven(impulse - w / row.scale, 1 / row.scale).impulse);
    sum += off * off;
  }
  return sum;
}

/// What was solved for changes the velocities of bodies.
void HeldJoints::move_bodies(std::vector<JointEnds<double>>& joints) const {
  for (std::size_t body = 0; body + 1 < start_.size(); ++body) {
    Twist<double> change;
    const auto each_end = [&](auto f) {
      for (int at = start_[body]; at < start_[body + 1]; ++at) {
        const End& e = ends_[static_cast<std::size_t>(at)];
        const auto k = static_cast<std::size_t>(e.joint);
        const int side = side_of(joints[k], e.side);
        if (joints[k].is_here && joints[k].end[side].moves) f(k, side);
      }
    };
    each_end([&](std::size_t k, int side) {
      JointValues<double> given;
      for (int r = 0; r < kJointRows; ++r)
        if (row(k, r) >= 0) given[r] = right_[static_cast<std::size_t>(row(k, r))];
      change = change + change_of(joints[k], side, given);
    });
    each_end([&](std::size_t k, int side) {
      Twist<double>& v = joints[k].end[side].velocity;
      v = v + change;
    });
  }
}

/// Adds what was solved for.
void HeldJoints::add(std::vector<JointEnds<double>>& joints) const {
  for (std::size_t k = 0; k < joints.size(); ++k)
    for (int r = 0; r < kJointRows; ++r)
      if (row(k, r) >= 0) joints[k].impulse[r] += right_[static_cast<std::size_t>(row(k, r))];
}

/// Where joints are redundant many impulses have one effect. Of these the one with the least squares of forces, and of moments
/// over the size of a joint: loads as of joints that are all alike stiff, and small beside their bodies.
void HeldJoints::share_loads(std::vector<JointEnds<double>>& joints,
                             const std::vector<FactorEntry>& free) {
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

/// Directions in which no drives take part.
std::vector<FactorEntry> HeldJoints::free_without_drives() const {
  std::vector<char> is_drive(static_cast<std::size_t>(rows_));
  for (const Drive& d : drives_)
    is_drive[static_cast<std::size_t>(row(d.joint, kJointAxisRow))] = 1;
  std::vector<FactorEntry> kept;
  int columns = 0;
  for (std::size_t at = 0, end = 0; at < free_.size(); at = end) {
    bool is_moved = false;
    for (; end < free_.size() && free_[end].column == free_[at].column; ++end)
      is_moved = is_moved || is_drive[static_cast<std::size_t>(free_[end].row)] != 0;
    if (is_moved) continue;
    for (std::size_t k = at; k < end; ++k) kept.push_back({free_[k].row, columns, free_[k].value});
    ++columns;
  }
  return kept;
}

/// Whether drives that hold do so by the impulses that they have.
bool HeldJoints::drives_hold(const std::vector<JointEnds<double>>& joints) const {
  return std::all_of(drives_.begin(), drives_.end(), [&](const Drive& d) {
    const JointRow<double>& row = joints[d.joint].row;
    const JointValues<double> w = velocity(joints[d.joint]);
    const double z = joints[d.joint].impulse[kJointAxisRow] - w[kJointAxisRow] / row.scale;
    return !d.holds() || row.driven(z, 1 / row.scale).by == d.by;
  });
}

/// Unknowns: rows that are held, and drives.
void HeldJoints::list_rows(const std::vector<JointEnds<double>>& joints) {
  rows_ = 0;
  drives_.clear();
  is_whole_ = true;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointRow<double>& j = joints[k].row;
    is_whole_ = is_whole_ && joints[k].is_here;
    const bool takes_drive = !j.rubs && (takes_springs_ || !(j.compliance > 0));
    for (int r = 0; r < kJointRows; ++r) {
      const bool is_there =
          joints[k].is_here && j.inverse_pivot(r) > 0 && (takes_drive || !j.is_driven(r));
      place_[k][static_cast<std::size_t>(r)] = is_there ? rows_++ : -1;
      if (is_there && j.is_driven(r)) drives_.push_back({.joint = k});
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
        JointValues<double> unit;
        unit[r] = 1;
        const Twist<double> change = change_of(joints[k], side, unit);
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

/// The same for the rows that hold; the others stand alone, so that the pattern stays.
void HeldJoints::list_entries_of_set(const std::vector<JointEnds<double>>& joints) {
  std::vector<char> holds(static_cast<std::size_t>(rows_), 1);
  for (const Drive& d : drives_)
    holds[static_cast<std::size_t>(row(d.joint, kJointAxisRow))] = d.holds() ? 1 : 0;
  of_set_ = entries_;
  for (FactorEntry& e : of_set_)
    if (e.row != e.column && (holds[static_cast<std::size_t>(e.row)] == 0 ||
                              holds[static_cast<std::size_t>(e.column)] == 0))
      e.value = 0;
  for (const Drive& d : drives_) {
    const int r = row(d.joint, kJointAxisRow);
    if (d.by == DrivePart::main) of_set_.push_back({r, r, joints[d.joint].row.compliance});
  }
}

}  // namespace scree
