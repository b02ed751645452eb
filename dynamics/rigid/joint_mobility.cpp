#include "dynamics/rigid/joint_mobility.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "dynamics/rigid/collision_settings.h"
#include "host/scene/motion.h"
#include "kernels/bodies/locks.h"
#include "kernels/math/sym3.h"
#include "kernels/step/joint_measure.h"

namespace scree {
namespace {

constexpr std::size_t kMostJoints = 24;
/// A row that moves less is held, where the scene begins, but for rounding. It may not be for long, so nothing is known of it.
constexpr double kLeastShare = 1e-7;

using Row = Eigen::Matrix<double, 6, 1>;

/// What a unit impulse along a row does to one body.
struct RowOnBody {
  int body = kWorldBody;
  Row impulse = Row::Zero();   ///< force, and moment about the center of mass
  Row velocity = Row::Zero();  ///< what that gives to the body
};
using RowOnBodies = std::array<RowOnBody, 2>;

bool has_spring(const JointFrames& joint) {
  const bool is_held = (joint.held >> kJointAxisRow & 1u) != 0;
  return !is_held && joint.drive.stiffness > 0;
}

class Mobility {
 public:
  Mobility(const Scene& scene, const std::vector<JointFrames>& frames)
      : scene_(scene), frames_(frames), joints_of_(scene.bodies.size()) {
    for (std::size_t j = 0; j < frames.size(); ++j)
      for (const Index id : frames[j].body)
        if (is_free(id)) joints_of_[static_cast<std::size_t>(id)].push_back(j);
  }

  double share(std::size_t spring) const {
    const std::vector<std::size_t> near = joints_near(spring);
    const RowOnBodies row = rows_of(spring, 1u << kJointAxisRow).front();
    const double alone = left_of(row, held_rows({spring}));
    if (near.size() < 2 || !(alone > 0)) return 1;
    const double share = left_of(row, held_rows(near)) / alone;
    return share < kLeastShare ? 1 : std::min(share, 1.0);
  }

 private:
  bool is_free(Index id) const {
    return id >= 0 && scene_.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free;
  }

  /// A joint and those that are joined with it, the nearest first.
  std::vector<std::size_t> joints_near(std::size_t joint) const {
    std::vector<std::size_t> near{joint};
    for (std::size_t k = 0; k < near.size() && near.size() < kMostJoints; ++k) {
      for (const Index id : frames_[near[k]].body) {
        if (!is_free(id)) continue;
        for (const std::size_t j : joints_of_[static_cast<std::size_t>(id)]) {
          if (near.size() == kMostJoints) break;
          if (std::find(near.begin(), near.end(), j) == near.end()) near.push_back(j);
        }
      }
    }
    return near;
  }

  JointSide side(const JointFrames& joint, int which) const {
    JointSide s;
    const Index id = joint.body[which];
    s.arm = joint.anchor[which];
    s.frame = joint.frame[which];
    if (id == kWorldId) return s;
    const BodyDescription& body = scene_.bodies[static_cast<std::size_t>(id)];
    const Pose pose = pose_at(body, 0);
    const Quatd q = normalized(pose.orientation);
    s.position = pose.position;
    s.arm = rotate(q, joint.anchor[which]);
    s.frame = q * joint.frame[which];
    return s;
  }

  /// Rows of a joint. @param rows  bits, see JointRow
  std::vector<RowOnBodies> rows_of(std::size_t j, unsigned rows) const {
    const JointFrames& joint = frames_[j];
    JointSide a = side(joint, 0);
    const JointSide b = side(joint, 1);
    const Vec3d period = periodic_box(scene_.periodicity).length;
    const JointMeasure m = measure_joint(joint.form, joint.held, joint.zero, a, b, period);
    std::vector<RowOnBodies> out;
    for (int k = 0; k < kJointRows; ++k) {
      if ((rows >> k & 1u) == 0) continue;
      // Of these forms the last two axes change places: the last row is a force.
      bool is_force = k < 3;
      if (ends_with_force(joint.form) && (k == 2 || k == kJointAxisRow)) is_force = !is_force;
      Vec3d axis;
      axis[k % 3] = 1;
      axis = rotate(m.frame, axis);
      RowOnBodies row;
      for (int which = 0; which < 2; ++which) {
        RowOnBody& on = row[static_cast<std::size_t>(which)];
        const double sign = which == 0 ? -1 : 1;
        const Vec3d force = is_force ? sign * axis : Vec3d{};
        const Vec3d moment = is_force ? cross((which == 0 ? a : b).arm, force) : sign * axis;
        on.body = joint.body[which];
        on.impulse << force.x, force.y, force.z, moment.x, moment.y, moment.z;
        if (is_free(on.body)) on.velocity = velocity(on.body, force, moment);
      }
      out.push_back(row);
    }
    return out;
  }

  std::vector<RowOnBodies> held_rows(const std::vector<std::size_t>& joints) const {
    std::vector<RowOnBodies> out;
    for (const std::size_t j : joints) {
      const std::vector<RowOnBodies> rows = rows_of(j, frames_[j].held);
      out.insert(out.end(), rows.begin(), rows.end());
    }
    return out;
  }

  /// Velocity that an impulse gives to a free body. @param moment  about the center of mass
  Row velocity(int id, const Vec3d& force, const Vec3d& moment) const {
    const BodyDescription& body = scene_.bodies[static_cast<std::size_t>(id)];
    const Vec3d linear = (1 / body.mass) * on_axes(force, free_linear_axes(body.locks));
    const Vec3d angular =
        inverse_on_axes(rotated_diagonal(normalized(body.orientation), body.inertia),
                        free_angular_axes(body.locks)) *
        moment;
    Row v;
    v << linear.x, linear.y, linear.z, angular.x, angular.y, angular.z;
    return v;
  }
  /// Velocity of one row by a unit impulse along another.
  static double coupling(const RowOnBodies& from, const RowOnBodies& to) {
    double sum = 0;
    for (const RowOnBody& on : from)
      for (const RowOnBody& of : to)
        if (on.body == of.body) sum += of.impulse.dot(on.velocity);
    return sum;
  }

  /// Velocity that a unit impulse gives a row while others are held.
  static double left_of(const RowOnBodies& row, const std::vector<RowOnBodies>& held) {
    const double alone = coupling(row, row);
    if (held.empty()) return alone;
    const auto n = static_cast<Eigen::Index>(held.size());
    Eigen::MatrixXd among(n, n);
    Eigen::VectorXd with(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const RowOnBodies& own = held[static_cast<std::size_t>(i)];
      with[i] = coupling(row, own);
      for (Eigen::Index k = 0; k <= i; ++k)
        among(i, k) = among(k, i) = coupling(own, held[static_cast<std::size_t>(k)]);
    }
    // Rows of unit size, since forces and moments have other units; those that others hold already may be left out.
    Eigen::VectorXd size = among.diagonal();
    for (double& s : size) s = s > 0 ? 1 / std::sqrt(s) : 0;
    among = size.asDiagonal() * among * size.asDiagonal();
    with = size.cwiseProduct(with);
    among.diagonal().array() += 1e-10;
    return alone - with.dot(among.ldlt().solve(with));
  }

  const Scene& scene_;
  const std::vector<JointFrames>& frames_;
  std::vector<std::vector<std::size_t>> joints_of_;  ///< by free body
};

}  // namespace

std::vector<double> mobility_shares(const Scene& scene, const std::vector<JointFrames>& frames) {
  std::vector<double> out(frames.size(), 1.0);
  if (std::none_of(frames.begin(), frames.end(), has_spring)) return out;
  const Mobility mobility(scene, frames);
  for (std::size_t j = 0; j < frames.size(); ++j)
    if (has_spring(frames[j])) out[j] = mobility.share(j);
  return out;
}

}  // namespace scree
